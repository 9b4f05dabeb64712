"""Parts of batches: rows, with all that they refer to, copied into lanes of their own. Lane by lane with numpy, not message by message.

What is copied lies together and in order, borrowed bytes included; nothing that no row refers to comes along.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias, assert_never

import numpy as np

from rosetta_jit.errors import DecodeError
from rosetta_jit.kernel.state import USED, VALID, lane_word
from rosetta_jit.model.initial_values import InitialValue
from rosetta_jit.model.layout import Layout, Number, Row, Slot, Span, Variant
from rosetta_jit.runtime.lanes import Lanes, in_use
from rosetta_jit.runtime.limits import MAX_GENERATIONS
from rosetta_jit.runtime.memory_plan import plan
from rosetta_jit.runtime.rows import Rows, elements, lent, offsets, picked
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Index: TypeAlias = slice | ArrayLike
    Errors: TypeAlias = dict[int, DecodeError]


@dataclass(frozen=True, slots=True)
class _Place:
    """A span in the rows of a lane: its first word, the lane of its elements, and the cases (word, number) that it is there in."""

    word: int
    lane: int
    cases: tuple[tuple[int, int], ...]


@dataclass(frozen=True, slots=True, eq=False)
class _Copied:
    """Rows of a lane that have been copied, or are going to be, to the rows from ``start`` on."""

    lane: int
    rows: Rows
    start: int
    generation: int


def joined(parts: Sequence[tuple[Lanes, Index]]) -> Lanes:
    """New lanes with some messages of others of the same layout, one part behind the other.

    Raises
    ------
    InvalidHolder
        If the last decode into some of them failed.
    """
    like, _ = parts[0]
    chosen = [(lanes, lanes.rows, chosen_rows(index, lanes.rows)) for lanes, index in parts]
    made = Lanes(plan(like.plan.layout, sum(rows.count for _, _, rows in chosen), like.plan.initial), like.array_type)
    start = 0
    with made:
        for lanes, of, rows in chosen:
            _append(made, lanes, of, rows, start)
            start += rows.count
    return made


def settled(lanes: Lanes) -> Lanes:
    """The same messages in new lanes, with nothing borrowed and no rows that nothing refers to; inside ``with lanes:``."""
    made = Lanes(plan(lanes.plan.layout, lanes.rows, lanes.plan.initial), lanes.array_type)
    with made:
        _copy(made, lanes, Rows.first(lanes.rows), 0)
    return made


def chosen_rows(index: Index, count: int) -> Rows:
    """The rows that a slice, a mask or numbers choose out of so many.

    Raises
    ------
    IndexError
        If the mask is of another length, or a number is too large.
    TypeError
        If it is none of these.
    """
    if isinstance(index, slice):
        span = range(*index.indices(count))
        return Rows(slice(span.start, span.start + len(span)) if span.step == 1 else np.array(span, np.int64), len(span))
    numbers = np.asarray(index)
    if isinstance(index, tuple) or numbers.ndim != 1 or (numbers.size and numbers.dtype.kind not in "biu"):
        columns = ", and columns by `batch.column(name)`, or `batch.to_pandas([names])`" if numbers.dtype.kind == "U" else ""
        raise TypeError(f"messages are chosen by a number, a slice, a mask or a list or array of numbers{columns}")
    if numbers.dtype == np.bool_:
        if len(numbers) != count:
            raise IndexError(f"a mask of {len(numbers)} for {count} messages")
        numbers = np.flatnonzero(numbers)
    numbers = numbers.astype(np.int64)
    wrong = numbers[(numbers < -count) | (numbers >= count)]
    if len(wrong):
        raise IndexError(f"message {wrong[0]} of {count}")
    return Rows(np.where(numbers < 0, numbers + count, numbers), len(numbers))


def errors_of_part(errors: Errors, kept: NDArray[np.int64] | None, index: Index, count: int) -> tuple[Errors, NDArray[np.int64] | None]:
    """What `Batch.errors` and `Batch.kept` become of messages that are chosen out of so many."""
    if kept is None and not errors:
        return {}, None
    rows = np.arange(count)[chosen_rows(index, count).at]
    if kept is not None:
        return dict(errors), kept[rows]
    return {new: errors[old] for new, old in enumerate(rows.tolist()) if old in errors}, None


def errors_together(parts: Iterable[tuple[Errors, NDArray[np.int64] | None, int]]) -> tuple[Errors, NDArray[np.int64] | None]:
    """The same of batches, one behind the other: their errors, the messages that they kept, and how many those are."""
    errors, kept, is_whole, first = dict[int, "DecodeError"](), list["NDArray[np.int64]"](), True, 0
    for refused, numbers, count in parts:
        is_whole = is_whole and numbers is None
        kept_numbers = np.arange(count) if numbers is None else numbers
        errors.update((first + number, error) for number, error in refused.items())
        kept.append(first + kept_numbers)
        first += 1 + max(int(kept_numbers.max(initial=-1)), max(refused, default=-1))
    return errors, None if is_whole else np.concatenate(kept)


def contents(lanes: Lanes) -> list[NDArray[np.uint8]]:
    """The bytes of each lane's rows; not of the scratch lane, which holds none."""
    return [lanes.buffers[lane][: lanes.used(lane) * each.stride] for lane, each in enumerate(lanes.plan.layout.lanes)]


