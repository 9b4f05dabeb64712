"""The native peers of `bench/native`, through ctypes; they time their own loops, so that ctypes costs nothing."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from bench.subjects import Subject

FOLDER = Path(__file__).resolve().parents[2] / "build" / "native"

_LIBRARIES = {
    "ros1": ("roscpp", "roscpp in C++", "an object, used again; std::vector and std::string"),
    "cdr": ("fastcdr", "Fast CDR in C++", "an object, used again; std::vector and std::string"),
    "protobuf": ("protobuf", "protobuf in C++", "a message, used again; RepeatedField and std::string"),
    "cdr-giop": ("omniorb", "omniORB in C++", "a struct, used again; its sequence allocates"),
    "lcm": ("lcm", "lcm-gen's C++", "an object, used again; std::vector"),
}
"""Encoding → the library's name, who it is, and what it makes."""

FIRST = 100
"""Iterations from which the number that fills a round is reckoned."""


@dataclass(frozen=True, slots=True)
class NativePeer:
    """A peer that times itself: ``decode(iterations)`` and ``encode(iterations)`` give nanoseconds a message."""

    who: str
    makes: str
    decode: Callable[[int], float]
    encode: Callable[[int], float]


def native_peers(subject: Subject, messages: Sequence[bytes] = ()) -> tuple[NativePeer, ...]:
    """The libraries that were built and know the subject's type, for messages that come in turn: by default for the subject's own."""
    if subject.encoding not in _LIBRARIES:
        return ()
    name, who, makes = _LIBRARIES[subject.encoding]
    if not _path(name).exists():
        return ()
    library = ctypes.CDLL(str(_path(name)))
    jobs = tuple(partial(_nanoseconds, library[f"{job}_ns"], subject.type, messages or (subject.message,)) for job in ("decode", "encode"))
    return (NativePeer(who, makes, *jobs),)


def built() -> tuple[str, ...]:
    """The native peers whose libraries were built."""
    return tuple(who for name, who, _ in _LIBRARIES.values() if _path(name).exists())


def absent() -> tuple[str, ...]:
    """Those for which headers or generators are not installed."""
    return tuple(who for name, who, _ in _LIBRARIES.values() if not _path(name).exists())


def _path(name: str) -> Path:
    return FOLDER / f"lib{name}_peer.so"


def rounds_of(job: Callable[[int], float], round_s: float) -> Callable[[], float]:
    """A contender: as many iterations each time as fill a round."""
    count = max(1, int(1e9 * round_s / max(job(FIRST), 0.1)))
    return partial(job, count)


def _nanoseconds(function: Any, type_: str, messages: Sequence[bytes], iterations: int) -> float:
    function.restype = ctypes.c_double
    ends = np.cumsum(list(map(len, messages)), dtype=np.int64)
    took = function(type_.encode(), b"".join(messages), ends.ctypes, ctypes.c_int64(len(messages)), ctypes.c_int64(iterations))
    if took < 0:
        raise ValueError(f"{function.__name__} refuses {type_}")
    return took
