"""Generated C++ as programs."""

from __future__ import annotations

import os
import shutil
import subprocess
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from tests.generate import driver
from tests.generate.driver import CHECKED, NO_SCOPES
from tests.shared import FOLDER, HEADERS

if TYPE_CHECKING:
    from collections.abc import Iterable

STRICT = ("-std=c++17", "-Wall", "-Wextra", "-Wconversion", "-pedantic", "-Werror")
QUICK = ("-O0", *CHECKED)
THOROUGH = ("-O2", *CHECKED, *NO_SCOPES)
CAREFUL = ("-O1", "-fstrict-aliasing", *CHECKED, *NO_SCOPES)
"""What -O2 makes of objects of one class that are read as another, in two thirds of the time: for classes of which some are."""
WATCHED = ("-O0", *driver.WATCHED)
"""The memory alone, for large units: they are compiled in half the time."""
PLAIN = ("-O0",)
OFTEN = (QUICK, THOROUGH, CAREFUL, WATCHED, PLAIN)
"""Options with which many programs are made: for these the headers that all of them begin with are read once."""
MAIN = Path(__file__).with_name("driver.cpp")
OURS = "rosetta_jit/rosetta_jit.hpp"

needs_cpp = pytest.mark.skipif(shutil.which("g++") is None, reason="generated C++ is compiled by g++, which is not installed")


def write(folder: Path, texts: dict[str, str]) -> str:
    """The files of a unit; gives its name."""
    for name, text in texts.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    return next(name for name in texts if name.endswith(".cpp"))[:-4]


def write_as_one(folder: Path, name: str, units: Iterable[dict[str, str]]) -> str:
    """Units in one header and one source file, which takes a compiler half the time."""
    texts = {file: text for unit in units for file, text in unit.items()}

    def joined(end: str) -> str:
        return "".join(text for file, text in texts.items() if file.endswith(end) and file != OURS)

    return write(folder, {f"{name}.hpp": joined(".hpp"), f"{name}.cpp": joined(".cpp")} | texts)


def encoding_once(folder: Path) -> Path:
    """The usual driver encodes twice, which of a mapping with state gives two messages: this one encodes once."""
    text, once = MAIN.read_text(), folder / "once.cpp"
    begin, end = text.index("    std::string again;"), text.index('    std::printf("ok ");')
    once.write_text(text[:begin] + text[end:])
    return once


def program(
    folder: Path,
    name: str,
    *sources: str,
    compiler: str = "g++",
    options: tuple[str, ...] = CAREFUL,
    main: Path = MAIN,
    units: Iterable[str] = (),
    classes: str = "",
    is_apart: bool = False,
) -> Path:
    """The program around a unit, or around several that are written as one, which must not give a compiler cause to complain.

    All is one source, of which a compiler reads the headers once: the unit's, those of ``classes`` (a file of them, if there is one), and
    ``main``. A unit that ``is_apart`` stays a source of its own, as people compile it.
    """
    made = folder / f"{name}.{compiler}"
    words = [f'-DHEADER="{name}.hpp"', f"-DUNITS={''.join(f'EACH({each})' for each in units or (name,))}"]
    begun = read_once(folder, name, options) if compiler == "g++" and (not is_apart or begins_with_unit(main)) else ()
    files = [main, folder / f"{name}.cpp"] if is_apart else [one_source(folder, name, classes, main)]
    command = [compiler, *STRICT, *options, *begun, f"-I{folder}", *words, *files, *sources, "-lm", "-o", made]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=folder)
    assert done.returncode == 0, done.stderr
    assert not done.stderr
    return made


def one_source(folder: Path, name: str, classes: str, main: Path) -> Path:
    """A unit's source with classes and a program behind it."""
    whole = folder / f"{name}.whole.cpp"
    between = f"#include <{classes}>\n" if classes else ""
    whole.write_text(f'{(folder / f"{name}.cpp").read_text()}\n{between}#include "{main}"\n')
    return whole


def begins_with_unit(main: Path) -> bool:
    """Whether a program includes the unit's header before any other."""
    return next(line for line in main.read_text().splitlines() if line.startswith("#include")) == "#include HEADER"


def read_once(folder: Path, name: str, options: tuple[str, ...]) -> tuple[str, ...]:
    """Options for g++, which then does not read the headers anew that the unit's own header includes before it declares anything.

    Those are some of the standard library, and the one that all units have. Other headers are read where they are included.
    """
    modes = tuple(each for each in options if not each.startswith("-isystem"))
    if modes not in OFTEN:
        return ()
    includes = [line for line in (folder / f"{name}.hpp").read_text().splitlines() if line.startswith("#include")]
    text = "".join(f"{line}\n" for line in includes[: includes.index(f"#include <{OURS}>") + 1])
    known = sha256("\n".join([text, (folder / OURS).read_text(), *modes]).encode()).hexdigest()
    begin = Path(os.environ[FOLDER]) / HEADERS / f"{known}.hpp"
    made = Path(f"{begin}.gch")
    if not made.exists():
        begin.parent.mkdir(exist_ok=True)
        begin.write_text(text)
        own = Path(f"{made}.{os.getpid()}")
        subprocess.run(["g++", *STRICT, *modes, f"-I{folder}", "-x", "c++-header", begin, "-o", own], check=True)
        own.replace(made)
    return "-Winvalid-pch", "-include", str(begin)


def compiled(compiler: str, folder: Path, name: str, *options: str) -> None:
    """A unit, without a warning. What clang has to say it knows before it makes code."""
    if compiler.startswith("clang"):
        options = (*options, "-fsyntax-only")
    command = [compiler, *STRICT, *options, "-I.", "-c", f"{name}.cpp", "-o", f"{name}.{compiler}.o"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert not done.stderr
