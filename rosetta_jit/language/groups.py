"""Functions of several values: the groups of numbers that they take and give, and one record each.

    Group         = name, Member*
    Member        = names, unit | Group
    GroupFunction = name, parameters, the group that it gives, definitions, inverses, what does not come back, row of the reference

A group is for example a quaternion: four numbers called x, y, z and w. In a mapping, a struct whose fields have these names stands for the
group, and so do an array of four elements, a list of four values, and the call of a function that gives one. Each of the numbers is a
*component*.

What a component is, its function *defines* in the mapping language: `definitions` has a line for each component, and lines for what several
components share. A component of a call is a function by itself, `quaternion.x`, which no mapping can write. So whatever knows functions of
one value knows those of several: units, laws, costs, kernels.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from types import MappingProxyType
from typing import TYPE_CHECKING, cast

from rosetta_jit.language.function import Function
from rosetta_jit.language.installed import GROUPS, family_of
from rosetta_jit.model.expr import Call, Choice, Coerced, Expr, Item, List, Literal
from rosetta_jit.startup.dataclass import dataclass
from rosetta_jit.startup.garbage import imported

if TYPE_CHECKING:
    Inverse = Callable[[tuple[Expr, ...], Expr], Expr]
    """Of the arguments of a call and its value: what one of the arguments must be."""

FLOATS = ("float32", "float64")
"""Conversions that a group may be in: each of its components is converted."""


# --- groups --------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Member:
    """A number of a group, or a group within it. A struct has it by one of the ``names``; the first one is the component's."""

    names: tuple[str, ...]
    unit: str | None = None
    group: Group | None = None


@dataclass(frozen=True, slots=True)
class Group:
    """Numbers that belong together. ``name`` is how reports call one of them."""

    name: str
    members: tuple[Member, ...]

    @property
    def components(self) -> tuple[Member, ...]:
        """The numbers of the group and of those within it, each with its whole name: `position.x`."""
        found: list[Member] = []
        for member in self.members:
            if member.group is None:
                found.append(member)
            else:
                found += [Member((f"{member.names[0]}.{each.names[0]}",), each.unit) for each in member.group.components]
        return tuple(found)


def numbers(name: str, *names: str, unit: str | None = None) -> Group:
    """A group of numbers that are all in one unit; `x|qx` are two names for one number."""
    return Group(name, tuple(Member(tuple(each.split("|")), unit) for each in names))


# --- records -------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Parameter:
    """A group that a function takes; its definitions call the components `name.x`."""

    name: str
    group: Group


@dataclass(frozen=True, slots=True)
class GroupFunction:
    """All that is known of a function of several values.

    Attributes
    ----------
    definitions
        Lines of `name = expression`. A component of the value has its name; other names stand for what later lines share.
    inverses
        For each parameter: what undoes the function where only this argument has fields, or why nothing does.
    lost
        How a value differs, besides rounding, that goes through the inverse and comes back by this function.
    separates
        Whether the inverses also hold together: where fields stand in several arguments, each inverse gives one of them.
    components
        A record for each component of the value, in order.
    """

    name: str
    parameters: tuple[Parameter, ...]
    gives: Group
    definitions: str
    inverses: tuple[Inverse | str, ...]
    lost: str
    components: tuple[Function, ...]
    separates: bool = False


@cache
def group_functions() -> Mapping[str, GroupFunction]:
    """Every function of several values by name, in the order of the reference."""
    found = (
        each for name in GROUPS for each in cast("tuple[GroupFunction, ...]", imported(f"rosetta_jit.functions.{name}").GROUP_FUNCTIONS)
    )
    return MappingProxyType({each.name: each for each in found})


# --- expressions ---------------------------------------------------------------------------------------------------------


def function_of(expr: Expr) -> GroupFunction | None:
    """The function of several values that an expression calls."""
    if isinstance(expr, Call) and expr.function.isidentifier() and family_of(expr.function) in GROUPS:
        return group_functions().get(expr.function)
    return None


def group_of(expr: Expr) -> Group | None:
    """The group that an expression gives: a call, the components of one as another float, or one of several."""
    match expr:
        case Call(function, (value, *_)) if function in FLOATS:
            return group_of(value)
        case Call():
            function = function_of(expr)
            return None if function is None else function.gives
        case Choice(((_, value), *_)) | Coerced(value=value):
            return group_of(value)
        case _:
            return None


def component(group: Expr, number: int) -> Item:
    """One number of a value that is a group."""
    found = group_of(group)
    assert found is not None
    return Item(group, Literal(found.components[number].names[0], group.span), group.span)


def arguments_of(call: Call, function: GroupFunction) -> tuple[Expr, ...] | None:
    """The argument for each parameter; None where there are too many or too few. A single group may be written number by number."""
    if len(call.arguments) == len(function.parameters):
        return call.arguments
    if len(function.parameters) == 1 and len(call.arguments) == len(function.parameters[0].group.components):
        return (List(call.arguments, call.span),)
    return None
