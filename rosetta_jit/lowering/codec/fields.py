"""The fields that a codec's leaves carry: what a walk over a codec reads from and writes to.

A walk knows paths and directions; only `Fields` knows where a value lives: in a holder (`holder_fields`), or, for rules of a mapping that
relates the wire to another type, where the walk came by it (`wire_fields`).
"""

from __future__ import annotations

from typing import Protocol

from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.terms import type_of
from rosetta_jit.lowering.writer import Where
from rosetta_jit.startup.dataclass import dataclass
from rosetta_jit.wire.codec import Choice, Codec, Path


@dataclass(frozen=True, slots=True)
class Stored:
    """How many bytes or elements a field has, and the row where they start, where it is known: both read at one moment."""

    size: nodes.Expr
    start: nodes.Expr | None = None


OTHER_CASE = "another case is set than the discriminator says"


class Fields(Protocol):
    """The places at which the values of one message or element live."""

    @property
    def where(self) -> Where:
        """The path of the value in the message, for errors."""
        ...

    def shown(self, path: Path) -> Where:
        """The place of a field, for errors."""
        ...

    def put(self, path: Path, value: nodes.Expr) -> None:
        """Decode: a number has come."""
        ...

    def get(self, path: Path) -> nodes.Expr | None:
        """Encode: the number to write; None where it is written later, in its place."""
        ...

    def put_bytes(self, path: Path, at: nodes.Expr, size: nodes.Expr) -> None:
        """Decode: bytes have come."""
        ...

    def stored(self, path: Path, fixed: int | None = None) -> Stored:
        """Encode: the bytes or elements to write; their number, where the schema fixes it."""
        ...

    def copy_bytes(self, path: Path, stored: Stored) -> None:
        """Encode: write bytes to the current position."""
        ...

    def open(self, path: Path, count: nodes.Expr) -> Elements:
        """Decode: so many elements come, one after another."""
        ...

    def elements(self, path: Path, stored: Stored) -> Elements:
        """Encode: the elements to write."""
        ...

    def branch(self, choice: Choice) -> None:
        """Each alternative of a choice will put the same fields."""
        ...

    def choose(self, path: Path, number: int) -> None:
        """The union at a path has this case, 0 for none: decode says so, encode checks it."""
        ...

    def scatter(self, path: Path) -> None:
        """Decode: the fields of the struct at a path come in any order, or not at all."""
        ...

    def appear(self, path: Path) -> None:
        """Decode: an optional field is there, whatever is put into it."""
        ...

    def present(self, path: Path) -> nodes.Expr:
        """Encode: whether an optional field is there."""
        ...

    @property
    def scope(self) -> Fields:
        """The fields of the struct around: those that lengths are computed from."""
        ...


class Elements(Protocol):
    """The fields of each element of an array."""

    def place(self, item: Codec, first: nodes.Expr, step: int) -> Elements:
        """The elements are of one size: the first lies there, the others each a step further."""
        ...

    def at(self, number: nodes.Expr) -> Fields:
        """The fields of one element."""
        ...


def converted(value: nodes.Expr, scalar: str) -> nodes.Expr:
    """A value as the scalar that a slot holds; nothing is checked."""
    source, target = type_of(value), scalar_name(scalar)
    if source == target:
        return value
    if target == "bool":
        zero = nodes.Const(source, 0)
        return nodes.Compare("ne", value, zero)
    return nodes.Convert(target, value)


def negated(condition: nodes.Expr) -> nodes.Expr:
    """The opposite of a condition."""
    return nodes.Unary("not", condition)


def scalar_name(scalar: str) -> nodes.Scalar:
    """The type of the scalar in a kernel."""
    match scalar:
        case "bool" | "i8" | "u8" | "i16" | "u16" | "i32" | "u32" | "i64" | "u64" | "f32" | "f64":
            return scalar
        case _:
            raise AssertionError(scalar)
