"""The differences between a type and another one that is used in its place, in sentences for the person who connects the two."""

from __future__ import annotations

from collections.abc import Iterator

from rosetta_jit.model.types import Array, Bytes, Int, Schema, Struct, Type
from rosetta_jit.startup.dataclass import dataclass
from rosetta_jit.wire.other_type import OCTET, Pairs, is_same_word


def differences(wire: Struct, holder: Struct, schema: Schema, pairs: Pairs, *, is_read: bool) -> tuple[str, ...]:
    """For a type on the wire and the holder's that stands for it: each field that is renamed, left out or added, or of another integer.

    ``is_read`` says that messages come from the wire; else they go there.
    """
    return tuple(_Walk(schema, pairs, is_read).of(wire, holder, "", ""))


@dataclass(frozen=True, slots=True)
class _Walk:
    schema: Schema
    pairs: Pairs
    is_read: bool

    def of(self, wire: Type, holder: Type, here: str, there: str) -> Iterator[str]:
        """Of two types, at their paths."""
        match self.schema.resolve(wire), self.schema.resolve(holder):
            case Struct() as one, Struct() as other:
                yield from self.of_structs(one, other, here, there)
            case Array(element), Array(other_element):
                yield from self.of(element, other_element, f"{here}[]", f"{there}[]")
            case Array(element), Bytes():
                yield from self.of(element, OCTET, f"{here}[]", f"{there}[]")
            case Int() as one, Int() as other if is_same_word(one, other):
                pass
            case Int(bits, signed), Int(other_bits, other_signed) if (bits, signed) != (other_bits, other_signed):
                names = self.turned(f"{'' if signed else 'u'}int{bits}", f"{'' if other_signed else 'u'}int{other_bits}")
                yield f"`{self.turned(here, there)[0]}`: {names[0]} becomes {names[1]}, and a value that does not fit is refused"
            case _:
                pass

    def of_structs(self, wire: Struct, holder: Struct, here: str, there: str) -> Iterator[str]:
        partners, types = self.pairs(wire, holder, here), {each.name: each.type for each in holder.fields}
        for each in wire.fields:
            partner, inside = partners.fields[each.name], f"{here}.{each.name}"
            if partner is None:
                yield f"`{inside}` is left out" if self.is_read else f"`{inside}` is written as 0"
                continue
            if partner != each.name:
                yield "`{}` becomes `{}`".format(*self.turned(inside, f"{there}.{partner}"))
            yield from self.of(each.type, types[partner], inside, f"{there}.{partner}")
        for name in sorted(partners.added):
            yield (
                f"`{there}.{name}` is zero or empty"
                if self.is_read
                else f"`{there}.{name}` is left out, and refused where it is not zero or empty"
            )

    def turned(self, wire: str, holder: str) -> tuple[str, str]:
        """In the direction in which messages go."""
        return (wire, holder) if self.is_read else (holder, wire)
