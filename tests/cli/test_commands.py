"""What each command prints, where, and with which exit code."""

from __future__ import annotations

import io
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from rosetta_jit.cli import main
from rosetta_jit.recording import Message, read_messages, write_recording

JSON_FIELDS = ["file", "line", "column", "end_line", "end_column", "severity", "code", "message", "label", "help", "notes"]
MESSAGES = [b"\x01", b"\x03abc"]


@pytest.fixture
def recording(tmp_path):
    path = tmp_path / "captured.rec.xz"
    write_recording(path, [Message(float(index), data) for index, data in enumerate(MESSAGES)])
    return str(path)


def test_check_forgives_warnings_and_reports_errors(capsys):
    assert main(["check", "good.mapping"]) == 0
    assert main(["check", "doubtful.mapping"]) == 0
    assert "warning[unused-import]" in capsys.readouterr().err
    assert main(["check", "good.mapping", "wrong.mapping"]) == 1
    captured = capsys.readouterr()
    assert captured.out == ""
    assert "error[unknown-field]: no field `z`" in captured.err


def test_check_as_json(capsys):
    assert main(["check", "--json", "good.mapping", "wrong.mapping"]) == 1
    captured = capsys.readouterr()
    good, wrong = map(json.loads, captured.out.splitlines())
    assert good == {"mapping": "good.mapping", "diagnostics": [], "more": 0}
    assert wrong["diagnostics"][0]["code"] == "unknown-field"
    assert list(wrong["diagnostics"][0]) == JSON_FIELDS
    assert captured.err == ""


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="the system has no device that is always full")
@pytest.mark.parametrize(
    "command", [["explain", "yarp/icub/torso_state.mapping", "--html"], ["decode", "a.mapping", "{recording}", "--npz"]]
)
def test_a_full_disk_is_told_with_the_file(command, recording, capsys):
    filled = [argument.format(recording=recording) for argument in command]
    assert main([*filled, "/dev/full"]) == 1
    assert capsys.readouterr().err == "error: [Errno 28] No space left on device: '/dev/full'\n"


def test_decode_as_text(recording, capsys):
    assert main(["decode", "a.mapping", recording]) == 0
    assert capsys.readouterr().out == "number: 1\nnumber: 3\n"


def test_decode_of_a_bad_message_goes_on(tmp_path, recording, capsys):
    (tmp_path / "empty").write_bytes(b"")
    assert main(["decode", "a.mapping", str(tmp_path / "empty"), recording]) == 1
    captured = capsys.readouterr()
    assert captured.out == "number: 1\nnumber: 3\n"
    assert "empty: message 0: truncated: no byte" in captured.err


def test_decode_and_encode_are_inverse(tmp_path, recording, capsys):
    assert main(["decode", "--json", "a.mapping", recording]) == 0
    lines = capsys.readouterr().out
    assert json.loads(lines.splitlines()[0])["inner"] == {"depth": {"float": "inf"}}
    (tmp_path / "values.json").write_text(lines)
    again = tmp_path / "again.rec"
    assert main(["encode", "a.mapping", str(tmp_path / "values.json"), "-o", str(again)]) == 0
    assert [message.data for message in read_messages(again)] == MESSAGES


def test_encode_of_one_message(tmp_path, monkeypatch, capsys):
    document, output = tmp_path / "one.json", tmp_path / "message"
    document.write_text('{\n  "data": {"base64": "YWJj"}\n}\n')
    assert main(["encode", "a.mapping", str(document), "-o", str(output)]) == 0
    assert output.read_bytes() == b"abc"
    stdout = io.TextIOWrapper(io.BytesIO())
    monkeypatch.setattr(sys, "stdout", stdout)
    assert main(["encode", "a.mapping", str(document)]) == 0
    stdout.flush()
    assert stdout.buffer.getvalue() == b"abc"


