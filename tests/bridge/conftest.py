"""What tests of bridges share: bridges that run until their test ends, and messages for them."""

from __future__ import annotations

import pytest

import rosetta_jit as rj
from rosetta_jit.bridge.checking import checked
from rosetta_jit.bridge.running import Running
from tests.bridge.routes import TORSO


@pytest.fixture(scope="module")
def bottles():
    encode = rj.Encoder(TORSO, encoding="yarp4")
    return [encode({"angles": [float(number), 0.0, 1.0]}) for number in range(100)]


@pytest.fixture
def run(tmp_path):
    """Runs a file, given as text, until the test ends; gives the bridge and what it has said."""
    bridges = []

    def start(configuration):
        (tmp_path / "bridge.toml").write_text(configuration)
        said = []
        bridges.append(Running(checked(str(tmp_path / "bridge.toml")), said.append))
        bridges[-1].start()
        return bridges[-1], said

    yield start
    for each in bridges:
        each.stop(0.2)
