"""Programs: what the user calls. A decoder (`runtime.decoder`) fills holders, an encoder (`runtime.encoder`) writes them.

A call goes through the compiled entry and never comes here. The methods of programs are everything else: what the entry hands over because
it is not the common case, other holders, many messages.
"""

from __future__ import annotations

import ctypes
import time
from collections.abc import Callable, Generator, Mapping
from contextlib import AbstractContextManager, contextmanager, nullcontext
from typing import TYPE_CHECKING, Any, ClassVar

from rosetta_jit.kernel.state import NOW, NUMBER
from rosetta_jit.runtime import run
from rosetta_jit.runtime.attributes.code import library
from rosetta_jit.runtime.attributes.makers import give_room, maker
from rosetta_jit.runtime.callable import MADE, Context, bind_call, builtin_of
from rosetta_jit.runtime.code.native import Library
from rosetta_jit.runtime.holder import Holder
from rosetta_jit.runtime.holder.message import Message
from rosetta_jit.runtime.lanes import Lanes
from rosetta_jit.runtime.limits import MAX_SPARES
from rosetta_jit.runtime.memory_plan import Plan
from rosetta_jit.runtime.registers import NOTHING_KEPT, Kept, Registers, address_of
from rosetta_jit.runtime.shared import Shared
from rosetta_jit.startup.cached import cached_property
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from rosetta_jit.runtime.batches.batch import Batch
    from rosetta_jit.runtime.message_spans import MessageSpans
    from rosetta_jit.runtime.on_demand import OnDemand

_NOTHING_LENT = nullcontext[None]()

