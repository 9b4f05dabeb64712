"""Values of lcm-gen's objects, of ours, and of records, all as plain Python values whose numbers compare bit for bit."""

from __future__ import annotations

import struct
from collections.abc import Mapping, Sequence

import numpy as np


def bits(value):
    """A float as its bits; NaN of any payload is one, since Python's struct does not keep those of floats."""
    if isinstance(value, float):
        return "nan" if value != value else struct.pack(">d", value)  # noqa: PLR0124  that is how NaN is found
    return value


def of_record(value):
    """A value tree of the records."""
    if "fields" in value:
        return {name: of_record(each) for name, each in value["fields"]}
    if "hex" in value:
        return bytes.fromhex(value["hex"])
    if "items" in value:
        return [of_record(each) for each in value["items"]]
    return leaves(value.get("value", value.get("values")), real=value["type"].startswith(("float", "double")))


def leaves(value, *, real):
    if isinstance(value, list):
        return [leaves(each, real=real) for each in value]
    return bits(float(value)) if real else value


def of_generated(value):
    """An object of lcm-gen's classes."""
    if hasattr(value, "__typenames__"):
        return {name: of_generated(getattr(value, name)) for name in value.__slots__}
    if isinstance(value, Sequence) and not isinstance(value, str | bytes):
        return [of_generated(each) for each in value]
    return bits(value)


def of_holder(value):
    """A holder, or a value of one."""
    if isinstance(value, np.ndarray):
        return of_holder(value.tolist())
    if hasattr(value, "family_"):
        return {name: of_holder(getattr(value, name)) for name in value.__slots__}
    if isinstance(value, Mapping):
        return {name: of_holder(each) for name, each in value.items()}
    if isinstance(value, np.generic):
        return bits(value.item())
    if isinstance(value, str | bytes | bool | int | float):
        return bits(value)
    return [of_holder(each) for each in value]
