"""What rules leave alone: fields of the source that none reads, and fields of the target that none sets."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.language import typed
from rosetta_jit.language.counters import counters_of
from rosetta_jit.language.places import field_names, places_in, value_inside
from rosetta_jit.language.typed import FieldStep
from rosetta_jit.model.types import Field, Optional, Ref, Struct, Union

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rosetta_jit.language.scope import Message
    from rosetta_jit.language.typed import Expr, Place, Rule

Names = tuple[str, ...]


def unread(rules: tuple[Rule, ...], source: Message, within: Names = ()) -> list[Names]:
    """Fields of the source whose values go nowhere; one that counts an array goes where its elements go.

    ``within`` is where the source lies, if it is a part of another message.
    """
    places = list(_read(rules))
    counters = {names for place in places for names in counters_of(place.steps)}
    return untouched({field_names(place) for place in places} | counters, source, source.root, within)


def unset(rules: tuple[Rule, ...], target: Message) -> list[Names]:
    """Fields of the target that stay absent."""
    return [names for names in never_set(rules, target) if _may_be_absent(names, target)]


def never_set(rules: tuple[Rule, ...], target: Message, within: Names = ()) -> list[Names]:
    """Fields of the target that no rule sets, whether they may be absent or not; ``within`` as above."""
    return untouched({field_names(place) for place in places_in(rules)}, target, target.root, within)


def untouched(touched: set[Names], message: Message, struct: Struct | Union, prefix: Names) -> list[Names]:
    """The outermost fields of which neither a part nor anything around is ``touched``."""
    found: list[Names] = []
    for each in struct.fields if isinstance(struct, Struct) else struct.cases:
        names = (*prefix, each.name)
        if each.constant is not None or names in touched:
            continue
        inner = value_inside(message, each.type)
        if not any(other[: len(names)] == names for other in touched):
            found.append(names)
        elif isinstance(inner, Struct | Union):
            found += untouched(touched, message, inner, names)
    return found


def _may_be_absent(names: Names, message: Message) -> bool:
    """Whether a field need not be set: that one must be is an error already."""
    *around, name = names
    struct: Struct | Union = message.root
    for each in around:
        inner = value_inside(message, _field(struct, each).type)
        assert isinstance(inner, Struct | Union)
        struct = inner
    last = _field(struct, name)
    return isinstance(message.schema.resolve(last.type), Optional | Union) and not last.required


def _field(struct: Struct | Union, name: str) -> Field:
    return next(each for each in (struct.fields if isinstance(struct, Struct) else struct.cases) if each.name == name)


# --- what is read ------------------------------------------------------------------------------------------------------


def _read(rules: tuple[Rule, ...]) -> Iterator[Place]:
    for rule in rules:
        match rule:
            case typed.Assign(place, value) | typed.SetLength(place, value):
                yield from _in_indices(place)
                yield from _in(value)
            case typed.For(_, start, stop, body, kept=kept):
                yield from _in(start)
                yield from _in(stop)
                if kept is not None:
                    yield from _in(kept.condition)
                yield from _read(body)
            case typed.When(condition, then, otherwise):
                yield from _in(condition)
                yield from _read((*then, *otherwise))
            case typed.Ignore(place):
                yield place
            case typed.Reject(pieces=pieces):
                for piece in pieces:
                    yield from _in(piece)
            case typed.SetState(_, value):
                yield from _in(value)
            case typed.Default():
                pass


def places_read(value: Expr) -> Iterator[Place]:
    """The places that an expression looks at, those of its indices included."""
    return _in(value)


def asks_arrival(value: Expr) -> bool:
    """Whether an expression asks if a message of a wire has arrived: every other message that is asked for can be absent."""
    match value:
        case typed.Has(typed.Place(side="wire", steps=(FieldStep(Field(type=Ref())),))):
            return True
        case _:
            return False


def _in(value: Expr) -> Iterator[Place]:
    match value:
        case typed.Has() if asks_arrival(value):
            pass  # nothing of a message
        case typed.Access(place) | typed.LenOf(place) | typed.IsText(place) | typed.Has(place):
            yield place
            yield from _in_indices(place)
        case typed.Unary(_, operand) | typed.Convert(operand) | typed.Search(_, _, operand):
            yield from _in(operand)
        case typed.Binary(_, left, right) | typed.Nearest(left, check=right) | typed.Reduce(_, _, left, right):
            yield from _in(left)
            yield from _in(right)
        case typed.Call(_, arguments) | typed.HostCall(_, arguments) | typed.Given(_, arguments):
            for argument in arguments:
                yield from _in(argument)
        case typed.Choice(cases, otherwise, pieces=pieces):
            for part in (*(part for case in cases for part in case), *pieces):
                yield from _in(part)
            if otherwise is not None:
                yield from _in(otherwise)
        case typed.Listed(items, index):
            for part in (*items, index):
                yield from _in(part)
        case typed.Const() | typed.Local() | typed.StateVariable():
            pass


def _in_indices(place: Place) -> Iterator[Place]:
    for step in place.steps:
        if isinstance(step, typed.IndexStep):
            yield from _in(step.index)
