"""What generated Python calls: outcomes of an attempt, and the few operations that Python lacks."""

from __future__ import annotations

from collections.abc import Callable, MutableSequence, Sequence
from typing import TYPE_CHECKING

import numpy as np

from rosetta_jit.kernel.state import ERROR_INDICES, ERROR_OFFSET, ERROR_SITE, GROW, GROW_LANE, GROW_ROWS, INDEX_WORDS

if TYPE_CHECKING:
    State = np.ndarray[tuple[int], np.dtype[np.int64]]
    Bytes = bytes | bytearray | memoryview
    Registers = MutableSequence[int]
    Attempt = Callable[..., int]


class Failed(Exception):  # noqa: N818 - it ends an attempt, and is no error of this program
    """An attempt came upon something that the message should not have."""

    def __init__(self, site: int, at: int, indices: tuple[int, ...]) -> None:
        super().__init__()
        self.site, self.at, self.indices = site, at, indices


class Full(Exception):  # noqa: N818 - as above
    """A lane is too small."""

    def __init__(self, lane: int, missing: int) -> None:
        super().__init__()
        self.lane, self.missing = lane, missing


def run_attempts(
    attempts: Sequence[Attempt],
    message: tuple[Bytes, int, int],
    state: State,
    lanes: Sequence[Bytes],
    row: int,
    own: int = 0,
    hidden: tuple[int, ...] = (),
    registers: tuple[Registers, ...] = (),
) -> int:
    """The first attempt that succeeds, else the failure that came farthest, left in the state.

    ``hidden`` are the strides of the hidden lanes behind the holder's ``own``; there may be too few of them in ``lanes`` yet.
    ``registers`` has those of the program, if the kernel has any.
    """
    buffer, begin, end = message
    views = [memoryview(lane).cast("B") for lane in lanes]
    views += [memoryview(bytearray())] * (own + len(hidden) - len(views))
    farthest: Failed | None = None
    for attempt in attempts:
        try:
            with np.errstate(all="ignore"):
                return attempt(memoryview(buffer).cast("B"), begin, end, state, views, row, *registers)
        except Failed as failed:
            if farthest is None or failed.at > farthest.at:
                farthest = failed.with_traceback(None)  # its frames hold this one, and that the message's buffer
        except Full as full:
            stride = hidden[full.lane - own] if hidden and full.lane >= own else 1
            state[GROW_LANE], state[GROW_ROWS] = full.lane, full.missing * stride
            return GROW
    return 0 if farthest is None else _recorded(state, farthest)


def _recorded(state: State, failed: Failed) -> int:
    state[ERROR_OFFSET], state[ERROR_SITE] = failed.at, failed.site
    for number, value in enumerate(failed.indices[:INDEX_WORDS]):
        state[ERROR_INDICES + number] = value
    return -1 - failed.site


def has_room(at: int, size: int, end: int) -> bool:
    """Whether ``size`` bytes lie at ``at``, before ``end``."""
    return at >= 0 and 0 <= size <= end - at


def reserve(lane: int, count: int, free: int) -> None:
    """Raise `Full` unless so many rows are free."""
    if not 0 <= count <= free:
        raise Full(lane, count - free)


def quotient(left: int, right: int) -> int:
    """``left / right``, truncated toward zero."""
    result = abs(left) // abs(right)
    return result if (left < 0) == (right < 0) else -result


def remainder(left: int, right: int) -> int:
    """What `quotient` leaves, with the sign of ``left``."""
    return left - right * quotient(left, right)


def is_text(data: memoryview) -> bool:
    """Whether bytes are valid UTF-8."""
    try:
        bytes(data).decode()
    except UnicodeDecodeError:
        return False
    return True
