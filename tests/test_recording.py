"""Recordings are read to the end or to the place where they break."""

from __future__ import annotations

import struct
import tracemalloc

import pytest

from rosetta_jit import recording
from rosetta_jit.recording import MAX_MESSAGE_BYTES, Message, RecordingError, read_messages, write_recording

MESSAGES = [Message(1.5, b"one"), Message(2.25, b""), Message(3.0, b"three")]


@pytest.mark.parametrize("name", ["a.rec", "a.rec.xz"])
def test_what_was_written_is_read(tmp_path, name):
    write_recording(tmp_path / name, MESSAGES)
    assert list(read_messages(tmp_path / name)) == MESSAGES


def test_any_other_file_is_one_message(tmp_path):
    (tmp_path / "a.bin").write_bytes(b"bytes")
    assert [message.data for message in read_messages(tmp_path / "a.bin")] == [b"bytes"]


@pytest.mark.parametrize("name", ["a.rec", "a.rec.xz"])
def test_every_truncation_gives_whole_messages_or_an_error(tmp_path, name):
    path = tmp_path / name
    write_recording(path, MESSAGES)
    data = path.read_bytes()
    whole = 0
    for size in range(len(data)):
        path.write_bytes(data[:size])
        messages = []
        try:
            messages += read_messages(path)
        except RecordingError:
            continue
        assert messages == MESSAGES[: len(messages)]
        whole += 1
    assert whole <= len(MESSAGES)


def test_a_length_takes_no_memory(tmp_path):
    path = tmp_path / "a.rec"
    path.write_bytes(struct.pack("<dI", 0.0, MAX_MESSAGE_BYTES) + bytes(3 << 20))
    tracemalloc.start()
    with pytest.raises(RecordingError, match="cut"):
        list(read_messages(path))
    assert tracemalloc.get_traced_memory()[1] < 16 << 20
    tracemalloc.stop()
    path.write_bytes(struct.pack("<dI", 0.0, 3 << 20) + bytes(3 << 20))
    assert [len(each.data) for each in read_messages(path)] == [3 << 20]


def test_a_length_is_not_believed(tmp_path):
    path = tmp_path / "a.rec"
    path.write_bytes(struct.pack("<dI", 0, MAX_MESSAGE_BYTES + 1))
    with pytest.raises(RecordingError, match="promises"):
        list(read_messages(path))


def test_what_xz_did_not_write(tmp_path):
    path = tmp_path / "a.rec.xz"
    path.write_bytes(b"not xz at all")
    with pytest.raises(RecordingError, match="recording-damaged"):
        list(read_messages(path))


@pytest.mark.parametrize("name", ["a.rec", "a.rec.xz", "a.bin"])
@pytest.mark.parametrize("kind", ["nothing", "folder", "device", "circle"])
def test_files_that_cannot_be_read_to_an_end(tmp_path, monkeypatch, name, kind):
    monkeypatch.setattr(recording, "MAX_MESSAGE_BYTES", 1 << 20)
    path = tmp_path / name
    match kind:
        case "folder":
            path.mkdir()
        case "device":
            path.symlink_to("/dev/zero")
        case "circle":
            path.symlink_to(name)
    with pytest.raises(RecordingError, match="file-"):
        list(read_messages(path))
