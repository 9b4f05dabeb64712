"""Programs: what the user calls. A decoder fills holders, an encoder writes them.

A call goes through the compiled entry and never comes here. The methods below are everything else: what the entry hands over because it is
not the common case, other holders, many messages.
"""

from __future__ import annotations

import ctypes
import time
from typing import TYPE_CHECKING, Any, ClassVar, cast

import numpy as np

from rosetta_jit.dataclass import dataclass
from rosetta_jit.errors import DecodeError, EncodeError
from rosetta_jit.kernel.state import CAPACITY, CLEAN, NOW, NUMBER, USED, VALID, lane_word
from rosetta_jit.runtime import run
from rosetta_jit.runtime.callable import MADE, Context, bind_call, builtin_of
from rosetta_jit.runtime.lanes import roomier

if TYPE_CHECKING:
    from collections.abc import Callable

    from _typeshed import ReadableBuffer as Buffer
    from numpy.typing import NDArray

    from rosetta_jit.runtime.batch import Batch
    from rosetta_jit.runtime.holder import Holder
    from rosetta_jit.runtime.lanes import Lanes
    from rosetta_jit.runtime.native import Library
    from rosetta_jit.runtime.plan import Plan

_MANY = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_void_p, ctypes.c_int64, ctypes.c_void_p, ctypes.c_int64, ctypes.c_int64, ctypes.c_void_p)
_SIZES = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_void_p, ctypes.c_int64, ctypes.c_int64, ctypes.c_void_p)


@dataclass(frozen=True, slots=True)
class Loaded:
    """A program that can run.

    Attributes
    ----------
    kernel, size
        What decodes or encodes, and what measures.
    library
        The compiled code, None where kernels run in Python.
    borrow
        Whether bytes fields of decoded holders are views into the message.
    told
        Whether the kernels ask for the time or the number of a message.
    """

    holder_type: type[Holder]
    sites: tuple[run.Site, ...]
    kernel: run.Run
    size: run.Run | None = None
    size_sites: tuple[run.Site, ...] = ()
    library: Library | None = None
    borrow: bool = False
    told: bool = False


class Program:
    """What decoders and encoders share."""

    _verb: ClassVar[str]
    _loaded: Loaded
    _holder: Holder
    _plan: Plan
    _context: tuple[Context, NDArray[np.int64]]

    def _bind(self, loaded: Loaded, slow: Callable[..., object]) -> None:
        if "_loaded" in vars(self):
            raise TypeError(f"this {type(self).__name__} is made already: its code may be running")
        self._loaded = loaded
        self._holder = loaded.holder_type()
        self._plan = loaded.holder_type.family_.plan
        lanes = self._holder.lanes_
        context = Context(lanes.state, self._holder, slow, lanes.source, loaded.holder_type)
        bind_call(self, None if loaded.library is None else loaded.library["call"], context)

    def _tell(self, lanes: Lanes) -> None:
        """Before messages are made: what their kernels may ask for."""
        if self._loaded.told:
            lanes.words[NOW], lanes.words[NUMBER] = time.time_ns(), int(self._context[1][MADE])

    def _count(self, made: int) -> None:
        """Behind them: the next one has the next number."""
        if self._loaded.told:
            self._context[1][MADE] += made

    @property
    def builtin(self) -> Callable[..., Any]:
        """The program's call as a built-in function, for inner loops: CPython calls those faster than any object."""
        return builtin_of(self, self._verb, "What calling its __self__ does.")

    @property
    def holder_type(self) -> type[Holder]:
        """The class of the holders that this program fills or reads."""
        return self._loaded.holder_type

    def new(self) -> Any:
        """A holder of one's own, with room for what has been decoded until now, unless that is much."""
        holder_type = self._loaded.holder_type
        holder = holder_type.__new__(holder_type)
        holder.lay_out_(self._plan)
        return holder

    def _checked(self, holder: object) -> Holder:
        expected = self._loaded.holder_type
        if not isinstance(holder, expected) or type(holder) is not expected:
            raise TypeError(f"a holder of {expected.__module__}.{expected.__qualname__} is needed, not {type(holder).__name__}")
        return holder


