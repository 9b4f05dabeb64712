"""Tables of logs: the times of messages beside their fields."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from rosetta_jit.runtime.batches.batch import Batch, hand_over

if TYPE_CHECKING:
    import pyarrow as pa

    from rosetta_jit.logs.decoded_parts import Part

STAMPS = (("secs", "nsecs"), ("sec", "nanosec"), ("sec", "nsec"))
"""What the seconds and nanoseconds of a ``header.stamp`` are called: ROS 1, ROS 2, OpenRTM."""


def table_of(part: Part, columns: Sequence[str] | None, clocks: Iterable[str], form: Mapping[str, Any]) -> pa.Table:
    """Messages as a table with columns of times in front; ``form`` is what `Batch.to_arrow` takes besides.

    Arrays that fill their lanes are not copied: they take the lanes' memory.
    """
    from rosetta_jit.runtime.arrow.stamps import with_times

    hand_over(part.batch)
    return with_times(part.batch.to_arrow(columns, **form), {name: _clock(name, part) for name in clocks})


def joined(tables: Iterable[pa.Table]) -> pa.Table:
    """One table of many, which shows their memory."""
    from rosetta_jit.runtime.arrow.stamps import concatenated

    return concatenated(list(tables))


def _clock(name: str, part: Part) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
    match name:
        case "log_time":
            return part.log_ns
        case "publish_time":
            return part.publish_ns
        case "header_time":
            return _header(part.batch)
        case _:
            raise ValueError(f"a clock is log_time, publish_time or header_time, not {name!r}")


def _header(batch: Batch) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
    for seconds, nanoseconds in STAMPS:
        try:
            return batch.column(f"header.stamp.{seconds}").astype(np.int64) * 10**9 + batch.column(f"header.stamp.{nanoseconds}")
        except KeyError:
            continue
    raise KeyError("header.stamp")