MANY = ctypes.CFUNCTYPE(
    *(ctypes.c_int64, ctypes.c_void_p, ctypes.c_int64, ctypes.c_void_p, ctypes.c_void_p),
    *(ctypes.c_int64, ctypes.c_int64, ctypes.c_void_p),
)
"""The compiled `many` (`backends/entry/many.ll`): buffer, its size, begins, ends, first, count, state.
It gives the first message that was not done."""


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
    asks_host
        Whether the kernels ask for the time or the number of a message.
    limit
        How many bytes of a lane a message may ask for, whatever its own size.
    state
        What it keeps from one message to the next.
    wires
        The names of the mapping's wires, where it has several.
    wire
        Of a decoder, the number of the one among them whose messages it reads; None where messages fill the whole holder.
    on_demand
        The program for messages that hardly ever come; None where this one handles all.
    """

    holder_type: type[Holder]
    sites: run.Sites
    kernel: run.Run
    size: run.Run | None = None
    size_sites: run.Sites = run.NO_SITES
    library: Library | None = None
    borrow: bool = False
    asks_host: bool = False
    limit: int = 0
    state: Kept = NOTHING_KEPT
    wires: tuple[str, ...] = ()
    wire: int | None = None
    on_demand: OnDemand | None = None

    def site(self, result: int) -> run.Site:
        """Where a message has failed, by what the kernel gave: behind its own sites are those of the program that is made on demand."""
        number = -1 - result
        if number < len(self.sites):
            return self.sites[number]
        later_sites = None if self.on_demand is None else self.on_demand.place.sites
        assert later_sites is not None, "it has run"
        return later_sites[number - len(self.sites)]


def entry_of(library: Library | None, state: Kept) -> int | None:
    """The compiled call of a program; None where all calls take the slow path.

    That is so without code, and where other threads may run while a kernel calls functions of the host: state must not change meanwhile.
    """
    return None if library is None or state.is_shared else library["call"]


INTERNAL = frozenset({"__annotations__", "__signature__", "__vectorcalloffset__", "__weakref__", "announced"})
"""What programs need for themselves and each other, besides attributes that begin or end with an underscore."""


class CallSignature:
    """``__signature__`` of programs: that of their compiled call. Their classes have that of ``__init__``."""

    def __get__(self, program: ProgramBase | None, owner: Any) -> Any:
        if program is None:
            return None
        from inspect import Parameter, Signature

        required, optional = owner._arguments  # noqa: SLF001 - the class is ours
        first = Parameter(required, Parameter.POSITIONAL_ONLY)
        return Signature([first, *(Parameter(name, Parameter.POSITIONAL_ONLY, default=each) for name, each in optional.items())])


class ProgramBase:
    """What decoders, encoders and bridges share: their kernels may ask for the time, or the number of a message, and keep state.

    ``_arguments`` are what a call takes: one argument, and others with their defaults. What compiled code has addresses of is in a slot:
    it lives as long as the program, whoever changes its ``__dict__``.
    """

    __slots__ = ("__dict__", "__weakref__", "_context")

    _arguments: ClassVar[tuple[str, dict[str, object]]]

    _context: tuple[Context, NDArray[np.int64]]
    _asks: bool
    _registers: Registers | None

    def _tell(self, lanes: Lanes, count: int) -> None:
        """Before so many messages are made: what their kernels may ask for. No others get their numbers."""
        if self._asks:
            words = self._context[1]
            number = words[MADE]  # this line and the next are one step: CPython lets other threads run at calls and loops
            words[MADE] = number + count
            lanes.words[NOW], lanes.words[NUMBER] = time.time_ns(), int(number)

    @contextmanager
    def _numbered(self, lanes: Lanes) -> Generator[None]:
        """Around one message. Where it cannot be made, the next one gets its number, unless another thread has taken one since."""
        with self._keeping(lanes), self._as_before():
            self._tell(lanes, 1)
            try:
                yield
            except BaseException:
                self._untell(lanes)
                raise

    def _keeping(self, lanes: Lanes) -> AbstractContextManager[None]:
        """Around kernels that run on some lanes: what the program keeps from message to message is theirs alone. InUse where it is not."""
        return _NOTHING_LENT if self._registers is None else self._registers.lent(lanes)

    def _as_before(self) -> AbstractContextManager[None]:
        """Around one message: where it fails, the program keeps what it kept before."""
        return _NOTHING_LENT if self._registers is None else self._registers.as_before()

    def _refuse_state(self) -> None:
        """Where users' own compiled code would run the kernel: nothing tells there which call has the state."""
        if self._registers is not None:
            raise ValueError("a mapping that keeps state from message to message cannot be called from one's own compiled code: use `many`")

    def reset(self) -> None:
        """Let the next message be the first one: state is what the mapping says that it is at first, and `counter()` is 0.

        Raises
        ------
        InUse
            Another thread's call of the program, which keeps state, has not returned.
        """
        if self._registers is not None:
            self._registers.reset()
        self._context[1][MADE] = 0

    def _untell(self, lanes: Lanes) -> None:
        """Behind a message that could not be made."""
        words, number = self._context[1], lanes.words[NUMBER]
        if self._asks and words[MADE] == number + 1:
            words[MADE] = number

    if not TYPE_CHECKING:  # a descriptor, which inspect asks for
        __signature__ = CallSignature()

    def __dir__(self) -> list[str]:
        return [name for name in super().__dir__() if name not in INTERNAL and (name.startswith("__") or "_" not in (name[0], name[-1]))]

    @cached_property
    def builtin(self) -> Callable[..., Any]:
        """The program's call as a built-in function, for inner loops: CPython calls those faster than any object."""
        return builtin_of(self, "builtin", "What calling its __self__ does.")


