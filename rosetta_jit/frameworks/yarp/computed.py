"""Values that a declaration computes from its fields, as an encoding needs them: with paths from the message on.

A holder need not have a computed field set, so where another value uses one, what it is computed from is put in.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.model import expr
from rosetta_jit.model.types import Field, Ref, Schema, Struct
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.wire.codec import Path


@dataclass(frozen=True, slots=True)
class Scope:
    """A declaration, whose computed values name fields of it, and where it stands in the message."""

    schema: Schema
    declared: Struct
    base: Path = ()

    def value(self, value: expr.Expr | None) -> expr.Expr | None:
        """A computed value of the declaration, None for none."""
        return None if value is None else self.resolved(value)

    def resolved(self, value: expr.Expr) -> expr.Expr:
        match value:
            case expr.Path(side, steps):
                names = tuple(step.name for step in steps if isinstance(step, expr.Member))
                scope, field = self.field_at(names)
                known = None if field is None else scope.value(field.constant)
                return known or expr.Path(side, tuple(expr.Member(name) for name in (*self.base, *names)))
            case expr.Len(path):
                names = tuple(step.name for step in path.steps if isinstance(step, expr.Member))
                return expr.Len(expr.Path(path.side, tuple(expr.Member(name) for name in (*self.base, *names))))
            case expr.Unary(operator, operand):
                return expr.Unary(operator, self.resolved(operand))
            case expr.Binary(operator, left, right):
                return expr.Binary(operator, self.resolved(left), self.resolved(right))
            case expr.Call(function, arguments):
                return expr.Call(function, tuple(self.resolved(each) for each in arguments))
            case _:
                return value

    def field_at(self, names: tuple[str, ...]) -> tuple[Scope, Field | None]:
        """A field of the declaration, and the scope of the one that it stands in: the paths of its own value start there."""
        scope, owner, found = self, self.declared, None
        for number, name in enumerate(names):
            found = next((each for each in owner.fields if each.name == name), None) if owner is not None else None
            inner = self.schema.resolve(found.type) if found is not None else None
            owner = inner if isinstance(inner, Struct) else None
            if found is not None and isinstance(found.type, Ref) and owner is not None and number < len(names) - 1:
                scope = Scope(self.schema, owner, (*self.base, *names[: number + 1]))
        return scope, found
