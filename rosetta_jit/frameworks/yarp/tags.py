"""The three wire dialects of YARP as data: which number announces which type.

No version field travels with a message, and the numbers moved twice: strings lost their trailing NUL in 2.3.64, and 4.0
gave float32 the number of float64 (robotology/yarp#3268). Tags are those of os/Bottle.h, the masks of os/impl/Storable.h.

Scalars are known by one spelling each: int8 int16 int32 int64 float32 float64 vocab32 vocab64 string blob.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Literal

from rosetta_jit.startup.dataclass import dataclass, field

LIST = 256
"""Code of a list; a specialised one adds the code of its elements' type."""

DICT = LIST | 512
"""Code of a dict, whose body is a complete bottle with a code of its own."""

FIXED_FORMATS: Mapping[str, str] = MappingProxyType(
    {
        "int8": "b",
        "int16": "h",
        "int32": "i",
        "int64": "q",
        "float32": "f",
        "float64": "d",
        "vocab32": "i",
        "vocab64": "q",
    }
)
"""Scalars of a fixed size, with their letter in the `struct` module; all are little-endian."""


@dataclass(frozen=True, slots=True)
class Dialect:
    """One way to write bottles.

    Parameters
    ----------
    tags
        Code of each scalar spelling that the dialect has.
    nul_terminated
        A string's length counts a NUL after its last byte.
    flagged_quantum
        The quantum word of an image has a flag in its high half (3.5 to 3.12); its low half is the quantum.
    """

    name: str
    tags: Mapping[str, int] = field(hash=False)
    nul_terminated: bool = False
    flagged_quantum: bool = False


_OLDEST = {"int32": 1, "vocab32": 9, "string": 4, "blob": 12}
_NEWER = {**_OLDEST, "int8": 32, "int16": 64, "int64": 17}

YARP2012 = Dialect("yarp2012", MappingProxyType({**_OLDEST, "float64": 10}), nul_terminated=True)
YARP3 = Dialect("yarp3", MappingProxyType({**_NEWER, "float32": 128, "float64": 10}), flagged_quantum=True)
YARP4 = Dialect("yarp4", MappingProxyType({**_NEWER, "float32": 10, "float64": 20, "vocab64": 18}))

DIALECTS: Mapping[str, Dialect] = MappingProxyType({dialect.name: dialect for dialect in (YARP2012, YARP3, YARP4)})


def list_code(dialect: Dialect, unit: str | None) -> int:
    """Code of a list of ``unit``, or of a general one where that is None."""
    return LIST if unit is None else LIST | dialect.tags[unit]


def list_units(dialect: Dialect) -> dict[int, str | None]:
    """What the code of a list says about its elements; a code that is not here is no list."""
    return {LIST: None, **{LIST | code: spelling for spelling, code in dialect.tags.items()}}


def vocab(text: bytes, size: Literal[4, 8] = 4) -> int:
    """The number of a vocab32 or vocab64: its bytes little-endian (os/Vocab32.h), as the signed integer that the wire carries."""
    return int.from_bytes(text.ljust(size, b"\0"), "little", signed=True)
