"""Chunks as they were before they were compressed: as much of it as is whole, and never more than the chunk promises.

Memory is taken for no more than the compressed bytes can become, whatever the chunk promises.
"""

from __future__ import annotations

import bz2
from collections.abc import Callable
from functools import cache
from importlib import import_module
from sys import getrefcount
from threading import Lock, local
from typing import TYPE_CHECKING, Any

import numpy as np

from rosetta_jit.catalogue import logs as words
from rosetta_jit.errors import LogError
from rosetta_jit.logs.limits import MAX_RECORD_BYTES

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Bytes = NDArray[np.uint8]

UNCOMPRESSED = "", "none"
"""What logs call the compression of chunks that are not compressed."""

STEP = 1 << 16
"""Bytes that are decompressed at once where a stream is damaged, so that those before the damage are kept."""

MOST_OF_LZ4 = 256
"""Bytes that one byte of LZ4 stands for, and one more than can be: it counts at most 255 bytes of a copy."""


LEAST_OF_ZSTD, MOST_OF_ZSTD = 4, 128 << 10
"""Bytes that a block of zstd takes at least, and those that it stands for at most: RFC 8878, sections 3.1.1.2.2 and 3.1.1.2.3."""


KEPT_BYTES = 16 << 20
"""The most memory that is kept from one reading of a log to the next."""


class Scratch:
    """Memory that is used for one chunk after another: fresh memory would take as long as reading into it. Threads may share it."""

    def __init__(self) -> None:
        self._contents, self._records, self._rows = list["Bytes"](), list["Bytes"](), list["Bytes"]()
        self._lock, self._of_thread = Lock(), local()

    def settle(self) -> None:
        """Keep some of the memory for the next reading."""
        with self._lock:
            for memory in (self._contents, self._records, self._rows):
                while sum(each.size for each in memory) > KEPT_BYTES // 2:
                    del memory[-1]

    def zstd(self, zstandard: Any) -> Any:
        """What decompresses one frame after another in this thread: to make it takes as long as to decompress some kilobytes."""
        if not hasattr(self._of_thread, "zstd"):
            self._of_thread.zstd = zstandard.ZstdDecompressor(max_window_size=MAX_RECORD_BYTES)
        return self._of_thread.zstd

    def room(self, size: int) -> Bytes:
        """So many bytes for the content of a chunk."""
        with self._lock:
            return _unused(self._contents, size)

    def record(self, size: int) -> Bytes:
        """The same for a chunk as it is in the file, which is its content where it is not compressed."""
        with self._lock:
            return _unused(self._records, size)

    def rows(self, size: int) -> NDArray[np.int64]:
        """The same for so many numbers of rows."""
        with self._lock:
            return _unused(self._rows, 8 * size).view(np.int64)


def _unused(memory: list[Bytes], size: int) -> Bytes:
    """The first of some memory that is large enough, and which no array and no view shows; else memory anew. What is too small goes."""
    for number in range(len(memory)):
        if _references(memory, number) == _UNUSED:
            if memory[number].size >= size:
                return memory[number][:size]
            del memory[number]
            break
    memory.append(np.empty(size, np.uint8))
    return memory[-1][:size]


def _references(memory: list[Bytes], number: int) -> int:
    """How many objects refer to an array of a list: the list, every view of the array, and the call that counts."""
    return getrefcount(memory[number])


_UNUSED = _references([np.empty(0, np.uint8)], 0)


def decompressed(name: str, compression: str, body: memoryview, size: int, scratch: Scratch) -> tuple[Bytes, str]:
    """The content of a chunk that promises so many bytes, and what is wrong with it; nothing of a compression that is not known.

    Raises
    ------
    LogError
        The package is missing that decompresses it; ``name`` is the log's.
    """
    if compression in UNCOMPRESSED:
        found, wrong = np.frombuffer(body, np.uint8), ""
    elif compression not in _STREAMS:
        return np.empty(0, np.uint8), f"it is compressed as {compression!r}, which is not known"
    elif size > MAX_RECORD_BYTES:
        return np.empty(0, np.uint8), f"it promises {size} bytes, more than the limit of {MAX_RECORD_BYTES}"
    else:
        found, wrong = _STREAMS[compression](name, body, size, scratch)
    if not wrong and found.size != size:
        wrong = f"it promises {size} bytes, and holds {found.size}"
    return found, wrong


def _zstd(name: str, body: memoryview, size: int, scratch: Scratch) -> tuple[Bytes, str]:
    zstandard = _package("zstandard", name)
    size = min(size, zstd_size(body) or size)  # the frame tells, too, how much it holds
    size = min(size, MOST_OF_ZSTD * (len(body) // LEAST_OF_ZSTD + 1))  # whatever both promise
    target = scratch.room(size)

    def read(step: int) -> tuple[Bytes, str]:
        filled = 0
        try:
            with scratch.zstd(zstandard).stream_reader(body) as stream:
                while filled < size and (count := stream.readinto(target.data[filled : filled + step])):
                    filled += count
        except (zstandard.ZstdError, MemoryError) as error:
            return target[:filled], str(error)
        return target[:filled], ""

    found, wrong = read(max(size, 1))
    return read(STEP) if wrong else (found, wrong)


def zstd_size(data: memoryview) -> int:
    """How many bytes a frame of zstd says that it holds; 0 where it does not say, or says more than is read."""
    zstandard = _package("zstandard", "a message")
    try:
        size = int(zstandard.get_frame_parameters(data[:64]).content_size)
    except zstandard.ZstdError:
        return 0
    return size if size <= MAX_RECORD_BYTES else 0


def _lz4(name: str, body: memoryview, size: int, _: Scratch) -> tuple[Bytes, str]:
    frame = _package("lz4.frame", name)
    size = min(size, MOST_OF_LZ4 * (len(body) + 1))  # for all of which the package takes memory at once
    return _pieces(frame.LZ4FrameDecompressor, body, size, (RuntimeError, EOFError, MemoryError))


def _bz2(_name: str, body: memoryview, size: int, _: Scratch) -> tuple[Bytes, str]:
    return _pieces(bz2.BZ2Decompressor, body, size, (OSError, EOFError, ValueError))


def _pieces(new: Callable[[], Any], body: memoryview, size: int, errors: tuple[type[Exception], ...]) -> tuple[Bytes, str]:
    """What a decompressor of Python's manner gives: all at once, else piece by piece up to the damage."""
    try:
        return np.frombuffer(new().decompress(body, max_length=size), np.uint8), ""
    except errors as error:
        wrong = str(error)
    decompressor, found = new(), bytearray()
    try:
        for begin in range(0, len(body), STEP):
            found += decompressor.decompress(body[begin : begin + STEP], max_length=size - len(found))
    except errors:
        pass
    return np.frombuffer(bytes(found[:size]), np.uint8), wrong


def _package(module: str, name: str) -> Any:
    try:
        return _imported(module)
    except ImportError:
        raise LogError((words.needs(name, module.partition(".")[0], "logs"),)) from None


_imported = cache(import_module)


_STREAMS = {"zstd": _zstd, "lz4": _lz4, "bz2": _bz2}
