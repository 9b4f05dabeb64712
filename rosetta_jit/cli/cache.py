"""`rosetta-jit cache`: look at the kernel cache, check it, empty it, and compile into it ahead."""

from __future__ import annotations

import json
import sys
import time
from dataclasses import asdict
from typing import TYPE_CHECKING, cast

from rosetta_jit.cli.arguments import Commands, add_command, add_encoding, add_parameters, encoding_of, parameters_of
from rosetta_jit.terminal import printable

if TYPE_CHECKING:
    import argparse

    from rosetta_jit.api.warm import Warmed

SUMMARY = "Look at the cache of compiled kernels (info), check it (verify), empty it (clear), or compile into it ahead (warm)."


def add(commands: Commands) -> None:
    """Declare the arguments."""
    command = add_command(commands, "cache", SUMMARY, run)
    command.add_argument("action", choices=("info", "verify", "clear", "warm"))
    command.add_argument(
        "names",
        metavar="MAPPING|TYPE|FOLDER",
        nargs="*",
        help="warm: mappings, types, and folders of mappings to compile in both directions",
    )
    add_encoding(command)
    add_parameters(command)
    command.add_argument("--jobs", type=int, metavar="N", help="warm: compile so many at a time (default: as many as there are processors)")
    command.add_argument("--json", action="store_true", help="one JSON object, on stdout; warm: one a program")


def run(arguments: argparse.Namespace) -> int:
    """Exit code 1 if `verify` or `warm` finds something wrong, or if the folder cannot be used; 2 if names are missing or out of place."""
    if bool(arguments.names) != (arguments.action == "warm"):
        print("error: " + ("name what to compile" if not arguments.names else f"cache {arguments.action} takes no names"), file=sys.stderr)
        return 2
    if arguments.action == "warm":
        return _warm(arguments)
    actions = {"info": _info, "verify": _verify, "clear": _clear}
    return actions[arguments.action](as_json=arguments.json)


def _warm(arguments: argparse.Namespace) -> int:
    """Compile, show what is done meanwhile, and say at the end what took how long."""
    from rosetta_jit.api.warm import programs_of, warm
    from rosetta_jit.runtime.cache.kernels import Cache

    programs = programs_of(arguments.names, encoding=encoding_of(arguments), parameters=parameters_of(arguments))
    started, made, wrong = time.perf_counter(), 0, 0
    for number, several in enumerate(warm(programs, cast("int | None", arguments.jobs)), 1):
        for each in several:
            made, wrong = made + 1, wrong + (each.error is not None)
            _show(each, as_json=arguments.json, progress=f"{number}/{len(programs)}")
    if not arguments.json:
        print(f"{made - wrong} programs ready, {wrong} wrong, in {time.perf_counter() - started:.1f} s")
    is_kept = Cache.default().is_kept
    if not is_kept:
        print("error: the cache cannot keep what was compiled: see `rosetta-jit cache info`", file=sys.stderr)
    return int(bool(wrong) or not made or not is_kept)


def _show(warmed: Warmed, *, as_json: bool, progress: str) -> None:
    request, error = warmed.request, warmed.error
    name = request.mapping or request.type or ""
    if as_json:
        plain = {"name": name, "direction": request.direction, "encoding": request.encoding, "seconds": round(warmed.seconds, 4)}
        print(json.dumps({**plain, "error": None if error is None else str(error)}), flush=True)
        return
    encoding = "" if request.encoding is None else f", {request.encoding}"
    if error is None:
        print(f"[{progress}] {printable(name)}: {request.direction}{encoding}, {1000 * warmed.seconds:.0f} ms", flush=True)
    else:
        print(f"[{progress}] {printable(name)}: {request.direction}{encoding}\n{error}\n", file=sys.stderr, flush=True)


def _info(*, as_json: bool) -> int:
    from rosetta_jit.runtime.cache.kernels import Cache

    info = Cache.default().info()
    facts = asdict(info) | {"folder": str(info.folder) if info.folder else None}
    if as_json:
        print(json.dumps(facts))
        return int(bool(info.problem))
    del facts["compiled_anew"]
    print("\n".join(f"{name.replace('_', ' ') + ':':<12}{value}" for name, value in facts.items() if value != ""))
    if info.compiled_anew:
        print("compiled anew in each process, because it cannot be told for certain which functions they call:")
    for unkept in info.compiled_anew:
        print(f"  {unkept.program}", *unkept.reasons, sep="\n    ")
    return int(bool(info.problem))


def _verify(*, as_json: bool) -> int:
    from rosetta_jit.runtime.cache.kernels import Cache

    damaged = Cache.default().verify()
    if as_json:
        print(json.dumps({"damaged": [asdict(file) for file in damaged]}))
    for file in () if as_json else damaged:
        print(f"{file.name}: {file.reason}", file=sys.stderr)
    return int(bool(damaged))


def _clear(*, as_json: bool) -> int:
    from rosetta_jit.runtime.cache.kernels import Cache

    count = Cache.default().clear()
    print(json.dumps({"removed": count}) if as_json else f"{count} files removed")
    return 0
