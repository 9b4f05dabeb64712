"""What the records of functions of several values share."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.language.conversions import FLOAT64
from rosetta_jit.language.function import SEVERAL, Function, Numbers, Row, Undone, Units
from rosetta_jit.language.groups import Group, GroupFunction, Parameter
from rosetta_jit.lowering.groups import lower_component
from rosetta_jit.model.expr import Call, Expr

if TYPE_CHECKING:
    from rosetta_jit.language.groups import Inverse


def group_function(
    name: str,
    parameters: dict[str, Group],
    gives: Group,
    definitions: str,
    inverses: tuple[Inverse | str, ...],
    lost: str,
    row: Row,
    *,
    separates: bool = False,
) -> GroupFunction:
    """The record of a function of several values, with one for each component."""
    taken = tuple(Parameter(each, group) for each, group in parameters.items())
    count = sum(len(each.group.components) for each in taken)
    law = Undone({}, of_several=f"it is rounded{'; ' if lost else ''}{lost}")
    components = tuple(
        Function(
            f"{name}.{each.names[0]}",
            Numbers((FLOAT64,), (count, count), f"{count} numbers"),
            lower_component,
            SEVERAL,
            law,
            (row,),
            units=Units(gives=each.unit),
        )
        for each in gives.components
    )
    return GroupFunction(name, taken, gives, definitions, inverses, lost, components, separates)


def row(forms: str, takes: str, gives: str) -> Row:
    """A row of the table of functions of several values."""
    return Row("groups", forms, (takes, gives))


def called(function: str, *arguments: Expr) -> Call:
    """A call in an inverse, at the place of its value."""
    return Call(function, arguments, arguments[-1].span)


def product(a: str, b: str, to: str = "") -> str:
    """The definitions of the product of two quaternions, by Hamilton's rules."""
    return f"""
        {to}x = {a}.w * {b}.x + {a}.x * {b}.w + {a}.y * {b}.z - {a}.z * {b}.y
        {to}y = {a}.w * {b}.y - {a}.x * {b}.z + {a}.y * {b}.w + {a}.z * {b}.x
        {to}z = {a}.w * {b}.z + {a}.x * {b}.y - {a}.y * {b}.x + {a}.z * {b}.w
        {to}w = {a}.w * {b}.w - {a}.x * {b}.x - {a}.y * {b}.y - {a}.z * {b}.z
    """


def square(q: str) -> str:
    """The definition of `n`, the square of the length of a quaternion, and of `double`, 2 / n: 0 of four zeros, which turn nothing."""
    return f"""
        n = {q}.x * {q}.x + {q}.y * {q}.y + {q}.z * {q}.z + {q}.w * {q}.w
        double = 2 / n if n > 0 else 0.0
    """


def rotated(q: str, v: str, to: str) -> str:
    """The definitions of a vector turned by a quaternion, which `square` has been defined of."""
    return f"""
        t.x = double * ({q}.y * {v}.z - {q}.z * {v}.y)
        t.y = double * ({q}.z * {v}.x - {q}.x * {v}.z)
        t.z = double * ({q}.x * {v}.y - {q}.y * {v}.x)
        {to}.x = {v}.x + {q}.w * t.x + {q}.y * t.z - {q}.z * t.y
        {to}.y = {v}.y + {q}.w * t.y + {q}.z * t.x - {q}.x * t.z
        {to}.z = {v}.z + {q}.w * t.z + {q}.x * t.y - {q}.y * t.x
    """


def inverted(q: str, to: str = "") -> str:
    """The definitions of the inverse of a quaternion, which `square` has been defined of: the one of four zeros has four zeros."""
    return f"""
        {to}x = {q}.x * double / -2
        {to}y = {q}.y * double / -2
        {to}z = {q}.z * double / -2
        {to}w = {q}.w * double / 2
    """