def revived(layout: Layout, initial: tuple[InitialValue, ...], array_type: type[NDArray[Any]], found: Sequence[NDArray[np.uint8]]) -> Lanes:
    """Lanes with such bytes.

    Raises
    ------
    ValueError
        If they are not of this layout: another version of rosetta_jit has written them.
    """
    if len(found) != len(layout.lanes) or any(each.size % lane.stride for each, lane in zip(found, layout.lanes, strict=True)):
        raise ValueError("these are the lanes of another version of rosetta_jit")
    counts = [each.size // lane.stride for each, lane in zip(found, layout.lanes, strict=True)]
    made = Lanes(plan(layout, counts[0], initial, (*counts, 1)), array_type)
    for lane, each in enumerate(found):
        made.buffers[lane][: each.size] = each
        made.words[lane_word(lane, USED)] = counts[lane]
    return made


def _append(made: Lanes, lanes: Lanes, of: int, rows: Rows, start: int) -> None:
    """Copy rows that were chosen out of so many."""
    before = [made.used(lane) for lane in range(len(made.plan.strides))]

    def copy(rows: Rows) -> None:
        if not lanes.words[VALID]:
            raise lanes.invalid()
        if lanes.rows != of:
            raise in_use()
        for lane, used in enumerate(before):
            made.give_back(lane, used)
        _copy(made, lanes, rows, start)

    lanes.consistent(copy, rows)


def _copy(made: Lanes, lanes: Lanes, rows: Rows, start: int) -> None:
    """Rows of lane 0 and what they refer to, in the order that encoders need: no row before the one that refers to it."""
    pending = deque([_Copied(0, rows, start, 0)])
    while pending:
        copied = pending.popleft()
        if copied.generation > MAX_GENERATIONS:
            raise ValueError("messages contain each other without end")
        words = made.row_words(copied.lane, copied.start, copied.rows.count)
        words[:] = lanes.row_words(copied.lane, 0, lanes.capacity(copied.lane))[copied.rows.at]
        for place in _places(made.plan.layout.lanes[copied.lane].element):
            pending.extend(_copy_elements(made, lanes, place, words, copied))


def _copy_elements(made: Lanes, lanes: Lanes, place: _Place, words: NDArray[np.int64], parent: _Copied) -> Iterator[_Copied]:
    """Let spans refer to elements of the new lanes. Numbers are there at once, rows are to be copied."""
    live = np.ones(len(words), np.bool_)
    for word, number in place.cases:
        live &= words[:, word] == number
    starts, counts = words[live, place.word], words[live, place.word + 1]
    leaf = isinstance(made.plan.layout.lanes[place.lane].element, Number)
    values, starts, counts = lent(lanes, place.lane, starts, counts) if leaf else (None, starts, counts)
    places = offsets(counts)
    first, total = made.used(place.lane), int(places[-1])
    source = None if leaf else elements(starts, counts, lanes.used(place.lane))
    _take(made, place.lane, total)
    words = made.row_words(parent.lane, parent.start, parent.rows.count)  # looked up again: a recursive lane may itself have grown
    words[live, place.word], words[live, place.word + 1] = places[:-1] + first, counts
    if values is not None:
        made.arrays[place.lane][first : first + total] = picked(values, starts, counts)
    elif source is not None and total:
        yield _Copied(place.lane, source, first, parent.generation + (made.plan.layout.lanes[place.lane].links is not None))


def _take(made: Lanes, lane: int, rows: int) -> None:
    """Take so many rows at a lane's end into use, which are going to be written."""
    missing = made.used(lane) + rows - made.capacity(lane)
    if missing > 0:
        made.grow(lane, missing)
    made.words[lane_word(lane, USED)] += rows


def _places(slot: Slot, cases: tuple[tuple[int, int], ...] = ()) -> Iterator[_Place]:
    match slot:
        case Number():
            pass
        case Span(offset, lane):
            yield _Place(offset // 8, lane, cases)
        case Row(members=members, unknown=unknown):
            if unknown is not None:
                yield from _places(unknown, cases)
            for member in members:
                yield from _places(member.slot, cases)
        case Variant(offset, members):
            for number, member in enumerate(members, 1):
                yield from _places(member.slot, (*cases, (offset // 8, number)))
        case _:
            assert_never(slot)
