"""`rosetta-jit check` of mappings for messages of ROS 1, as a bag uses them."""

from __future__ import annotations

from pathlib import Path

import pytest
from mcap.writer import Writer

from rosetta_jit import demo
from rosetta_jit.cli import main

BEAT = """import "beat.proto"
import "robot/msg/Beat.msg"
data-holder: b.Beat
wire-schema: robot/Beat
unpack-rules:
  ignore rest
  .x = .x
  .seconds = .at.secs
"""


@pytest.fixture
def beat(tmp_path, monkeypatch):
    """A mapping with a message of ROS 1, which is none of ROS 2: `time` is no type there."""
    monkeypatch.chdir(tmp_path)
    Path("robot/msg").mkdir(parents=True)
    Path("robot/msg/Beat.msg").write_text("time at\nfloat64 x\n")
    Path("beat.proto").write_text('syntax = "proto3"; package b; message Beat { double x = 1; int64 seconds = 2; }')
    Path("beat.mapping").write_text(BEAT)
    return "beat.mapping"


def test_check_says_which_framework_has_no_mistakes(beat, capsys):
    assert main(["check", beat]) == 1
    said = capsys.readouterr().err
    assert "error[type]: `time`" in said
    assert "note[other-framework]: beat.mapping has no mistakes where the files that it imports are read as those of ros1" in said
    assert main(["check", "--framework", "ros1", beat]) == main(["check", "--encoding", "ros1", beat]) == 0
    Path(beat).write_text(BEAT.replace(".x = .x", ".x = .y"))
    assert main(["check", "--json", beat]) == 1
    assert "other-framework" not in capsys.readouterr().out


def test_check_as_a_log_uses_it(beat, capsys):
    log = Path(demo.__file__).parent / "recordings" / "drive.bag"
    assert main(["check", "--log", str(log), beat]) == 0
    assert main(["check", "--log", "none.bag", beat]) == 1
    assert "error[log-unreadable]" in capsys.readouterr().err
    for encodings, said in (((), "does not say how its messages are encoded"), (("cdr", "json"), "in 2 encodings: cdr, json")):
        with Path("some.mcap").open("wb") as file:
            writer = Writer(file)
            writer.start()
            for each in encodings:
                writer.register_channel(f"/{each}", each, 0)
            writer.finish()
        assert main(["check", "--log", "some.mcap", beat]) == 1
        assert said in capsys.readouterr().err


@pytest.mark.parametrize(("option", "code"), [("--encoding", "unknown-encoding"), ("--framework", "unknown-framework")])
def test_check_refuses_what_it_does_not_know(option, code, beat, capsys):
    assert main(["check", option, "ros9", beat]) == 1
    assert f"error[{code}]: there is no {option[2:]} `ros9`" in capsys.readouterr().err