class DecoderBase(Program):
    """Decodes messages of one wire into holders of one type."""

    _verb = "decode"

    if TYPE_CHECKING:  # the entry does this

        def __call__(self, message: Buffer, holder: Any = None) -> Any:
            """Decode into a holder, by default the decoder's own; returns it."""
            ...

    def _start(self, loaded: Loaded) -> None:
        self._bind(loaded, self.call_slowly)

    def into(self, message: Buffer, holder: Any) -> Any:
        """Decode into a holder of one's own; returns it.

        Raises
        ------
        DecodeError
            The message is not what the schema promises; the holder is invalid until it is filled again.
        TypeError, BufferError
            The message has no bytes, or the holder is of another type.
        """
        return self(message, holder)

    def many(self, buffer: Buffer, offsets: NDArray[np.int64], *, into: Batch | None = None) -> Batch:
        """Decode many messages that lie in one buffer, without the interpreter lock.

        Parameters
        ----------
        buffer
            Any bytes-like object.
        offsets : ndarray of int64, shape (n + 1,)
            Message i is bytes ``offsets[i]`` to ``offsets[i + 1]``.
        into
            A batch to fill again, so that no memory is taken; a new one by default.

        Raises
        ------
        DecodeError
            A message is not what the schema promises; its path begins with the number of the message, ``[17]``.
        ValueError
            The offsets are not int64 of one dimension, fall, or leave the buffer.
        """
        data, places = run.readable(buffer), _offsets(offsets)
        count = len(places) - 1
        batch = self._batch(count) if into is None else self._reused(into, count)
        lanes = batch.lanes
        self._tell(lanes)
        self._count(count)
        done = self._many(data, places, 0, batch)
        while done < count:
            result = run.result_of(lanes)
            if result != run.GROW:
                raise self._many_error(result, data, places, done, batch)
            with run.decoding():
                run.limit(lanes, data.size)
                _grow_for_all(batch, done, count)
            done = self._many(data, places, done, batch)
        lanes.words[VALID] = CLEAN
        lanes.source[0] = buffer if self._loaded.borrow else None
        return batch

    def _batch(self, count: int) -> Batch:
        from rosetta_jit.runtime.batch import Batch

        batch = Batch.room(self._loaded.holder_type, max(count, 1))
        return self._reused(batch, count)

    def _reused(self, batch: Batch, count: int) -> Batch:
        if batch.family_ is not self._loaded.holder_type.family_:
            raise TypeError(f"a batch of {self._loaded.holder_type.__qualname__} is needed")
        lanes = batch.lanes
        lanes.words[VALID] = 0
        missing = count - lanes.words[lane_word(0, CAPACITY)]
        if missing > 0:
            lanes.grow(0, missing)
        for lane in range(1, len(lanes.buffers)):
            lanes.words[lane_word(lane, USED)] = 0
        lanes.words[lane_word(0, USED)] = lanes.rows = count
        lanes.moves += 1
        return batch

    def _many(self, data: NDArray[np.uint8], offsets: NDArray[np.int64], first: int, batch: Batch) -> int:
        """Decode from one message on; the first that could not be."""
        lanes, count = batch.lanes, len(offsets) - 1
        if self._loaded.library is not None:
            many = _MANY(self._loaded.library["many"])
            return many(data.ctypes.data, data.size, offsets.ctypes.data, first, count, lanes.address)
        return _one_by_one(self._loaded.kernel, data, offsets, first, batch)

    def _many_error(self, result: int, data: NDArray[np.uint8], offsets: NDArray[np.int64], done: int, batch: Batch) -> Exception:
        begin, end = int(offsets[done]), int(offsets[done + 1])
        if result == 0:
            return ValueError(f"offsets {begin} and {end} of message {done} fall, or leave the buffer of {data.size} bytes")
        error = run.decode_error(self._loaded.sites[-1 - result], batch.lanes, begin, end)
        return DecodeError(error.kind, f"[{done}]{error.path}", error.detail, error.offset)

    def call_slowly(self, *arguments: object, **named: object) -> object:
        """Whatever the entry does not do: wrong arguments, lanes that are too small, errors, holders that borrow."""
        if named or len(arguments) not in (1, 2):
            raise TypeError("a decoder takes a message, and perhaps a holder to fill")
        holder = self._holder if len(arguments) == 1 else self._checked(arguments[1])
        message, lanes = arguments[0], holder.lanes_
        data = run.readable(message)
        lanes.words[VALID] = 0
        self._tell(lanes)
        with run.decoding():
            result = run.run_growing(self._loaded.kernel, data, 0, data.size, lanes, 0)
        if result < 0:
            raise run.decode_error(self._loaded.sites[-1 - result], lanes, 0, data.size)
        self._count(1)
        self._plan = roomier(self._plan, lanes)
        lanes.words[VALID] = CLEAN
        lanes.source[0] = (message if isinstance(message, bytes) else memoryview(cast("Any", message))) if self._loaded.borrow else None
        return holder


