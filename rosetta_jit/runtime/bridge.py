"""Bridges, from the bytes of one wire to those of another: many messages at once, and calls that the entry does not serve itself.

Their lanes are nobody else's: threads take them in turn, and others where they are taken.
"""

from __future__ import annotations

import ctypes
from collections.abc import Generator, Iterable, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from rosetta_jit.errors import DecodeError, EncodeError, InUse
from rosetta_jit.kernel.state import ADDRESS, CAPACITY, GROW, NUMBER, USED, lane_word
from rosetta_jit.model.layout import Layout
from rosetta_jit.runtime import run
from rosetta_jit.runtime.callable import Context, bind_call, give_own
from rosetta_jit.runtime.code.native import Library
from rosetta_jit.runtime.lanes import Lanes
from rosetta_jit.runtime.limits import MAX_SPARES
from rosetta_jit.runtime.message_spans import MessageSpans, laid_out
from rosetta_jit.runtime.program import ProgramBase, entry_of
from rosetta_jit.runtime.registers import NOTHING_KEPT, Kept, address_of
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer as Buffer
    from numpy.typing import NDArray


_NOTHING = np.empty(0, np.uint8)

FULL = 1
"""What `many` leaves as its result where there is no room for the next message."""

_MANY = ctypes.CFUNCTYPE(
    ctypes.c_int64,
    *(ctypes.c_void_p, ctypes.c_int64, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_int64, ctypes.c_int64),
    *(ctypes.c_void_p, ctypes.c_void_p, ctypes.c_int64, ctypes.c_void_p),
)
"""The compiled `many` (`backends/entry/bridge.ll`): buffer, its size, begins, ends, first, count, state, target, its room, places."""


@dataclass(frozen=True, slots=True)
class LoadedBridge:
    """A bridge that can run.

    Attributes
    ----------
    layout
        Of the type at which both halves meet.
    kernels, sites
        What decodes, what measures, what encodes; and where each of them can fail.
    references
        The lanes that become the message when it is decoded.
    library
        The compiled code, None where kernels run in Python.
    asks_host, limit, state
        As of `rosetta_jit.runtime.program.Loaded`.
    """

    layout: Layout
    kernels: tuple[run.Run, run.Run, run.Run]
    sites: tuple[run.Sites, ...]
    references: tuple[int, ...] = ()
    library: Library | None = None
    asks_host: bool = False
    limit: int = 0
    state: Kept = NOTHING_KEPT


