"""Kernels as an object file for any machine that LLVM knows: nothing of CPython, nothing of this process.

Each kernel is a function ``int64 NAME(uint8 *buffer, int64 begin, int64 end, int64 *state, int64 row)``; the state's words are those of
`kernel.state`.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Mapping

from llvmlite import ir

from rosetta_jit.backends.llvm import function as llvm
from rosetta_jit.kernel.ir import Kernel

PROGRAM = "rosetta_jit.backends.entry.another_machine"
NO_SUCH_PROCESSOR = "is not a recognized processor"
"""So LLVM warns, and goes on with some other one."""


class TargetError(ValueError):
    """A machine that objects cannot be made for; says why."""


def object_for(kernels: Mapping[str, Kernel], triple: str, cpu: str = "") -> bytes:
    """The object file that defines kernels by name.

    Parameters
    ----------
    kernels
        Verified kernels that call no functions of the host.
    triple
        The machine as LLVM names it: ``thumbv7em-none-eabihf``.
    cpu
        One that it has, as ``cortex-m7``; any of the kind by default.

    Raises
    ------
    TargetError
        LLVM knows no such machine, or the kernels do not run on it.
    """
    modules = [_emitted(kernel, name) for name, kernel in kernels.items()]
    path = {"PYTHONPATH": os.pathsep.join(sys.path)}
    command, given = [sys.executable, "-m", PROGRAM], json.dumps([triple, cpu, list(kernels), modules]).encode()
    done = subprocess.run(command, input=given, capture_output=True, check=False, env={**os.environ, **path})  # noqa: S603 - our own program
    said = done.stderr.decode("utf-8", "replace")
    if NO_SUCH_PROCESSOR in said:
        raise TargetError(f"LLVM knows no processor `{cpu}` of it")
    if done.returncode != 0:
        is_said = done.returncode > 0 and said.strip()
        raise TargetError(said.strip().splitlines()[-1] if is_said else "LLVM has failed")
    return done.stdout


def _emitted(kernel: Kernel, name: str) -> str:
    """Not every machine has the calling convention of the attempts behind the first, and none is this one, of which loops' widths are."""
    module = ir.Module(name)
    llvm.emit(module, kernel, name)
    return re.sub(r"preserve_mostcc |, !llvm\.loop !\d+", "", str(module))
