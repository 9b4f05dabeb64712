"""Curves: numbers of a topic over time, as many points as a picture has room for."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import takewhile
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from rosetta_jit.catalogue import logs as words
from rosetta_jit.errors import LogError
from rosetta_jit.logs.limits import MAX_LISTED_DEPTH
from rosetta_jit.model.units import Context
from rosetta_jit.runtime.batches.batch import Batch, family_in
from rosetta_jit.runtime.batches.nested import Columns, Ragged
from rosetta_jit.runtime.holder.record import Child, Items, Node, Record
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rosetta_jit.logs.channel import Channel
    from rosetta_jit.logs.log import Log

    Floats = NDArray[np.float64]

POINTS = 1 << 20
"""Points that are kept of a curve; of more, the least and the greatest of some neighbours."""

STEP = re.compile(r"\.?([^.\[\]]+)|\[(\d+)\]")


@dataclass(slots=True)
class Curve:
    """A field over time.

    Attributes
    ----------
    name
        As the user wrote it: ``/imu.angular_velocity.x``.
    times_ns : ndarray of int64, shape (n,)
        When the messages were logged, since 1970.
    values : ndarray of float64, shape (n,)
        NaN where a message has no such element.
    unit
        What the values are measured in, where the schema says it.
    """

    name: str
    times_ns: NDArray[np.int64]
    values: Floats
    unit: str | None = None

    @property
    def title(self) -> str:
        """Its name, and its unit."""
        return self.name if self.unit is None else f"{self.name}, {self.unit}"


def curve_of(log: Log, name: str, target: str | None, start: int | None = None, end: int | None = None) -> Curve:
    """The curve of a field: the topic and the field behind it, ``/imu.angular_velocity.x``, ``/joint_states.position[2]``.

    Raises
    ------
    LogError
        There is no such topic or field, or the field is no number.
    """
    topic = max((each for each in log.topics if name.startswith((f"{each}.", f"{each}["))), key=len, default="")
    if not topic:
        raise LogError((words.unknown_topic(log.name, name.partition(".")[0], log.topics),))
    channel = log[topic] if target is None else log[topic, target]
    steps = [each[1] or int(each[2]) for each in STEP.finditer(name[len(topic) :])]
    curve = Curve(name, np.empty(0, np.int64), np.empty(0))
    for part in channel.parts(start=start, end=end):
        try:
            values = _numbers(part.batch, steps)
        except (KeyError, TypeError):
            raise LogError((words.unknown_field(log.name, topic, name[len(topic) + 1 :], list(numbers_in(channel))),)) from None
        curve.unit = unit_of(family_in(part.batch).tree.root, steps)
        curve.times_ns = np.concatenate([curve.times_ns, part.log_ns])
        curve.values = np.concatenate([curve.values, values])
        while len(curve.values) > POINTS:
            _thin(curve)
    return curve


def _numbers(batch: Batch, steps: list[str | int]) -> Floats:
    """The numbers at the end of some steps, of each message one; KeyError and TypeError where they lead to none."""
    names = [str(each) for each in takewhile(lambda step: isinstance(step, str), steps)]
    found: Any = batch.column(".".join(names))
    present: Any = batch.mask(".".join(names))
    rows: Any = np.arange(len(batch))
    for step in steps[len(names) :]:
        if isinstance(step, str):
            found = _part(found, step)
        elif isinstance(found, Ragged):
            present = present & (found.counts[rows] > step)
            rows, found = np.where(present, found.starts[rows] + step, 0), found.values
        elif _dimensions(found) > 1:
            found = found[:, step]
        else:
            _no_number()
    if _dimensions(found) != 1 or found.dtype.kind not in "biuf":
        _no_number()
    values: Floats = found.astype(np.float64)
    return np.where(present, values[rows] if len(values) else np.nan, np.nan)


def _part(columns: object, name: str) -> Any:
    """The column of a name of a struct's."""
    return columns[name] if isinstance(columns, Columns) else _no_number()


def _dimensions(value: object) -> int:
    """Of an array; 0 of anything else."""
    return value.ndim if isinstance(value, np.ndarray) else 0


def _no_number() -> Any:
    raise TypeError("no number")


def unit_of(record: Record, steps: list[str | int]) -> str | None:
    """In what the number at the end of some steps is measured, where the schema says it."""
    context, node = Context(), cast("Node", record)
    for step in steps:
        if isinstance(step, int):
            context, node = context.element(step), node.element if isinstance(node, Items) else node
            continue
        around = node.record if isinstance(node, Child) else node
        assert isinstance(around, Record)
        entry = around.entries[step]
        context, node = context.member(entry.field), entry.node
    return context.unit


def _thin(curve: Curve) -> None:
    """Of each four neighbours keep the least and the greatest, in their order."""
    whole = len(curve.values) // 4 * 4
    blocks = curve.values[:whole].reshape(-1, 4)
    least = np.where(np.isnan(blocks), np.inf, blocks).argmin(1)
    greatest = np.where(np.isnan(blocks), -np.inf, blocks).argmax(1)
    places = np.sort(np.stack([least, greatest], 1), 1) + np.arange(len(blocks))[:, None] * 4
    kept = np.concatenate([places.ravel(), np.arange(whole, len(curve.values))])
    curve.times_ns, curve.values = curve.times_ns[kept], curve.values[kept]


def numbers_in(channel: Channel) -> Iterator[str]:
    """The fields of a channel that are numbers, with dots those of nested messages."""
    from rosetta_jit.runtime.holder.record import Bit, Numbers, Scalar

    def inside(record: Record, before: str, depth: int) -> Iterator[str]:
        for name, entry in record.entries.items():
            node: Any = entry.node
            match node:
                case Record() if depth < MAX_LISTED_DEPTH:
                    yield from inside(node, f"{before}{name}.", depth + 1)
                case Scalar() | Bit():
                    yield before + name
                case Numbers():
                    yield f"{before}{name}[0]"
                case _:
                    pass

    holder: Any = channel.decoder.holder_type
    return inside(holder.family_.tree.root, "", 0)
