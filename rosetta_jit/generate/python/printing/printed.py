"""What the printers of statements share: a function that is printed, how it comes to objects, and how it is called."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence

from rosetta_jit.backends.printing import Writer
from rosetta_jit.generate.origins import Origin
from rosetta_jit.generate.parentheses import bare
from rosetta_jit.generate.python.passes.direct import Direct, LateRow
from rosetta_jit.generate.python.printing.expressions import expression
from rosetta_jit.generate.python.printing.scope import Scope
from rosetta_jit.kernel import ir, nodes
from rosetta_jit.model.layout import Layout, Span
from rosetta_jit.startup.dataclass import dataclass, field


@dataclass(frozen=True, slots=True)
class Attempt:
    """A body as a function: its name, and the names of what it needs of the message's lanes and row; ``is_bounded`` says that it asks
    how many rows the message may take.

    Of a routine, ``is_mostly_a_byte`` says that its results are a byte and the place behind it, unless that byte is 128 or more;
    ``may_lack`` that this byte may be missing.
    """

    name: str
    needs: tuple[str, ...]
    is_mostly_a_byte: bool = False
    may_lack: bool = True
    is_bounded: bool = True

    def arguments(self) -> str:
        """What a decoder is called with."""
        return ", ".join(["data", "end", *(["most"] if self.is_bounded else []), *self.needs])


@dataclass(frozen=True, slots=True)
class Objects:
    """How a function comes to objects: ``result`` is what a return of success gives at a position.

    Where a body sets ``attributes`` of the object (`sparse`), ``begun`` makes it, and ``settings`` are the lines before a return;
    it may lack the groups ``late_lists``. ``late_rows`` are the lanes whose rows may be so, too.

    Of decoders ``row`` is the object of a lane's row, ``inner`` are the lines of functions for rows that contain rows of their own type,
    ``inner_names`` what these are called: they refer to themselves, and to all rows, which would stay in memory for a while.
    ``arrays`` are the lanes of arrays in the ``layout``, ``inner_arrays`` these and those in types that contain themselves, and ``blobs``
    those of bytes among them. ``numpy``: arrays of numbers are numpy's; ``classes`` are the names of classes, which no local hides.
    """

    result: Callable[[Scope, str], str]
    attributes: Callable[[nodes.Block, frozenset[tuple[int, str]], Direct], dict[int, str] | None] = lambda _, __, ___: None
    begun: Callable[[Scope], list[str]] = lambda _: []
    settings: Callable[[Scope], list[str]] = lambda _: []
    late_lists: Callable[[Scope], tuple[tuple[Span, ...], ...]] = lambda _: ()
    row: Callable[[Scope, int], str] = lambda _, lane: f"<row {lane}>"
    inner: Callable[[Scope], list[str]] = lambda _: []
    inner_names: Callable[[Scope], list[str]] = lambda _: []
    layout: Layout | None = None
    arrays: frozenset[int] = frozenset()
    inner_arrays: frozenset[int] = frozenset()
    blobs: frozenset[int] = frozenset()
    numpy: bool = False
    classes: frozenset[str] = frozenset()
    late_rows: Mapping[int, LateRow] = field(default_factory=dict[int, LateRow])


@dataclass(slots=True)
class Function:
    """One function being printed; ``routines`` are functions by name with what they need.

    ``settled`` are the fields of the message's row, by offset and type, that are set whatever the message is before any is read.
    ``unasked`` are the presence words for which nothing asks. ``positive`` are the locals that are not negative; ``reserved`` says how
    often rows of a lane are reserved, ``outside`` of which lanes that is not within a loop or a case, and nothing asks for their room.
    ``measured`` are the hidden lanes that an encoder gets as measuring has left them.
    """

    scope: Scope
    kernel: ir.Kernel
    sites: Sequence[ir.Site]
    routines: Mapping[str, Attempt]
    origins: Sequence[Origin]
    objects: Objects
    settled: frozenset[tuple[int, str]] = frozenset()
    unasked: frozenset[nodes.Place] = frozenset()
    read: frozenset[str] = frozenset()
    is_routine: bool = False
    measured: range = range(0)
    moved: set[int] = field(default_factory=set[int])
    positive: frozenset[str] = frozenset()
    reserved: Counter[int] = field(default_factory=Counter[int])
    outside: set[int] = field(default_factory=set[int])
    writer: Writer = field(default_factory=lambda: Writer(depth=1))

    def line(self, text: str) -> None:
        self.writer.line(text)

    def text(self, expr: nodes.Expr) -> str:
        return bare(expression(self.scope, expr))
