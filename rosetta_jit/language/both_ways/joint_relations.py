"""Relations that only together say what a value of the wire is: numbers of one text, signals of one frame, an image and its measures."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from rosetta_jit.model.expr import Expr
from rosetta_jit.model.mapping import Relation

if TYPE_CHECKING:
    from rosetta_jit.language.both_ways.inverse import Solution, TypeOf
    from rosetta_jit.language.both_ways.knowledge import Loops

Related = tuple["Relation", "Loops"]


class Together(Protocol):
    """Such relations: the first of them sets the value, for all."""

    @property
    def whole(self) -> Expr:
        """What has the field of the wire that they set."""
        ...

    @property
    def relations(self) -> tuple[Related, ...]: ...

    @property
    def refused(self) -> tuple[tuple[Expr, str], ...]:
        """When unpacking refuses a message, because packing could not give it back, and why."""
        ...

    def solved(self, type_of: TypeOf) -> Solution:
        """The value of which they all hold; raises NoInverseError."""
        ...

    def length(self, type_of: TypeOf) -> int | None:
        """How long the value is, where they tell; raises NoInverseError."""
        ...
