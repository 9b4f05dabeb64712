"""Generated C++ as programs."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

STRICT = ("-std=c++17", "-Wall", "-Wextra", "-Wconversion", "-pedantic", "-Werror")
SANITIZED = ("-O1", "-g1", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
MAIN = Path(__file__).with_name("driver.cpp")

needs_cpp = pytest.mark.skipif(shutil.which("g++") is None, reason="generated C++ is compiled by g++, which is not installed")


def write(folder: Path, texts: dict[str, str]) -> str:
    """The files of a unit; gives its name."""
    for name, text in texts.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    return next(name for name in texts if name.endswith(".cpp"))[:-4]


def encoding_once(folder: Path) -> Path:
    """The usual driver encodes twice, which of a mapping with state gives two messages: this one encodes once."""
    text, once = MAIN.read_text(), folder / "once.cpp"
    begin, end = text.index("    std::string again;"), text.index('    std::printf("ok ");')
    once.write_text(text[:begin] + text[end:])
    return once


def program(folder: Path, name: str, *sources: str, compiler: str = "g++", options: tuple[str, ...] = SANITIZED, main: Path = MAIN) -> Path:
    """The program around a unit, which must not give a compiler cause to complain."""
    made = folder / f"{name}.{compiler}"
    words = [f'-DHEADER="{name}.hpp"', f"-DUNIT={name}"]
    command = [compiler, *STRICT, *options, f"-I{folder}", *words, main, folder / f"{name}.cpp", *sources, "-lm", "-o", made]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=folder)
    assert done.returncode == 0, done.stderr
    assert not done.stderr
    return made


def compiled(compiler: str, folder: Path, name: str, *options: str) -> None:
    """A unit, without a warning."""
    command = [compiler, *STRICT, *options, "-I.", "-c", f"{name}.cpp", "-o", f"{name}.{compiler}.o"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert not done.stderr