class EncoderBase(Program):
    """Encodes holders of one type as messages of one wire."""

    _verb = "encode"

    if TYPE_CHECKING:  # the entry does this

        def __call__(self, holder: Any, buffer: Buffer | None = None, offset: int = 0) -> Any:
            """The message as bytes, or, written into a buffer, the offset behind it."""
            ...

    def _start(self, loaded: Loaded) -> None:
        self._bind(loaded, self.call_slowly)

    def into(self, holder: Any, buffer: Buffer, offset: int = 0) -> int:
        """Write a message into a buffer; returns the offset behind it.

        Raises
        ------
        EncodeError
            The holder has values that the wire cannot carry.
        BufferError
            The buffer is read-only, or has not enough room.
        """
        return self(holder, buffer, offset)

    def size(self, holder: Any) -> int:
        """How many bytes the message takes."""
        usable = self._usable(holder)
        self._tell(usable.lanes_)
        return self._measured(usable)

    def many(self, batch: Batch) -> tuple[NDArray[np.uint8], NDArray[np.int64]]:
        """Encode all messages of a batch.

        Returns
        -------
        buffer : ndarray of uint8
            The messages, one behind the other.
        offsets : ndarray of int64, shape (n + 1,)
            Message i is bytes ``offsets[i]`` to ``offsets[i + 1]``.
        """
        if batch.family_ is not self._loaded.holder_type.family_:
            raise TypeError(f"a batch of {self._loaded.holder_type.__qualname__} is needed")
        count = len(batch)
        self._tell(batch.lanes)
        self._count(count)
        offsets = np.zeros(count + 1, np.int64)
        self._all(batch, lambda first: self._sizes(batch, offsets, first))
        with run.encoding():
            buffer = np.empty(int(offsets[-1]), np.uint8)
        self._all(batch, lambda first: self._written(batch, buffer, offsets, first))
        return buffer, offsets

    def _all(self, batch: Batch, step: Callable[[int], int]) -> None:
        """Go on from where a lane was too small, until all are done."""
        done = step(0)
        while done < len(batch):
            result = run.result_of(batch.lanes)
            if result != run.GROW:
                sites = self._loaded.sites if -1 - result < len(self._loaded.sites) else self._loaded.size_sites
                error = run.encode_error(sites[-1 - result], batch.lanes)
                raise EncodeError(error.kind, f"[{done}]{error.path}", error.detail)
            with run.encoding():
                run.grow(batch.lanes)
            done = step(done)

    def _sizes(self, batch: Batch, offsets: NDArray[np.int64], first: int) -> int:
        if self._loaded.library is not None:
            sizes = _SIZES(self._loaded.library["sizes"])
            return sizes(offsets.ctypes.data, first, len(batch), batch.lanes.address)
        assert self._loaded.size is not None
        for number in range(first, len(batch)):
            size = self._loaded.size(None, 0, run.ANY_SIZE, batch.lanes, number)
            if size < 0:
                run.note(batch.lanes, size)
                return number
            offsets[number + 1] = offsets[number] + size
        return len(batch)

    def _written(self, batch: Batch, buffer: NDArray[np.uint8], offsets: NDArray[np.int64], first: int) -> int:
        lanes = batch.lanes
        if self._loaded.library is not None:
            many = _MANY(self._loaded.library["many"])
            return many(buffer.ctypes.data, buffer.size, offsets.ctypes.data, first, len(batch), lanes.address)
        return _one_by_one(self._loaded.kernel, buffer, offsets, first, batch, self._loaded.size)

    def _usable(self, holder: object) -> Holder:
        """The holder, of our type, valid, and in the form that kernels read."""
        checked = self._checked(holder)
        if not checked.lanes_.words[VALID]:
            raise checked.lanes_.invalid()
        checked.materialise()
        return checked

    def _measured(self, holder: Holder) -> int:
        assert self._loaded.size is not None
        with run.encoding():
            size = run.run_growing(self._loaded.size, None, 0, run.ANY_SIZE, holder.lanes_, 0)
        if size < 0:
            raise run.encode_error(self._loaded.size_sites[-1 - size], holder.lanes_)
        return size

    def call_slowly(self, *arguments: object, **named: object) -> object:
        """Whatever the entry does not do: wrong arguments, holders that must be put in order, a scratch lane that is too small, errors."""
        if len(arguments) == 2:
            arguments = (*arguments, 0)
        if named or len(arguments) not in (1, 3):
            raise TypeError("an encoder takes a holder, and perhaps a buffer and an offset")
        holder = self._usable(arguments[0])
        self._tell(holder.lanes_)
        size = self._measured(holder)
        if len(arguments) == 1:
            with run.encoding():
                written = np.empty(size, np.uint8)
            self._write(holder, written, 0, size)
            return written.tobytes()
        target, offset = run.writable(arguments[1]), arguments[2]
        if not isinstance(offset, int):
            raise TypeError(f"an offset is an int, not {type(offset).__name__}")
        if not 0 <= offset <= target.size - size:
            raise BufferError(f"the message takes {size} bytes, and {max(target.size - offset, 0)} are left behind offset {offset}")
        return self._write(holder, target, offset, offset + size)

    def _write(self, holder: Holder, target: NDArray[np.uint8], begin: int, end: int) -> int:
        with run.encoding():
            result = run.run_growing(self._loaded.kernel, target, begin, end, holder.lanes_, 0)
        if result < 0:
            raise run.encode_error(self._loaded.sites[-1 - result], holder.lanes_)
        self._count(1)
        return result


