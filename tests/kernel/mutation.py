"""The campaign against mutants: each is run through the probes in a process of its own, until one of them notices it.

    python -m tests.kernel.mutation [--slice K/N] [--refusals] [WORD…]

prints what became of each mutant, and a table. Survivors are explained in `survivors.txt`, one a line: why no probe can notice it. The
campaign fails where one is not explained, and where one that is explained is killed.
"""

from __future__ import annotations

import argparse
import importlib.machinery
import importlib.util
import os
import pickle
import resource
import sys
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np  # noqa: F401 - so that each process has it already

from tests.kernel.mutants import MODULES, ROOT, Mutant, mutants, path_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

SURVIVORS = ROOT / "tests/kernel/survivors.txt"
MOST_SECONDS = 60
"""CPU time after which a mutant counts as killed: it hangs."""
SHARE = 4
"""Of the mutants that change what is known or asked one in so many is run; of those that demand less, all."""
MAPPINGS = {
    "yarp/icub/torso_state.mapping": "yarp3",
    "yarp/icub/camera_image.mapping": "yarp3",
    "ros1/joint_positions.mapping": "ros1",
    "ros1/joint_state.mapping": "ros1",
    "ros1/polygon.mapping": "ros1",
}


@dataclass(frozen=True)
class Outcome:
    """The probe that noticed a mutant; None where none did."""

    mutant: Mutant
    killer: str | None


def chosen(modules: Iterable[str] = MODULES) -> list[Mutant]:
    """The campaign's mutants; of two of one name the first."""
    found: dict[str, Mutant] = {}
    for module in modules:
        for mutant in mutants(module, SHARE):
            found.setdefault(mutant.name, mutant)
    return list(found.values())


def explanations() -> dict[str, str]:
    """Why survivors survive, by their names."""
    lines = [line for line in SURVIVORS.read_text().splitlines() if line and not line.startswith("#")]
    return {name: why for why, _, name in (line.partition(" | ") for line in lines)}


# --- one mutant --------------------------------------------------------------------------------------------------------


class Expected:
    """What the probes say without a mutant. Made in processes of their own, so that this one knows nothing of what is mutated.

    Where only ``refusals`` are asked for, what they say is known.
    """

    def __init__(self, *, refusals: bool = False) -> None:
        self.refusals = refusals
        self.corpus = b"" if refusals else _apart(_lowered)
        self.results: dict[str, str] = pickle.loads(_apart(lambda: pickle.dumps(dict(self._probes()))))  # noqa: S301 - our own
        assert "unsound" not in " ".join(self.results.values())

    def _probes(self) -> Iterator[tuple[str, str]]:
        from tests.kernel import kernels, probes
        from tests.kernel.unsafe import ACCEPTED

        yield from probes.refusals()
        if not self.refusals:
            yield from probes.theorems()
            yield from probes.products()
            yield from probes.owed({**kernels.ALL, **{f"safe twin of {name}": kernel for name, kernel in ACCEPTED.items()}})
            yield from probes.less()
            yield from probes.orders()
            yield from probes.texts()
            yield from probes.outcomes()
            yield from probes.corpus(self.corpus)

    def run(self, mutant: Mutant) -> Outcome:
        """A mutant's fate."""

        def work() -> bytes:
            sys.meta_path.insert(0, _Finder(mutant))
            for name, result in self._probes():
                if self.results[name] != result:
                    return name.encode()
            return b""

        killer = _apart(work).decode()
        return Outcome(mutant, killer or None)


def _lowered() -> bytes:
    """Kernels of shipped mappings as the passes get them."""
    from rosetta_jit.pipeline.build import Build
    from rosetta_jit.pipeline.request import Request

    made = {}
    for mapping, encoding in MAPPINGS.items():
        for direction in ("decode", "encode"):
            made[f"{mapping} {direction}"] = Build(Request(direction, mapping, encoding=encoding))._lowered(direction)
    return pickle.dumps(made)


def _apart(work: Callable[[], bytes]) -> bytes:
    """Do something in a process of its own."""
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reader)
        resource.setrlimit(resource.RLIMIT_CPU, (MOST_SECONDS, MOST_SECONDS))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        try:
            said = work()
        except BaseException as error:  # noqa: BLE001 - whatever a mutant raises kills it
            said = f"raises {type(error).__name__}: {error}"[:200].encode()
        with os.fdopen(writer, "wb") as out:
            out.write(said)
        os._exit(0)
    os.close(writer)
    with os.fdopen(reader, "rb") as given:
        said = given.read()
    _, status = os.waitpid(child, 0)
    return said if os.waitstatus_to_exitcode(status) == 0 else b"takes too long"


class _Finder:
    """Finds one module as a mutant of it."""

    def __init__(self, mutant: Mutant) -> None:
        self.name = mutant.module.removesuffix(".__init__")
        self.mutant = mutant

    def find_spec(self, name: str, _path: object = None, _target: object = None) -> importlib.machinery.ModuleSpec | None:
        if name != self.name:
            return None
        path = path_of(self.mutant.module)
        return importlib.util.spec_from_file_location(name, path, loader=_Loader(name, str(path), self.mutant.source()))


class _Loader(importlib.machinery.SourceFileLoader):
    def __init__(self, name: str, path: str, source: str) -> None:
        super().__init__(name, path)
        self.source = source

    def get_code(self, fullname: str) -> object:  # noqa: ARG002 - importlib's name
        return compile(self.source, self.path, "exec")


# --- all ---------------------------------------------------------------------------------------------------------------


def main(arguments: list[str]) -> int:
    """Run the campaign; gives the exit code."""
    options = argparse.ArgumentParser(prog="python -m tests.kernel.mutation", description="Run mutants of the proof and the passes.")
    options.add_argument("words", nargs="*", help="only mutants whose names and changes contain all of these")
    options.add_argument("--slice", default="0/1", metavar="K/N", help="only each Nth, from the Kth on")
    options.add_argument("--refusals", action="store_true", help="only ask whether unsafe kernels are refused, and safe ones not")
    chosen_options = options.parse_args(arguments)
    number, count = map(int, chosen_options.slice.split("/"))
    some = [each for each in chosen() if all(word in f"{each.change}: {each.name}" for word in chosen_options.words)][number::count]
    expected, why = Expected(refusals=chosen_options.refusals), explanations()
    outcomes = [_told(expected.run(mutant), why, f"{position}/{len(some)}") for position, mutant in enumerate(some, 1)]
    for module in MODULES:
        fates = Counter("survived" if each.killer is None else "killed" for each in outcomes if each.mutant.module == module)
        print(f"{module:<40} {fates['killed']:4} killed {fates['survived']:4} survived")
    survivors = {each.mutant.name for each in outcomes if each.killer is None}
    wrong = survivors - why.keys() | {each.mutant.name for each in outcomes if each.killer is not None and each.mutant.name in why}
    print(f"{len(outcomes)} mutants, {len(survivors)} survivors; the table is wrong about {len(wrong)}")
    return int(bool(wrong))


def _told(outcome: Outcome, why: dict[str, str], progress: str) -> Outcome:
    name = outcome.mutant.name
    if outcome.killer is None:
        print(f"{progress} survived ({why.get(name, 'NOT EXPLAINED')}) | {name}", flush=True)
    else:
        wrongly = "killed, though explained" if name in why else "killed"
        print(f"{progress} {wrongly} by {outcome.killer} | {name}", flush=True)
    return outcome


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
