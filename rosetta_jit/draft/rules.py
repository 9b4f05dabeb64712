"""Pairs of leaves as rules. An array that holds what fields hold, and a moment in another unit, relate several leaves at once."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from rosetta_jit.draft.conversions import as_type, converted, kind
from rosetta_jit.draft.limits import MAX_FIELDS
from rosetta_jit.draft.pairs import FAMILIES, around, fit, pairs
from rosetta_jit.draft.words import shared, tokens
from rosetta_jit.language.typed import INT64
from rosetta_jit.language.units.dimensions import conversion
from rosetta_jit.model.types import Bytes, Enum, Float, Int, Type
from rosetta_jit.startup.dataclass import dataclass, replace

if TYPE_CHECKING:
    from rosetta_jit.draft.leaves import Leaf


GUESS = 0.25
"""The score of what is alone on either side."""

STRIDES = frozenset(("step", "stride", "pitch", "quantum"))
"""Words for how far the rows of an image are apart."""


@dataclass(frozen=True, slots=True)
class Decision:
    """Leaves of both sides that are the same, and the relations that say so; none where only a person can: ``why`` says that."""

    holder: tuple[Leaf, ...]
    wire: tuple[Leaf, ...]
    relations: tuple[str, ...]
    score: float
    why: str = ""


def decisions(holder: list[Leaf], wire: list[Leaf]) -> list[Decision]:
    """What the names, types, units and structure of two messages suggest, in the order of the holder's fields."""
    found = list(_moments(holder, wire))
    for decide in (_pairs, _unrolled, _alone):
        taken = {id(leaf) for each in found for leaf in (*each.holder, *each.wire)}
        mine, theirs = ([leaf for leaf in leaves if id(leaf) not in taken] for leaves in (holder, wire))
        found += decide(mine, theirs)
    found = [_of_padded_rows(each, wire) for each in found]
    order = {id(leaf): number for number, leaf in enumerate(holder)}
    return sorted(found, key=lambda each: min(order[id(leaf)] for leaf in each.holder))


def _of_padded_rows(decision: Decision, wire: list[Leaf]) -> Decision:
    """Pixels in a message that tells how far rows are apart: whether these are padded, nothing here knows."""
    strides = [each for each in wire if STRIDES & {*tokens(each.names[-1])}]
    if not strides or not decision.relations or not isinstance(decision.wire[0].type, Bytes):
        return decision
    pixels, stride = decision.wire[0].path(), strides[0].path()
    return replace(decision, why=f"rows may be padded, see {stride}; if they are: rows({pixels}, height, bytes of a row, stride)")


def _moments(holder: list[Leaf], wire: list[Leaf]) -> Iterator[Decision]:
    known = without_another(clocks(wire), clocks(holder))
    for number in numbers(holder):
        clock = best_clock(number, known)
        value = None if clock is None else of_clock(number, clock, "")
        if clock is not None and value is not None:
            known.remove(clock)
            yield Decision((number,), clock, (f"{number.path()} <-> {value}",), 1.0)
    known = without_another(clocks(holder), clocks(wire))
    for number in numbers(wire):
        clock = best_clock(number, known)
        values = None if clock is None else of_number(number, clock, "")
        if clock is not None and values is not None:
            known.remove(clock)
            yield Decision(clock, (number,), tuple(f"{leaf.path()} <-> {value}" for leaf, value in zip(clock, values, strict=True)), 1.0)


def _pairs(holder: list[Leaf], wire: list[Leaf]) -> Iterator[Decision]:
    for each in pairs(holder, wire):
        yield _decided(each.holder, each.wire, each.score)


def _decided(mine: Leaf, theirs: Leaf, score: float) -> Decision:
    value = converted(mine, theirs, theirs.path())
    if value is not None:
        whole = value == theirs.path() and mine.type == theirs.type and mine.arrays[-1] == theirs.arrays[-1] == 0 and mine.depth == 1
        relation = f"{mine.path()} <-> {value}"
        return Decision((mine,), (theirs,), (relation.replace("[]", "") if whole and "]." not in relation else relation,), score)
    return Decision((mine,), (theirs,), (), score, _undecided(mine, theirs))


def _undecided(mine: Leaf, theirs: Leaf) -> str:
    """Why two leaves are not related, and how they might be."""
    if isinstance(mine.type, Enum) or isinstance(theirs.type, Enum):
        key, value = (_constant(each.type) for each in (theirs, mine))
        return f"which value means which constant? {mine.path()} <-> table({theirs.path()}) {{ {key} = {value}, ... }}"
    units = " and ".join(each.unit or "no unit" for each in (mine, theirs))
    return f"{mine.path()} is like {theirs.path()}, but nothing converts {units}"


def _constant(type_: Type) -> str:
    """A value of a type, as it stands in a table."""
    if isinstance(type_, Enum) and type_.values:
        return f"{type_.name}.{type_.values[0][0]}"
    return '"..."' if kind(type_) == "text" else "0"


def _unrolled(holder: list[Leaf], wire: list[Leaf]) -> Iterator[Decision]:
    """Arrays of numbers that are fields on the other side, in their order."""
    taken: set[int] = set()
    for mine, theirs, of_holder in (*_arrays(holder, wire, of_holder=True), *_arrays(wire, holder, of_holder=False)):
        if {id(mine), *map(id, theirs)} & taken:
            continue
        relations = tuple(_elements(mine, theirs, of_holder=of_holder))
        if relations:
            taken |= {id(mine), *map(id, theirs)}
            sides = ((mine,), tuple(theirs)) if of_holder else (tuple(theirs), (mine,))
            yield Decision(*sides, relations, around(mine, theirs[0]))


