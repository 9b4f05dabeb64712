"""Compile programs ahead, several at a time, so that later processes load them from the cache."""

from __future__ import annotations

import os
import sys
import threading
import time
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from functools import partial
from multiprocessing import get_context
from pathlib import Path

from rosetta_jit.api.options import Options, is_mapping, named_request
from rosetta_jit.api.programs import program_of
from rosetta_jit.errors import ReportError
from rosetta_jit.pipeline.request import Direction, Request
from rosetta_jit.runtime.attributes.code import make_ready
from rosetta_jit.runtime.decoder import complete
from rosetta_jit.runtime.program import make_rest
from rosetta_jit.startup.dataclass import dataclass, replace

SUFFIX = ".mapping"
LEAST = 4
"""For how many programs a process of their own pays."""

DIRECTIONS: tuple[Direction, ...] = ("decode", "encode")


@dataclass(frozen=True, slots=True)
class Warmed:
    """A program that was compiled or loaded, or what is wrong with it.

    Attributes
    ----------
    request
        Which program: ``mapping`` or ``type``, ``direction``, ``encoding``.
    seconds
        How long it took to compile it, or to load it where the cache had it.
    error
        What is wrong with the mapping or the type; None if nothing is.
    """

    request: Request
    seconds: float
    error: ReportError | None = None


def members(name: str) -> Iterable[str]:
    """The mappings in a folder; what is no folder stands for itself."""
    folder = Path(name)
    return sorted(map(str, folder.rglob(f"*{SUFFIX}"))) if folder.is_dir() else (name,)


def programs_of(
    names: Iterable[str],
    directions: Sequence[Direction] = DIRECTIONS,
    options: Options | None = None,
) -> tuple[Request, ...]:
    """The programs of some mappings, types, and folders of mappings, each once.

    A name that ends in ``.mapping``, or is a file's, is that of a mapping; any other one that is no folder's is that of a type, which
    the imports may declare.
    """
    of_mapping: Options = {**(options or {}), "imports": ()}
    of_type: Options = {**(options or {}), "parameters": {}}
    found = [
        named_request(direction, name, of_mapping if is_mapping(name) else of_type)
        for each in names
        for name in members(each)
        for direction in directions
    ]
    return tuple(dict.fromkeys(found))


def warm(programs: Iterable[Request], jobs: int | None = None, *, usual: bool = False) -> Iterator[tuple[Warmed, ...]]:
    """Compile programs, ``jobs`` at a time (by default as many as there are processors); yields what became of each when it is done.

    That is nothing where the mapping has no rules for the direction, and several programs where the encoding stands for several dialects,
    of which a writer must choose one. Many programs are compiled in processes of their own, because LLVM works for one thread of a process
    at a time; the first one here, and with it, into the cache, what all of them need. All accessors of messages are compiled, too.
    ``usual`` leaves out what decoders make when a message comes that hardly ever does, such as big-endian CDR.

    Raises
    ------
    BrokenProcessPool
        One of these processes was ended from outside.
    """
    wanted, made = tuple(programs), partial(_made, usual=usual)
    processes = min(jobs or os.cpu_count() or 1, len(wanted) // LEAST)
    if processes < 2:
        yield from map(made, wanted)
        make_ready()
        return
    yield made(wanted[0])
    with ProcessPoolExecutor(processes, get_context(_start_method())) as pool:
        accessors = pool.submit(make_ready)
        for done in as_completed([pool.submit(made, each) for each in wanted[1:]]):
            yield done.result()
        accessors.result()


def _start_method() -> str:
    """How processes begin: as copies of this one, which has imported the compiler, where no other thread can hold a lock meanwhile."""
    return "fork" if sys.platform == "linux" and threading.active_count() == 1 else "spawn"


def _made(request: Request, *, usual: bool) -> tuple[Warmed, ...]:
    started = time.perf_counter()
    try:
        program = program_of(request)
        make_rest(program)
        if request.direction == "decode" and not usual:
            complete(program)
    except ReportError as error:
        match error.diagnostics[0].code:
            case "no-rules":
                return ()
            case "ambiguous-encoding":
                return tuple(made for each in _dialects(request) for made in _made(each, usual=usual))
            case "wire-unsaid":
                return tuple(made for each in _wires(request) for made in _made(each, usual=usual))
            case _:
                return (Warmed(request, time.perf_counter() - started, error),)
    return (Warmed(request, time.perf_counter() - started),)


def _wires(request: Request) -> list[Request]:
    """The same program of each wire of the mapping."""
    from rosetta_jit.pipeline.build import Build

    return [replace(request, wire=each.name) for each in Build(request).checked.mapping.wires]


def _dialects(request: Request) -> list[Request]:
    """The same program in each encoding of its framework but the one that cannot be written."""
    from rosetta_jit.pipeline.build import Build

    encodings = tuple(Build(request).wire_framework.encodings)
    return [replace(request, encoding=each) for each in encodings if each != (request.encoding or encodings[0])]
