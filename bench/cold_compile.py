"""Run as a program: compile one mapping or type in this new process, stage by stage; prints the milliseconds of each as JSON.

`python -m bench.cold_compile MAPPING BACKEND`. The stages are those of the pipeline; what they import counts as import.
"""

from __future__ import annotations

import json
import sys
import time
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Generator

    from rosetta_jit.pipeline.request import Backend

STAGES = ("import", "import numba", "parse and check", "lower", "verify", "numba", "LLVM", "load")


class Clock:
    """Milliseconds by stage. What an inner stage takes is not the outer one's."""

    def __init__(self) -> None:
        self.ms: dict[str, float] = dict.fromkeys(STAGES, 0.0)
        self._inner = [0.0]

    @contextmanager
    def stage(self, name: str) -> Generator[None]:
        started = time.process_time()
        self._inner.append(0.0)
        yield
        took = 1000 * (time.process_time() - started)
        self.ms[name] += took - self._inner.pop()
        self._inner[-1] += took

    def timed(self, name: str, function: Callable[..., Any]) -> Callable[..., Any]:
        """The same function, its time counted for a stage."""

        def timed(*arguments: Any, **options: Any) -> Any:
            with self.stage(name):
                return function(*arguments, **options)

        return timed


def main(mapping: str, backend: Backend) -> dict[str, float]:
    clock = Clock()
    with clock.stage("import"):
        from rosetta_jit.api import loading
        from rosetta_jit.kernel.passes import order as passes
        from rosetta_jit.pipeline.build import Build
        from rosetta_jit.pipeline.request import Request
    if backend == "numba":
        with clock.stage("import numba"):
            from rosetta_jit.backends.numba import function as numba
        numba.typed, numba.library = clock.timed("numba", numba.typed), clock.timed("numba", numba.library)
    passes.verify = clock.timed("verify", passes.verify)
    build = Build(Request("decode", mapping=mapping, encoding="yarp3", backend=backend))
    with clock.stage("parse and check"):
        _ = build.types
    with clock.stage("lower"):
        _ = build.text
    with clock.stage("LLVM"):
        image = build.image()
    with clock.stage("load"):
        loading.library(image, build.header)
    return clock.ms


if __name__ == "__main__":
    print(json.dumps(main(sys.argv[1], "numba" if sys.argv[2] == "numba" else "llvm")))
