"""State variables as registers of the kernel, which are words of 64 bits: integers as they are, floats by their bits.

What a rule sets one to is kept in a variable of the kernel until the message is done; the Return at its end hands it over.
"""

from __future__ import annotations

import struct

from rosetta_jit.kernel.nodes import Bits, Convert, Expr, Register, Scalar
from rosetta_jit.kernel.terms import type_of
from rosetta_jit.language import typed
from rosetta_jit.language.places import rules_within
from rosetta_jit.language.typed import SetState
from rosetta_jit.lowering.evaluation import Evaluation
from rosetta_jit.lowering.writer import Writer

BITS: dict[Scalar, Scalar] = {"f32": "u32", "f64": "i64"}
"""Floats, and the integers of their width."""


def remembered(number: int, scalar: Scalar) -> Expr:
    """What a state variable is while the message is read."""
    register = Register(number)
    if scalar in BITS:
        return Bits(scalar, _converted(register, BITS[scalar]))
    return _converted(register, scalar)


def word_of(value: float, type_: str) -> int:
    """The register that holds a value of a type, which is known by its name."""
    match type_:
        case "float32":
            return int.from_bytes(struct.pack("<f", value), "little")
        case "float64":
            return int.from_bytes(struct.pack("<d", value), "little", signed=True)
        case _:
            return (int(value) + 2**63) % 2**64 - 2**63


def begin(writer: Writer, rules: tuple[typed.Rule, ...]) -> None:
    """Before the rules of a message: a variable for each register that they may set, which is at first what it was."""
    if writer.direction == "size":
        return
    for number in sorted({rule.variable.number for rule in rules_within(rules) if isinstance(rule, SetState)}):
        writer.registers[number] = writer.var("kept", Register(number))


def remember(writer: Writer, number: int, values: Evaluation, value: typed.Expr) -> None:
    """What a state variable is from the next message on. To measure a message changes none."""
    if writer.direction == "size":
        return
    made = values.of(value)
    scalar = type_of(made)
    word = Bits(BITS[scalar], made) if scalar in BITS else made
    writer.assign(writer.registers[number], _converted(word, "i64"))


def _converted(value: Expr, scalar: Scalar) -> Expr:
    return value if type_of(value) == scalar else Convert(scalar, value)
