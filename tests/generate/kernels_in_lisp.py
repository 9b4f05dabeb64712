"""Kernels made by hand as Lisp: rows without fields, one row in lane 0, messages that begin at 0; one process runs them all."""

from __future__ import annotations

import atexit
import subprocess
import tempfile
from functools import cache
from itertools import count
from pathlib import Path

import numpy as np

from rosetta_jit.generate.c.holder.lanes import Lane
from rosetta_jit.generate.lisp.functions import About, print_kernel
from rosetta_jit.generate.lisp.lanes import Lanes, lanes_of
from rosetta_jit.generate.lisp.language import codec
from rosetta_jit.kernel.passes.alone import alone
from tests.generate.lisp import COMMAND, begun

CAPACITY = 40
NUMBERS = count()


@cache
def machine():
    """A process of SBCL that has the runtime, and its folder."""
    folder = Path(tempfile.mkdtemp())
    command = [*COMMAND, *(part for form in (*begun(), "(loop (eval (read)))") for part in ("--eval", form))]
    with (folder / "said").open("w") as said:
        process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=said, text=True)
    atexit.register(_end, process)
    return process, folder


def _end(process) -> None:
    process.kill()
    process.communicate()


def asked(form: str) -> str:
    """The line that the process prints for a form."""
    process, folder = machine()
    process.stdin.write(f"{form}\n")
    process.stdin.flush()
    line = process.stdout.readline().rstrip("\n")
    assert line, (folder / "said").read_text()[-2000:]
    return line


@cache
def loaded(kernel):
    """The kernel in the process: its package, its lanes, how many attempts it has, and which of its sites its table has."""
    package, kernel = f"kernel-{next(NUMBERS)}", alone(kernel)
    named = [Lane("message" if k == 0 else f"lane_{k}", "", stride, None) for k, stride in enumerate(kernel.strides)]
    lanes: Lanes = lanes_of(named, len(named))
    printed = print_kernel(kernel, lanes, "decode", About(paths=[f"lane{k}" for k in range(len(named))]))
    path = machine()[1] / f"{package}.lisp"
    path.write_text(f"(in-package #:{package})\n{codec(lanes, spilled=printed.spilled)}\n{printed.text}")
    assert asked(f'(kernel "{package}" "{path}")') == "ready"
    return package, lanes, printed


def outcome(kernel, message: bytes, rows):
    """As `tests.backends.engines.outcome`: of a success the lanes, of a lane that is full its number, of a failure all of it."""
    package, lanes, printed = loaded(kernel)
    sizes = [len(lane) if number else kernel.strides[0] for number, lane in enumerate(rows.lanes)]
    given = " ".join(f'("{name}" {size})' for name, size in zip(lanes.names, sizes, strict=True))
    most = len(rows.lanes[-1]) // kernel.strides[-1]
    said, *parts = asked(f'(run-kernel "{package}" {printed.attempts} {most} \'({given}) "{message.hex()}")').split(" ")
    if said == "ok":
        for lane, part in zip(rows.lanes, parts, strict=True):
            lane[: len(part) // 2] = np.frombuffer(bytes.fromhex(part), np.uint8)
        return (0, [lane.tobytes() for lane in rows.lanes])
    site, at, *indices = map(int, parts[:6])
    if site == 0:
        return (-1, int(parts[6].removeprefix("lane")))
    return (-1 - printed.sites[site], [at, printed.sites[site]], indices)


def seen(result):
    """Of what the interpreter says, that much."""
    if result[0] >= 0:
        return (0, result[2])
    return (-1, result[1][0]) if result[0] == -1 else result
