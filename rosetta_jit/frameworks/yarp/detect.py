"""Which dialect a message is in: the `yarp` pseudo-dialect.

Nothing on the wire says so. What decides, in this order: in which dialects the message is a bottle at all, to its last
byte (tag 10 stands for eight bytes in YARP 3 and for four in YARP 4); a NUL after every string, which only 2012 writes;
and in an image the high half of the quantum word. A message that means the same in all of them is called YARP 3.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.errors import DecodeError
from rosetta_jit.frameworks.yarp.bottle import read
from rosetta_jit.frameworks.yarp.tags import YARP3, YARP4, YARP2012, vocab
from rosetta_jit.frameworks.yarp.tree import Dict, List, Value

if TYPE_CHECKING:
    from rosetta_jit.frameworks.yarp.tags import Dialect
    from rosetta_jit.frameworks.yarp.tree import Item


def detect(data: bytes) -> Dialect:
    """The dialect of a message; raises DecodeError where it is a bottle in none."""
    return read_any(data)[0]


def read_any(data: bytes) -> tuple[Dialect, List]:
    """The dialect of a message, and its tree.

    Raises
    ------
    DecodeError
        Where it is a bottle in no dialect: the error of the reading that came furthest.
    """
    readings: list[tuple[Dialect, List]] = []
    failures: list[DecodeError] = []
    for dialect in (YARP3, YARP4, YARP2012):
        try:
            readings.append((dialect, read(data, dialect)))
        except DecodeError as failure:
            failures.append(failure)
    if not readings:
        raise max(failures, key=lambda failure: failure.offset)
    return _likeliest(readings)


def _likeliest(readings: list[tuple[Dialect, List]]) -> tuple[Dialect, List]:
    *_, last = readings
    if last[0] is YARP2012 and _has_string(last[1]):
        return last
    dialect, bottle = readings[0]
    if _plain_quantum(bottle):
        return next(((known, tree) for known, tree in readings if known is YARP4), readings[0])
    return dialect, bottle


def _has_string(item: Item) -> bool:
    """A string was read with its NUL: 2012's reading has refused any other."""
    match item:
        case Value(tag):
            return tag == "string"
        case List(items):
            return any(_has_string(inner) for inner in items)
        case Dict(content):
            return _has_string(content)


def _plain_quantum(bottle: List) -> bool:
    """The message is an image, and its quantum word has no flag in the high half (yarp.md 3.5)."""
    match bottle.items:
        case (Value("vocab32", name), Value("vocab32"), List((_, _, Value("int32", int(quantum)), _, _)), Value("blob")):
            return name == vocab(b"mat") and quantum >> 16 == 0
        case _:
            return False
