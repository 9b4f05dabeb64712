"""Running kernels from Python: buffers, growth, and results turned into errors.

This is the slow path of calls that go through the entry, and the only path of kernels that were not compiled.
"""

from __future__ import annotations

import ctypes
import marshal
from collections.abc import Callable, Generator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from rosetta_jit.errors import DecodeError, EncodeError, Kind
from rosetta_jit.kernel.state import ERROR_INDICES, ERROR_OFFSET, GROW, GROW_LANE, GROW_ROWS, RESULT
from rosetta_jit.runtime.memory import has_references, no_message
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rosetta_jit.runtime.lanes import Lanes

ANY_SIZE = 1 << 60
"""The room that a kernel has that only measures."""

Run = Callable[["NDArray[np.uint8] | None", int, int, "Lanes", int], int]
"""A kernel: buffer, begin, end, lanes of the holder, row; a position, or a failure."""

_KERNEL = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_void_p, ctypes.c_int64, ctypes.c_int64, ctypes.c_void_p, ctypes.c_int64)


def native_run(address: int) -> Run:
    """A compiled kernel."""
    kernel = _KERNEL(address)

    def run(buffer: NDArray[np.uint8] | None, begin: int, end: int, lanes: Lanes, row: int) -> int:
        return kernel(None if buffer is None else buffer.ctypes.data, begin, end, lanes.address, row)

    return run


def python_run(kernel: Callable[..., int], *, keeps: bool) -> Run:
    """A kernel in Python, which gets the lanes themselves, and the registers of its program if it ``keeps`` anything."""

    def run(buffer: NDArray[np.uint8] | None, begin: int, end: int, lanes: Lanes, row: int) -> int:
        memory = np.empty(0, np.uint8) if buffer is None else buffer
        buffers = lanes.buffers if lanes.hidden is None else [*lanes.buffers, *lanes.hidden.buffers]
        registers = (lanes.registers,) if keeps else ()
        return kernel(memory, begin, end, lanes.state, buffers, row, *registers)

    return run


def run_growing(
    run: Run, buffer: NDArray[np.uint8] | None, begin: int, end: int, lanes: Lanes, row: int, *, message_limit: int | None = None
) -> int:
    """Run until no lane is too small; ``message_limit`` is the program's, where the buffer is a message that somebody sent."""
    result = run(buffer, begin, end, lanes, row)
    while result == GROW:
        if message_limit is not None:
            limit(lanes, end - begin, message_limit)
        grow(lanes)
        result = run(buffer, begin, end, lanes, row)
    return result


def grow(lanes: Lanes) -> None:
    """Make the room that the last run lacked; raises MemoryError if there is none."""
    lanes.grow(*missing(lanes))


GRACE_BYTES = 1 << 20
"""What any message may ask for in a lane, unless its mapping says otherwise."""

ELEMENTS_A_BYTE = 64
"""How many elements of each lane one byte of a message may make: a number of eight bytes becomes a text of three hundred at most."""

HIDDEN_BYTES_A_BYTE = 1 << 12
"""The same of hidden lanes, in bytes: a text may be put in place of each character of another."""


def limit(lanes: Lanes, size: int, most: int, used: int = 0) -> None:
    """Refuse a message of so many bytes that asks for far more room than they can fill: rules may take a length from what it says.

    Parameters
    ----------
    most
        The bytes of a lane that any message may ask for.
    used
        How many rows of the lane are those of messages before it.

    Raises
    ------
    DecodeError
        It does.
    """
    lane, rows = missing(lanes)
    if lane >= len(lanes.buffers):
        if rows > max(most, GRACE_BYTES) + size * HIDDEN_BYTES_A_BYTE:
            raise DecodeError("count", "", NO_MEMORY, 0)
        return
    plan = lanes.plan
    described = plan.layout.lanes[lane] if lane < len(plan.layout.lanes) else None
    each, within = plan.strides[lane], 1 if described is None else described.within
    wanted = lanes.capacity(lane) + rows - used
    if (wanted - ELEMENTS_A_BYTE * size * within) * each > most * within:
        path = f".{described.name}" if described is not None and described.name else ""
        raise DecodeError("count", path, TOO_MUCH.format(wanted=wanted, size=size, most=most, each=ELEMENTS_A_BYTE), 0)


TOO_MUCH = (
    "{wanted} elements out of a message of {size} bytes, more than {each} for each of them and {most} bytes besides; "
    "a mapping that means this says so with `limit:`"
)

NO_MEMORY = "it asks for more elements than there may be, or than there is memory for"
"""A mapping may take a length from what a message says, and not from how much it holds."""


@contextmanager
def decoding() -> Generator[None]:
    """Around what makes room for a message: none may ask for more than there is."""
    try:
        yield
    except MemoryError as error:
        raise DecodeError("count", "", NO_MEMORY, 0) from error


@contextmanager
def encoding() -> Generator[None]:
    """The same of a holder."""
    try:
        yield
    except MemoryError as error:
        raise EncodeError("count", "", NO_MEMORY) from error


