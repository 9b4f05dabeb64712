"""Numbers within a whole value that are in another unit at its target: `typed.Change` as statements, and as rules for elements."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import count

from rosetta_jit.kernel.nodes import Binary, Compare, Const, Convert, Expr, If
from rosetta_jit.kernel.terms import index, type_of
from rosetta_jit.language import typed
from rosetta_jit.language.conversions import FLOAT64
from rosetta_jit.language.units.numbers import scaled
from rosetta_jit.lowering.writer import Writer, block
from rosetta_jit.model.types import Array, Bool, Enum, Float, Int, String
from rosetta_jit.startup.dataclass import replace


def rescaled(value: Expr, change: typed.Change) -> Expr:
    """A number in its new unit, in float64."""
    assert isinstance(change, typed.Rescale)
    wide = value if type_of(value) == "f64" else Convert("f64", value)
    result = Binary("mul", wide, Const("f64", change.factor))
    return Binary("add", result, Const("f64", change.offset)) if change.offset else result


def change_of_member(change: typed.Change | None, name: str) -> typed.Change | None:
    """What changes in a member, if anything does."""
    return dict(change.members).get(name) if isinstance(change, typed.EachMember) else None


def by_number(writer: Writer, change: typed.Change | None, number: Expr, copy: Callable[[typed.Change | None], None]) -> None:
    """Copy an element with the change that is for its number."""
    if not isinstance(change, typed.EachElement):
        copy(None)
        return
    with writer.nested() as body:
        copy(change.rest)
    for known, within in reversed(change.numbered):
        rest = block(body)
        with writer.nested() as then:
            copy(within)
        with writer.nested() as body:
            writer.emit(If(Compare("eq", number, index(known)), block(then), rest))
    for statement in block(body):
        writer.emit(statement)


def element_rule(place: typed.Place, origin: typed.Place, variable: typed.Local, change: typed.Change | None) -> typed.Rule:
    """The rule for an element of an array that is assigned as a whole."""
    target, source = (_element(each, variable) for each in (place, origin))
    if not isinstance(change, typed.EachElement):
        return _assigned(target, source, None)
    rule = _assigned(target, source, change.rest)
    for number, within in reversed(change.numbered):
        here = typed.Binary("==", variable, typed.Const(number, typed.INT64), typed.BOOL)
        rule = typed.When(here, (_assigned(target, source, within),), (rule,))
    return rule


def names_of_elements() -> Iterator[str]:
    """Names for the variables of such loops."""
    return (f"element{number or ''}" for number in count())


def _element(place: typed.Place, variable: typed.Local) -> typed.Place:
    type_ = place.type.element if isinstance(place.type, Array) else typed.UINT16 if isinstance(place.type, String) else place.type
    return replace(place, steps=(*place.steps, typed.IndexStep(variable)), type=type_)


def _assigned(place: typed.Place, origin: typed.Place, change: typed.Change | None) -> typed.Rule:
    read: typed.Expr = typed.Access(origin, origin.type)
    if isinstance(change, typed.Rescale):
        factors = change.factor, change.offset
        number = read if origin.type == FLOAT64 else typed.Convert(read, FLOAT64, "widen")
        converted = scaled(number, place.type, factors)
        assert converted is not None
        return typed.Assign(place, converted)
    if isinstance(place.type, Bool | Int | Float | Enum) and origin.type != place.type:
        read = typed.Convert(read, place.type, "widen")
    return typed.Assign(place, read, by=change)
