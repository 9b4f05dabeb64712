"""No test reads or fills the user's own cache. Each run tries the same random examples; `--hypothesis-profile=default` asks for others."""

from __future__ import annotations

import gc
import os
import pickle
import sys
from collections import Counter, OrderedDict
from contextlib import suppress
from hashlib import sha256
from pathlib import Path
from shutil import rmtree
from threading import get_ident

import pytest
from hypothesis import settings

from rosetta_jit.generate import languages
from rosetta_jit.generate.build import AheadOfTime, InRounds
from rosetta_jit.kernel.printer import to_text
from rosetta_jit.pipeline.build import Build
from rosetta_jit.startup import entry_points, garbage
from rosetta_jit.transports import installed as transports
from tests.shared import FOLDER, HEADERS

settings.register_profile("reproducible", derandomize=True)
settings.load_profile("reproducible")


@pytest.fixture(scope="session")
def of_all_processes(tmp_path_factory):
    """A folder that pytest's processes share: workers of xdist, and those that a test starts to run tests in another way."""
    with pytest.MonkeyPatch.context() as patch:
        if FOLDER not in os.environ:
            own = tmp_path_factory.getbasetemp()
            patch.setenv(FOLDER, str(own.parent if "PYTEST_XDIST_WORKER" in os.environ else own))
        yield Path(os.environ[FOLDER])


@pytest.fixture(scope="session", autouse=True)
def own_cache(of_all_processes):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROSETTA_JIT_CACHE_DIR", str(of_all_processes / "kernels"))
        yield


@pytest.fixture(scope="session", autouse=True)
def bytecode_once(of_all_processes):
    """Where no bytecode may be written, each interpreter that a test starts would compile our modules anew, which takes half a second."""
    with pytest.MonkeyPatch.context() as patch:
        if sys.dont_write_bytecode:
            patch.delenv("PYTHONDONTWRITEBYTECODE", raising=False)
            patch.setenv("PYTHONPYCACHEPREFIX", str(of_all_processes / "bytecode"))
        yield


@pytest.fixture(scope="session", autouse=True)
def proven_once(of_all_processes):
    """Programs of several backends, and of several languages, have the same kernels: each is improved and proven by the first process
    that comes to it.

    Tests of the proof do not come this way.
    """
    folder = of_all_processes / "proven"
    folder.mkdir(exist_ok=True)

    known = OrderedDict()

    def sharing(optimised):
        def once(build, kernel):
            # By its text: 0.0 and -0.0 are equal, but not the same.
            name = sha256(f"{passes_of(build)} {build.types.rules is None} {to_text(kernel)}".encode()).hexdigest()
            made = known.get(name)
            if made is None:
                made = known[name] = read_or_written(folder / name, lambda: optimised(build, kernel))
                if len(known) > 200:
                    with suppress(KeyError):  # another thread has removed it
                        known.popitem(last=False)
            return made

        return once

    with pytest.MonkeyPatch.context() as patch:
        for each in (Build, AheadOfTime):
            patch.setattr(each, "_optimised", sharing(each._optimised))
        yield


@pytest.fixture(scope="session", autouse=True)
def seldom_collected():
    """A search for garbage looks at much that pytest and the tests have made, and runs a function of hypothesis besides.

    Each import of one of our modules would count all that `little_to_collect` has put aside.
    """
    gc.set_threshold(50_000, 20, 20)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(garbage, "_call_all_old", lambda: None)
        yield


def passes_of(build):
    """What is done with the kernels of a program, as text: the rounds that Python makes objects in depend on the layout besides."""
    if not isinstance(build, AheadOfTime):
        return ""
    return " ".join([*(each.__qualname__ for each in build._passes()), repr(build.layout) if isinstance(build, InRounds) else ""])


def read_or_written(path, make):
    """What a process has written there, or what ``make`` makes, for the others."""
    if path.exists():
        return pickle.loads(path.read_bytes())  # noqa: S301 - ours
    made, own = make(), path.with_name(f"{path.name}.{os.getpid()}.{get_ident()}")
    own.write_bytes(pickle.dumps(made))
    own.replace(path)
    return made


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


def pytest_unconfigure(config):
    """What `tests.generate.cpp.read_once` keeps is large, and of no use to another run."""
    if "PYTEST_XDIST_WORKER" not in os.environ:
        rmtree(config._tmp_path_factory.getbasetemp() / HEADERS, ignore_errors=True)


def pytest_terminal_summary(terminalreporter):
    """What was left out, and why: `make peers` and the extras of pyproject.toml install the most of it."""
    skipped = terminalreporter.stats.get("skipped", ())
    reasons = Counter(report.longrepr[2].removeprefix("Skipped: ") for report in skipped if isinstance(report.longrepr, tuple | list))
    if reasons:
        terminalreporter.section("left out")
    for reason, count in sorted(reasons.items()):
        terminalreporter.write_line(f"{count:4}  {reason}")
