"""The places that rules set, and places as text.

A place is shown as a mapping names it: a case of a union as a field of what is around the union, `.u.n` and not `.u._u.n`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rosetta_jit.language.scope import Message
from rosetta_jit.language.typed import Assign, Const, Default, FieldStep, For, IndexStep, Place, Rule, SetLength, Step, When
from rosetta_jit.model.types import Array, Field, Struct, Type, Union
from rosetta_jit.model.walk import every_rule


def field_names(place: Place) -> tuple[str, ...]:
    """The fields on the way to a place, without indices."""
    return tuple(step.field.name for step in place.steps if isinstance(step, FieldStep))


def places_in(rules: tuple[Rule, ...]) -> list[Place]:
    """All places that rules set, those within blocks included."""
    return [rule.place for rule in every_rule(rules) if isinstance(rule, Assign | SetLength | Default)]


def rules_within(rules: tuple[Rule, ...]) -> Iterator[Rule]:
    """The rules in all blocks, without the blocks."""
    return (rule for rule in every_rule(rules) if not isinstance(rule, For | When))


# --- as text -----------------------------------------------------------------------------------------------------------


def shown_place(steps: Sequence[Step]) -> str:
    """The way to a place, with the indices that are constants: `.joints[0].name`, `.joints[].name`."""
    return _joined([step.field if isinstance(step, FieldStep) else _shown_index(step) for step in steps])


def shown_shape(steps: Sequence[Step]) -> str:
    """The way to a place, whatever its indices are: `.joints[].name`."""
    return _joined([step.field if isinstance(step, FieldStep) else "[]" for step in steps])


def shown_fields(steps: Sequence[Step]) -> str:
    """The fields on the way to a place: `.joints.name`."""
    return _joined([step.field for step in steps if isinstance(step, FieldStep)])


def shown_names(names: Sequence[str], message: Message) -> str:
    """The same of a place of a message that is known by its names."""
    parts: list[Field | str] = []
    type_: Type = message.root
    for name in names:
        fields = type_.fields if isinstance(type_, Struct) else type_.cases if isinstance(type_, Union) else ()
        found = next((field for field in fields if field.name == name), None)
        parts += [*_brackets(message, parts), f".{name}" if found is None else found]
        type_ = type_ if found is None else value_inside(message, found.type)
    return _joined(parts)


def _brackets(message: Message, parts: list[Field | str]) -> list[str]:
    """What stands between the last field and one of its elements."""
    type_, found = parts[-1].type if parts and isinstance(parts[-1], Field) else None, ""
    while type_ is not None and isinstance(value := message.value_type(type_), Array):
        type_, found = value.element, f"{found}[]"
    return [found] if found else []


def value_inside(message: Message, type_: Type) -> Type:
    """The type of a value, or of an array's innermost element."""
    value = message.value_type(type_)
    return value_inside(message, value.element) if isinstance(value, Array) else value


def _shown_index(step: IndexStep) -> str:
    return f"[{step.index.value}]" if isinstance(step.index, Const) else "[]"


def _joined(parts: list[Field | str]) -> str:
    """A text of fields and of what stands between them."""
    following = [*parts, None][1:]
    return "".join(part if isinstance(part, str) else _member(part, behind) for part, behind in zip(parts, following, strict=True))


def _member(field: Field, behind: Field | str | None) -> str:
    """A field; nothing for a union that a case of its own stands for, unless what is around has another field of that name."""
    if isinstance(field.type, Union) and isinstance(behind, Field) and behind.name not in (field.name, field.type.discriminator):
        return ""
    return f".{field.name}"
