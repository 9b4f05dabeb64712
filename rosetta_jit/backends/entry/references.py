"""Lanes that become the message itself between decoding and encoding: a function that says so to the state.

define void @refer(ptr %state, ptr %data, i64 %end)
"""

from __future__ import annotations

from collections.abc import Iterable

from rosetta_jit.kernel.state import ADDRESS, CAPACITY, USED, lane_word

LANE = """\
  %address{lane} = getelementptr i64, ptr %state, i64 {address}
  store ptr %data, ptr %address{lane}
  %capacity{lane} = getelementptr i64, ptr %state, i64 {capacity}
  store i64 %end, ptr %capacity{lane}
  %used{lane} = getelementptr i64, ptr %state, i64 {used}
  store i64 %end, ptr %used{lane}
"""


def references_text(lanes: Iterable[int]) -> str:
    """The function, for lanes of bytes."""
    stores = "".join(
        LANE.format(lane=lane, address=lane_word(lane, ADDRESS), capacity=lane_word(lane, CAPACITY), used=lane_word(lane, USED))
        for lane in lanes
    )
    return f"define void @refer(ptr %state, ptr %data, i64 %end) alwaysinline {{\n{stores}  ret void\n}}\n"
