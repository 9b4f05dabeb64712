"""Filling a batch with many messages: of one buffer, or of several, one after another."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Literal, TypeAlias

import numpy as np

from rosetta_jit.errors import DecodeError
from rosetta_jit.kernel.state import CAPACITY, CLEAN, LANE_WORDS, USED, VALID, lane_word
from rosetta_jit.runtime import run
from rosetta_jit.runtime.batches.batch import Batch, begin_anew, is_handed_over, keep_only
from rosetta_jit.runtime.lanes import Lanes
from rosetta_jit.runtime.memory import pointer_to
from rosetta_jit.runtime.program import Loaded, one_by_one

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rosetta_jit.runtime.message_spans import MessageSpans

OnError = Literal["raise", "skip", "mask"]
MadeFor: TypeAlias = "Callable[[int, NDArray[np.uint8], int, int], bool]"
"""Of the result of a kernel and the message of a buffer, whether what the message is left to is there now: it is tried again."""


class Filling:
    """A batch on its way from the first message to the last: `begin`, `add` for each buffer, `end`. All inside ``with lanes:``.

    Until its end the batch is invalid: reading it raises.

    Attributes
    ----------
    batch : Batch
    count : int
        How many messages were given so far, those that could not be decoded included.
    expected : int
        How many there are going to be, as far as is known: lanes that grow get room for the rest, too.
    """

    def __init__(
        self, loaded: Loaded, batch: Batch, on_error: OnError, expected: int, compiled: Callable[..., int] | None, made_for: MadeFor
    ) -> None:
        self.batch, self.count, self.expected = batch, 0, expected
        self._loaded, self._on_error, self._compiled, self._made_for = loaded, on_error, compiled, made_for

    def begin(self) -> None:
        """Forget what the batch holds."""
        batch, lanes = self.batch, self.batch.lanes
        begin_anew(batch)
        self.count = 0
        lanes.begin_filling()
        words = lanes.words
        for used in range(lane_word(0, USED), lane_word(len(lanes.plan.strides), USED), LANE_WORDS):
            words[used] = 0
        lanes.rows = 0

    def resume(self, done: int) -> None:
        """Go on where so many messages have been decoded already, and nothing but that has been done."""
        begin_anew(self.batch)
        self.count = done

    def add(self, data: NDArray[np.uint8], spans: MessageSpans, count: int) -> None:
        """Decode messages, so that there are ``count``: message ``i`` of all lies at place ``i``. Room is made on the way.

        Raises
        ------
        DecodeError
            A message is not what the schema promises, and errors are not collected.
        ValueError
            A place is not in the buffer.
        """
        lanes, errors = self.batch.lanes, self.batch.errors
        first, self.count = self.count, count
        _make_rows(lanes, count)
        done = self._many(data, spans, first, lanes)
        while done < count:
            error = self._unstuck(lanes, data, spans, done)
            if isinstance(error, DecodeError) and self._on_error != "raise":
                errors[done] = error
                lanes.row_words(0, done, 1)[:] = 0
                lanes.initialise(lanes.plan.initial, done, 1)
                done += 1
            elif error is not None:
                raise error
            done = self._many(data, spans, done, lanes)

    def end(self) -> Batch:
        """The batch, which can be read now."""
        batch, lanes = self.batch, self.batch.lanes
        if self._on_error == "skip" and batch.errors:
            keep_only(batch, _leave_out(lanes, list(batch.errors)))
        lanes.words[VALID] = CLEAN
        return batch

    def _unstuck(self, lanes: Lanes, data: NDArray[np.uint8], spans: MessageSpans, done: int) -> Exception | None:
        """Make the room or the program that was missing, if it was that; otherwise what is wrong with the message."""
        result = run.result_of(lanes)
        if result < run.GROW and self._made_for(result, data, *spans.span(done)):
            return None
        if result != run.GROW:
            return self._error(result, data, spans, done)
        try:
            with run.decoding():
                self._limit(lanes, spans, done)
                _grow_for_all(lanes, done, max(self.count, self.expected))
        except DecodeError as error:
            return error
        return None

    def _limit(self, lanes: Lanes, spans: MessageSpans, done: int) -> None:
        """As `run.limit`, of the message behind those that the lanes hold."""
        lane, _ = run.missing(lanes)
        used = lanes.words[lane_word(lane, USED)] if lane < len(lanes.buffers) else 0
        begin, end = spans.span(done)
        try:
            run.limit(lanes, end - begin, self._loaded.limit, used)
        except DecodeError as error:
            raise DecodeError(error.kind, f"[{done}]{error.path}", error.detail, error.offset) from None

    def _many(self, data: NDArray[np.uint8], spans: MessageSpans, first: int, lanes: Lanes) -> int:
        """Decode from one message on; the first that could not be."""
        if self._compiled is not None:
            return self._compiled(pointer_to(data), data.size, *spans.addresses, first, self.count, lanes.address)
        return one_by_one(self._loaded.kernel, data, spans, first, self.count, lanes)

    def _error(self, result: int, data: NDArray[np.uint8], spans: MessageSpans, done: int) -> Exception:
        if result == 0:
            return spans.broken(done, data.size)
        error = run.decode_error(self._loaded.site(result), self.batch.lanes, *spans.span(done))
        return DecodeError(error.kind, f"[{done}]{error.path}", error.detail, error.offset)


_ROWS_CAPACITY, _ROWS_USED = lane_word(0, CAPACITY), lane_word(0, USED)


def can_be_at_once(batch: Batch) -> bool:
    """Whether a batch can be filled as it is: nothing is borrowed in it, and no table takes its memory."""
    return batch.lanes.source[0] is None and not is_handed_over(batch)


def end_at_once(batch: Batch, count: int) -> None:
    """Inside ``with lanes:``, behind the compiled step that has decoded so many messages: the batch has these, and can be read."""
    begin_anew(batch)
    batch.lanes.rows = count
    batch.lanes.words[VALID] = CLEAN


def _make_rows(lanes: Lanes, count: int) -> None:
    """So many rows for messages that are going to be decoded."""
    missing = count - lanes.words[_ROWS_CAPACITY]
    if missing > 0:
        lanes.grow(0, missing)
    lanes.words[_ROWS_USED] = lanes.rows = count


MOST_GUESSED = 16
"""How many times as large a lane may become by a guess: messages behind a large one may be small."""

SPARE = 32
"""A guess is larger by one of so many parts: a lane that lacks little at its end would be copied to one of twice the size."""


def _grow_for_all(lanes: Lanes, done: int, count: int) -> None:
    """Guess from the messages so far what all will take, so that a lane does not move often."""
    lane, rows = run.missing(lanes)
    if lane >= len(lanes.buffers):
        lanes.grow(lane, rows)
        return
    used, capacity = lanes.words[lane_word(lane, USED)], lanes.capacity(lane)
    wanted = (used * count) // max(done, 1) + rows
    guessed = wanted + wanted // SPARE - capacity
    lanes.grow(lane, max(rows, min(guessed, MOST_GUESSED * capacity)))


def _leave_out(lanes: Lanes, numbers: list[int]) -> NDArray[np.int64]:
    """Do without some rows of lane 0, which refer to nothing; the numbers of the others."""
    kept = np.delete(np.arange(lanes.rows), numbers)
    words = lanes.row_words(0, 0, lanes.rows)
    words[: len(kept)] = words[kept]
    lanes.words[lane_word(0, USED)] = lanes.rows = len(kept)
    return kept
