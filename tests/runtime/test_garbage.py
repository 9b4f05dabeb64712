"""While programs are made, garbage is looked for seldom; afterwards as the process had it."""

from __future__ import annotations

import gc
import subprocess
import sys

import pytest

from rosetta_jit.startup.garbage import SELDOM, seldom_collected


@pytest.fixture(autouse=True)
def as_it_was():
    before = gc.get_threshold()
    yield
    gc.set_threshold(*before)


def test_thresholds_come_back():
    before = gc.get_threshold()
    with seldom_collected():
        assert gc.get_threshold() == (SELDOM, *before[1:])
        with seldom_collected():
            assert gc.get_threshold() == (SELDOM, *before[1:])
        assert gc.get_threshold() == (SELDOM, *before[1:])
    assert gc.get_threshold() == before


def test_thresholds_come_back_from_a_failure():
    before = gc.get_threshold()
    with pytest.raises(KeyError), seldom_collected():
        raise KeyError
    assert gc.get_threshold() == before


@pytest.mark.parametrize("threshold", [0, SELDOM, 10 * SELDOM])
def test_who_collects_seldom_or_never_is_left_alone(threshold):
    gc.set_threshold(threshold, 5, 5)
    with seldom_collected():
        assert gc.get_threshold() == (threshold, 5, 5)
    assert gc.get_threshold() == (threshold, 5, 5)


IMPORTS = """
import gc
import subprocess
import sys
from rosetta_jit.startup.garbage import imported
FREEZE
has_frozen = gc.get_freeze_count() > 0
module = imported("rosetta_jit.model.expr")
assert any(each is module for each in gc.get_objects(generation=2)) == (not has_frozen)
assert (gc.get_freeze_count() > 0) == has_frozen
assert imported("rosetta_jit.model.expr") is module and gc.isenabled()
"""


@pytest.mark.parametrize("freeze", ["", "gc.freeze()"])
def test_what_is_imported_is_old_at_once(freeze):
    subprocess.run([sys.executable, "-c", IMPORTS.replace("FREEZE", freeze)], check=True)


COUNTS = """
import gc
from rosetta_jit.startup.garbage import imported
FREEZE
counted = []
gc.get_freeze_count = lambda count=gc.get_freeze_count: counted.append(count()) or counted[-1]
for name in ("expr", "rules", "units"):
    imported(f"rosetta_jit.model.{name}")
assert list(map(bool, counted)) == COUNTED, counted
"""


@pytest.mark.parametrize(("freeze", "counted"), [("", [False] * 3), ("gc.freeze()", [True])])
def test_what_a_process_has_frozen_is_counted_once(freeze, counted):
    subprocess.run([sys.executable, "-c", COUNTS.replace("FREEZE", freeze).replace("COUNTED", str(counted))], check=True)
