"""How long each mapping takes to be ready, measured in processes of their own: one with an empty cache, then one that finds it full.

Run as a program, with ``cold`` or ``warm`` as argument, it prints milliseconds by mapping and dialect as JSON.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from typing import cast

from rosetta_jit.demo.streams import DIALECTS, MAPPINGS


def start_times_ms() -> tuple[dict[str, float], dict[str, float]]:
    """Cold and warm milliseconds by `start_key`: the second process finds what the first one compiled."""
    with tempfile.TemporaryDirectory() as folder:
        environment = {**os.environ, "ROSETTA_JIT_CACHE_DIR": os.path.join(folder, "cache")}  # noqa: PTH118 - one join
        environment.pop("ROSETTA_JIT_CACHE", None)
        return _run(environment), _run(environment)


def start_key(mapping: str, dialect: str) -> str:
    """What both sides of the pipe call a mapping in a dialect."""
    return f"{mapping} {dialect}"


def _run(environment: dict[str, str]) -> dict[str, float]:
    command = [sys.executable, "-m", "rosetta_jit.demo.start"]
    output = subprocess.run(command, env=environment, check=True, stdout=subprocess.PIPE, text=True).stdout  # noqa: S603 - our own module
    return cast("dict[str, float]", json.loads(output))


def _measure() -> dict[str, float]:
    import rosetta_jit

    times: dict[str, float] = {}
    for mapping in dict.fromkeys(MAPPINGS.values()):
        for dialect in DIALECTS:
            started = time.perf_counter()
            rosetta_jit.Decoder(mapping, encoding=dialect)
            times[start_key(mapping, dialect)] = 1000 * (time.perf_counter() - started)
    return times


if __name__ == "__main__":
    sys.stdout.write(json.dumps(_measure()))
