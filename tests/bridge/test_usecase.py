"""The use case, in short: a component on RSB moves a simulated iCub on YARP, and sees it move."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

import tests.usecase.__main__ as usecase
from tests.usecase.page import write

POSES = ((0.3, 0.0, 0.1), (-0.2, 0.1, 0.2))


def check(seen, snapshot, folder):
    assert len(seen.angles) > 50
    assert seen.images > 5
    turn = seen.commands[1][0]
    before = [angles for time, angles in seen.angles if time < turn]
    for joint in range(3):
        assert before[-1][joint] == pytest.approx(POSES[0][joint], abs=0.1)
        assert seen.angles[-1][1][joint] == pytest.approx(POSES[1][joint], abs=0.1)
    column = 80 + round(seen.angles[-1][1][0] * 180 / 3.141592653589793)
    assert seen.image.shape == (120, 160, 3)
    assert tuple(seen.image[60, column]) == (255, 120, 0)  # the arm
    assert all(not each["failed"] and not each["dropped"] for each in snapshot)
    assert snapshot[2]["sent"] == 2
    write(folder / "index.html", seen, snapshot, "test")
    assert "<polyline" in (folder / "index.html").read_text()


def test_on_ports_of_ours(tmp_path, monkeypatch):
    monkeypatch.setattr(usecase, "POSES", POSES)
    check(*usecase.play(2.0, None), tmp_path)


@pytest.mark.skipif(not os.environ.get("YARP_DIR"), reason="YARP is not built: `make yarp`")
def test_on_the_real_yarp(tmp_path, monkeypatch):
    build = usecase.built(Path(tmp_path / "simulator"))
    if build is None:
        pytest.skip("no CMake, or no YARP that it can build with where YARP_DIR says")
    monkeypatch.setattr(usecase, "POSES", POSES)
    check(*usecase.play(2.0, build), tmp_path)
