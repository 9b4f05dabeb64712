"""`rosetta-jit compile`, also `cache warm`: compile programs now, several at a time, so that later processes load them from the cache."""

from __future__ import annotations

import argparse
import json
import sys
import time
from typing import TYPE_CHECKING, cast

from rosetta_jit.cli.arguments import Commands, add_command, add_options, options_of, positive
from rosetta_jit.pipeline.request import Direction
from rosetta_jit.terminal import printable

if TYPE_CHECKING:
    from rosetta_jit.api.warm import Warmed

SUMMARY = "Compile mappings and types in both directions and keep the kernels in the cache."


def add(commands: Commands) -> None:
    """Declare the arguments."""
    command = add_command(commands, "compile", SUMMARY, run)
    add_programs(command, nargs="+")
    command.add_argument("--json", action="store_true", help="one JSON object a program, on stdout")


def add_programs(command: argparse.ArgumentParser, *, nargs: str, of: str = "") -> None:
    """Declare which programs to compile; ``of`` begins the help of an action among others."""
    command.add_argument("names", metavar="MAPPING|TYPE|FOLDER", nargs=nargs, help=f"{of}mappings, types, and folders of mappings")
    add_options(command)
    command.add_argument("--direction", choices=("decode", "encode"), action="append", help=f"{of}only this direction")
    usual = f"{of}leave out what is compiled when a message comes that hardly ever does, such as big-endian CDR"
    command.add_argument("--usual", action="store_true", help=usual)
    jobs = f"{of}compile so many at a time (default: as many as there are processors)"
    command.add_argument("--jobs", type=positive, metavar="N", help=jobs)


def run(arguments: argparse.Namespace) -> int:
    """One line a program: how long it took to compile or to load. Exit code 1 if one is wrong, there is none, or the cache keeps none."""
    from concurrent.futures.process import BrokenProcessPool

    from rosetta_jit.api.warm import DIRECTIONS, programs_of, warm
    from rosetta_jit.runtime.cache.kernels import Cache

    directions = cast("list[Direction] | None", arguments.direction) or DIRECTIONS
    programs = programs_of(arguments.names, directions, options_of(arguments))
    started, made, wrong = time.perf_counter(), 0, 0
    try:
        for number, several in enumerate(warm(programs, cast("int | None", arguments.jobs), usual=arguments.usual), 1):
            for each in several:
                made, wrong = made + 1, wrong + (each.error is not None)
                _show(each, as_json=arguments.json, progress=f"{number}/{len(programs)}")
    except BrokenProcessPool:
        wrong += 1
        print(
            "error: a process that compiled was ended from outside, as the system does where memory is short: try --jobs 1", file=sys.stderr
        )
    if not arguments.json:
        print(f"{made - wrong} ready, {wrong} wrong, in {time.perf_counter() - started:.1f} s")
    is_kept = Cache.default().is_kept
    if not is_kept:
        print("error: the cache cannot keep what was compiled: see `rosetta-jit cache info`", file=sys.stderr)
    return int(bool(wrong) or not made or not is_kept)


def _show(warmed: Warmed, *, as_json: bool, progress: str) -> None:
    request, error = warmed.request, warmed.error
    name = request.mapping or request.type or ""
    if as_json:
        plain = {
            "name": name,
            "direction": request.direction,
            "wire": request.wire,
            "encoding": request.encoding,
            "seconds": round(warmed.seconds, 4),
        }
        print(json.dumps({**plain, "error": None if error is None else str(error)}), flush=True)
        return
    encoding = "".join(f", {each}" for each in (request.wire, request.encoding) if each is not None)
    if error is None:
        print(f"[{progress}] {printable(name)}: {request.direction}{encoding}, {1000 * warmed.seconds:.0f} ms", flush=True)
    else:
        print(f"[{progress}] {printable(name)}: {request.direction}{encoding}\n{_said(error)}\n", file=sys.stderr, flush=True)


def _said(error: Exception) -> str:
    from rosetta_jit.cli.advice import said_of
    from rosetta_jit.errors import RosettaError

    return said_of(error) if isinstance(error, RosettaError) else str(error)
