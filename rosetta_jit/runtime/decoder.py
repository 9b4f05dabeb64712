"""Decoders: decoding many messages at once, and all calls that the compiled entry does not serve by itself."""

from __future__ import annotations

import struct
from _thread import get_ident
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import TYPE_CHECKING, Any, TypeVar, overload

from rosetta_jit.kernel.state import CLEAN, NUMBER, RESULT, UNUSUAL, VALID
from rosetta_jit.runtime import run
from rosetta_jit.runtime.attributes.code import functions, library
from rosetta_jit.runtime.attributes.methods import turning
from rosetta_jit.runtime.callable import FAILED, THREAD, give_own
from rosetta_jit.runtime.holder import Holder
from rosetta_jit.runtime.lanes import Lanes
from rosetta_jit.runtime.limits import MAX_CLASSES
from rosetta_jit.runtime.memory import LARGE
from rosetta_jit.runtime.program import Loaded, Program, is_foreign
from rosetta_jit.runtime.row_counts import roomier
from rosetta_jit.startup.cached import cached_property
from rosetta_jit.startup.late import late

if TYPE_CHECKING:
    import numpy as np
    from _typeshed import ReadableBuffer as Buffer
    from numpy.typing import NDArray

    from rosetta_jit.runtime import message_spans
    from rosetta_jit.runtime.batches import filling as batches
    from rosetta_jit.runtime.batches.batch import Batch
    from rosetta_jit.runtime.batches.filling import Filling, OnError
    from rosetta_jit.runtime.holder.objects.giving import Givers
    from rosetta_jit.runtime.message_spans import MessageSpans
    from rosetta_jit.runtime.on_demand import OnDemand
else:
    (batches,) = late("rosetta_jit.runtime.batches", "filling")
    (message_spans,) = late("rosetta_jit.runtime", "message_spans")

_Object = TypeVar("_Object")


