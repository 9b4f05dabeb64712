"""Random relations to reductions of the elements for which a condition holds: packing checks them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from tests.random_mappings.meaning import COMPARED, Refused, quotient
from tests.random_mappings.message_types import Array, Kind, Scalar
from tests.random_mappings.relations import Part

if TYPE_CHECKING:
    import random
    from collections.abc import Callable, Iterable

    from tests.random_mappings.blocks import Relations
    from tests.random_mappings.relations import Values


def added(numbers: Iterable[Any], zero: Any) -> Any:
    """From the first to the last: Python's `sum` compensates floats."""
    for number in numbers:
        zero = zero + number
    return zero


def of_some(numbers: list[Any], function: Callable[[list[Any]], Any]) -> Any:
    if not numbers:
        raise Refused("range")
    return function(numbers)


OF_BOTH: dict[str, Callable[[list[Any]], Any]] = {
    "min": lambda numbers: of_some(numbers, min),
    "max": lambda numbers: of_some(numbers, max),
    "mean": lambda numbers: of_some(numbers, lambda some: added(map(np.float64, some), np.float64(0)) / np.float64(len(some))),
    "any": lambda numbers: any(number > 1 for number in numbers),
    "all": lambda numbers: all(number > 1 for number in numbers),
    "count": lambda numbers: sum(number > 1 for number in numbers),
}
OF_FLOATS = {**OF_BOTH, "sum": lambda numbers: added(numbers, np.float64(0))}
OF_INTEGERS = {**OF_BOTH, "sum": lambda numbers: added(numbers, 0), "xor": lambda numbers: int(np.bitwise_xor.reduce(numbers or [0]))}
TYPES = {"any": "bool", "all": "bool", "mean": "float64"}


def conditional(relations: Relations, name: str) -> Part:
    """An array, and what a reduction makes of some of its elements; what is computed of the others would fail."""
    rng = relations.rng
    is_float, by_number = rng.random() < 0.5, rng.random() < 0.2
    functions = OF_FLOATS if is_float else OF_INTEGERS
    function, operator, limit = rng.choice(list(functions)), rng.choice(list(COMPARED)), rng.choice([-1, 0, 2])
    is_divided = not is_float and rng.random() < 0.5
    a, made = f"{name}a", f"{name}r"
    text = f"100 / .{a}[]" if is_divided else f".{a}[]"
    text = f"float64({text})" if function == "mean" and is_divided else text
    text += " > 1" if function in ("any", "all", "count") else ""
    condition = f"index() % 2 {operator} {abs(limit)}" if by_number else f".{a}[] {operator} {limit}"
    condition += f" and .{a}[] != 0" if is_divided else ""

    def holds(number: int, value: Any) -> bool:
        by_limit = COMPARED[operator](number % 2, abs(limit)) if by_number else COMPARED[operator](value, limit)
        return bool(by_limit) and (not is_divided or value != 0)

    def unpack(values: Values) -> Values:
        taken = [value for number, value in enumerate(values[a]) if holds(number, value)]
        found = functions[function]([quotient(100, each) for each in taken] if is_divided else taken)
        return {a: values[a], made: found}

    def wires(rng: random.Random) -> Values:
        some = [rng.randrange(-4, 5) for _ in range(rng.choice([0, 1, 2, 5, 40]))]
        return {a: [np.float64(each) / 3 for each in some] if is_float else some}

    def holders(rng: random.Random) -> Values:
        values = wires(rng)
        try:
            return unpack(values)
        except Refused:
            return {**values, made: np.float64(0) if is_float or function == "mean" else 0}

    element: Kind = Array(Scalar("float64" if is_float else "int32"))
    result = TYPES.get(function, "int64" if function == "count" or not is_float else "float64")
    lines = [f".{a} <-> .{a}\n", f".{made} <-> {function}({text} where {condition})\n"]
    rng.shuffle(lines)
    return Part({a: element}, {a: element, made: Scalar(result)}, "".join(lines), unpack, wires, holders, is_bounded=True)
