"""Generated Lisp as programs: one process of SBCL compiles the units of a test and answers for all of them."""

from __future__ import annotations

import os
import shutil
import struct
import subprocess
from hashlib import sha256
from itertools import islice
from pathlib import Path

import numpy as np
import pytest

from rosetta_jit.api import programs
from rosetta_jit.generate.build import generated
from rosetta_jit.generate.lisp.language import runtime
from rosetta_jit.generate.lisp.words import Names
from rosetta_jit.model.layout import WIDTH, Number, Row, Span, Variant, map_entry
from rosetta_jit.model.types import Array, Bool, Bytes, Map, Ref, String, Struct, Union
from tests.generate import driver
from tests.shared import FOLDER, LISP

BOTH = ("decode", "encode")
MAIN = Path(__file__).with_name("driver.lisp")
COMMAND = ("sbcl", "--noinform", "--no-sysinit", "--no-userinit", "--disable-debugger", "--non-interactive")
NUMPY = {"bool": "?", **{f"{kind}{8 * size}": f"<{kind}{size}" for kind in "iu" for size in (1, 2, 4, 8)}, "f32": "<u4", "f64": "<u8"}

QUICKLY = "(sb-ext:without-package-locks (setf (fdefinition 'sb-c::constraint-propagate) (constantly nil)))"
"""Leaves out a pass of SBCL's compiler that optimises alone, and takes three quarters of its time for a unit of many messages."""
TOO_QUICKLY = "IMMEDIATE-CONSTANT"
"""What SBCL's compiler fails to find in some units where it was left out."""

needs_sbcl = pytest.mark.skipif(shutil.which("sbcl") is None, reason="generated Lisp is compiled by SBCL, which is not installed")


def write(folder: Path, texts: dict[str, str]) -> str:
    """The files of a unit; gives the name of its package."""
    for name, text in texts.items():
        (folder / name).write_text(text)
    return next(name for name in texts if name.endswith(".asd"))[:-4]


def run(*forms: str, cwd: Path) -> str:
    """What SBCL prints that evaluates some forms; with its whole compiler, where it needs that."""
    given = [part for form in forms for part in ("--eval", form)]
    done = subprocess.run([*COMMAND, *given], cwd=cwd, capture_output=True, text=True, check=False)
    if done.returncode != 0 and QUICKLY in forms and TOO_QUICKLY in done.stdout + done.stderr:
        return run(*(form for form in forms if form != QUICKLY), cwd=cwd)
    assert done.returncode == 0, done.stderr[-3000:]
    return done.stdout


def begun() -> list[str]:
    """Forms for SBCL to evaluate before others: they load the driver and the runtime of all units."""
    return [f'(load "{MAIN}")', f'(runtime "{compiled_runtime()}")']


def compiled_runtime() -> Path:
    """The runtime, compiled by the first process of a run of tests that comes to it."""
    text = runtime("runtime")
    made = Path(os.environ[FOLDER]) / LISP / f"{sha256(text.encode()).hexdigest()}.fasl"
    if not made.exists():
        made.parent.mkdir(exist_ok=True)
        own = made.with_name(f"{os.getpid()}.lisp")
        own.write_text(text)
        run(f'(load "{MAIN}")', f'(load-source "{own}")', cwd=made.parent)
        own.with_suffix(".fasl").replace(made)
    return made


def answers(folder: Path, asked: list[tuple[object, list[bytes]]], *before: str) -> list[list[str]]:
    """What units say of messages: for each request and its messages the lines; ``before`` are forms for SBCL to evaluate first."""
    forms = [*before, *begun()]
    for number, (request, messages) in enumerate(asked):
        package = write(folder, generated(request, "lisp", BOTH, f"unit_{number}"))
        (folder / f"{package}.messages").write_bytes(b"".join(struct.pack("<I", len(message)) + message for message in messages))
        forms += [f'(unit "{folder}/" "{package}")', f'(answers "{package}" "{package}.messages")']
    lines = iter(run(*forms, cwd=folder).split("\n")[:-1])
    return [list(islice(lines, len(messages))) for _, messages in asked]