class DecoderBase(Program):
    """Decodes messages of one wire into holders of one type.

    The decoder's own holder is made for the thread that decodes first, and belongs to it. Each other thread has another one, as long as it
    lives.
    """

    _arguments = "message", {"holder": None}

    if TYPE_CHECKING:  # the entry does this

        def __call__(self, message: Buffer, holder: Any = None, /) -> Any:
            """Decode into a holder, by default the decoder's own; returns it."""
            ...

    def _start(self, loaded: Loaded, beside: DecoderBase | None = None) -> None:
        self._bind(loaded, self._call_slowly, beside)

    if TYPE_CHECKING:  # for people and type checkers it is a method

        def into(self, message: Buffer, holder: Any, /) -> Any: ...

    else:

        @cached_property
        def into(self):
            """``into(message, holder)`` decodes into a holder of one's own, or into an object of another class by its attributes.

            It returns what it filled, and is the same as `builtin`: it costs no more than a call of the decoder.

            Raises
            ------
            DecodeError
                The message is not what the schema promises; a holder is invalid until it is filled again, an object is as it was.
            ValuesError
                The object lacks an attribute, or no class is known for a message in it (see `to`). It has some of the values then.
            TypeError, BufferError
                The message has no bytes, or the holder is of another type.
            """
            return self.builtin

    if TYPE_CHECKING:  # for people and type checkers it is a method

        def to(self, message: Buffer, object_type: type[_Object], *, types: Mapping[str, type] | None = None) -> _Object: ...

    else:

        @cached_property
        def to(self):
            """``to(message, object_type, types=None)`` decodes into a new object of a class: a dataclass, or a framework's own.

            Parameters
            ----------
            types
                The classes of messages within it by the names of their types, where ``object_type`` does not tell them. A table for many
                types will do, such as the ``types`` of a typestore of rosbags.

            Raises
            ------
            DecodeError
                The message is not what the schema promises.
            ValuesError
                The class lacks an attribute, or no class is known for a message within it.
            """
            return self._to if library() is None else turning(self._to, type(self), lambda: vars(self).get("_turned"))

    def _to(self, message: Buffer, object_type: type[_Object], *, types: Mapping[str, type] | None = None) -> _Object:
        """Decode into a new object of a class."""
        quick = self._quick.get(object_type) if types is None else None
        if quick is not None:
            self._turned = object_type, quick
            return quick(message)
        self._refuse_part("to a new object")
        family = self._loaded.holder_type.family_
        if types is None and not self._loaded.borrow and len(self._quick) < MAX_CLASSES:
            from rosetta_jit.runtime.whole_objects import decoding, decoding_whole

            whole = family.wholes[object_type]
            if whole is None:
                self._quick[object_type] = decoding(self.builtin, self.new, family.givers.maker(object_type))
            else:
                self._quick[object_type] = decoding_whole(self.builtin, self.new, whole, is_plain=self._is_plain(whole.reads))
        givers = family.givers if types is None else self._givers_of(types)
        holder = self._borrow()
        try:
            return givers.make(object_type, self(message, holder))
        finally:
            self._give_back(holder)

    _to.__name__ = "to"

    def _givers_of(self, types: Mapping[str, type]) -> Givers:
        """A maker of objects for a table of classes; that of the last table is kept."""
        kept: tuple[Mapping[str, type], Givers] | None = vars(self).get("_kept_givers")
        if kept is None or kept[0] is not types:
            from rosetta_jit.runtime.holder.objects.giving import Givers

            kept = vars(self)["_kept_givers"] = types, Givers(self._loaded.holder_type.family_, types)
        return kept[1]

    @overload
    def many(self, messages: Buffer, offsets: NDArray[np.int64], *, into: Batch | None = None, on_error: OnError = "raise") -> Batch: ...
    @overload
    def many(self, messages: Iterable[Buffer], *, into: Batch | None = None, on_error: OnError = "raise") -> Batch: ...
    def many(
        self,
        messages: Buffer | Iterable[Buffer],
        offsets: NDArray[np.int64] | None = None,
        *,
        into: Batch | None = None,
        on_error: OnError = "raise",
    ) -> Batch:
        """Decode many messages, without the interpreter lock.

        Parameters
        ----------
        messages
            A bytes-like object in which they lie, with ``offsets``; or one such object for each, which costs a copy.
        offsets : ndarray of int64, shape (n + 1,) or (2, n)
            Message i is bytes ``offsets[i]`` to ``offsets[i + 1]``; of two rows, bytes ``offsets[0, i]`` to ``offsets[1, i]``.
        into
            A batch to fill again, so that no memory is taken; a new one by default.
        on_error
            What becomes of a message that is not what the schema promises: the whole call raises its error, or the batch has no such
            row (``"skip"``), or an empty message there (``"mask"``). `Batch.errors` has the errors then.

        Raises
        ------
        DecodeError
            A message is not what the schema promises; its path begins with the number of the message, ``[17]``.
        ValueError
            The offsets are not int64, have another shape, fall, or leave the buffer.
        InUse
            Another thread is filling, changing or encoding the batch.
        """
        if offsets is None:
            messages, offsets = message_spans.together(messages)
        batch = self._batch(len(message_spans.laid_out(messages, offsets)[1])) if into is None else into
        lanes = self._lanes_to_fill(batch, on_error)
        before = lanes.source[0]
        with lanes, self._keeping(lanes):
            done = self._filled(batch, lanes, messages, offsets)
            if done is not None:
                self._go_on(batch, lanes, messages, offsets, on_error, done)
        del before  # outside: what ends with it may run any code
        return batch

    def _filled(self, batch: Batch, lanes: Lanes, messages: Any, offsets: Any) -> int | None:
        """Inside ``with lanes:``, decode all messages in one compiled step. None where that was done; else how many messages were."""
        fill_rows = self._fill_rows
        if fill_rows is None or not batches.can_be_at_once(batch):
            return 0
        lanes.is_filled = False
        count = fill_rows(messages, offsets, lanes.address)
        if count < 0:
            return -1 - count
        batches.end_at_once(batch, count)
        return None

    @cached_property
    def _fill_rows(self) -> Callable[[Any, Any, int], int] | None:
        """The compiled step of `many`; None where it would leave something out, or there is no code."""
        loaded = self._loaded
        if library() is None or loaded.library is None or loaded.borrow or loaded.asks_host:
            return None
        return partial(functions()["fill_rows"], struct.pack("=2q", loaded.library["many"], len(loaded.holder_type.family_.plan.strides)))

    def _go_on(self, batch: Batch, lanes: Lanes, messages: Any, offsets: Any, on_error: OnError, done: int) -> None:
        """Inside ``with lanes:``, decode messages step by step, behind so many that are."""
        source, spans = message_spans.laid_out(messages, offsets)
        data, count = run.readable(source), len(spans)
        filling = batches.Filling(self._loaded, batch, on_error, count, self._compiled_many, self._made_for)
        if done:
            filling.resume(done)
        else:
            filling.begin()
            self._tell(lanes, count)
        filling.add(data, spans, count)
        lanes.source[0] = source if self._loaded.borrow else None
        filling.end()

    @property
    def _borrows(self) -> bool:
        """Whether bytes fields show the messages that they came in."""
        return self._loaded.borrow

    def _filling(self, count: int, into: Batch | None = None, on_error: OnError = "raise") -> Filling:
        """What decodes many messages step by step, about so many: into a batch, or into a new one.

        Raises
        ------
        ValueError
            There is no such way to treat errors.
        TypeError
            The batch is of another type.
        """
        batch = self._batch(count) if into is None else into
        self._lanes_to_fill(batch, on_error)
        return batches.Filling(self._loaded, batch, on_error, count, self._compiled_many, self._made_for)

    def _lanes_to_fill(self, batch: Batch, on_error: OnError) -> Lanes:
        """The lanes of a batch that many messages fill. Raises as `_filling`."""
        if self._loaded.wire is not None:
            self._refuse_part("with many others")
        if on_error not in ("raise", "skip", "mask"):
            raise ValueError(f'on_error is "raise", "skip" or "mask", not {on_error!r}')
        return self._lanes_of(batch)

    def _fill(self, filling: Filling, data: NDArray[np.uint8], spans: MessageSpans, count: int) -> None:
        """One step, inside ``with lanes:``. Message ``i`` of all steps lies at place ``i``; there are ``count`` behind this step."""
        lanes, first = filling.batch.lanes, filling.count
        with self._keeping(lanes):
            if not first:
                filling.begin()
            self._tell(lanes, count - first)
            if first and self._asks:
                lanes.words[NUMBER] -= first  # kernels add the row
            filling.add(data, spans, count)

    def _batch(self, count: int) -> Batch:
        from rosetta_jit.runtime.batches.batch import Batch

        holder_type = self._loaded.holder_type
        is_large = count * holder_type.family_.layout.lanes[0].stride >= LARGE
        return Batch.room(holder_type, 1 if is_large or count < 1 else count)  # rows that are many get memory of their own

    def _call_slowly(self, *arguments: object, **named: object) -> object:
        """Whatever the entry does not do: wrong arguments, lanes that are too small, errors, holders that borrow."""
        if named or len(arguments) not in (1, 2):
            raise TypeError("a decoder takes a message, and perhaps a holder to fill")
        message: Any = arguments[0]
        if len(arguments) == 2 and is_foreign(arguments[1]):
            return self._into_foreign(message, arguments[1])
        if len(arguments) == 2 or type(message) is not bytes:
            self._need_rest()
        if len(arguments) == 1 and self._context[1][THREAD] != get_ident():
            return self(message) if self._becomes_mine() else self(message, self._shared.of_this_thread(self.new))
        holder = self._shared.holder if len(arguments) == 1 else self._checked(arguments[1])
        source, before = message_spans.source_of(message), holder.lanes_.source[0]
        data, is_left_to_next = run.readable(source), holder.lanes_.words[RESULT] == UNUSUAL
        if self._loaded.wire is not None:
            self._join(data, holder, self._loaded.wire)
        else:
            with holder.lanes_ as lanes, self._numbered(lanes):
                lanes.begin_filling()
                self._decode(data, lanes)
                lanes.source[0] = source if self._loaded.borrow else None
                lanes.words[VALID] = CLEAN
        if is_left_to_next:
            self._need_rest()
        del before  # outside: what ends with it may run any code
        return holder

    def _decode(self, data: NDArray[np.uint8], lanes: Lanes) -> None:
        """One message into the first row of lanes."""
        with run.decoding():
            result = run.run_growing(self._loaded.kernel, data, 0, data.size, lanes, 0, message_limit=self._loaded.limit)
            if result < 0 and self._made_for(result, data, 0, data.size):
                result = run.run_growing(self._loaded.kernel, data, 0, data.size, lanes, 0, message_limit=self._loaded.limit)
        if result < 0:
            raise run.decode_error(self._loaded.site(result), lanes, 0, data.size)
        self._need(roomier(self._plan, lanes))

    def _made_for(self, result: int, data: NDArray[np.uint8], begin: int, end: int) -> bool:
        """Whether a message that failed is left to a program that was not there then, and now is: made here, or by another thread."""
        on_demand = self._loaded.on_demand
        is_ours = -1 - result < len(self._loaded.sites)  # else the other program has seen the message
        if on_demand is None or not is_ours or not on_demand.is_for_other(data, begin, end):
            return False
        self._complete()
        return True

    def _complete(self) -> None:
        """Make the program now that is made on demand, if there is one."""
        on_demand = self._loaded.on_demand
        if on_demand is not None and on_demand.place.sites is None:
            other = self._other(on_demand)
            assert other.library is not None, "it is compiled, as this one is"
            on_demand.place.take(other.library, other.sites)

    def _other(self, on_demand: OnDemand) -> Loaded:
        """The program that some messages are left to. Who makes programs makes it."""
        raise NotImplementedError

    def _join(self, data: NDArray[np.uint8], holder: Holder, wire: int) -> None:
        """One message into its part of a holder."""
        from rosetta_jit.runtime.joining import broken_wires, joining

        words = self._context[1]
        has_failed, words[FAILED] = bool(words[FAILED]), 0
        broken = broken_wires(self._shared.broken, holder)
        with holder.lanes_ as lanes, self._numbered(lanes), joining(holder, wire, broken, has_failed=has_failed):
            self._decode(data, lanes)

    def _into_foreign(self, message: Any, value: object) -> object:
        """Decode into an object of another class."""
        self._refuse_part("into an object of another class")
        holder = self._borrow()
        try:
            self._loaded.holder_type.family_.givers.fill(value, self(message, holder))
        finally:
            self._give_back(holder)
        return value

    def _refuse_part(self, how: str) -> None:
        """Refuse a decoder of one of several wires, whose messages do not fill a whole holder."""
        if self._loaded.wire is not None:
            from rosetta_jit.runtime.joining import NOT_WHOLE

            raise ValueError(NOT_WHOLE.format(how))

    def _becomes_mine(self) -> bool:
        """Let the decoder's own holder belong to this thread, if it belongs to no other."""
        thread = get_ident()
        if not self._shared.is_of(thread):
            return False
        holder = self._shared.holder
        give_own(self, holder, holder.lanes_.state, holder.lanes_.source)
        self._context[1][THREAD] = thread
        return True


# --- what other modules need of a decoder, and users do not -------------------------------------------------------------


def filling_of(decoder: DecoderBase, count: int, into: Batch | None, on_error: OnError) -> Filling:
    """What decodes many messages step by step, about so many: into a batch, or into a new one. Raises as `DecoderBase.many`."""
    return decoder._filling(count, into, on_error)  # noqa: SLF001 # pyright: ignore[reportPrivateUsage]


def fill(decoder: DecoderBase, filling: Filling, data: NDArray[np.uint8], spans: MessageSpans, count: int) -> None:
    """One step, inside ``with lanes:``. Message ``i`` of all steps lies at place ``i``; there are ``count`` behind this step."""
    decoder._fill(filling, data, spans, count)  # noqa: SLF001 # pyright: ignore[reportPrivateUsage]


def borrows(decoder: DecoderBase) -> bool:
    """Whether bytes fields show the messages that they came in."""
    return decoder._borrows  # noqa: SLF001 # pyright: ignore[reportPrivateUsage]


def complete(decoder: DecoderBase) -> None:
    """Make the program now that is made on demand, if there is one."""
    decoder._complete()  # noqa: SLF001 # pyright: ignore[reportPrivateUsage]
