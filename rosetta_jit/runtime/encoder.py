"""Encoders: encoding many messages at once, and all calls that the compiled entry does not serve by itself."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from rosetta_jit.errors import EncodeError, ValuesError
from rosetta_jit.kernel.state import CLEAN, VALID
from rosetta_jit.model.types import same_name
from rosetta_jit.runtime import run
from rosetta_jit.runtime.callable import OTHERS
from rosetta_jit.runtime.holder import Holder
from rosetta_jit.runtime.holder.classes import settle_lanes
from rosetta_jit.runtime.holder.message import Message, place
from rosetta_jit.runtime.lanes import Lanes
from rosetta_jit.runtime.limits import MAX_CLASSES
from rosetta_jit.runtime.program import Loaded, Program, is_foreign, one_by_one
from rosetta_jit.startup.cached import cached_property
from rosetta_jit.startup.late import late

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer as Buffer
    from numpy.typing import NDArray

    from rosetta_jit.runtime import message_spans
    from rosetta_jit.runtime.batches.batch import Batch

    Target = tuple[NDArray[np.uint8], int]
    """A buffer, and where to write in it."""
else:
    (message_spans,) = late("rosetta_jit.runtime", "message_spans")

PARAMETERS = "holder", "buffer", "offset"

_SIZES = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_void_p, ctypes.c_int64, ctypes.c_int64, ctypes.c_void_p)
"""The compiled `sizes` (`backends/entry/encode.ll`): offsets, first, count, state; the first message that was not measured."""


class EncoderBase(Program):
    """Encodes holders of one type as messages of one wire."""

    _arguments = "holder", {"buffer": None, "offset": 0}

    if TYPE_CHECKING:  # the entry does this

        def __call__(self, holder: Any, buffer: Buffer | None = None, offset: int = 0) -> Any:
            """The message as bytes, or, written into a buffer, the offset behind it.

            The holder may also be a part of another holder that has the same type, a dict, as `Holder.from_dict` takes it, or an object
            whose attributes are called as the type's fields: of a framework's own class, a dataclass.

            Raises
            ------
            ValuesError
                An attribute is missing, of no field, or of a value that its field cannot have.
            """
            ...

    def _start(self, loaded: Loaded, beside: EncoderBase | None = None) -> None:
        self._bind(loaded, self._call_slowly, beside)

    if TYPE_CHECKING:  # for people and type checkers it is a method

        def into(self, holder: Any, buffer: Buffer, offset: int = 0) -> int: ...

    else:

        @cached_property
        def into(self):
            """``into(holder, buffer, offset=0)`` writes a message into a buffer; returns the offset behind it.

            It is the same as `builtin`, so that it costs no more than a call of the encoder, and returns the message itself where no buffer
            is given. Where it fails, a part of the message may stand in the buffer.

            Raises
            ------
            EncodeError
                The holder has values that the wire cannot carry.
            BufferError
                The buffer is read-only, or has not enough room.
            """
            return self.builtin

    def size(self, holder: Any) -> int:
        """How many bytes the message takes."""
        if self._is_to_be_taken(holder):
            return self._of_foreign(holder, self.size)
        checked = self._checked(holder)
        with checked.lanes_ as lanes, self._keeping(lanes):
            self._make_usable(checked)
            self._tell(lanes, 0)
            return self._measured(lanes, 0)

    def many(self, batch: Any) -> tuple[NDArray[np.uint8], NDArray[np.int64]]:
        """Encode all messages of a batch.

        Parameters
        ----------
        batch : Batch
            Or a table or frame with Arrow's interface, as `Batch.from_arrow` takes it; or a list of whatever the encoder encodes alone.

        Returns
        -------
        buffer : ndarray of uint8
            The messages, one behind the other.
        offsets : ndarray of int64, shape (n + 1,)
            Message i is bytes ``offsets[i]`` to ``offsets[i + 1]``.

        Raises
        ------
        EncodeError
            A message has values that the wire cannot carry; its path begins with the number of the message, ``[17]``.
        InvalidHolder
            The last decode into the batch failed.
        ValuesError
            A column of the table is of no field, or its values are not those that the field can have.
        """
        if isinstance(batch, list | tuple):
            return self._one_by_one(cast("Sequence[object]", batch))
        lanes = self._lanes_of(self._batch_of(batch))
        with lanes, self._keeping(lanes):
            self._settle(lanes)
            self._tell(lanes, lanes.rows)
            offsets, buffer = np.zeros(lanes.rows + 1, np.int64), np.empty(0, np.uint8)
            stretch = 1 if self._loaded.state.sizes else max(1, lanes.rows)  # one, where the size depends on what those before have left
            for first in range(0, lanes.rows, stretch):
                buffer = self._stretch(lanes, buffer, offsets, first, first + stretch)
        return buffer[: offsets[-1]], offsets

    def _stretch(self, lanes: Lanes, buffer: NDArray[np.uint8], offsets: NDArray[np.int64], first: int, count: int) -> NDArray[np.uint8]:
        """Measure messages from one on, so that there are ``count``, and write them; gives the buffer, with room for them.

        Where one cannot be measured, those before it are written nevertheless if the program keeps state: it is what they leave.
        """
        done, error = self._done(lanes, lambda at: self._sizes(lanes, offsets, at, count), first, count)
        if error is None or self._registers is not None:
            room = _with_room(buffer, int(offsets[first]), int(offsets[done]))
            _, earlier = self._done(lanes, lambda at: self._written(lanes, room, offsets, at, done), first, done)
            if earlier is None and error is None:
                return room
            error = earlier or error
        assert error is not None
        raise error

    def _one_by_one(self, holders: Sequence[object]) -> tuple[NDArray[np.uint8], NDArray[np.int64]]:
        offsets, messages = np.zeros(len(holders) + 1, np.int64), list[bytes]()
        for number, holder in enumerate(holders):
            try:
                messages.append(self(holder))
            except EncodeError as error:
                raise EncodeError(error.kind, f"[{number}]{error.path}", error.detail) from error
            except ValuesError as error:
                raise ValuesError(f"[{number}]{error.path}", error.detail) from error
        np.cumsum([len(each) for each in messages], out=offsets[1:])
        return np.frombuffer(bytearray().join(messages), np.uint8), offsets

    def _batch_of(self, source: Any) -> Batch:
        from rosetta_jit.runtime.batches.batch import Batch

        return source if isinstance(source, Batch) else Batch.from_arrow(self._loaded.holder_type, source)

    def _settle(self, lanes: Lanes) -> None:
        """Bring the messages of a batch, whose lanes are one's own, into the form that kernels read."""
        if not lanes.words[VALID]:
            raise lanes.invalid()
        if lanes.words[VALID] != CLEAN or lanes.source[0] is not None:
            from rosetta_jit.runtime.batches.parts import settled

            lanes.adopt(settled(lanes))

    def _done(self, lanes: Lanes, step: Callable[[int], int], first: int, count: int) -> tuple[int, EncodeError | None]:
        """Go on from where a lane was too small, until so many are done; where one cannot be, its number, and why."""
        done = step(first)
        while done < count:
            result = run.result_of(lanes)
            if result != run.GROW:
                sites = self._loaded.sites if -1 - result < len(self._loaded.sites) else self._loaded.size_sites
                error = run.encode_error(sites[-1 - result], lanes)
                return done, EncodeError(error.kind, f"[{done}]{error.path}", error.detail)
            with run.encoding():
                run.grow(lanes)
            done = step(done)
        return done, None

    def _sizes(self, lanes: Lanes, offsets: NDArray[np.int64], first: int, count: int) -> int:
        if self._loaded.library is not None:
            sizes = _SIZES(self._loaded.library["sizes"])
            return sizes(offsets.ctypes.data, first, count, lanes.address)
        assert self._loaded.size is not None
        for number in range(first, count):
            size = self._loaded.size(None, 0, run.ANY_SIZE, lanes, number)
            if size < 0:
                run.note(lanes, size)
                return number
            offsets[number + 1] = offsets[number] + size
        return count

    def _written(self, lanes: Lanes, buffer: NDArray[np.uint8], offsets: NDArray[np.int64], first: int, count: int) -> int:
        spans = message_spans.MessageSpans.of(offsets)
        if self._compiled_many is not None:
            return self._compiled_many(buffer.ctypes.data, buffer.size, *spans.addresses, first, count, lanes.address)
        return one_by_one(self._loaded.kernel, buffer, spans, first, count, lanes, self._loaded.size)

    def _make_usable(self, holder: Holder) -> None:
        """Bring a valid holder, whose lanes are one's own, into the form that kernels read."""
        if not holder.lanes_.words[VALID]:
            raise holder.lanes_.invalid()
        settle_lanes(holder)

    def _measured(self, lanes: Lanes, row: int) -> int:
        assert self._loaded.size is not None
        with run.encoding():
            size = run.run_growing(self._loaded.size, None, 0, run.ANY_SIZE, lanes, row)
        if size < 0:
            raise run.encode_error(self._loaded.size_sites[-1 - size], lanes)
        return size

    def _call_slowly(self, *arguments: object, **named: object) -> object:
        """Whatever the entry does not do: wrong arguments, holders that must be put in order, a scratch lane that is too small, errors."""
        quick = self._quick.get(type(arguments[0])) if arguments and not named else None
        if quick is not None:
            return quick(*arguments)
        arguments = _in_order(arguments, named)
        if self._is_to_be_taken(arguments[0]):
            return self._call_with_foreign(*arguments)
        holder, target = self._checked(arguments[0]), _target(*arguments[1:])
        if target is not None:
            self._need_rest()
        with holder.lanes_ as lanes, self._numbered(lanes):
            self._make_usable(holder)
            return self._written_row(lanes, 0, target)

    def _is_to_be_taken(self, value: object) -> bool:
        """Whether a value is no holder of this program's, but has the values of one: it is foreign, or of the same type elsewhere."""
        own = self._loaded.holder_type
        if isinstance(value, Message):
            return type(value) is not own and same_name(value.access_.record.struct, own.family_.tree.root.struct)
        return is_foreign(value)

    def _call_with_foreign(self, value: object, *more: object) -> Any:
        """Encode an object of another class; from now on quickly, where objects of its class are handed over at once."""
        if isinstance(value, Message):
            is_row = value.access_ is self._loaded.holder_type.family_.root and value.parent_ is None
            return self._of_row(value, *more) if is_row else self._of_foreign(value, self, *more)
        from rosetta_jit.runtime.whole_objects import encoding, encoding_by_steps

        whole = self._loaded.holder_type.family_.wholes[type(value)]
        steps = self._loaded.holder_type.family_.takers.steps(value) if whole is None else None
        if whole is not None:
            quick = encoding(self.builtin, self.new, whole, is_plain=self._is_plain(whole.writes))
        elif steps is not None:
            quick = encoding_by_steps(self.builtin, self.new, steps, self._of_unusual)
        else:
            return self._of_foreign(value, self, *more)
        if len(self._quick) < MAX_CLASSES:
            self._quick[type(value)] = quick
            self._let_call(type(value), quick)
        return quick(value, *more)

    def _let_call(self, object_type: type, quick: Callable[..., Any]) -> None:
        """From now on, let the entry itself call what encodes objects of a class."""
        if len(self._handed) < MAX_CLASSES:
            from rosetta_jit.runtime.attributes.handing import caller_of

            self._need_rest()
            words = np.array([id(object_type), id(quick), caller_of(quick)], np.int64)
            self._handed.append((words, object_type, quick))  # for good: another thread may be just about to use them
            self._context[1][OTHERS] = words.ctypes.data

    @cached_property
    def _handed(self) -> list[tuple[object, ...]]:
        handed = list[tuple[object, ...]]()
        self._context[0].kept.append(handed)
        return handed

    def _of_unusual(self, value: object, *more: object) -> Any:
        """Encode an object that is not as the others of its class. Where the class has changed, the next one is looked at anew."""
        if self._loaded.holder_type.family_.takers.is_stale(type(value)):
            self._quick.pop(type(value), None)
            self._context[1][OTHERS] = 0
        return self._of_foreign(value, self, *more)

    def _of_row(self, message: Message, *more: object) -> Any:
        """Encode one message of a batch where it lies."""
        if self._asks:  # for the number of the message, which lanes of many messages count from the first of them
            return self._of_foreign(message, self, *more)
        lanes, row, target = message.lanes_, message.index_, _target(*more)
        with lanes:
            place(message)
            if lanes.words[VALID] == CLEAN and lanes.source[0] is None:
                return self._written_row(lanes, row, target)
        from rosetta_jit.runtime.batches.parts import joined

        with joined([(lanes, slice(row, row + 1))]) as alone:
            return self._written_row(alone, 0, target)

    def _of_foreign(self, value: object, use: Callable[..., Any], *more: object) -> Any:
        """The result of ``use`` for a holder with the values of an object of another class, or of a dict."""
        holder = self._borrow()
        try:
            takers = self._loaded.holder_type.family_.takers
            if isinstance(value, Message):
                takers.take_message(holder, value)
            else:
                takers.take(holder, value)
            return use(holder, *more)
        finally:
            self._give_back(holder)

    def _written_row(self, lanes: Lanes, row: int, target: Target | None) -> Any:
        """The bytes of the message in a row; or, written into a buffer, the offset behind it."""
        size = self._measured(lanes, row)
        if target is None:
            with run.encoding():
                written = np.empty(size, np.uint8)
            self._write(lanes, row, written, 0, size)
            return written.tobytes()
        buffer, offset = target
        if not 0 <= offset <= buffer.size - size:
            raise BufferError(f"the message takes {size} bytes, and {max(buffer.size - offset, 0)} are left behind offset {offset}")
        return self._write(lanes, row, buffer, offset, offset + size)

    def _write(self, lanes: Lanes, row: int, target: NDArray[np.uint8], begin: int, end: int) -> int:
        with run.encoding():
            result = run.run_growing(self._loaded.kernel, target, begin, end, lanes, row)
        if result < 0:
            raise run.encode_error(self._loaded.sites[-1 - result], lanes)
        return result


