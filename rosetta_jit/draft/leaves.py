"""A message as its leaves: every number, text and enum in it, with the way there."""

from __future__ import annotations

from collections.abc import Iterator

from rosetta_jit.draft.limits import MAX_DEPTH, MAX_LEAVES
from rosetta_jit.language.scope import Message
from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Field, Float, Int, String, Struct, Type
from rosetta_jit.startup.dataclass import dataclass, replace

Names = tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Leaf:
    """A value within a message.

    ``arrays`` are the lengths of the way, one for each step: None where the field is no array, 0 where its length varies. ``types``
    are the names of the messages on the way. ``declared`` is whether the mapping itself knows the unit, so that the compiler converts it.
    """

    names: Names
    arrays: tuple[int | None, ...]
    types: tuple[str, ...]
    type: Type
    unit: str | None
    declared: bool = True

    @property
    def depth(self) -> int:
        """In how many arrays it stands."""
        return sum(each is not None for each in self.arrays)

    @property
    def group(self) -> tuple[Names, tuple[int | None, ...]]:
        """The message that it is a field of."""
        return self.names[:-1], self.arrays[:-1]

    def path(self, index: str = "") -> str:
        """As a rule writes it: with ``index`` for each array on the way."""
        return "".join(f".{name}" + ("" if length is None else f"[{index}]") for name, length in zip(self.names, self.arrays, strict=True))


def with_units(leaves: list[Leaf], known: list[Leaf]) -> list[Leaf]:
    """The leaves of a message with units that are known of it, but not declared."""
    return [leaf if leaf.unit else replace(leaf, unit=other.unit, declared=False) for leaf, other in zip(leaves, known, strict=True)]


def leaves_of(message: Message) -> list[Leaf]:
    """All that rules can set one by one; unions, maps and what lies deeper than `MAX_DEPTH` are leaves as a whole."""
    found: list[Leaf] = []
    for leaf in _leaves(message, message.root, (), (), (message.root.name,), None):
        found.append(leaf)
        if len(found) == MAX_LEAVES:
            break
    return found


def _leaves(
    message: Message, struct: Struct, names: Names, arrays: tuple[int | None, ...], types: tuple[str, ...], unit: str | None
) -> Iterator[Leaf]:
    for field in struct.fields:
        if field.constant is not None:
            continue
        type_, length = message.value_type(field.type), None
        if isinstance(type_, Array):
            length, type_ = type_.fixed or 0, message.value_type(type_.element)
        here, lengths = (*names, field.name), (*arrays, length)
        own = _unit(field) or unit
        match type_:
            case Struct(name=name) if len(here) < MAX_DEPTH and name not in types:
                yield from _leaves(message, type_, here, lengths, (*types, name), own)
            case Bool() | Int() | Float() | String() | Bytes() | Enum():
                yield Leaf(here, lengths, types, type_, own)
            case other:  # a union, a map, what contains itself: it can be left alone, or be the same as a whole
                yield Leaf(here, lengths, types, other, own)


def _unit(field: Field) -> str | None:
    return field.unit or next((unit for _, unit in field.part_units), None)
