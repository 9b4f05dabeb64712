"""A program in C around a generated unit: it decodes messages, writes them again, and says what is wrong with those that are broken."""

from __future__ import annotations

import random
import shutil
import struct
import subprocess
from pathlib import Path

import pytest

STRICT = ("-std=c11", "-Wall", "-Wextra", "-Wconversion", "-pedantic", "-Werror")
WATCHED = ("-fsanitize=address", "--param=asan-instrumentation-with-call-threshold=0")
"""Accesses to memory are checked by calls and not in line, which is compiled in less time."""
CHECKED = (*WATCHED, "-fsanitize=undefined", "-fno-sanitize-recover=all", "-fsanitize-undefined-trap-on-error")
"""What is undefined ends the program without a word about it, for the same reason."""
NO_SCOPES = ("-fno-sanitize-address-use-after-scope",)
"""Optimised programs leave out whether locals are used behind their scope: those without optimisation see that."""
SANITIZED = ("-O1", *CHECKED, *NO_SCOPES)
MAIN = Path(__file__).with_name("driver.c")

needs_gcc = pytest.mark.skipif(shutil.which("gcc") is None, reason="generated C is compiled by gcc, which is not installed")


def write(folder: Path, texts: dict[str, str] | dict[str, str | bytes]) -> str:
    """The files of a unit in a folder; gives the unit's name."""
    for name, text in texts.items():
        (folder / name).write_bytes(text if isinstance(text, bytes) else text.encode())
    return next(name for name in texts if name.endswith(".h"))[:-2]


def compiled(compiler: str, folder: Path, name: str, *options: str) -> Path:
    """A unit, without a warning."""
    made = folder / f"{name}.{compiler}.o"
    done = subprocess.run(
        [compiler, *STRICT, *options, "-c", f"{name}.c", "-o", made], cwd=folder, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert not done.stderr
    return made


def driver(folder: Path, name: str, compiler: str = "gcc", options: tuple[str, ...] = SANITIZED) -> Path:
    """The program around a unit, which must not give a compiler cause to complain."""
    made = folder / f"{name}.{compiler}"
    words = [f'-DHEADER="{name}.h"', f"-DUNIT={name}"]
    sources = [MAIN, folder / f"{name}.c", "-lm"]
    done = subprocess.run(
        [compiler, *STRICT, *options, f"-I{folder}", *words, "-o", made, *sources], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return made


def driver_of_object(folder: Path, name: str, compiler: str = "gcc", options: tuple[str, ...] = SANITIZED) -> Path:
    """The program around a unit's object file."""
    calls = folder / f"{name}_calls.c"
    calls.write_text(f'#define {name.upper()}_IMPLEMENTATION\n#include "{name}.h"\n')
    compiled(compiler, folder, calls.stem)
    made = folder / f"{name}.program"
    words = [f'-DHEADER="{name}.h"', f"-DUNIT={name}"]
    sources = [MAIN, calls, folder / f"{name}.o", "-lm"]
    done = subprocess.run(
        [compiler, *STRICT, *options, f"-I{folder}", *words, "-o", made, *sources], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return made


def answers(program: Path, messages: list[bytes], *runner: str, unit: str = "") -> list[str]:
    """What the program says of each message; one of several units names its own."""
    given = b"".join(struct.pack("<I", len(message)) + message for message in messages)
    done = subprocess.run([*runner, program, *filter(None, [unit])], input=given, capture_output=True, check=False)
    assert done.returncode == 0, f"ended with {done.returncode}: {done.stderr.decode()}"
    return done.stdout.decode("utf-8", "replace").split("\n")[:-1]


def harmed(messages: list[bytes], rounds: int, seed: str) -> list[bytes]:
    """Good messages, cut and altered."""
    chance = random.Random(seed)
    found = list(messages)
    for message in messages:
        found += [message[:cut] for cut in sorted(chance.sample(range(len(message)), min(rounds, len(message))))]
        found.append(message + b"\0")
        for _ in range(rounds if message else 0):
            changed = bytearray(message)
            for _ in range(chance.randint(1, 3)):
                changed[chance.randrange(len(changed))] = chance.choice((0, 1, 127, 128, 255, chance.randrange(256)))
            found.append(bytes(changed))
    return found


def expected(decode, encode, message: bytes) -> str:
    """What the library says of a message, as the program writes it."""
    from rosetta_jit.errors import DecodeError, EncodeError

    try:
        return f"ok {encode(decode(message)).hex()}"
    except DecodeError as error:
        return f"{error.kind} {error.offset} [{error.path}] {error.detail}"
    except EncodeError as error:
        return f"{error.kind} [{error.path}] {error.detail}"
