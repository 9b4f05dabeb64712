"""Fields that no rule touches: of the source those that none reads, of the target those that none sets."""

from __future__ import annotations

from collections.abc import Iterator
from collections.abc import Set as AbstractSet

from rosetta_jit.language import typed
from rosetta_jit.language.counters import counters_of
from rosetta_jit.language.places import field_names, value_inside
from rosetta_jit.language.scope import Message
from rosetta_jit.language.typed import Assign, Default, Expr, FieldStep, Place, Rule, SetLength
from rosetta_jit.language.walk import expressions_of, parts
from rosetta_jit.model.types import Field, Optional, Ref, Struct, Union
from rosetta_jit.model.walk import every_rule

Names = tuple[str, ...]
_LOOKS = typed.Access | typed.LenOf | typed.IsText | typed.Has


def unread(rules: tuple[Rule, ...], source: Message, within: Names = ()) -> list[Names]:
    """Fields of the source whose values go nowhere; one that counts an array goes where its elements go.

    ``within`` is where the source lies, if it is a part of another message.
    """
    places = list(_read(rules))
    lengths = {
        field_names(place) for place, is_length in places if is_length and isinstance(value_inside(source, place.type), Struct | Union)
    }
    counters = {names for place, _ in places for names in counters_of(place.steps)}
    touched = {field_names(place) for place, is_length in places if not is_length or field_names(place) not in lengths}
    return untouched(touched | counters, source, source.root, within, lengths)


def unset(rules: tuple[Rule, ...], target: Message) -> list[Names]:
    """Fields of the target that stay absent."""
    return [names for names in never_set(rules, target) if _may_be_absent(names, target)]


def never_set(rules: tuple[Rule, ...], target: Message, within: Names = ()) -> list[Names]:
    """Fields of the target that no rule sets, whether they may be absent or not; ``within`` as above."""
    rules_of_fields = [rule for rule in every_rule(rules) if isinstance(rule, Assign | SetLength | Default)]
    lengths = {field_names(rule.place) for rule in rules_of_fields if isinstance(rule, SetLength)}
    touched = {field_names(rule.place) for rule in rules_of_fields if not isinstance(rule, SetLength)}
    return untouched(touched, target, target.root, within, lengths)


def untouched(
    touched: set[Names], message: Message, struct: Struct | Union, prefix: Names, lengths: AbstractSet[Names] = frozenset()
) -> list[Names]:
    """The outermost fields of which neither a part nor anything around is ``touched``; of arrays with ``lengths``, the elements' fields."""
    found: list[Names] = []
    for each in struct.fields if isinstance(struct, Struct) else struct.cases:
        names = (*prefix, each.name)
        if each.constant is not None or names in touched:
            continue
        inner = value_inside(message, each.type)
        if names not in lengths and not any(other[: len(names)] == names for other in touched):
            found.append(names)
        elif isinstance(inner, Struct | Union):
            found += untouched(touched, message, inner, names, lengths)
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


def _read(rules: tuple[Rule, ...]) -> Iterator[tuple[Place, bool]]:
    """The places that rules look at, and whether at their lengths alone."""
    for rule in every_rule(rules):
        if isinstance(rule, typed.Ignore):
            yield rule.place, False
        for part in (part for expr in expressions_of(rule) for part in parts(expr)):
            if isinstance(part, _LOOKS) and not asks_arrival(part):
                yield part.place, isinstance(part, typed.LenOf)


def asks_arrival(value: Expr) -> bool:
    """Whether an expression asks if a message of a wire has arrived: every other message that is asked for can be absent."""
    match value:
        case typed.Has(typed.Place(side="wire", steps=(FieldStep(Field(type=Ref())),))):
            return True
        case _:
            return False


def places_read(value: Expr) -> Iterator[Place]:
    """The places that an expression looks at, those of its indices included; of a search, what its condition looks at."""
    return (part.place for part in parts(value) if isinstance(part, _LOOKS) and not asks_arrival(part))
