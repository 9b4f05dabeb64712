"""The commands on the shipped mappings and recordings, in processes of their own: nothing stands in for anything."""

from __future__ import annotations

import json
import os
import struct
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

RECORDINGS = Path(__file__).resolve().parents[2] / "rosetta_jit" / "demo" / "recordings"
TORSO = "yarp/icub/torso_state.mapping"
MESSAGE = struct.pack("<ii3d", 266, 3, 10.0, -20.0, 30.0)


@pytest.fixture(scope="module")
def environment(tmp_path_factory):
    return {**os.environ, "ROSETTA_JIT_CACHE_DIR": str(tmp_path_factory.mktemp("cache"))}


@pytest.fixture
def command(environment, tmp_path):
    def run(*arguments, expected=0):
        ran = subprocess.run(
            [sys.executable, "-m", "rosetta_jit", *arguments], env=environment, cwd=tmp_path, capture_output=True, text=True, check=False
        )
        assert ran.returncode == expected, ran.stderr
        return ran

    return run


def test_decode_as_json(command, tmp_path):
    (tmp_path / "message.bin").write_bytes(MESSAGE)
    shown = json.loads(command("decode", TORSO, "message.bin", "--json").stdout)
    assert np.allclose(shown["angles"], np.radians([10, -20, 30]), atol=1e-6)


def test_decode_a_recording_to_arrays(command, tmp_path):
    command("decode", TORSO, str(RECORDINGS / "icub-yarp3" / "torso_state.rec.xz"), "--npz", "out.npz")
    with np.load(tmp_path / "out.npz") as columns:
        assert any(columns[name].size == 1500 for name in columns.files)


def test_encode_is_the_inverse(command, tmp_path):
    (tmp_path / "values.json").write_text(json.dumps({"angles": [0.0, 0.0, 0.0]}))
    command("encode", TORSO, "values.json", "--encoding", "yarp4", "-o", "out.bin")
    assert (tmp_path / "out.bin").read_bytes() == struct.pack("<ii3d", 276, 3, 0, 0, 0)


def test_values_of_a_type_that_a_file_declares(command, tmp_path):
    (tmp_path / "own.proto").write_text('syntax = "proto3"; package mine; message Spot { double x = 1; string name = 2; }')
    (tmp_path / "values.json").write_text(json.dumps({"x": 1.5, "name": "a"}))
    command("encode", "mine.Spot", "values.json", "--import", "own.proto", "-o", "out.bin")
    assert (tmp_path / "out.bin").read_bytes() == b"\x09" + struct.pack("<d", 1.5) + b"\x12\x01a"
    assert json.loads(command("decode", "mine.Spot", "out.bin", "--json", "--import", "own.proto").stdout) == {"x": 1.5, "name": "a"}
    assert "--import" in command("decode", "mine.Spot", "out.bin", expected=1).stderr
    assert "needless-option" in command("decode", TORSO, "out.bin", "--import", "own.proto", expected=1).stderr


def test_what_peers_do_otherwise_is_said_by_name(command, tmp_path):
    """In all commands that make programs: byte orders, and what is forgiven."""
    message = bytes([0, 0, 0, 0, 255])
    (tmp_path / "values.json").write_text(json.dumps({"data": 258}))
    (tmp_path / "bool.bin").write_bytes(message)
    command("encode", "std_msgs/msg/Int32", "values.json", "--byte-order", "big", "-o", "big.bin")
    assert (tmp_path / "big.bin").read_bytes() == struct.pack(">4xi", 258)
    assert "constant" in command("decode", "std_msgs/msg/Bool", "bool.bin", expected=1).stderr
    assert json.loads(command("decode", "std_msgs/msg/Bool", "bool.bin", "--lenient", "bool", "--json").stdout) == {"data": True}
    assert "it can forgive bool" in command("dump", "std_msgs/msg/Bool", "--lenient", "foo", expected=1).stderr
    command("cache", "warm", "std_msgs/msg/Bool", "--lenient", "bool", "--lenient", "trailing", "--byte-order", "big", "--jobs", "1")
    command("generate", "std_msgs/msg/Int32", "--byte-order", "big", "--lenient", "trailing", "--language", "python", "--name", "number")
    said = "import number; print(number.decode(bytes([0, 0, 0, 0, 0, 0, 1, 2, 9])).data)"
    assert subprocess.run([sys.executable, "-c", said], cwd=tmp_path, capture_output=True, text=True, check=True).stdout == "258\n"


