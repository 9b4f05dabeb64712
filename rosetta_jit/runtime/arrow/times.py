"""Moments as Arrow's timestamps: integers of a unit, and structs of seconds and a part of one, as ROS, protobuf and OpenRTM have them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, assert_never

import numpy as np
import pyarrow as pa

from rosetta_jit.errors import EncodeError, ValuesError
from rosetta_jit.model.layout import scalar_of
from rosetta_jit.model.types import Int
from rosetta_jit.runtime.holder.record import Blob, Child, Items, Node, Numbers, Pairs, Record, Scalar, Text
from rosetta_jit.runtime.lanes import Lanes
from rosetta_jit.runtime.rows import Rows, read
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.runtime.rows import Indices

Unit = Literal["s", "ms", "us", "ns"]
SECOND_NS = 1_000_000_000
UNITS_NS: dict[str, int] = {"s": SECOND_NS, "ms": 1_000_000, "us": 1_000, "ns": 1}
_MOST = (1 << 63) - 1
_FRACTIONS = {"n": 1, "u": 1_000, "micro": 1_000, "m": 1_000_000}
"""What the name of the second field begins with, and how many nanoseconds its unit has."""


@dataclass(frozen=True, slots=True, eq=False)
class _Moment:
    """A struct of seconds and a part of one, of so many nanoseconds a unit."""

    seconds: Scalar
    part: Scalar
    unit_ns: int


def time_array(node: Node, lanes: Lanes, rows: Rows, unit: Unit, validity: pa.Buffer | None, path: str) -> pa.Array:
    """Timestamps in a unit, of integers that count it, or of structs.

    Raises
    ------
    TypeError
        If the field is no time.
    EncodeError
        If one is further from 1970 than a timestamp reaches, or a struct's is between two of them.
    """
    match node:
        case Scalar(_, Int()):
            return stamps_array(_integers(node, lanes, rows, path), unit, validity)
        case Record():
            moment = _moment(node)
            if moment is None:
                raise _no_time(path)
            seconds, part = _integers(moment.seconds, lanes, rows, path), _integers(moment.part, lanes, rows, path)
            return stamps_array(_ticks(seconds, part, moment.unit_ns, unit, path), unit, validity)
        case Scalar() | Text() | Blob() | Numbers() | Items() | Pairs() | Child():
            raise _no_time(path)
        case _:
            assert_never(node)


def _ticks(seconds: Indices, part: Indices, part_ns: int, unit: Unit, path: str) -> Indices:
    """Seconds and a part of one, of so many nanoseconds a unit, as whole numbers of another unit."""
    unit_ns = UNITS_NS[unit]
    if _reach(part, part_ns) > _MOST or _reach(seconds, SECOND_NS // unit_ns) + _reach(part, part_ns) // unit_ns > _MOST:
        raise _too_far(path)
    whole, rest = np.divmod(part * part_ns, unit_ns)
    if rest.any():
        raise EncodeError("range", path, f"time {np.argmax(rest != 0)} is between two timestamps in {unit}: take a finer unit")
    return seconds * (SECOND_NS // unit_ns) + whole


def stamps_array(values: Indices, unit: Unit, validity: pa.Buffer | None = None) -> pa.Array:
    """Integers of a unit as timestamps, which show their memory. Unlike `pa.array`, this does not import pandas."""
    return pa.Array.from_buffers(pa.timestamp(unit), len(values), [validity, pa.py_buffer(values)])


def _integers(node: Scalar, lanes: Lanes, rows: Rows, path: str) -> Indices:
    values = read(lanes, node.cell, scalar_of(node.type), rows)
    if values.dtype == np.uint64 and len(values) and int(values.max()) > _MOST:
        raise _too_far(path)
    return values.astype(np.int64, copy=False)


def _reach(values: Indices, unit_ns: int) -> int:
    """How far from 0 they reach, in nanoseconds."""
    return unit_ns * max(abs(int(values.min())), abs(int(values.max()))) if len(values) else 0


def _no_time(path: str) -> TypeError:
    name = path.lstrip(".")
    return TypeError(f"`{name}` is no time: that is an integer, or a struct of seconds and of nano-, micro- or milliseconds, both integers")


def _too_far(path: str) -> EncodeError:
    return EncodeError("range", path, "a time is further from 1970 than a timestamp in this unit reaches")


def _moment(record: Record) -> _Moment | None:
    match list(record.entries.values()):
        case [first, second] if first.name.startswith("s") and isinstance(first.node, Scalar) and isinstance(second.node, Scalar):
            unit = next((each for begin, each in _FRACTIONS.items() if second.name.startswith(begin)), None)
            are_integers = isinstance(first.node.type, Int) and isinstance(second.node.type, Int)
            return _Moment(first.node, second.node, unit) if unit is not None and are_integers else None
        case _:
            return None


def moment_columns(record: Record, array: pa.Array, path: str) -> dict[str, pa.Array]:
    """Timestamps as the fields of a struct; raises ValuesError if the struct is no time, or has no unit that is small enough."""
    moment = _moment(record)
    if moment is None:
        raise ValuesError(path, f"{record.struct or 'the record'} is no time, found a column of {array.type}")
    unit_ns = UNITS_NS[array.type.unit]
    seconds, rest = np.divmod(array.cast(pa.int64()).to_numpy(), SECOND_NS // unit_ns)
    rest *= unit_ns
    if (rest % moment.unit_ns).any():
        raise ValuesError(path, f"value {np.argmax(rest % moment.unit_ns != 0)} has parts that the field has no room for")
    return dict(zip(record.entries, (pa.array(seconds), pa.array(rest // moment.unit_ns)), strict=True))
