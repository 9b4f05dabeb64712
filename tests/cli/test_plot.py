"""`rosetta-jit plot`: what it draws in a terminal, which pictures it makes, and what it says of fields that are none."""

from __future__ import annotations

import io
import sys
from pathlib import Path

import numpy as np
import pytest
from mcap.writer import Writer

import rosetta_jit as rj
from rosetta_jit.api.encoder import Encoder
from rosetta_jit.cli import main
from rosetta_jit.cli.drawing import drawn
from rosetta_jit.logs import curves
from rosetta_jit.logs.curves import Curve, curve_of

ARM = f"""Joint[] joints
float64[2] pair # both [m]
float64 plain
{"=" * 80}
MSG: t/Joint
float64 angle # of the joint [rad]
"""
DRIVE = Path(rj.__file__).parent / "demo" / "recordings" / "drive.bag"


def test_text(monkeypatch, capsys):
    monkeypatch.setenv("COLUMNS", "60")
    assert main(["plot", str(DRIVE), "/imu.angular_velocity.z", "/joint_states.position[1]"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert (lines[0], lines[12]) == ("/imu.angular_velocity.z", "/joint_states.position[1]")
    assert lines[1].startswith("       0.5 ")
    assert lines[-1] == "0 s is 2023-11-14T22:13:20.000250000Z"
    assert all(len(line) <= 60 for line in lines)
    assert any("\u2800" < letter < "\u28ff" for letter in lines[1])


def test_terminals_without_braille(monkeypatch):
    out = io.TextIOWrapper(io.BytesIO(), encoding="ascii")
    monkeypatch.setattr(sys, "stdout", out)
    assert main(["plot", str(DRIVE), "/joint_states.position[1]"]) == 0
    out.flush()
    assert b"****" in out.buffer.getvalue()


def test_a_line_is_drawn_where_its_values_are():
    times = np.arange(4) * 10**9
    lines = drawn(Curve("x", times, np.array([0.0, 1, 2, 3])), (0, 3 * 10**9), 11 + 5, 4, braille=False)
    assert lines == ["x", "         3    *", "             *", "            *", "         0 *", "           0 3 s"]
    assert drawn(Curve("x", times, np.full(4, np.nan)), (0, 1), 40, 4, braille=True)[1].strip() == "no values"


@pytest.mark.parametrize("suffix", [".png", ".svg"])
def test_pictures(tmp_path, capsys, suffix):
    path = tmp_path / f"a{suffix}"
    assert main(["plot", str(DRIVE), "/imu.angular_velocity.z", "/imu.orientation.w", "-o", str(path)]) == 0
    assert path.read_bytes()[:5] in (b"\x89PNG\r", b"<?xml")
    assert "2 curves" in capsys.readouterr().out
    assert main(["plot", str(DRIVE), "/imu.orientation.w", "-o", "a.gif"]) == 2


@pytest.fixture
def arms(tmp_path):
    """A log of one message whose definition says units."""
    encode = Encoder.of("t/msg/Arm", encoding="cdr", schema=ARM)
    path = tmp_path / "arms.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        channel = writer.register_channel("/arm", "cdr", writer.register_schema("t/msg/Arm", "ros2msg", ARM.encode()))
        message = encode({"joints": [{"angle": 1.0}, {"angle": 2.0}], "pair": [1.0, 2.0], "plain": 3.0})
        writer.add_message(channel, log_time=1, publish_time=1, data=message)
        writer.finish()
    return path


UNITS = {"joints[1].angle": "rad", "pair[1]": "m", "plain": None}


@pytest.mark.parametrize(("field", "unit"), UNITS.items())
def test_units_are_shown_where_the_schema_says_them(arms, field, unit, capsys):
    name = f"/arm.{field}"
    assert main(["plot", str(arms), name]) == 0
    assert capsys.readouterr().out.splitlines()[0] == (name if unit is None else f"{name}, {unit}")


def test_the_axis_of_a_picture_shows_the_unit(arms, tmp_path):
    path = tmp_path / "a.svg"
    assert main(["plot", str(arms), "/arm.joints[1].angle", "-o", str(path)]) == 0
    assert "<!-- rad -->" in path.read_text()


@pytest.mark.parametrize(
    ("field", "said"),
    [
        ("/imu.angular_velocity.q", "did you mean `angular_velocity.z`?"),
        ("/imu.header.frame_id", "have no number `header.frame_id`"),
        ("/imu.header", "have no number"),
        ("/imu.angular_velocity[0]", "have no number"),
        ("/joint_states.name[0]", "have no number"),
        ("/nothing.x", "no topic `/nothing`"),
        ("/imu", "no topic"),
    ],
)
def test_what_is_no_number(field, said, capsys):
    assert main(["plot", str(DRIVE), field]) == 1
    assert said in capsys.readouterr().err


def test_values(monkeypatch):
    """Those of columns, also through a mapping; NaN where a message has too few elements; and of many points the extremes."""
    log = rj.open(DRIVE)
    imu = log["/imu"]["angular_velocity.z"]
    assert np.array_equal(curve_of(log, "/imu.angular_velocity.z", None).values, imu)
    assert np.isnan(curve_of(log, "/joint_states.position[5]", None).values).all()
    assert np.array_equal(curve_of(log, "/imu.angular_velocity_covariance[4]", None).values, np.zeros(400))
    states = "ros1/joint_positions.mapping"
    wanted = curve_of(log, "/joint_states.position[1]", None).values.astype(np.float32)
    assert np.array_equal(curve_of(log, "/joint_states.joints[1].value", states).values.astype(np.float32), wanted)
    late = curve_of(log, "/imu.angular_velocity.z", None, log.start + 10**9, log.start + 2 * 10**9)
    assert len(late.values) == 100
    monkeypatch.setattr(curves, "POINTS", 100)
    few = curve_of(log, "/imu.angular_velocity.z", None)
    assert len(few.values) <= 100
    assert (few.values.min(), few.values.max()) == (imu.min(), imu.max())
    assert (np.diff(few.times_ns) > 0).all()