def readable(message: Any) -> NDArray[np.uint8]:
    """The bytes of a message: TypeError if it has none, BufferError if they do not lie together, or are references to objects."""
    view = memoryview(message)
    if view.itemsize != 1 and has_references(view):
        raise no_message(message.obj if isinstance(message, memoryview) else message)
    if not view.c_contiguous:
        raise BufferError("the message's bytes do not lie one after another")
    return np.frombuffer(view, np.uint8) if view.nbytes else np.empty(0, np.uint8)


def writable(buffer: object) -> NDArray[np.uint8]:
    """The bytes of an output: TypeError if it has none, BufferError if they cannot be written, or are references to objects."""
    view = memoryview(cast("Any", buffer))
    if has_references(view):
        raise BufferError(f"{type(buffer).__name__} has references to Python objects, which a message would overwrite: give a bytearray")
    array = readable(buffer)
    if not array.flags.writeable and view.readonly:
        raise BufferError(f"{type(buffer).__name__} is read-only")
    return array


@dataclass(frozen=True, slots=True)
class Part:
    """A stretch of a merged check, as `kernel.ir.Part`."""

    offset: int
    size: int
    path: str
    step: int


@dataclass(frozen=True, slots=True)
class Site:
    """Where a message can fail, as `kernel.ir.Site`."""

    kind: str
    path: str
    detail: str
    line: str
    parts: tuple[Part, ...]
    detail_lane: int | None

    @classmethod
    def of(cls, plain: Sequence[Any]) -> Site:
        """From the header of a cached program."""
        kind, path, detail, line, parts, lane = plain
        return cls(kind, path, detail, line, tuple(Part(*part) for part in parts), lane)


class Sites:
    """The sites of a kernel by their numbers, as headers of programs have them.

    Few messages fail: they are kept packed until one does, in less memory, and each is made when it is asked for.
    """

    __slots__ = ("_count", "_packed", "_plain")

    def __init__(self, plain: Sequence[Sequence[Any]] = ()) -> None:
        self._count, self._packed = len(plain), marshal.dumps(cast("Any", plain))
        self._plain: Sequence[Sequence[Any]] | None = None

    def __len__(self) -> int:
        return self._count

    def __getitem__(self, number: int) -> Site:
        if self._plain is None:
            self._plain = cast("Sequence[Sequence[Any]]", marshal.loads(self._packed))  # noqa: S302 - what it has packed itself
        return Site.of(self._plain[number])


NO_SITES = Sites()


def decode_error(site: Site, lanes: Lanes, begin: int, end: int) -> DecodeError:
    """What a failed kernel has left in the state, as an error. Offsets count from the message's begin."""
    at = lanes.words[ERROR_OFFSET]
    path, at = _located(site, lanes, at, end)
    return DecodeError(cast("Kind", site.kind), path, _sentence(site, lanes), at - begin)


def encode_error(site: Site, lanes: Lanes) -> EncodeError:
    """The error that a failed encoder has left in the state."""
    path, _ = _located(site, lanes, 0, 0)
    return EncodeError(cast("Kind", site.kind), path, _sentence(site, lanes))


def missing(lanes: Lanes) -> tuple[int, int]:
    """The lane that was too small for the last run, and how many rows it lacked."""
    return lanes.words[GROW_LANE], lanes.words[GROW_ROWS]


def note(lanes: Lanes, result: int) -> None:
    """Leave a result where a run over many messages leaves it."""
    lanes.words[RESULT] = result


def result_of(lanes: Lanes) -> int:
    """The result of the kernel that stopped a run over many messages."""
    return lanes.words[RESULT]


def _located(site: Site, lanes: Lanes, at: int, end: int) -> tuple[str, int]:
    indices = [lanes.words[ERROR_INDICES + number] for number in range(site.path.count("{}"))]
    available = end - at
    for part in site.parts:
        number = max(0, (available - part.offset - part.size) // part.step + 1) if part.step else 0
        if part.step or part.offset + part.size > available:
            known = [lanes.words[ERROR_INDICES + index] for index in range(part.path.count("{}") - bool(part.step))]
            return part.path.format(*known, *([number] if part.step else [])), at + part.offset + number * part.step
    return site.path.format(*indices), at


def _sentence(site: Site, lanes: Lanes) -> str:
    detail = site.detail if site.detail_lane is None else _text_of_kernel(site, site.detail_lane, lanes)
    return f"{detail} ({site.line})" if site.line else detail


def _text_of_kernel(site: Site, lane: int, lanes: Lanes) -> str:
    """The text that a kernel has put together; a character that it cut shows as a mark."""
    assert lanes.hidden is not None, "a kernel that writes to a hidden lane has made it grow"
    first = ERROR_INDICES + site.path.count("{}")
    start, size = lanes.words[first], lanes.words[first + 1]
    return bytes(lanes.hidden.buffers[lane - len(lanes.buffers)][start : start + size]).decode(errors="replace")
