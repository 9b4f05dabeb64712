"""`rosetta-jit cache`: look at the kernel cache, check it, empty it, or fill it."""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import asdict

from rosetta_jit.cli import compile as ahead
from rosetta_jit.cli.arguments import Commands, add_command

SUMMARY = "Look at the cache of compiled kernels (info), check it (verify), empty it (clear), or compile into it ahead (warm)."


def add(commands: Commands) -> None:
    """Declare the arguments."""
    command = add_command(commands, "cache", SUMMARY, run)
    command.add_argument("action", choices=("info", "verify", "clear", "warm"))
    ahead.add_programs(command, nargs="*", of="warm: ")
    command.add_argument("--json", action="store_true", help="one JSON object, on stdout; warm: one a program")


def run(arguments: argparse.Namespace) -> int:
    """Exit code 1 if `verify` or `warm` finds something wrong, or if the folder cannot be used; 2 if names are missing or out of place."""
    if bool(arguments.names) != (arguments.action == "warm"):
        print("error: " + ("name what to compile" if not arguments.names else f"cache {arguments.action} takes no names"), file=sys.stderr)
        return 2
    if arguments.action == "warm":
        return ahead.run(arguments)
    actions = {"info": _info, "verify": _verify, "clear": _clear}
    return actions[arguments.action](as_json=arguments.json)


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