def _in_order(arguments: tuple[object, ...], named: Mapping[str, object]) -> tuple[object, ...]:
    """A holder, or a holder, a buffer and an offset: those that are given by name behind the others."""
    wanted = PARAMETERS[len(arguments) :]
    if len(arguments) > len(PARAMETERS) or not named.keys() <= set(wanted) or not (arguments or "holder" in named):
        raise TypeError("an encoder takes a holder, and perhaps a buffer and an offset")
    if len(arguments) == 1 and not named:
        return arguments
    given: dict[str, object] = {"buffer": None, "offset": 0, **named}
    return (*arguments, *(given[each] for each in wanted))


def _target(buffer: object = None, offset: object = 0) -> Target | None:
    """Where in a buffer to write. Who gives the buffer may run any code when it is asked for: no lanes are in use yet."""
    if buffer is None:
        return None
    found = run.writable(buffer)
    if not isinstance(offset, int):
        raise TypeError(f"an offset is an int, not {type(offset).__name__}")
    if offset < 0:
        raise BufferError(f"offset {offset} lies before the buffer: offsets count from its begin")
    return found, offset


def _with_room(buffer: NDArray[np.uint8], used: int, size: int) -> NDArray[np.uint8]:
    """A buffer with so many bytes, of which those in use are kept."""
    if size <= buffer.size:
        return buffer
    with run.encoding():
        made = np.empty(size if not used else max(size, 2 * buffer.size), np.uint8)
    made[:used] = buffer[:used]
    return made
