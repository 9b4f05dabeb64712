"""A function of C while it is printed, and the statements by which it fails.

What a message cannot be ends a function with a negative result: `fail` notes the site, the offset and the indices.
"""

from __future__ import annotations

from collections.abc import Generator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

from rosetta_jit.backends.printing import Writer
from rosetta_jit.generate.c.printing.expressions import expression
from rosetta_jit.generate.c.printing.room import moved
from rosetta_jit.generate.c.texts import comment
from rosetta_jit.generate.origins import Origin, described
from rosetta_jit.generate.parentheses import bare
from rosetta_jit.generate.passes.descents import Visit
from rosetta_jit.generate.passes.positions import NONE, Positions, is_position
from rosetta_jit.generate.unit import Role
from rosetta_jit.kernel import ir, nodes
from rosetta_jit.kernel.terms import END, add
from rosetta_jit.startup.dataclass import dataclass, field

if TYPE_CHECKING:
    from rosetta_jit.generate.c.printing.scope import Scope


@dataclass(frozen=True, slots=True)
class Callable:
    """A routine as a C function: its name, what it takes besides its own parameters, and which results are positions of the message.

    Where ``returns``, its only result is what it returns, a negative number where it fails.
    """

    name: str
    shared: tuple[str, ...]
    fails: bool
    positions: frozenset[int] = frozenset()
    returns: bool = False


@dataclass(slots=True)
class Function:
    """One function being printed.

    ``read`` are the locals whose values anything needs; ``finish`` are the lines before a return of success. ``is_routine``: it
    returns the numbers of its own sites. ``visits`` are the calls that write the messages of an array. ``numbers`` are the rows of the
    file's table that sites of the kernel have got, ``origins`` what rules of the mapping name. ``role`` is what its kernel is for, ``body``
    the number of the body, if that has several. ``otherwise`` is what is done where a message cannot be, if nobody is told why. ``known``
    are positions of the message where the next statement stands, ``aligned`` other forms of values that the block's locals have.
    """

    scope: Scope
    sites: Sequence[ir.Site]
    routines: Mapping[str, Callable]
    read: frozenset[str] = frozenset()
    finish: tuple[str, ...] = ()
    is_routine: bool = False
    visits: Mapping[str, Visit] = field(default_factory=dict[str, Visit])
    numbers: dict[int, int] = field(default_factory=lambda: {0: 0})
    origins: Sequence[Origin] = ()
    role: Role = "decode"
    body: str = ""
    otherwise: str = ""
    known: Positions = NONE
    aligned: Mapping[str, nodes.Expr] = field(default_factory=dict[str, nodes.Expr])
    writer: Writer = field(default_factory=lambda: Writer(depth=1))

    def line(self, text: str) -> None:
        self.writer.line(text)

    def site(self, number: int) -> int:
        """The row of a site in the table, which has those alone that a function names."""
        return number if self.is_routine else self.numbers.setdefault(number, len(self.numbers))

    def kept_lines(self) -> list[str]:
        """The lines, without those that find the rows anew of lanes whose rows it does not touch."""
        needless = {moved(self.scope.lanes, lane) for lane in self.scope.moved - self.scope.touched}
        return [line for line in self.writer.lines if line.strip() not in needless]

    @contextmanager
    def block(self, head: str) -> Generator[None]:
        """Braces around what is written until the end of the `with`."""
        with self.writer.indented(f"{head} {{"):
            yield
        self.line("}")


def lacks(function: Function, at: nodes.Expr, size: nodes.Expr) -> str:
    """Whether some of ``size`` bytes from ``at`` are missing."""
    scope = function.scope
    is_known = is_position(function.known, at)
    match size:
        case nodes.Const(_, length) if is_known and length >= 0:
            return f"({expression(scope, END)} < {bare(expression(scope, add(at, size)))})"
        case _:
            arguments = [bare(expression(scope, each)) for each in (at, size, END)]
            return f"{scope.calls('lacks_behind' if is_known else 'lacks')}({', '.join(arguments)})"


def fail_if(function: Function, condition: str, failure: nodes.Failure) -> None:
    """Fail under a condition."""
    with function.block(f"if ({bare(condition)})"):
        fail(function, failure)


def fail(function: Function, failure: nodes.Failure) -> None:
    """Fail at a site."""
    failed(
        function, str(function.site(failure.site)), expression(function.scope, failure.at), failure.indices, function.sites[failure.site]
    )


def failed(function: Function, site: str, at: str, indices: tuple[nodes.Expr, ...], about: ir.Site | None) -> None:
    """Leave the function. A routine leaves the indices to who calls it."""
    if function.otherwise:
        function.line(function.otherwise)
        return
    function.scope.takes("failure")
    for number, each in enumerate(indices if not function.is_routine else ()):
        function.line(f"failure->indices[{number}] = {bare(expression(function.scope, each))};")
    said = "" if about is None else f" {comment(described(about))}"
    name = "fail_here" if function.is_routine else "fail"
    function.line(f"return {function.scope.calls(name)}(failure, {site}, {bare(at)});{said}")
