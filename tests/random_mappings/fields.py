"""Random values of fields, plain and extreme."""

from __future__ import annotations

import math
import struct
from typing import TYPE_CHECKING, Any

import numpy as np

from tests.random_mappings.meaning import INTEGERS, TEXTS, Fields, Value

if TYPE_CHECKING:
    import random

    import rosetta_jit as rj


def written(encode: rj.Encoder, values: dict[str, Any]) -> bytes:
    """The message of values, every byte of which is written: what a buffer had before does not show.

    That is asked of one function twice: the sign of a NaN that is computed is free, and need not be the same in another one.
    """
    holder = encode.holder_type.from_dict(values)
    message = bytes(encode(holder))
    buffers = [bytearray(bytes((before,)) * len(message)) for before in (0xA5, 0x5A)]
    for buffer in buffers:
        assert encode.into(holder, buffer) == len(message)
    assert buffers[0] == buffers[1]
    return message


def some_value(rng: random.Random, type_: str) -> Value:
    """A value of a leaf, plain or extreme."""
    match type_:
        case "bool":
            return rng.random() < 0.5
        case "string":
            return rng.choice([*TEXTS, "".join(rng.choice("ab/ é1") for _ in range(rng.randrange(6)))])
        case "float32" | "float64":
            return some_float(rng, type_)
        case _:
            low, high = INTEGERS[type_]
            close = [value for value in (*range(-3, 12), 63, 64, 100) if low <= value <= high]
            return rng.choice([low, high, rng.randint(low, high), low + 1, *(rng.choice(close) for _ in range(6))])


def some_float(rng: random.Random, type_: str) -> np.floating:
    kind = np.float32 if type_ == "float32" else np.float64
    edges = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        0.5,
        1.5,
        2.5,
        -2.5,
        1e10,
        127.5,
        255.5,
        math.nan,
        math.inf,
        -math.inf,
        2.0**31,
        -(2.0**63),
        2.0**63,
        2.0**64,
    ]
    with np.errstate(all="ignore"):
        bits = np.frombuffer(rng.randbytes(8), "<f8")[0] if kind is np.float64 else np.frombuffer(rng.randbytes(4), "<f4")[0]
        return kind(rng.choice([*edges, round(rng.uniform(-100, 100), 2), bits]))


def some_fields(rng: random.Random, leaves: dict[str, str]) -> Fields:
    """The values of the fields that expressions read, without the arrays."""
    return {name: some_value(rng, type_) for name, type_ in leaves.items()}


def plain(value: Value) -> Value:
    """A value as `to_dict` has it, floats by their bits: NaN is equal to itself, and -0 not to 0."""
    if isinstance(value, list):
        return [plain(each) for each in value]
    if isinstance(value, dict):
        return {name: plain(each) for name, each in value.items()}
    if isinstance(value, np.floating | float):
        return "nan" if math.isnan(value) else struct.pack("<d", float(value))
    return int(value) if isinstance(value, np.integer) else value
