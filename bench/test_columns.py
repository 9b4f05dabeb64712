"""Batches as tables: what it takes beside decoding them."""

from __future__ import annotations

import numpy as np
import pyarrow as pa

from bench.contest import Contender
from bench.messages import repeated
from bench.report import words
from bench.subjects import IMU

CHAPTER = "Columns"
COUNT, FEW = 100_000, 1000
"""Messages; fewer are in the processor's caches, so that it is not memory alone that is measured."""
ARROW, SHOWN, MANY, AGAIN, COPY, FEW_AGAIN, FEW_COPIED, BY_HAND = (
    "rosetta_jit, `to_arrow`",
    "rosetta_jit, `to_arrow(copy=False)`",
    "its decode, `many`",
    "its decode, `many(into=)`",
    "numpy's copy",
    f"its decode of {FEW:,}, `many(into=)`",
    f"numpy's copy of {FEW:,}",
    "pyarrow, from a dict a message",
)


def test_arrow_nested(effort, compare, record):
    """Structs in structs, a text and arrays of fixed length; decoded anew, as the table is made anew."""
    count = COUNT // 10 if effort.quick else COUNT
    decode = IMU.decoder()
    buffer, offsets = repeated(IMU.message, count)
    batch, few, target = decode.many(buffer, offsets), decode.many(buffer, offsets[: FEW + 1]), np.empty_like(buffer)
    head, there = buffer[: offsets[FEW]], target[: offsets[FEW]]
    assert few.to_arrow().to_pylist() == by_hand(few).to_pylist()

    def shown():
        return batch.to_arrow(copy=False)

    outcome = compare(
        CHAPTER,
        f"{count:,} messages of sensor_msgs/Imu",
        [
            Contender(ARROW, "ours", "a table, anew", effort.call(batch.to_arrow, messages=count)),
            Contender(SHOWN, "ours", "a table that shows the batch's arrays", effort.call(shown, messages=count)),
            Contender(MANY, "limit", "a batch, anew", effort.call(decode.many, buffer, offsets, messages=count)),
            Contender(AGAIN, "limit", "a batch, used again", effort.call(lambda: decode.many(buffer, offsets, into=batch), messages=count)),
            Contender(COPY, "limit", "the messages' bytes, elsewhere", effort.call(np.copyto, target, buffer, messages=count)),
            Contender(
                FEW_AGAIN, "ours", "a batch, used again", effort.call(lambda: decode.many(head, offsets[: FEW + 1], into=few), messages=FEW)
            ),
            Contender(FEW_COPIED, "limit", "their bytes, elsewhere", effort.call(np.copyto, there, head, messages=FEW)),
            Contender(BY_HAND, "peer", "a table, anew", effort.call(by_hand, few, messages=len(few))),
        ],
    )
    took = outcome.took(ARROW).median
    record(f"{COUNT:,} messages to Arrow, nested", outcome.ratio(ARROW, MANY), 1.5, "x many", f"{took:.0f} ns a message")
    record(
        f"{COUNT:,} messages to a batch, nested", outcome.ratio(AGAIN, COPY), 3.0, "x numpy's copy", words.time(outcome.took(AGAIN).median)
    )
    took = words.time(outcome.took(FEW_AGAIN).median)
    record(f"{FEW:,} messages to a batch, nested", outcome.ratio(FEW_AGAIN, FEW_COPIED), 5, "x numpy's copy", took)
    record("the same, showing the batch's arrays", outcome.ratio(SHOWN, MANY), None, "x many", words.time(outcome.took(SHOWN).median))


def by_hand(batch):
    return pa.Table.from_pylist([message.to_dict() for message in batch])