class BridgeBase(ProgramBase):
    """Turns messages of one wire into messages of another."""

    _arguments = "message", {"buffer": None}
    _loaded: LoadedBridge

    if TYPE_CHECKING:  # the entry does this

        def __call__(self, message: Buffer, buffer: Buffer | None = None) -> Any:
            """The message as the other wire has it, as bytes; or, written to the begin of a buffer, how many bytes it takes there."""
            ...

    def _start(self, loaded: LoadedBridge) -> None:
        if "_loaded" in vars(self):
            raise TypeError(f"this {type(self).__name__} is made already: its code may be running")
        self._loaded, self._asks, self._registers = loaded, loaded.asks_host, loaded.state.registers()
        self._lanes = Lanes.of(loaded.layout)
        self._spares: list[Lanes] = []
        context = Context(self._call_slowly, Lanes, address_of(self._registers), [loaded, self._registers])
        bind_call(self, entry_of(loaded.library, loaded.state), context)
        give_own(self, self._lanes, self._lanes.state, self._lanes.source)

    @property
    def state(self) -> Mapping[str, Mapping[str, bool | int | float]]:
        """What each state variable is for the next message: those of the mapping that reads in ``decode``, of the other in ``encode``.

        Raises
        ------
        InUse
            Another thread's call of the bridge has not returned.
        """
        halves: dict[str, dict[str, bool | int | float]] = {"decode": {}, "encode": {}}
        if self._registers is not None:
            for name, value in self._registers.shown().items():
                half, _, variable = name.partition(".")
                halves[half][variable] = value
        return halves

    def into(self, message: Buffer, buffer: Buffer) -> int:
        """Write what a message becomes to the begin of a buffer; returns how many bytes that are.

        Raises
        ------
        DecodeError
            The message is not what its schema promises.
        EncodeError
            It has values that the other wire cannot carry.
        BufferError
            The buffer is read-only, or has not enough room.
        """
        return self(message, buffer)

    def many(
        self, messages: Buffer | Iterable[Buffer], offsets: NDArray[np.int64] | None = None
    ) -> tuple[NDArray[np.uint8], NDArray[np.int64]]:
        """Turn many messages into those of the other wire, without the interpreter lock.

        Parameters
        ----------
        messages
            A bytes-like object in which they lie, with ``offsets``; or one such object for each, which costs a copy.
        offsets : ndarray of int64, shape (n + 1,) or (2, n)
            Message i is bytes ``offsets[i]`` to ``offsets[i + 1]``; of two rows, bytes ``offsets[0, i]`` to ``offsets[1, i]``.

        Returns
        -------
        buffer : ndarray of uint8
            What they become, one behind the other.
        offsets : ndarray of int64, shape (n + 1,)
            Where each of them begins in the buffer, and the last ends.

        Raises
        ------
        DecodeError, EncodeError
            As for one message; the path begins with its number, ``[17]``.
        ValueError
            The offsets are not int64, have another shape, fall, or leave the buffer.
        """
        source, spans = laid_out(cast("Any", messages), offsets)
        data, count = run.readable(source), len(spans)
        ends = np.zeros(count + 1, np.int64)
        target = np.empty(max(2 * data.size, 64), np.uint8)
        with self._free() as lanes, self._keeping(lanes):
            self._tell(lanes, count)
            done = self._many(data, spans, 0, lanes, target, ends)
            while done < count:
                if run.result_of(lanes) == FULL:
                    target = _copied(target, int(ends[done]), 2 * target.size)
                else:
                    with self._as_before():
                        target = self._unstuck(data, spans, done, lanes, target, ends)
                    done += 1
                done = self._many(data, spans, done, lanes, target, ends)
        return target[: ends[-1]], ends

    def _many(
        self,
        data: NDArray[np.uint8],
        spans: MessageSpans,
        first: int,
        lanes: Lanes,
        target: NDArray[np.uint8],
        ends: NDArray[np.int64],
    ) -> int:
        """Go on from one message; the first that could not be done."""
        count = len(spans)
        if self._loaded.library is None:
            run.note(lanes, 0 if first == count or not spans.are_in(first, data.size) else run.GROW)
            return first
        many = _MANY(self._loaded.library["many"])
        buffers = data.ctypes.data, data.size, *spans.addresses, first, count
        return many(*buffers, lanes.address, target.ctypes.data, target.size, ends.ctypes.data)

    def _unstuck(
        self,
        data: NDArray[np.uint8],
        spans: MessageSpans,
        number: int,
        lanes: Lanes,
        target: NDArray[np.uint8],
        ends: NDArray[np.int64],
    ) -> NDArray[np.uint8]:
        """Do one message for which lanes must grow, or say what is wrong with it; gives the target, with room for it."""
        if run.result_of(lanes) == 0:
            raise spans.broken(number, data.size)
        begin, end = spans.span(number)
        place = int(ends[number])
        try:
            size = self._taken(lanes, data, begin, end)
            if place + size > target.size:
                target = _copied(target, place, max(2 * target.size, place + size))
            self._written(lanes, data, end, target, place, size)
        except DecodeError as error:
            raise DecodeError(error.kind, f"[{number}]{error.path}", error.detail, error.offset) from None
        except EncodeError as error:
            raise EncodeError(error.kind, f"[{number}]{error.path}", error.detail) from None
        ends[number + 1] = place + size
        lanes.words[NUMBER] += 1
        return target

    def _call_slowly(self, *arguments: Any, **named: object) -> object:
        """Whatever the entry does not do: wrong arguments, lanes that are too small or in use, errors."""
        if named or len(arguments) not in (1, 2):
            raise TypeError("a bridge takes a message, and perhaps a buffer to write to")
        data = run.readable(arguments[0])
        target = None if len(arguments) == 1 else run.writable(arguments[1])
        if target is not None and np.may_share_memory(data, target):
            data = data.copy()
        with self._free() as lanes, self._numbered(lanes):
            size = self._taken(lanes, data, 0, data.size)
            if target is None:
                with run.encoding():
                    made = np.empty(size, np.uint8)
                self._written(lanes, data, data.size, made, 0, size)
                return made.tobytes()
            if size > target.size:
                raise BufferError(f"the message takes {size} bytes, and the buffer has {target.size}")
            self._written(lanes, data, data.size, target, 0, size)
            return size

    @contextmanager
    def _free(self) -> Generator[Lanes]:
        """Lanes that nobody uses: the bridge's own, or others where another thread has those."""
        try:
            self._lanes.__enter__()
        except InUse:
            try:
                lanes = self._spares.pop()
            except IndexError:
                lanes = Lanes.of(self._loaded.layout)
            with lanes:
                yield lanes
            if len(self._spares) < MAX_SPARES:
                self._spares.append(lanes)
            return
        try:
            yield self._lanes
        finally:
            self._lanes.__exit__()

    def _taken(self, lanes: Lanes, data: NDArray[np.uint8], begin: int, end: int) -> int:
        """Decode a message, and measure what it becomes."""
        decode, measure, _ = self._loaded.kernels
        with run.decoding():
            result = run.run_growing(decode, data, begin, end, lanes, 0, message_limit=self._loaded.limit)
        if result < 0:
            raise run.decode_error(self._loaded.sites[0][-1 - result], lanes, begin, end)
        size = self._encoded(measure, lanes, data, end, None, 0, run.ANY_SIZE)
        if size < 0:
            raise run.encode_error(self._loaded.sites[1][-1 - size], lanes)
        return size

    def _written(self, lanes: Lanes, data: NDArray[np.uint8], end: int, target: NDArray[np.uint8], begin: int, size: int) -> None:
        """Write what was measured."""
        result = self._encoded(self._loaded.kernels[2], lanes, data, end, target, begin, begin + size)
        if result < 0:
            raise run.encode_error(self._loaded.sites[2][-1 - result], lanes)

    def _encoded(
        self, kernel: run.Run, lanes: Lanes, data: NDArray[np.uint8], end: int, target: NDArray[np.uint8] | None, begin: int, stop: int
    ) -> int:
        """Run a kernel on what was decoded. Where it lacks room, lanes are made anew: it is said again which of them the message is."""
        with run.encoding():
            self._refer(lanes, data, end)
            result = kernel(target, begin, stop, lanes, 0)
            while result == GROW:
                run.grow(lanes)
                self._refer(lanes, data, end)
                result = kernel(target, begin, stop, lanes, 0)
        self._refer(lanes, _NOTHING, 0)
        return result

    def _refer(self, lanes: Lanes, data: NDArray[np.uint8], end: int) -> None:
        """Let lanes be the message, as the entry does. Kernels in Python do not read their addresses."""
        for lane in self._loaded.references:
            lanes.words[lane_word(lane, ADDRESS)] = data.ctypes.data
            lanes.words[lane_word(lane, CAPACITY)] = lanes.words[lane_word(lane, USED)] = end
            if self._loaded.library is None:
                lanes.buffers[lane] = data


def _copied(target: NDArray[np.uint8], used: int, room: int) -> NDArray[np.uint8]:
    """The bytes in use, with room for more behind them."""
    with run.encoding():
        made = np.empty(room, np.uint8)
    made[:used] = target[:used]
    return made
