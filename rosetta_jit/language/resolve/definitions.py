"""The definitions of a function of several values, with types. An expression may name what is defined before it, and the parameters."""

from __future__ import annotations

from functools import cache

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.errors import MappingError
from rosetta_jit.language.constants import Constants
from rosetta_jit.language.conversions import FLOAT64
from rosetta_jit.language.groups import GroupFunction, group_functions
from rosetta_jit.language.parse.definitions import read_definitions
from rosetta_jit.language.resolve.expressions import type_expr
from rosetta_jit.language.scope import Scope
from rosetta_jit.language.typed import Expr
from rosetta_jit.language.uses import UsableMappings
from rosetta_jit.model.types import Type


def arguments_in(function: GroupFunction) -> tuple[str, ...]:
    """The names by which definitions call the numbers that a function takes: `q.x`."""
    return tuple(f"{each.name}.{member.names[0]}" for each in function.parameters for member in each.group.components)


@cache
def definitions_of(name: str) -> tuple[tuple[str, Expr], ...]:
    """The definitions of a function, in order; raises MappingError where they are wrong."""
    function = group_functions()[name]
    values: dict[str, Type] = dict.fromkeys(arguments_in(function), FLOAT64)
    problems: list[Diagnostic] = []
    scope = Scope({}, {}, Constants({}, {}), "holder", (), problems, set(), {}, UsableMappings({}, {}, ()), values=values)
    found: list[tuple[str, Expr]] = []
    for defined, expression in read_definitions(name, function.definitions):
        typed = type_expr(expression, scope)
        if typed is None:
            raise MappingError(tuple(problems))
        values[defined] = typed.type
        found.append((defined, typed))
    return tuple(found)
