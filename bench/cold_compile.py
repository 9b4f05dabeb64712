"""Run as a program: compile one mapping or type in this new process, stage by stage; prints the milliseconds of each as JSON.

`python -m bench.cold_compile MAPPING BACKEND`. The stages are those of the pipeline; what they import counts as import.
"""

from __future__ import annotations

import json
import sys
import time
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Generator

STAGES = ("import", "import numba", "parse and check", "lower", "verify", "numba", "LLVM", "load")


class Clock:
    """Milliseconds by stage. What an inner stage takes is not the outer one's."""

    def __init__(self) -> None:
        self.ms = dict.fromkeys(STAGES, 0.0)
        self._inner = [0.0]

    @contextmanager
    def stage(self, name: str) -> Generator[None]:
        started = time.perf_counter()
        self._inner.append(0.0)
        yield
        took = 1000 * (time.perf_counter() - started)
        self.ms[name] += took - self._inner.pop()
        self._inner[-1] += took

    def timed(self, name: str, function: Callable[..., object]) -> Callable[..., object]:
        """The same function, its time counted for a stage."""

        def timed(*arguments: object, **options: object) -> object:
            with self.stage(name):
                return function(*arguments, **options)

        return timed


def main(mapping: str, backend: str) -> dict[str, float]:
    clock = Clock()
    with clock.stage("import"):
        from rosetta_jit.backends import link
        from rosetta_jit.lowering import passes
        from rosetta_jit.pipeline import Build
        from rosetta_jit.programs import _linked
        from rosetta_jit.request import Request
    if backend == "numba":
        with clock.stage("import numba"):
            import rosetta_jit.backends.numba  # noqa: F401 - that it is imported is all that is wanted
    passes.verify = clock.timed("verify", passes.verify)
    link._typed = clock.timed("numba", link._typed)
    build = Build(Request("decode", mapping=mapping, encoding="yarp3", backend=backend))
    with clock.stage("parse and check"):
        _ = build.types
    with clock.stage("lower"):
        _ = build.text
    with clock.stage("LLVM"):
        image = build.image()
    with clock.stage("load"):
        _linked(build.header, image)
    return clock.ms


if __name__ == "__main__":
    print(json.dumps(main(*sys.argv[1:])))
