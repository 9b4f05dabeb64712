"""No test reads or fills the user's own cache. Each run tries the same random examples; `--hypothesis-profile=default` asks for others."""

from __future__ import annotations

import gc
import sys
from collections import Counter
from functools import lru_cache

import pytest
from hypothesis import settings

from rosetta_jit.generate import languages
from rosetta_jit.kernel.passes import order as passes
from rosetta_jit.kernel.printer import to_text
from rosetta_jit.pipeline.build import Build
from rosetta_jit.startup import entry_points
from rosetta_jit.transports import installed as transports

settings.register_profile("reproducible", derandomize=True)
settings.load_profile("reproducible")


@pytest.fixture(scope="session", autouse=True)
def own_cache(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROSETTA_JIT_CACHE_DIR", str(tmp_path_factory.mktemp("kernels")))
        yield


@pytest.fixture(scope="session", autouse=True)
def bytecode_once(tmp_path_factory):
    """Where no bytecode may be written, each interpreter that a test starts would compile our modules anew, which takes half a second."""
    with pytest.MonkeyPatch.context() as patch:
        if sys.dont_write_bytecode:
            patch.delenv("PYTHONDONTWRITEBYTECODE", raising=False)
            patch.setenv("PYTHONPYCACHEPREFIX", str(tmp_path_factory.mktemp("bytecode")))
        yield


@pytest.fixture(scope="session", autouse=True)
def proven_once():
    """Programs of several backends have the same kernels: each is proven once a process. Tests of the proof do not come this way."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Build, "_optimised", lambda build, kernel: optimised(Lowered(kernel, to_text(kernel))))  # noqa: ARG005 - a method
        yield


class Lowered:
    """A kernel that is known by its text: 0.0 and -0.0 are equal, but not the same."""

    def __init__(self, kernel, text):
        self.kernel, self.text = kernel, text

    def __hash__(self):
        return hash(self.text)

    def __eq__(self, other):
        return self.text == other.text


@lru_cache(maxsize=200)
def optimised(lowered):
    return passes.run(lowered.kernel)


@pytest.fixture(scope="module", autouse=True)
def little_to_collect():
    """Tests that ask for a collection wait for what their module has made, and not for all that the modules before it have."""
    gc.freeze()


@pytest.fixture
def offers_anew():
    """What installed packages offer is looked for again by the test, and forgotten behind it."""

    def forget():
        for known in (entry_points.offered, languages.installed, transports.installed):
            known.cache_clear()

    forget()
    yield
    forget()


def pytest_terminal_summary(terminalreporter):
    """What was left out, and why: `make peers` and the extras of pyproject.toml install the most of it."""
    skipped = terminalreporter.stats.get("skipped", ())
    reasons = Counter(report.longrepr[2].removeprefix("Skipped: ") for report in skipped if isinstance(report.longrepr, tuple | list))
    if reasons:
        terminalreporter.section("left out")
    for reason, count in sorted(reasons.items()):
        terminalreporter.write_line(f"{count:4}  {reason}")
