"""New processes, for what a process pays but once."""

from __future__ import annotations

import os
import resource
import subprocess
import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

SURROUNDINGS = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
"""Our modules are compiled to bytecode once, as an installer has done with numpy's and llvmlite's."""


def took_s(program: str, *arguments: str, **environment: str) -> float:
    """Seconds that a process has a processor, from its start to its end: what others do meanwhile does not count."""
    before = _of_children_s()
    run("-c", program, *arguments, **environment)
    return _of_children_s() - before


def _of_children_s() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def run(*arguments: str, **environment: str) -> str:
    """What Python prints."""
    surroundings: Mapping[str, str] = {**SURROUNDINGS, **environment}
    return subprocess.run([sys.executable, *arguments], env=surroundings, check=True, capture_output=True, text=True).stdout
