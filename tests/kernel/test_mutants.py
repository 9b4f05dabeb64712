"""Mutants of the proof and of the passes: each is noticed, or it is explained why nobody can notice it."""

from __future__ import annotations

import subprocess
import sys

import pytest

from tests.golden import GOLDEN, check_golden
from tests.kernel import mutation, probes


def test_probes_say_what_they_said():
    """The prover is as strong as it was, and sound; each pass makes of a kernel what it made."""
    text = probes.golden_text()
    assert "unsound" not in text
    check_golden(GOLDEN / "kernel" / "probes.txt", text)


def test_what_kernels_do_survives_the_passes():
    assert {result for _, result in probes.outcomes()} == {"same"}


def test_there_are_mutants():
    every = mutation.chosen()
    assert len(every) >= 200
    assert set(mutation.explanations()) <= {mutant.name for mutant in every}
    assert all(mutation.explanations().values())


def test_a_sample_is_killed():
    """Some of those that do not demand what they should; in a process that has imported nothing of what they change."""
    some = [sys.executable, "-m", "tests.kernel.mutation", "demands nothing", "--refusals", "--slice", "10/16"]
    done = subprocess.run(some, cwd=mutation.ROOT, capture_output=True, text=True, timeout=600, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert " 0 survivors" in done.stdout


@pytest.mark.campaign
def test_all_are_killed_or_explained():
    done = subprocess.run([sys.executable, "-m", "tests.kernel.mutation"], cwd=mutation.ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