def _alone(holder: list[Leaf], wire: list[Leaf]) -> Iterator[Decision]:
    """The one array that is left on each side, where they are of one type: a guess that nothing but their being alone supports."""
    mine, theirs = ([each for each in leaves if each.depth == 1 and kind(each.type) in FAMILIES] for leaves in (holder, wire))
    if len(mine) == len(theirs) == 1 and len(holder) == 1 and mine[0].type == theirs[0].type and fit(mine[0], theirs[0]):
        yield _decided(mine[0], theirs[0], GUESS)


def _arrays(arrays: list[Leaf], fields: list[Leaf], *, of_holder: bool) -> list[tuple[Leaf, list[Leaf], bool]]:
    """Arrays and messages of as many numbers; those of a known length, and of which more is said alike, come first."""
    groups: dict[object, list[Leaf]] = {}
    for each in fields:
        if each.depth == 0 and kind(each.type) == "number":
            groups.setdefault(each.group, []).append(each)
    lists = [each for each in arrays if each.depth == 1 and each.arrays[-1] is not None and kind(each.type) == "number"]
    found = [
        (one, many)
        for one in lists
        for many in groups.values()
        if 1 < len(many) <= MAX_FIELDS and one.arrays[-1] in {0, len(many)} and len({each.type for each in many}) == 1
    ]
    found.sort(key=lambda each: (not each[0].arrays[-1], -around(each[0], each[1][0]), -len(each[1])))
    return [(one, many, of_holder) for one, many in found]


def _elements(array: Leaf, fields: list[Leaf], *, of_holder: bool) -> Iterator[str]:
    if of_holder and not array.arrays[-1]:
        yield f"len({array.path().removesuffix('[]')}) <-> {len(fields)}"
    for number, field in enumerate(fields):
        element = f"{array.path().removesuffix('[]')}[{number}]"
        mine, theirs = (array, field) if of_holder else (field, array)
        value = converted(mine, theirs, field.path() if of_holder else element)
        if value is None:
            return
        yield f"{element if of_holder else field.path()} <-> {value}"


SECONDS = frozenset(("sec", "second"))
NANOSECONDS = frozenset(("nsec", "nanosec", "nanosecond"))
MOMENTS = frozenset(("time", "timestamp", "stamp", "date", "duration", "moment"))

ALIKE = 0.8
"""How much of two names is shared where they are of the same moment."""

Clock = tuple["Leaf", "Leaf"]
"""Seconds, and the nanoseconds behind them."""


def clocks(leaves: list[Leaf]) -> list[Clock]:
    """The messages that are a moment."""
    seconds = [each for each in leaves if SECONDS & {*tokens(each.names[-1])} and isinstance(each.type, Int)]
    rest = {each.group: each for each in leaves if NANOSECONDS & {*tokens(each.names[-1])} and isinstance(each.type, Int)}
    return [(each, rest[each.group]) for each in seconds if each.group in rest]


def without_another(mine: list[Clock], theirs: list[Clock]) -> list[Clock]:
    """The clocks that are not the same moment as one of the other side: that one tells them better than a number does."""
    return [each for each in mine if not any(shared(each[0].names[:-1], other[0].names[:-1]) > ALIKE for other in theirs)]


def numbers(leaves: list[Leaf]) -> Iterator[Leaf]:
    """The numbers that are a moment, by their name or their message's, and by their unit."""
    for each in leaves:
        said = {*tokens(each.names[-1]), *tokens(each.types[-1].replace("/", ".").split(".")[-1])}
        if said & MOMENTS and isinstance(each.type, Int | Float) and each.unit is not None and _a_second(each.unit) is not None:
            yield each


def _a_second(unit: str) -> int | None:
    """How many of a unit are a second, where that is a power of 1000."""
    found = conversion("s", unit)
    if found is None or isinstance(found, str) or found[1]:
        return None
    return round(found[0]) if round(found[0]) in {1, 10**3, 10**6, 10**9} else None


def best_clock(number: Leaf, known: list[Clock]) -> Clock | None:
    """The clock that a number is likely the same moment as."""
    fitting = [each for each in known if each[0].depth == number.depth]
    words = (*number.names, *number.types)
    return max(fitting, key=lambda each: (shared(each[0].names[:-1], words), -len(each[0].names)), default=None)


def of_clock(number: Leaf, clock: Clock, index: str) -> str | None:
    """A number as a clock tells it."""
    seconds, rest = (each.path(index) for each in clock)
    each_second = _a_second(number.unit or "")
    match number.type, each_second:
        case Float(), 1:
            return as_type(number.type, Float(64), f"timestamp({seconds}, {rest})")
        case Int(), 1_000_000_000:
            return as_type(number.type, INT64, f"nanoseconds({seconds}, {rest})")
        case Int(), int(units) if units > 1:
            return as_type(number.type, INT64, f"{seconds} * {units} + floor_divide({rest}, {1_000_000_000 // units})")
        case _:
            return None


def of_number(number: Leaf, clock: Clock, index: str) -> tuple[str, str] | None:
    """The seconds and the nanoseconds of a clock as a number tells them."""
    value, each_second = number.path(index), _a_second(number.unit or "")
    match number.type, each_second:
        case (Float(), 1) | (Int(), 1_000_000_000):
            texts = (f"seconds({value})", f"fraction({value})")
            if isinstance(number.type, Int):
                texts = (f"floor_divide({value}, 1000000000)", f"modulo({value}, 1000000000)")
        case Int(), int(units) if units > 1:
            texts = (f"floor_divide({value}, {units})", f"modulo({value}, {units}) * {1_000_000_000 // units}")
        case _:
            return None
    seconds, rest = (as_type(leaf.type, INT64, text) for leaf, text in zip(clock, texts, strict=True))
    return None if seconds is None or rest is None else (seconds, rest)
