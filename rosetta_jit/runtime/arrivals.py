"""Which messages have arrived, of several wires that fill one holder: the state variables that count them, and keep values of them.

No mapping can give a variable such a name.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

ALL = "(arrivals)"
"""How many messages have arrived in all."""


def variable_of(wire: str) -> str:
    """The variable that has the number of a wire's last message, from 1 on; 0 before the first."""
    return f"({wire})"


def variable_of_value(number: int) -> str:
    """The variable that keeps a value of a wire's last message for the rules of other wires' messages."""
    return f"(value {number})"


def ages(shown: Mapping[str, bool | int | float], wires: Sequence[str]) -> dict[str, int | None]:
    """How many messages have arrived since the last one of each wire; None of one without any. ``shown`` is the state of the programs."""
    numbers = {wire: int(shown[variable_of(wire)]) for wire in wires}
    return {wire: int(shown[ALL]) - number if number else None for wire, number in numbers.items()}
