"""What an encoder that joins parts has written: numbers packed together, sequences as a whole, messages behind their lengths."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING

from rosetta_jit.generate.parentheses import bare
from rosetta_jit.generate.passes.cleared import slots_of
from rosetta_jit.generate.python.encoding.object_rows import Binder, Listed, ObjectScope
from rosetta_jit.generate.python.encoding.packed import ANY, Part, part_text, starred, with_numbers
from rosetta_jit.generate.python.passes.positions import NotInParts, Positions, Sum
from rosetta_jit.generate.python.passes.search import numbers_of
from rosetta_jit.generate.python.printing.expressions import expression
from rosetta_jit.generate.python.printing.scope import CODES
from rosetta_jit.generate.python.runtime.varints import _varint  # pyright: ignore[reportPrivateUsage] - as generated modules name it
from rosetta_jit.generate.unit import Unit
from rosetta_jit.kernel.nodes import WIDTH, Convert, Expr, Get, Place
from rosetta_jit.kernel.terms import index, type_of
from rosetta_jit.model.layout import UNKNOWN, Number
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.generate.python.printing.printed import Function

JOIN = 'b"".join'

MOST_STARRED = 256
"""Numbers of an array of a fixed length that are packed together with those around it."""

FEW_STARRED = 4
"""The same of an array of numpy's, whose elements become Python's one by one."""


@dataclass(frozen=True, slots=True)
class Around:
    """What there is before a message within another: ``begun``, ``pending`` and ``list_name`` of `Written`.

    ``line`` and ``depth`` are where the lines of the inner one begin, ``routine`` writes its length; ``may_be_long`` and ``has_long`` are
    of `Written`, too, and ``is_entry`` says whether the inner one is an entry of a map.
    """

    begun: bool
    pending: list[Part]
    list_name: str
    line: int
    depth: int
    routine: str
    may_be_long: bool
    has_long: bool
    is_entry: bool


class Written:
    """``pending`` are parts that no line has written yet, ``begun`` is whether any has, ``list_name`` the local that has those.

    A message within another that has texts or bytes may be long: then those around it do not copy it. ``may_be_long`` and ``has_long`` say
    whether the message at hand has any, and such messages within; ``at_entry`` whether the next one within is an entry of a map.
    ``result`` is what makes the result of all parts, where that is not its bytes.
    """

    def __init__(self, unit: Unit, function: Function, scope: ObjectScope, needed: set[tuple[int, int]]) -> None:
        self.unit, self.function, self.scope = unit, function, scope
        self.positions, self.pending, self.begun, self.list_name = Positions(), list[Part](), False, "parts"
        self.around: dict[str, Around] = {}
        self.binder = Binder(unit, function, scope, needed)
        self.exact: dict[int, int] = {}
        self.result = ""
        self.limits: dict[Expr, int] = {}
        self.may_be_long = self.has_long = self.at_entry = False

    def line(self, text: str) -> None:
        self.function.line(text)

    def _store(self, at: Expr, value: Expr, order: str) -> None:
        type_ = type_of(value)
        match value:
            case Convert("u8", Get("bool", place)) | Get("bool", place):
                self._add("", "?", (self.scope.truth(place),))
                self.positions.written(at, Sum(1))
                return
            case Get(_, place) if not self.scope.has(place):
                text = self.scope.element_of(place, type_)
            case Get(_, place):
                text = self.scope.given(place)
            case Convert(_, count) if self.limits.get(count, 1 << 64) <= 1 << 8 * WIDTH[type_] - (type_[0] == "i"):
                text = bare(expression(self.scope, count))
            case _:
                text = bare(expression(self.scope, value))
        self._add(order if WIDTH[type_] > 1 else "", CODES[type_], (text,))
        self.positions.written(at, Sum(WIDTH[type_]))

    def _add(self, order: str, codes: str, texts: tuple[str, ...]) -> None:
        """Numbers behind the parts so far."""
        self.pending = with_numbers(self.pending, order, codes, texts)

    def _copy(self, at: Expr, source: Place, size: Expr) -> None:
        """A sequence as a whole."""
        sequence, start = self.scope.sequences.get(source.lane), self.scope.behind(source)
        if sequence is None or start != index(0) or source.offset:
            raise NotInParts
        stride = self.unit.layout.lanes[source.lane].stride
        size_sum = self.positions.sum(size)
        counts = [self.positions.values[name] for name, lane in self.scope.counts.items() if lane == source.lane]
        exact = self.exact.get(source.lane)
        if not any(size_sum == Sum().plus(count, stride) for count in counts) and size_sum != Sum(
            stride * exact if exact is not None else -1
        ):
            raise NotInParts
        codes = numbers_of(sequence.slot, stride)
        if sequence.element is None:
            self.pending.append(Part("", "", (self._text_or_bytes(sequence),)))
        elif isinstance(sequence.slot, Number):
            self._numbers(sequence, "<", exact)
        elif codes:
            self._each(sequence, codes)
        else:
            raise NotInParts
        self.positions.written(at, size_sum)

    def _text_or_bytes(self, sequence: Listed) -> str:
        """They are not copied by messages around theirs, where they are long; those that no schema knows hardly are.

        Neither are entries of maps, but in types that contain themselves, whose texts may be long as they are bound.
        """
        recursive, around = self.scope.keeps_long, [*self.around.values()][-1:]
        is_within = (around and not around[0].is_entry) or self.result or (around and recursive)
        if not is_within or self.unit.layout.lanes[sequence.lane].name.endswith(UNKNOWN):
            return sequence.local
        self.may_be_long = True
        return sequence.local if recursive and sequence.is_text else f"_long({sequence.local})"

    def _numbers(self, sequence: Listed, order: str, exact: int | None) -> None:
        assert isinstance(sequence.slot, Number)
        code, own = "?" if sequence.slot.scalar == "bool" else CODES[sequence.slot.scalar], sequence.local
        is_alone = self.unit.numpy and order == "<" and not self.pending
        if exact is not None and 0 < exact <= (FEW_STARRED if self.unit.numpy else MOST_STARRED) and not is_alone:
            self._add(order if WIDTH[sequence.slot.scalar] > 1 else "", code * exact, (starred(own, self.scope),))
        elif self.unit.numpy:
            dtype, is_bool = self.scope.dtype(sequence.slot.scalar, order), sequence.slot.scalar == "bool"
            self.pending.append(Part("", "", (f"_raw({dtype}, {own}{', is_bool=True' if is_bool else ''})",)))
        elif sequence.slot.scalar == "u8":
            self.pending.append(Part("", "", (f"bytes({own})",)))
        else:
            names = [name for name, lane in self.scope.counts.items() if lane == sequence.lane and name in self.function.read]
            count = self.scope.locals.identifier(names[0]) if names else f"len({own})"
            self.pending.append(Part("", "", (f"{self.scope.by_count(order, code, 'writes')}[{count}](*{own})",)))

    def _each(self, sequence: Listed, codes: tuple[str, ...]) -> None:
        """Rows that are numbers."""
        assert sequence.element is not None
        self.flush()
        self.begun = True
        element, lane = self.binder.local("element"), sequence.lane
        with self.function.writer.indented(f"for {element} in {sequence.local}:"):
            found: dict[int, str] = {}
            needed = {(lane, each.offset) for each in slots_of(sequence.slot)}
            Binder(self.unit, self.function, self.scope, needed).value(lane, element, sequence.element, sequence.slot, found)
            texts = tuple(text for _, text in sorted(found.items()))
            self.pending.append(Part("<", "".join(CODES[each] for each in codes), texts))
            self.flush()

    def flush(self) -> None:
        """Write the parts that are pending."""
        texts = [part_text(each, self.scope, self.exact) for each in self.pending]
        self.pending = []
        if texts:
            self.begun = True
            name = self.list_name
            self.line(f"{name}.append({texts[0]})" if len(texts) == 1 else f"{name} += {', '.join(texts)}")

    def end(self, name: str) -> None:
        """Join the parts: that is the result, or has a name."""
        made = self._joined(self.result or ("_whole" if self.has_long else JOIN))
        self.line(f"{name} = {made}" if name else f"return {made}")

    def _joined(self, join: str) -> str:
        """All parts as one."""
        if self.begun:
            self.flush()
            return f"{join}({self.list_name})"
        texts = [part_text(each, self.scope, self.exact) for each in self.pending]
        if len(texts) == 1 and (self.pending[0].codes or join == JOIN):
            return texts[0] if self.pending[0].codes or texts[0].startswith("_raw(") else f"bytes({texts[0]})"
        return f"{join}(({', '.join(texts)}{',' if len(texts) == 1 else ''}))" if texts else 'b""'

    # --- a message behind its length ---------------------------------------------------------------------------------------------------

    def begin(self, name: str, routine: str) -> None:
        """What follows comes behind its length, a local of the kernel: parts of a list of their own."""
        writer = self.function.writer
        long = self.may_be_long, self.has_long, self.at_entry
        self.around[name] = Around(self.begun, self.pending, self.list_name, len(writer.lines), writer.depth, routine, *long)
        self.pending, self.begun, self.list_name = [], False, self.binder.local("parts")
        self.may_be_long = self.has_long = self.at_entry = False

    def finish(self, name: str) -> None:
        """All of it is there: its length is known, and written before it."""
        around, writer = self.around.pop(name), self.function.writer
        if writer.depth != around.depth:
            raise NotInParts
        if not self.begun and all(part.codes for part in self.pending):
            inner, size = self.pending, sum(struct.calcsize(f"<{part.codes}") for part in self.pending)
            self._go_on(around, has_long=False)
            length = _varint(size)
            self._add("", "B" * len(length), tuple(map(str, length)))
            for part in inner:
                self._add("" if part.order == ANY else part.order, part.codes, part.texts)
            return
        body = self.binder.local("body")
        if self.begun:
            writer.lines.insert(around.line, f"{'    ' * around.depth}{self.list_name} = []")
        is_kept = self.has_long or self.may_be_long
        self.line(f"{body} = {self._joined('_joined' if is_kept else JOIN)}")
        self._go_on(around, has_long=is_kept)
        self.pending = [*self.pending, Part("", "", (f"{around.routine}(len({body}))",)), Part("", "", (body,))]

    def _go_on(self, around: Around, *, has_long: bool) -> None:
        """Go on with what there was before a message within another."""
        self.pending, self.begun, self.list_name = around.pending, around.begun, around.list_name
        self.may_be_long, self.has_long = around.may_be_long, around.has_long or has_long