@pytest.mark.parametrize("text", ["", "[1]", "{", '{"data": {"base64": "*"}}', "[" * 100_000, '{"data": {"base64": ""}}\n' * 2, "\x00"])
def test_encode_refuses_what_is_no_value(tmp_path, text, capsys):
    document = tmp_path / "bad.json"
    document.write_text(text)
    assert main(["encode", "a.mapping", str(document), "-o", str(tmp_path / "out")]) == 1
    assert "error[values-" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_decode_to_numpy(tmp_path, recording):
    output = tmp_path / "columns.npz"
    assert main(["decode", "a.mapping", recording, "--npz", str(output)]) == 0
    with np.load(output, allow_pickle=False) as columns:
        assert columns["number"].tolist() == [1, 3]
        assert columns["samples"].dtype == np.float32
        assert columns["samples.offsets"].tolist() == [0, 1, 4]
        assert columns["data"].tobytes() == b"".join(MESSAGES)
        assert columns["inner.depth"].tolist() == [np.inf, np.inf]


def test_dump_prints_a_stage(capsys):
    assert main(["dump", "--stage", "llvm", "--encoding", "yarp4", "a.mapping"]) == 0
    assert main(["dump", "--direction", "encode", "a.mapping"]) == 0
    assert capsys.readouterr().out == "StubDecoder yarp4 llvm\nStubEncoder own kernel\n"


def test_infer_reads_recordings_and_files(tmp_path, recording, library, capsys):
    (tmp_path / "one").write_bytes(b"one")
    assert main(["infer", recording, str(tmp_path / "one"), "--name", "x", "--encoding", "yarp3"]) == 0
    assert library.inferred == [*MESSAGES, b"one"]
    assert capsys.readouterr().out == '"x" ; yarp3\n'


def test_a_file_that_is_not_there_is_exit_code_1(capsys):
    assert main(["decode", "a.mapping", "/no/such/file"]) == 1
    assert "/no/such/file" in capsys.readouterr().err


def test_cache_commands(tmp_path, monkeypatch, capsys):
    from rosetta_jit.runtime.cache.kernels import ENTRY, Cache

    monkeypatch.setenv("ROSETTA_JIT_CACHE_DIR", str(tmp_path / "cache"))
    Cache.default().put("kernel", {}, b"code")
    assert main(["cache", "info", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["entries"] == 1
    assert main(["cache", "info"]) == 0
    assert str(tmp_path / "cache") in capsys.readouterr().out
    assert main(["cache", "verify"]) == 0
    (tmp_path / "cache" / f"kernel{ENTRY}").write_bytes(b"cut")
    assert main(["cache", "verify"]) == 1
    assert f"kernel{ENTRY}: it is cut short" in capsys.readouterr().err
    assert main(["cache", "clear"]) == 0
    assert capsys.readouterr().out == "1 files removed\n"


CHATTY = """
import sys
from rosetta_jit.cli import check, main
check.run = lambda _: print("x" * 10_000_000) or 0
sys.exit(main(["check", "a.mapping"]))
"""


def test_a_reader_that_has_seen_enough_is_no_error():
    process = subprocess.Popen([sys.executable, "-c", CHATTY], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    process.stdout.read(1)
    process.stdout.close()
    assert process.stderr.read() == b""
    process.stderr.close()
    assert process.wait() == 1


@pytest.mark.parametrize("name", ["none.json", ".", "deep.json", "digits.json", "zero.json"])
def test_values_that_cannot_be_read(name, tmp_path, monkeypatch, capsys):
    """One sentence and exit code 1, whatever the file is."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("rosetta_jit.recording.MAX_MESSAGE_BYTES", 1 << 20)
    (tmp_path / "deep.json").write_text("[" * 100_000)
    (tmp_path / "digits.json").write_text('{"angles": [' + "9" * 5_000 + "]}")
    (tmp_path / "zero.json").symlink_to("/dev/zero")
    assert main(["encode", "yarp/icub/torso_state.mapping", "--encoding", "yarp4", name]) == 1
    assert capsys.readouterr().err.startswith("error[")