def test_encoding_must_be_said_where_it_would_be_a_guess(command, tmp_path):
    (tmp_path / "values.json").write_text(json.dumps({"angles": [0.0, 0.0, 0.0]}))
    ran = command("encode", TORSO, "values.json", "-o", "out.bin", expected=1)
    assert "ambiguous-encoding" in ran.stderr
    assert not (tmp_path / "out.bin").exists()


def test_check_reports_every_mistake(command, tmp_path):
    (tmp_path / "wrong.mapping").write_text(
        'import "rst/kinematics/JointAngles.proto"\nimport "yarp/icub/torso_state.bottle-schema"\n'
        "data-holder: rst.kinematics.JointAngles\nwire-schema: yarp.icub.torso.state\n"
        "unpack-rules:\n  len(.angles) = 3\n  .angles[0] = .yaw\n  .angels[1] = float32(.roll)\n"
    )
    ran = command("check", "wrong.mapping", expected=1)
    assert "angels" in ran.stderr
    assert "wrong.mapping:7" in ran.stderr
    assert "^" in ran.stderr
    assert command("check", TORSO).stdout == ""


def test_infer_drafts_what_decodes(command, tmp_path):
    (tmp_path / "message.bin").write_bytes(MESSAGE)
    drafted = command("infer", "message.bin", "--name", "torso").stdout
    assert drafted.count(":float64") == 3


def test_cut_message_is_reported_and_fails(command, tmp_path):
    (tmp_path / "cut.bin").write_bytes(MESSAGE[:-1])
    ran = command("decode", TORSO, "cut.bin", expected=1)
    assert "truncated" in ran.stderr
    assert ".pitch" in ran.stderr


@pytest.mark.parametrize("stage", ["model", "codec", "kernel", "python", "llvm", "asm"])
def test_dump(command, stage):
    assert len(command("dump", "--stage", stage, TORSO).stdout.splitlines()) > 5


def test_cache_commands(command):
    command("compile", TORSO, "--encoding", "yarp3")
    assert "kernel" in command("cache", "info").stdout.lower() or command("cache", "info").stdout
    command("cache", "verify")


def test_texts_that_are_no_utf_8_are_written_as_they_came(environment, tmp_path):
    (tmp_path / "a.mapping").write_text('import "a.bottle-schema"\ndata-holder: a\nwire-schema: a\nrules:\n.s <-> .s\n')
    (tmp_path / "a.bottle-schema").write_text('"a" (("s" :string))')
    (tmp_path / "a.bin").write_bytes(struct.pack("<4i", 256, 1, 4, 1) + b"\xff")
    arguments = [sys.executable, "-m", "rosetta_jit", "decode", "a.mapping", "a.bin", "--json"]
    ran = subprocess.run(arguments, env={**environment, "PYTHONUTF8": "1"}, cwd=tmp_path, capture_output=True, check=False)
    assert (ran.returncode, ran.stdout) == (0, b'{"s": "\xff"}\n'), ran.stderr


def test_a_folder_stands_for_its_mappings(command, tmp_path):
    for name in ("b", "inner/a"):
        path = tmp_path / "all" / f"{name}.mapping"
        path.parent.mkdir(exist_ok=True, parents=True)
        path.write_text("data-holder: no.Such\n")
    shown = command("check", "--json", "all", expected=1).stdout.splitlines()
    assert [json.loads(line)["mapping"] for line in shown] == ["all/b.mapping", "all/inner/a.mapping"]
    (tmp_path / "none").mkdir()
    assert 'there is no mapping "none"' in command("check", "none", expected=1).stderr
