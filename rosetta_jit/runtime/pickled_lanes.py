"""The bytes of lanes, as pickles keep them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from rosetta_jit.kernel.state import USED, lane_word

if TYPE_CHECKING:
    from rosetta_jit.runtime.lanes import Lanes


def contents_of(lanes: Lanes) -> list[bytes]:
    """The bytes of each lane's rows. Nothing may be borrowed."""
    return [bytes(lanes.memory[lane][: lanes.used(lane) * stride]) for lane, stride in enumerate(lanes.plan.strides[:-1])]


def fill(lanes: Lanes, contents: Sequence[bytes]) -> None:
    """Let lanes have such bytes; inside ``with lanes:``.

    Raises
    ------
    ValueError
        If they cannot be of this layout.
    """
    strides = lanes.plan.strides[:-1]
    if len(contents) != len(strides) or any(len(each) % stride for each, stride in zip(contents, strides, strict=True)):
        raise ValueError("these are no lanes of this type")
    for lane, (content, stride) in enumerate(zip(contents, strides, strict=True)):
        used = len(content) // stride
        if used > lanes.capacity(lane):
            lanes.grow(lane, used - lanes.capacity(lane))
        lanes.memory[lane][: len(content)] = content
        lanes.words[lane_word(lane, USED)] = used
