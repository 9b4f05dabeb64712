"""The functions that a kernel's host has, for the backends that run in Python.

A function gets the numbers, then the bytes that it reads, then those that it fills; it gives a number of its result's type, or refuses.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np

from rosetta_jit.kernel.arithmetic import FLOATS, Value, constant, limits
from rosetta_jit.kernel.nodes import Scalar
from rosetta_jit.startup.dataclass import dataclass

Functions = Mapping[str, Callable[..., Value]]

NO_FUNCTIONS: Functions = MappingProxyType({})


class RefusedError(Exception):
    """What a function of the host was asked cannot be answered: the kernel's statement fails."""


@dataclass(frozen=True, slots=True)
class UserFunction:
    """A function that a mapping declares, and what its user gives as it."""

    name: str
    function: Callable[..., object]
    parameters: tuple[Scalar, ...]
    result: Scalar


def in_python(declared: UserFunction) -> Callable[..., Value]:
    """A user's function as one of the host. What it raises, and a result that is not of its type, are refusals."""

    def call(*arguments: Value) -> Value:
        converted = [_converted(argument, type_) for argument, type_ in zip(arguments, declared.parameters, strict=True)]
        try:
            found = declared.function(*converted)
        except Exception as error:
            raise RefusedError from error
        return _of_type(found, declared.result)

    return call


def _converted(value: Value, type_: Scalar) -> Value | float:
    """A value as Python computes it: a division of Python's floats by zero raises, as numba's does."""
    match type_:
        case "bool":
            return bool(value)
        case "f64":
            return float(value)
        case _:
            return value


def _of_type(found: object, result: Scalar) -> Value:
    match found:
        case bool() | np.bool_() if result == "bool":
            return bool(found)
        case bool() | np.bool_():
            raise RefusedError
        case int() | float() | np.integer() | np.floating() if result in FLOATS:
            return constant(result, float(found))
        case int() | np.integer() if result != "bool" and limits(result)[0] <= int(found) <= limits(result)[1]:
            return int(found)
        case _:
            raise RefusedError
