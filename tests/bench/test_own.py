"""What a mapping of one's own costs, at the command line."""

from __future__ import annotations

import struct

import pytest

from bench import own

MAPPING = "yarp/icub/torso_state.mapping"


@pytest.fixture
def message(tmp_path):
    path = tmp_path / "torso.bin"
    path.write_bytes(struct.pack("<ii3d", 266, 3, 10.0, -20.0, 30.0))
    return path


def test_both_directions_are_measured_beside_their_limits(message, capsys):
    assert own.main([MAPPING, str(message), "--encoding", "yarp3", "--quick"]) == 0
    lines = [line.split(" | ")[0].lstrip("| ") for line in capsys.readouterr().out.splitlines() if line.startswith("| ")]
    decode, encode = ["a call", "a call of `builtin`", "a holder anew", "`many`"], ["into a buffer", "bytes"]
    assert lines == ["who", *decode, "len()", "numpy's copy", "who", *encode, "len()", "numpy's copy"]


@pytest.mark.parametrize(
    ("mapping", "content", "told"),
    [
        ("nowhere.mapping", b"", "there is no mapping"),
        (MAPPING, b"abc", "truncated"),
        (MAPPING, None, "No such file"),
    ],
)
def test_what_cannot_be_measured_is_told(message, mapping, content, told, capsys):
    if content is None:
        message.unlink()
    else:
        message.write_bytes(content)
    assert own.main([mapping, str(message), "--encoding", "yarp3", "--quick"]) == 2
    assert told in capsys.readouterr().err
