"""What the rows of an encoder's kernel are in the object that is encoded: attributes, elements of lists, lengths."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from rosetta_jit.generate.parentheses import bare
from rosetta_jit.generate.passes.cleared import slots_of
from rosetta_jit.generate.python.passes.positions import NotInParts
from rosetta_jit.generate.python.printing.classes import member_names
from rosetta_jit.generate.python.printing.conversions import within
from rosetta_jit.generate.python.printing.expressions import expression
from rosetta_jit.generate.python.printing.scope import CODES, Scope
from rosetta_jit.generate.unit import Unit
from rosetta_jit.kernel.arithmetic import FLOATS
from rosetta_jit.kernel.nodes import WIDTH, Binary, Expr, Local, Place
from rosetta_jit.kernel.terms import index
from rosetta_jit.model.layout import Member, Number, Row, Slot, Span, Variant, map_entry
from rosetta_jit.model.types import Array, Bytes, Map, Optional, String, Struct, Type, Union
from rosetta_jit.startup.dataclass import dataclass, field

if TYPE_CHECKING:
    from rosetta_jit.generate.python.printing.printed import Function

FLAG = "(1 if "
"""Begins what stands for a bool, which may be anything that is true or not."""

START = "<start> "
"""Begins what stands for the start of a sequence, behind which its lane is named: objects have no such number."""


@dataclass(frozen=True, slots=True)
class Listed:
    """An array, a text or bytes of an object: the local that holds it, the type of its elements, and what its rows are."""

    local: str
    lane: int
    element: Type | None
    slot: Slot
    is_map: bool = False
    is_text: bool = False


@dataclass(frozen=True, slots=True)
class Maybe:
    """What a row has under a condition: the local that holds it, or None, its type and slot; ``case`` of a union or not."""

    lane: int
    row: Expr
    local: str
    type: Type
    slot: Slot
    case: bool = False


@dataclass(frozen=True, slots=True)
class Asked:
    """A sequence of an object that is taken out of it where it has elements: the condition for that, and the line."""

    condition: str
    line: str


@dataclass(slots=True)
class ObjectScope(Scope):
    """What the fields of rows are in objects.

    ``objects`` has the expressions of fields by lane, row and offset; ``starts`` and ``counts`` are the locals of a kernel that say where
    the rows of a sequence start and how many there are, with the lane of the sequence. ``numbers`` are the expressions whose values a
    program has set, and that may be no numbers of their type; ``float_fields`` has the types of the fields that are floats, by lane, row
    and offset: the cases of a union share a local. ``maybe`` has what is there under a condition, by the field that says so and the bit
    or number of it. ``messages`` are the locals that hold messages of types that contain themselves, by lane and row, ``linked`` those
    which are fields, by lane. ``keeps_long``: long texts stay what they are until all parts are joined. ``integers`` are the
    lanes of arrays whose elements are known to be integers that fit; ``asked`` are sequences by the
    fields that say how many elements they have; ``holders`` are the locals that hold the objects of rows.
    """

    objects: dict[tuple[int, Expr], dict[int, str]] = field(default_factory=dict[tuple[int, "Expr"], dict[int, str]])
    sequences: dict[int, Listed] = field(default_factory=dict[int, Listed])
    starts: dict[str, int] = field(default_factory=dict[str, int])
    counts: dict[str, int] = field(default_factory=dict[str, int])
    numbers: set[str] = field(default_factory=set[str])
    float_fields: dict[tuple[int, Expr, int], str] = field(default_factory=dict[tuple[int, Expr, int], str])
    maybe: dict[tuple[Place, int], Maybe] = field(default_factory=dict[tuple[Place, int], Maybe])
    messages: dict[tuple[int, Expr], str] = field(default_factory=dict[tuple[int, "Expr"], str])
    linked: dict[int, str] = field(default_factory=dict[int, str])
    keeps_long: bool = False
    integers: set[int] = field(default_factory=set[int])
    asked: dict[Place, Asked] = field(default_factory=dict[Place, "Asked"])
    holders: dict[tuple[int, Expr], str] = field(default_factory=dict[tuple[int, "Expr"], str])

    def place(self, place: Place, scalar: str, row: Callable[[], str]) -> str:  # noqa: ARG002 - of a scope
        """A scalar of a row of an object."""
        known = self.objects.get((place.lane, place.row))
        if known is not None and place.offset in known:
            if (float_ := self.float_fields.get((place.lane, place.row, place.offset))) is not None and scalar not in FLOATS:
                return f"_bits{8 * WIDTH[float_]}({known[place.offset]})"
            return _checked(known[place.offset], scalar) if known[place.offset] in self.numbers else known[place.offset]
        found = self.element_of(place, scalar)
        if self.numpy and scalar[0] in "iu" and self.sequences[place.lane].element is not None and place.lane not in self.integers:
            return f"int({found})"
        return f"_single({found})" if scalar == "f32" else f"float({found})" if scalar == "f64" else found

    def is_number(self, place: Place) -> bool:
        """Whether a field is a number, or a bool, of an object."""
        known = self.objects.get((place.lane, place.row), {}).get(place.offset, "")
        return known in self.numbers or known.startswith(FLAG)

    def given(self, place: Place) -> str:
        """A number of an object, whatever a program has set."""
        return bare(self.objects[place.lane, place.row][place.offset])

    def is_not_zero(self, place: Place) -> str:
        """Whether a number of an object has any bits."""
        known = self.objects[place.lane, place.row][place.offset]
        if known.startswith(FLAG):
            return self.truth(place)
        if (float_ := self.float_fields.get((place.lane, place.row, place.offset))) is None:
            return f"{known} is not _ZERO and _index({bare(known)}) != 0"
        bits = f"{self.struct('<', CODES[float_], 'whole')}({bare(known)})"
        return f"{known} is not _ZERO_FLOAT and {bits} != {bytes(WIDTH[float_])!r}"

    def truth_of(self, place: Place) -> str | None:
        known = self.objects.get((place.lane, place.row), {}).get(place.offset, "")
        return self.truth(place) if known.startswith(FLAG) else None

    def truth(self, place: Place) -> str:
        """What stands for a bool: it is true or not."""
        known = self.objects.get((place.lane, place.row), {}).get(place.offset)
        return self.element_of(place, "bool") if known is None else known.removeprefix(FLAG).removesuffix(" else 0)")

    def element_of(self, place: Place, scalar: str) -> str:
        """An element of a list of numbers, or of bytes."""
        number = self.behind(place)
        sequence = self.sequences.get(place.lane)
        if number is None or sequence is None or not isinstance(sequence.slot, Number) or place.offset or sequence.slot.scalar != scalar:
            raise NotInParts
        return f"{sequence.local}[{bare(expression(self, number))}]"

    def behind(self, place: Place) -> Expr | None:
        """The number of an element, of the row that a place is in."""
        match place.row:
            case Local(_, name) if self.starts.get(name) == place.lane:
                return index(0)
            case Binary("add", Local(_, name), number) if self.starts.get(name) == place.lane:
                return number
            case _:
                return None

    def field(self, lane: int, row: str, offset: int, scalar: str) -> str:  # noqa: ARG002 - of a scope
        raise NotInParts

    def view(self, lane: int, code: str) -> str:  # noqa: ARG002 - of a scope
        raise NotInParts

    def message(self, place: Place) -> str:
        """The local that holds the message, of a type that contains itself, of a row."""
        linked = self.linked.get(place.lane) if self.behind(place) == index(0) else None
        if (found := self.messages.get((place.lane, place.row), linked)) is None:
            raise NotInParts
        return found

    def start(self, place: Place, behind: int = 0) -> int | None:
        """The lane of the sequence whose start is the field ``behind`` bytes before a place."""
        text = self.objects.get((place.lane, place.row), {}).get(place.offset - behind, "")
        return int(text.removeprefix(START)) if text.startswith(START) else None

    def has(self, place: Place) -> bool:
        """Whether a field of an object is known."""
        return place.offset in self.objects.get((place.lane, place.row), {})


def _checked(text: str, scalar: str) -> str:
    """A number that is computed with: nothing else asks whether it is one of its field's."""
    return f"_single({text})" if scalar == "f32" else text if scalar == "f64" else within(text, scalar)