def expected(request, decode, encode, messages: list[bytes]) -> list[str]:
    """What the library says of messages, with their values."""
    shown, found = Shown(request), list[str]()
    for message in messages:
        line = driver.expected(decode, encode, message)
        found.append(f"{line} {shown.of(decode(message))}" if line.startswith("ok ") else line)
    return found


class Shown:
    """The values of the library's holders, in the form that the driver prints."""

    def __init__(self, request) -> None:
        build = programs.build_of(request)
        self.layout, self.schema, self.root = build.layout, build.types.schema, Ref(build.types.holder.name)

    def of(self, holder) -> str:
        return self.value(self.root, self.layout.root, holder.lanes_, 0, 0)

    def scalar(self, lanes, lane: int, row: int, offset: int, scalar: str):
        at = row * self.layout.lanes[lane].stride + offset
        return lanes.buffers[lane][at : at + WIDTH[scalar]].view(NUMPY[scalar])[0]

    def number(self, lanes, lane: int, row: int, offset: int, scalar: str) -> str:
        found = self.scalar(lanes, lane, row, offset, scalar)
        if scalar == "bool":
            return "t" if found else "nil"
        if scalar[0] != "f":
            return str(int(found))
        is_number = not np.isnan(found.view(f"<f{WIDTH[scalar]}"))
        return f"#{int(found):x}" if is_number else "nan"

    def value(self, type_, slot, lanes, lane: int, row: int) -> str:
        resolved = self.schema.resolve(type_)
        match resolved, slot:
            case _, Number(offset, scalar):
                return self.number(lanes, lane, row, offset, scalar)
            case Struct(_, fields), Row():
                parts = [self.member(each.type, member, slot, lanes, lane, row) for each, member in zip(fields, slot.members, strict=True)]
                return f"({' '.join(parts)})"
            case Union(_, cases), Variant():
                which = int(self.scalar(lanes, lane, row, slot.offset, "i64"))
                if which == 0:
                    return "nil"
                scope = Names(frozenset())
                names = [scope.symbol(each.name) for each in cases]
                return f"<{names[which - 1]} {self.value(cases[which - 1].type, slot.members[which - 1].slot, lanes, lane, row)}>"
            case _, Span():
                start, count = (int(self.scalar(lanes, lane, row, slot.offset + by, "i64")) for by in (0, 8))
                return self.span(type_, resolved, slot.lane, lanes, start, count)
        raise AssertionError(type_)

    def member(self, type_, member, slot, lanes, lane: int, row: int) -> str:
        if member.presence is None:
            return self.value(type_, member.slot, lanes, lane, row)
        word, bit = divmod(member.presence, 64)
        there = int(self.scalar(lanes, lane, row, slot.offset + 8 * word, "u64")) >> bit & 1
        absent = "absent" if isinstance(self.schema.resolve(type_.value), Bool) else "nil"
        return self.value(type_.value, member.slot, lanes, lane, row) if there else absent

    def span(self, type_, resolved, lane: int, lanes, start: int, count: int) -> str:
        element = self.layout.lanes[lane].element
        stride = self.layout.lanes[lane].stride
        match resolved:
            case Struct():
                return self.value(type_, element, lanes, lane, start) if count else "nil"
            case String(encoding):
                data = bytes(lanes.buffers[lane][start * stride : (start + count) * stride])
                text = data.decode("utf-16-le", "surrogatepass") if encoding == "utf-16" else data.decode("utf-8", "surrogateescape")
                return f'"{".".join(str(ord(char)) for char in text)}"'
            case Bytes():
                return f"[{' '.join(map(str, lanes.buffers[lane][start : start + count]))}]"
            case Array(inner):
                return f"[{' '.join(self.value(inner, element, lanes, lane, row) for row in range(start, start + count))}]"
            case Map(key, value):
                entry = map_entry(key, value)
                found = {}
                for row in range(start, start + count):
                    parts = [
                        self.value(each.type, member.slot, lanes, lane, row)
                        for each, member in zip(entry.fields, element.members, strict=True)
                    ]
                    found[parts[0]] = parts[1]
                return "{" + " ".join(sorted(f"{key}:{value}" for key, value in found.items())) + "}"
        raise AssertionError(type_)