def _one_by_one(
    kernel: run.Run, data: NDArray[np.uint8], offsets: NDArray[np.int64], first: int, batch: Batch, size: run.Run | None = None
) -> int:
    """What the compiled `many` does, in Python."""
    for number in range(first, len(offsets) - 1):
        begin, end = int(offsets[number]), int(offsets[number + 1])
        result = 0 if 0 <= begin <= end <= data.size else None
        if result is not None and size is not None:
            result = min(size(None, 0, run.ANY_SIZE, batch.lanes, number), 0)
        if result == 0:
            result = kernel(data, begin, end, batch.lanes, number)
        if result is None or result < 0:
            run.note(batch.lanes, result or 0)
            return number
    return len(offsets) - 1


def _grow_for_all(batch: Batch, done: int, count: int) -> None:
    """Guess from the messages so far what all will take, so that a lane does not move often."""
    lanes = batch.lanes
    lane, rows = run.missing(lanes)
    if lane >= len(lanes.buffers):
        lanes.grow(lane, rows)
        return
    used = lanes.words[lane_word(lane, USED)]
    lanes.grow(lane, max(rows, (used * count) // (done + 1) + rows - lanes.words[lane_word(lane, CAPACITY)]))


def _offsets(offsets: NDArray[np.int64]) -> NDArray[np.int64]:
    places = np.ascontiguousarray(offsets)
    if places.dtype != np.int64 or places.ndim != 1 or not places.size:
        raise ValueError("offsets are an int64 array of one dimension, one longer than there are messages")
    return places
