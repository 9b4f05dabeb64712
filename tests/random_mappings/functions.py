"""Random expressions that call users' functions, and what those give."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from tests.random_mappings.meaning import INTEGERS, Refused
from tests.random_mappings.rules import exactly
from tests.random_mappings.values import Made, Maker

if TYPE_CHECKING:
    from collections.abc import Callable

    from tests.random_mappings.meaning import Fields, Value


@dataclass(frozen=True)
class Function:
    """A function with the types that a mapping declares."""

    arguments: tuple[str, ...]
    result: str
    run: Callable[..., Value]


def scaled(x, n):
    return x * 0.5 + n


def masked(n):
    return n & 0xFFFF


def turned(flag, x):
    return x if flag else -x


def halved(n):
    if n < 0:
        raise ValueError("below 0")
    return n // 2


def is_odd(n):
    return n % 2 == 1


def larger(a, b):
    return max(a, b)


def nearer(x, y, is_first):
    if is_first:
        return x
    if y == 2.5:
        raise ArithmeticError("no such number")
    return y


FUNCTIONS = {
    "scaled": Function(("float64", "int32"), "float64", scaled),
    "masked": Function(("int64",), "int64", masked),
    "turned": Function(("bool", "float32"), "float32", turned),
    "halved": Function(("int64",), "int64", halved),
    "is_odd": Function(("uint64",), "bool", is_odd),
    "larger": Function(("uint8", "uint8"), "uint8", larger),
    "nearer": Function(("float64", "float64", "bool"), "float64", nearer),
}
DECLARED = "".join(f"function {name}({', '.join(each.arguments)}): {each.result}\n" for name, each in FUNCTIONS.items())


class Calling(Maker):
    """Makes expressions some of which are calls."""

    def of(self, type_: str, depth: int) -> Made:
        names = [name for name, each in FUNCTIONS.items() if each.result == type_ or (type_ == "int64" and each.result in INTEGERS)]
        return self.called(self.rng.choice(names), depth) if names and depth > 0 and self.rng.random() < 0.3 else super().of(type_, depth)

    def called(self, name: str, depth: int) -> Made:
        function = FUNCTIONS[name]
        arguments = [exactly(self, type_, depth - 1) for type_ in function.arguments]

        def evaluate(fields: Fields) -> Value:
            values = [typed(each.evaluate(fields), type_) for each, type_ in zip(arguments, function.arguments, strict=True)]
            try:
                return typed(function.run(*values), function.result)
            except (ValueError, ArithmeticError):
                raise Refused("rejected") from None

        return Made(f"{name}({', '.join(each.text for each in arguments)})", function.result, evaluate)


def typed(value: Value, type_: str) -> Value:
    match type_:
        case "float32":
            return np.float32(value)
        case "float64":
            return np.float64(value)
        case "bool":
            return bool(value)
        case _:
            return int(value)
