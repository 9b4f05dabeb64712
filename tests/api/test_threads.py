"""Threads that share decoders, encoders, holders, views and batches get what is right, or `InUse`; none ends the process."""

from __future__ import annotations

import subprocess
import sys

import pytest

from tests.api.sharing import KINDS


def share(kind, seconds):
    command = [sys.executable, "-m", "tests.api.sharing", kind, str(seconds)]
    ended = subprocess.run(command, check=False, capture_output=True, text=True, timeout=seconds + 120)
    assert ended.returncode == 0, f"{ended.returncode}: {ended.stdout}\n{ended.stderr[-3000:]}"


@pytest.mark.parametrize("kind", KINDS)
def test_sharing(kind):
    share(kind, 1.5)


@pytest.mark.campaign
@pytest.mark.parametrize("kind", KINDS)
def test_sharing_for_long(kind):
    share(kind, 120)