class Program(ProgramBase):
    """What decoders and encoders share."""

    _loaded: Loaded
    _shared: Shared
    _plan: Plan

    def _bind(self, loaded: Loaded, slow: Callable[..., object], beside: Program | None = None) -> None:
        """Become a loaded program; ``beside`` is one for another wire, with which it shares its own holder, and its state."""
        if "_loaded" in vars(self):
            raise TypeError(f"this {type(self).__name__} is made already: its code may be running")
        self._loaded, self._asks = loaded, loaded.asks_host
        self._shared = Shared(loaded.holder_type, loaded.state.registers()) if beside is None else shared_of(beside)
        self._registers = self._shared.registers
        self._plan = loaded.holder_type.family_.plan
        if library() is not None:
            vars(self)["new"] = maker(loaded.holder_type, self._plan)
        context = Context(slow, loaded.holder_type, address_of(self._registers), [loaded, self._registers])
        bind_call(self, entry_of(loaded.library, loaded.state), context)

    @property
    def _wires(self) -> tuple[str, ...]:
        """The names of the mapping's wires, where it has several."""
        return self._loaded.wires

    @property
    def state(self) -> Mapping[str, bool | int | float]:
        """What each state variable of the mapping is for the next message, by its name.

        Raises
        ------
        InUse
            Another thread's call of the program has not returned.
        """
        if self._registers is None:
            return {}
        return {name: value for name, value in self._registers.shown().items() if name.isidentifier()}

    @property
    def holder_type(self) -> type[Holder]:
        """The class of the holders that this program fills or reads."""
        return self._loaded.holder_type

    def new(self) -> Any:  # where there is compiled code, that does it, as an attribute of each program
        """A holder of one's own, with room for what has been decoded until now, unless that is much."""
        own, family = self._plan, self._loaded.holder_type.family_
        return family.making.new(own if own.size_bytes > family.roomy.size_bytes else family.roomy)

    def _need(self, plan: Plan) -> None:
        """From now on, give new holders the room of a plan."""
        if plan is not self._plan:
            self._plan = plan
            if library() is not None:
                give_room(vars(self)["new"], plan)

    def _borrow(self) -> Any:
        """An empty holder that nobody else has, until it comes back by `_give_back`."""
        try:
            return self._spares.pop()
        except IndexError:
            return self.new()

    def _give_back(self, holder: Any) -> None:
        holder.lanes_.restart()
        if len(self._spares) < MAX_SPARES:
            self._spares.append(holder)

    @cached_property
    def _spares(self) -> list[Any]:
        return []

    @cached_property
    def _quick(self) -> dict[type, Callable[..., Any]]:
        """What does, for objects of some classes, all that the program does with them (`rosetta_jit.runtime.whole_objects`)."""
        return {}

    @cached_property
    def _compiled_many(self) -> Callable[..., int] | None:
        """The compiled `many`, which takes addresses; None where there is no code."""
        return None if self._loaded.library is None else MANY(self._loaded.library["many"])

    def _need_rest(self) -> None:
        """Have the rest of the program's calls compiled, if they are not, for calls that will come again."""
        library = self._loaded.library
        if library is not None and library.later is not None:
            library.later()

    def _is_plain(self, encodings: frozenset[str | None]) -> bool:  # noqa: ARG002  whatever they are
        """Whether its bytes are those of its holders in one of some encodings, with nothing mapped. Who makes programs knows that."""
        return False

    def _checked(self, holder: object) -> Holder:
        expected = self._loaded.holder_type
        if not isinstance(holder, expected) or type(holder) is not expected:
            what = f"a holder of {expected.__module__}.{expected.__qualname__} is needed, not {type(holder).__name__}"
            raise TypeError(f"{what}: many messages are encoded by `many`" if hasattr(holder, "__arrow_c_stream__") else what)
        if not hasattr(holder, "lanes_"):
            raise TypeError(f"a holder of {expected.__qualname__} that was never made: its __init__ has not run")
        return holder

    def _lanes_of(self, batch: Batch) -> Lanes:
        """The lanes of a batch of this program's holders."""
        expected = self._loaded.holder_type
        lanes: Lanes | None = getattr(batch, "lanes", None)
        if lanes is None or getattr(batch, "_family", None) is not expected.family_ or lanes.plan.layout is not expected.family_.layout:
            raise TypeError(f"a batch of {expected.__qualname__} is needed")
        return lanes


def is_foreign(value: object) -> bool:
    """Whether a value may be a message that is no holder: an object of another class, or a dict."""
    if isinstance(value, Message):
        return False
    from rosetta_jit.runtime.holder.objects.shapes import is_message_like

    return is_message_like(value)


def one_by_one(
    kernel: run.Run, data: NDArray[np.uint8], spans: MessageSpans, first: int, count: int, lanes: Lanes, size: run.Run | None = None
) -> int:
    """Do in Python what the compiled `many` does."""
    for number in range(first, count):
        begin, end = spans.span(number)
        result = 0 if spans.are_in(number, data.size) else None
        if result is not None and size is not None:
            result = min(size(None, 0, run.ANY_SIZE, lanes, number), 0)
        if result == 0:
            result = kernel(data, begin, end, lanes, number)
        if result is None or result < 0:
            run.note(lanes, result or 0)
            return number
    return count


def wires_of(program: Program) -> tuple[str, ...]:
    """The names of the wires of a program's mapping, where it has several."""
    return program._wires  # noqa: SLF001 # pyright: ignore[reportPrivateUsage]


def shared_of(program: Program) -> Shared:
    """What a program has together with those for other wires of its mapping."""
    return program._shared  # noqa: SLF001 # pyright: ignore[reportPrivateUsage]


def make_rest(program: Program) -> None:
    """Have the rest of a program's calls compiled now."""
    program._need_rest()  # noqa: SLF001 # pyright: ignore[reportPrivateUsage]
