"""The command line `rosetta-jit`: one file a command, each with `add` (its arguments) and `run` (its work; gives the exit code).

Exit codes: 0 all is well, 1 the input is wrong, 2 the command line is wrong. What is wrong goes to stderr. The library is imported
by a command when it runs, so that help costs nothing.
"""

from __future__ import annotations

import argparse
import codecs
import io
import os
import sys
from collections.abc import Callable, Sequence
from typing import cast

from rosetta_jit.cli import (
    bridge,
    cache,
    cat,
    check,
    convert,
    decode,
    demo,
    doctor,
    draft,
    dump,
    encode,
    explain,
    frameworks,
    generate,
    infer,
    info,
    operations,
    plot,
    prove,
    stubs,
)
from rosetta_jit.cli import compile as compile_

COMMANDS = (
    demo,
    check,
    explain,
    operations,
    prove,
    compile_,
    decode,
    encode,
    info,
    cat,
    convert,
    plot,
    bridge,
    doctor,
    draft,
    dump,
    infer,
    generate,
    stubs,
    frameworks,
    cache,
)


INTERRUPTED = 130
"""The exit code where the user has pressed Ctrl-C, as shells have it: 128 and the number of the signal."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; gives the exit code."""
    from rosetta_jit.errors import RosettaError

    _write_whatever_comes()
    chosen = parser().parse_args(arguments)
    run = cast("Callable[[argparse.Namespace], int]", chosen.run)
    try:
        return run(chosen)
    except RosettaError as error:
        from rosetta_jit.cli.advice import said_of

        print(said_of(error), file=sys.stderr)
    except BrokenPipeError:
        # Whoever read our output has seen enough. Python would complain once more when it flushes at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except OSError as error:
        print(f"error: {error}", file=sys.stderr)
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return INTERRUPTED
    return 1


def _write_whatever_comes() -> None:
    """Texts hold what robots sent and what users typed, which need not be UTF-8: bytes are written as they came, the rest as an escape."""
    codecs.register_error("as-it-came", _as_it_came)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="as-it-came")


def _as_it_came(error: UnicodeError) -> tuple[str | bytes, int]:
    try:
        return codecs.lookup_error("surrogateescape")(error)
    except UnicodeError:
        return codecs.lookup_error("backslashreplace")(error)


def parser() -> argparse.ArgumentParser:
    """The arguments of all commands."""
    root = argparse.ArgumentParser(
        prog="rosetta-jit", description="Decode one robot middleware's bytes into another's data holders, and back."
    )
    root.add_argument("--version", action=_Version)
    root.add_argument("--cmake-dir", action=_CMakeFolder)
    commands = root.add_subparsers(metavar="COMMAND", required=True)
    for command in COMMANDS:
        command.add(commands)
    return root


class _CMakeFolder(argparse.Action):
    """Shows where CMake finds the package."""

    def __init__(self, option_strings: Sequence[str], dest: str, **_: object) -> None:
        super().__init__(option_strings, dest, nargs=0, help="show the folder for rosetta_jit_DIR of CMake and exit")

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        print(os.path.join(os.path.dirname(os.path.dirname(os.path.realpath(__file__))), "generate", "cmake"))  # noqa: PTH118, PTH120 - starts quickly
        parser.exit()


class _Version(argparse.Action):
    """Asks the installed package for its version, only when somebody wants to know."""

    def __init__(self, option_strings: Sequence[str], dest: str, **_: object) -> None:
        super().__init__(option_strings, dest, nargs=0, help="show the version and exit")

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        from importlib.metadata import PackageNotFoundError, version

        try:
            print(f"rosetta-jit {version('rosetta-jit')}")
        except PackageNotFoundError:
            print("rosetta-jit, from a folder of sources")
        parser.exit()
