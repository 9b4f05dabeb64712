"""The tests of all frameworks, and of the nine operations, with every decoder and encoder in generated C.

The operations are tested in each backend, and whichever it is here all runs in C: one is enough.
"""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.generate.driver import needs_gcc

ROOT = Path(__file__).resolve().parents[2]
FRAMEWORKS = ("yarp", "protobuf", "ros", "omg", "lcm", "orocos")
FOLDERS = [*(pytest.param(f"frameworks/{name}", "", marks=pytest.mark.campaign) for name in FRAMEWORKS), ("operations", "python")]


@needs_gcc
@pytest.mark.parametrize(("folder", "only"), FOLDERS)
def test_they_pass(folder, only):
    command = [sys.executable, "-m", "pytest", "-q", "-m", "not campaign", "-k", only, "-p", "tests.generate.through_c", f"tests/{folder}"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout[-5000:]
    assert int(re.search(r"'in C': (\d+)", done.stdout)[1]) > 0
