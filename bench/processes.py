"""New processes, for what a process pays but once."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

SURROUNDINGS = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
"""Our modules are compiled to bytecode once, as an installer has done with numpy's and llvmlite's."""


def took_s(program: str, *arguments: str, **environment: str) -> float:
    """Seconds that a process takes from its start to its end."""
    started = time.perf_counter()
    run("-c", program, *arguments, **environment)
    return time.perf_counter() - started


def run(*arguments: str, **environment: str) -> str:
    """What Python prints."""
    surroundings: Mapping[str, str] = {**SURROUNDINGS, **environment}
    return subprocess.run([sys.executable, *arguments], env=surroundings, check=True, capture_output=True, text=True).stdout
