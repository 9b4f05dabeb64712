"""Whether rules can work on a message where its bytes lie: decided from the codec and the rules, before anything is lowered.

To unpack in place, the walk over the codec must be able to leave what rules read where they find it: numbers outside arrays, counts, bytes,
and in elements of one size numbers, and arrays and bytes of fixed length. To pack in place, a rule must give each number and each size
when the walk asks for it, and what rules set later must have its room by then. An `Obstacle` says what is in the way of that; the
message is then staged (`rosetta_jit.lowering.staging`).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from rosetta_jit.kernel.nodes import Direction
from rosetta_jit.language import typed
from rosetta_jit.language.places import rules_within
from rosetta_jit.language.resolve.defaults import has_array
from rosetta_jit.language.walk import expressions_of, operands
from rosetta_jit.lowering.codec.wire_fields import EACH
from rosetta_jit.lowering.rules.bound_fields import BoundFields, Obstacle
from rosetta_jit.lowering.rules.wire_side import wire_key
from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Float, Int, Schema, String, Type
from rosetta_jit.model.walk import every_rule
from rosetta_jit.startup.late import Late
from rosetta_jit.wire.codec import Codec, Encoding, Path

if TYPE_CHECKING:
    from rosetta_jit.lowering.rules import filters
else:
    filters = Late("rosetta_jit.lowering.rules.filters")

NESTED = "an array within an element has no place that is known beforehand"
UNKNOWN = "the walk over the message leaves no place or number for it"


def obstacle(
    encoding: Encoding, attempts: tuple[Codec, ...], rules: tuple[typed.Rule, ...], direction: Direction, schema: Schema
) -> Obstacle | None:
    """The first obstacle to rules that work on messages in place; None if there is none."""
    if encoding.nested:
        return Obstacle((), "messages that contain themselves have no fixed number of places")
    if direction != "decode":
        for place in (rule.place for rule in rules_within(rules) if isinstance(rule, typed.Default)):
            if has_array(place.type, schema, counted=False):
                return Obstacle(wire_key(place)[0], "it is left alone, and must have elements nevertheless")
    return next((found for attempt in attempts for found in _obstacles(attempt, rules, direction)), None)


def _obstacles(attempt: Codec, rules: tuple[typed.Rule, ...], direction: Direction) -> Iterator[Obstacle]:
    bound = BoundFields(direction, rules)
    yield from bound.message(attempt)
    if direction == "decode":
        for rule in every_rule(rules):
            yield from _of_expressions(expressions_of(rule), bound)
    elif direction == "encode":
        yield from _of_writing(rules, bound)


# --- rules that read the wire ------------------------------------------------------------------------------------------------


def _of_expressions(values: tuple[typed.Expr, ...], bound: BoundFields) -> Iterator[Obstacle]:
    for value in values:
        match value:
            case typed.Access(place):
                yield from _of_value(place, place.type, bound)
            case typed.IsText(place):
                yield from _of_bytes(place, bound)
            case typed.LenOf(place) | typed.Search(place):
                yield from _of_count(place, bound)
            case typed.Has(place):
                yield Obstacle(wire_key(place)[0], "whether it is there is known only where the walk stands")
            case _:
                pass
        yield from _of_expressions(operands(value), bound)


def _of_value(place: typed.Place, type_: Type, bound: BoundFields) -> Iterator[Obstacle]:
    match type_:
        case Bool() | Int() | Float() | Enum():
            yield from _of_number(place, bound)
        case String(encoding="utf-16"):
            yield from _of_count(place, bound)
            yield from _of_elements(wire_key(place)[0], typed.UINT16, bound)
        case String() | Bytes():
            yield from _of_bytes(place, bound)
        case Array(element=element):
            yield from _of_count(place, bound)
            yield from _of_elements(wire_key(place)[0], element, bound)
        case _:
            yield Obstacle(wire_key(place)[0], "a message as a whole is copied between lanes")


def _of_number(place: typed.Place, bound: BoundFields) -> Iterator[Obstacle]:
    key, indices = wire_key(place)
    if len(indices) > 1 and key not in bound.regions:
        yield Obstacle(key, NESTED)
    elif key not in (bound.regions if indices else bound.numbers):
        yield Obstacle(key, UNKNOWN)


def _of_bytes(place: typed.Place, bound: BoundFields) -> Iterator[Obstacle]:
    yield from _of_count(place, bound)
    key = (*wire_key(place)[0], EACH)
    if key not in bound.regions:
        yield Obstacle(key, UNKNOWN)


def _of_count(place: typed.Place, bound: BoundFields) -> Iterator[Obstacle]:
    key, indices = wire_key(place)
    if indices and key not in bound.fixed:
        yield Obstacle(key, "how long it is, is known only where the walk stands at its element")
    elif not indices and key not in bound.counts:
        yield Obstacle(key, UNKNOWN)


def _of_elements(key: Path, element: Type, bound: BoundFields) -> Iterator[Obstacle]:
    if not isinstance(element, Bool | Int | Float | Enum):
        yield Obstacle(key, NESTED)
    elif key.count(EACH) or (*key, EACH) not in bound.regions:
        yield Obstacle((*key, EACH), UNKNOWN)


# --- rules that write the wire -----------------------------------------------------------------------------------------------


def _of_writing(rules: tuple[typed.Rule, ...], bound: BoundFields) -> Iterator[Obstacle]:
    for rule in rules:
        match rule:
            case typed.Assign(place, value):
                yield from _of_setting(place, value, bound)
            case typed.For(body=body, kept=kept):
                if kept is not None:
                    for place in filters.filtered_arrays(rule, kept):
                        yield from _of_count(place, bound)
                yield from _of_writing(body, bound)
            case typed.When(_, then, otherwise):
                yield from _of_writing((*then, *otherwise), bound)
            case typed.Default(place):
                yield from _of_leaving(place, bound)
            case _:
                pass


def _of_leaving(place: typed.Place, bound: BoundFields) -> Iterator[Obstacle]:
    """The walk leaves room for an element's numbers, and writes nothing there."""
    key, indices = wire_key(place)
    if indices:
        yield from (Obstacle(each, UNKNOWN) for each in sorted(bound.translated) if each[: len(key)] == key)


def _of_setting(place: typed.Place, value: typed.Expr, bound: BoundFields) -> Iterator[Obstacle]:
    key, indices = wire_key(place)
    match place.type, value:
        case ((String() | Bytes() | Array()), typed.Call()):
            yield Obstacle(key, "how long it becomes is known only when it is made")
        case String(encoding="utf-16"), _:
            if isinstance(value, typed.Access):
                yield from _of_elements(key, typed.UINT16, bound)
            else:
                yield Obstacle(key, "how many units of 16 bits it has is known only when it is made")
        case ((String() | Bytes()), _):
            pass  # the walk has asked for its size
        case Array(element=element), _:
            yield from _of_elements(key, element, bound)
        case ((Bool() | Int() | Float() | Enum()), _):
            if indices:
                yield from _of_number(place, bound)
        case _:
            yield Obstacle(key, "a message as a whole is copied between lanes")