@dataclass(slots=True)
class Binder:
    """Prints the statements that take objects apart.

    ``needed`` are the fields, by lane and offset, that anything reads, ``late`` the sequences of which statements ask whether they are
    empty before they do anything else with them; ``row`` is that at hand.
    """

    unit: Unit
    function: Function
    scope: ObjectScope
    needed: set[tuple[int, int]]
    late: frozenset[tuple[int, int]] = frozenset()
    row: Expr = field(default_factory=lambda: index(0))

    def local(self, what: str) -> str:
        """A new local."""
        return self.scope.locals.identifier(f"{what}\0{len(self.scope.locals.taken)}")

    def bind(self, lane: int, row: Expr, at: str, type_: Type, slot: Slot) -> None:
        """The fields of a row that anything reads, from an object."""
        found: dict[int, str] = {}
        self.row = row
        self.scope.holders |= {(lane, row): at} if at.isidentifier() else {}
        self.value(lane, at, type_, slot, found)
        self.scope.objects[lane, row] = found

    def bind_entry(self, entries: Listed, row: Expr, names: list[str]) -> None:
        """Key and value of a map, which are locals."""
        assert isinstance(entries.element, Struct)
        assert isinstance(entries.slot, Row)
        found: dict[int, str] = {}
        self.row = row
        for name, each, member in zip(names, entries.element.fields, entries.slot.members, strict=True):
            self.value(entries.lane, name, each.type, member.slot, found)
        self.scope.objects[entries.lane, row] = found

    def there(self, maybe: Maybe) -> None:
        """The fields of what is there, where that is known."""
        found = dict(self.scope.objects[maybe.lane, maybe.row])
        self.row = maybe.row
        self.value(maybe.lane, maybe.local, maybe.type, maybe.slot, found)
        self.scope.objects[maybe.lane, maybe.row] = found

    def _is_needed(self, lane: int, slot: Slot) -> bool:
        return any((lane, offset) in self.needed for each in slots_of(slot) for offset in (each.offset, each.offset + 8))

    def value(self, lane: int, at: str, type_: Type, slot: Slot, found: dict[int, str]) -> None:
        """A value of an object: ``found`` gets the expressions of its fields by offset."""
        resolved = self.unit.schema.resolve(type_)
        match resolved, slot:
            case _, Number(offset, scalar):
                found[offset] = f"{FLAG}{at} else 0)" if scalar == "bool" else at
                self.scope.numbers |= {at} if scalar != "bool" else set()
                self.scope.float_fields |= {(lane, self.row, offset): scalar} if scalar in FLOATS else {}
            case Struct(), Row():
                self._struct(lane, at, resolved, slot, found)
            case ((String() | Bytes() | Array()), Span()):
                self._sequence(lane, at, resolved, slot, found)
            case Map(key, value), Span():
                self._map(lane, at, map_entry(key, value), slot, found)
            case Union(), Variant():
                self._union(lane, at, resolved, slot, found)
            case Struct(), Span():
                self.scope.linked[slot.lane] = at
                found[slot.offset], found[slot.offset + 8] = f"{START}{slot.lane}", "1"
            case _:
                raise NotInParts

    def _map(self, of: int, at: str, entry: Struct, slot: Span, found: dict[int, str]) -> None:
        lane = self.unit.layout.lanes[slot.lane]
        own = self.local(lane.name.rpartition(".")[2] or "entries")
        self._take(of, slot, f"len({at})", f"{own} = {at}")
        self.scope.sequences[slot.lane] = Listed(own, slot.lane, entry, lane.element, is_map=True)
        found[slot.offset], found[slot.offset + 8] = f"{START}{slot.lane}", f"len({own})"

    def _take(self, of: int, slot: Span, condition: str, line: str) -> None:
        """Take a sequence out of an object: at once, or where it has elements, as a condition says."""
        if (of, slot.offset) in self.late:
            self.scope.asked[Place(of, self.row, slot.offset + 8)] = Asked(condition, line)
        else:
            self.function.line(line)

    def _union(self, lane: int, at: str, union: Union, slot: Variant, found: dict[int, str]) -> None:
        """The number of the case that a pair names, or 0; what it has is taken apart where that is known."""
        case, own, which = self.local("case"), self.local("value"), self.local("which")
        self.function.line(f"{case}, {own} = {at} or (None, None)")
        numbers = "".join(f'{number} if {case} == "{each.name}" else ' for number, each in enumerate(union.cases, 1))
        self.function.line(f"{which} = 0 if {own} is None else {numbers}0")
        found[slot.offset] = which
        for number, (each, member) in enumerate(zip(union.cases, slot.members, strict=True), 1):
            self.scope.maybe[Place(lane, self.row, slot.offset), number] = Maybe(lane, self.row, own, each.type, member.slot, case=True)

    def _struct(self, lane: int, at: str, struct: Struct, slot: Row, found: dict[int, str]) -> None:
        if not at.isidentifier():
            own = self.local(at.rpartition(".")[2])
            self.function.line(f"{own} = {at}")
            at = own
        words = [list[str]() for _ in range(slot.presence_words)]
        for each, member, name in zip(struct.fields, slot.members, member_names(struct), strict=True):
            if member.presence is not None:
                self._optional(lane, f"{at}.{name}", each.type, member, words, (slot.offset, found))
            elif self._is_needed(lane, member.slot):
                self.value(lane, f"{at}.{name}", each.type, member.slot, found)
        if slot.unknown is not None and self._is_needed(lane, slot.unknown):
            self._sequence(lane, f"{at}.unknown_fields", Bytes(), slot.unknown, found)
        for number, bits in enumerate(words):
            if (lane, slot.offset + 8 * number) in self.needed:
                word = found[slot.offset + 8 * number] = self.local("presence")
                self.function.line(f"{word} = {' | '.join(bits)}")

    def _optional(
        self, lane: int, at: str, type_: Type, member: Member, words: list[list[str]], around: tuple[int, dict[int, str]]
    ) -> None:
        """A field that may be None, for which its bit is 0. A number is 0 then; others are taken apart where they are known to be there.

        ``around`` is where the presence words of the struct begin, and its fields.
        """
        assert isinstance(type_, Optional)
        assert member.presence is not None
        own, (word, bit), (begin, found) = self.local(at.rpartition(".")[2]), divmod(member.presence, 64), around
        self.function.line(f"{own} = {at}")
        words[word].append(f"({1 << bit} if {own} is not None else 0)")
        self.scope.maybe[Place(lane, self.row, begin + 8 * word), 1 << bit] = Maybe(lane, self.row, own, type_.value, member.slot)
        if isinstance(member.slot, Number) and self._is_needed(lane, member.slot):
            self.value(lane, f"(0 if {own} is None else {own})", type_.value, member.slot, found)

    def _encoded(self, type_: String, at: str) -> str:
        """The bytes of a text; lone surrogates are bytes that are no UTF-8, where a text may have any."""
        if type_.encoding == "octets":
            return f'{at}.encode("utf-8", "surrogateescape")'
        return f"_utf8({at})" if self.scope.keeps_long else f"{at}.encode()"

    def _sequence(self, of: int, at: str, type_: String | Bytes | Array, slot: Span, found: dict[int, str]) -> None:
        lane = self.unit.layout.lanes[slot.lane]
        if isinstance(type_, String) and type_.encoding == "utf-16":
            raise NotInParts
        own = self.local((at if at.replace(".", "").isidentifier() and "." in at else lane.name).rpartition(".")[2] or "value")
        is_text = isinstance(type_, String)
        self._take(of, slot, f'{at} != ""' if is_text else f"len({at})", f"{own} = {self._encoded(type_, at) if is_text else at}")
        element = type_.element if isinstance(type_, Array) else None
        self.scope.sequences[slot.lane] = Listed(own, slot.lane, element, lane.element, is_text=is_text)
        found[slot.offset], found[slot.offset + 8] = f"{START}{slot.lane}", f"len({own})"
