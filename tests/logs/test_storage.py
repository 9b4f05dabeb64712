"""Logs that are no local files: standard input, and addresses of `fsspec`."""

from __future__ import annotations

import gzip
import io
import lzma
import pickle
import shutil
import sys
from pathlib import Path
from types import SimpleNamespace

import fsspec
import pytest
import zstandard

import rosetta_jit as rj
from rosetta_jit.errors import LogError

from .made import write_bag, write_lcm, write_mcap, write_old_bag
from .test_folders import write_rosbag2
from .test_small_damage import SMALL

COUNT = 20


@pytest.fixture(scope="module")
def logs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("logs")
    (database,) = write_rosbag2(folder / "a").glob("*.db3")
    written = [write_mcap(folder / "a.mcap", COUNT), write_bag(folder / "a.bag", COUNT, "bz2"), write_old_bag(folder / "old.bag", COUNT)]
    found = {path.name: path for path in (*written, write_lcm(folder / "a.lcmlog", COUNT), database)}
    for name, data in (SMALL | {"a.rec.xz": lzma.compress(SMALL["a.rec"])}).items():
        found[name] = folder / name
        found[name].write_bytes(data)
    return found


KINDS = ("a.mcap", "a.bag", "old.bag", "a.lcmlog", "a.db3", "a.rec", "a.rec.xz", "a.delimited", "a.tide")


def read(name, form=None):
    found = []
    with rj.open(name, format=form, on_problem=found.append) as log:
        channels = [(each.topic, each.type, each.count) for each in log.channels]
        messages = list(log.messages(raw=True))
    assert not found
    assert messages
    return log.format, channels, messages


@pytest.mark.parametrize("kind", KINDS)
def test_an_address_of_fsspec(kind, logs):
    with fsspec.open(f"memory://logs/{kind}", "wb") as file:
        file.write(logs[kind].read_bytes())
    assert read(f"memory://logs/{kind}") == read(logs[kind]) == read(f"file://{logs[kind]}")


@pytest.mark.parametrize("kind", ["zip", "tar"])
def test_a_log_within_an_archive(kind, logs, tmp_path):
    """Its bytes are compressed once more, and the archive is closed before they are read."""
    archive = shutil.make_archive(str(tmp_path / "drive"), "zip" if kind == "zip" else "gztar", logs["a.mcap"].parent, "a.mcap")
    assert read(f"{kind}://a.mcap::{archive}") == read(logs["a.mcap"])


def test_a_folder_as_an_address(logs):
    folder = logs["a.db3"].parent
    assert read(f"file://{folder}") == read(folder)


@pytest.mark.parametrize("kind", KINDS)
def test_standard_input(kind, logs, monkeypatch):
    form, channels, messages = read(logs[kind])
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(logs[kind].read_bytes())))
    has_begin = not kind.startswith(("a.rec", "a.delim"))
    found = read("-", None if has_begin else form)
    assert [(each.time, each.message) for each in found[2]] == [(each.time, each.message) for each in messages]
    assert found[:2] == (form, channels) or not has_begin  # topics of the others are named after the file


class AddressError(Exception):
    """Of a package of its own."""


class Broken(fsspec.AbstractFileSystem):
    """A server that refuses, or is not there."""

    protocol = "broken"

    def _open(self, path, mode="rb", **_):  # noqa: ARG002 - fsspec's signature
        match path.rpartition("/")[2]:
            case "refused":
                raise AddressError("403, Forbidden")
            case "away":
                raise FileNotFoundError(path) from AddressError("Cannot connect to host")
            case _:
                raise FileNotFoundError(path)


@pytest.mark.parametrize(
    ("name", "said"), [("refused", "403, Forbidden"), ("away", "Cannot connect to host"), ("x.mcap", "No such file or directory")]
)
def test_an_address_that_cannot_be_opened(name, said):
    """Whatever the package of the address raises, it is said which log cannot be read, and why."""
    fsspec.register_implementation("broken", Broken, clobber=True)
    with pytest.raises(LogError, match=f"broken://{name} cannot be read: {said}"):
        rj.open(f"broken://{name}")


def test_copies_go_with_the_log(logs, monkeypatch, tmp_path):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    with fsspec.open("memory://logs/copied.db3", "wb") as file:
        file.write(logs["a.db3"].read_bytes())
    log = rj.open("memory://logs/copied.db3")
    (folder,) = tmp_path.iterdir()
    assert [each.name for each in Path(folder).iterdir()] == ["log.db3"]
    assert list(log.messages(raw=True))
    log.close()
    assert not list(tmp_path.iterdir())


def test_a_log_that_is_closed_is_not_read(logs, tmp_path):
    """The number of its file is another one's then."""
    log = rj.open(logs["a.mcap"])
    assert len(log.channels)
    log.close()
    other = tmp_path / "other"
    other.write_bytes(bytes(logs["a.mcap"].stat().st_size))
    with other.open("rb"), pytest.raises(ValueError, match="closed file"):
        list(log.messages(raw=True))


PACKINGS = {".gz": gzip.compress, ".zst": zstandard.ZstdCompressor().compress}


@pytest.mark.parametrize("suffix", PACKINGS)
@pytest.mark.parametrize("kind", KINDS)
def test_a_log_that_is_compressed_as_a_whole(kind, suffix, logs, tmp_path, monkeypatch):
    packed, pack = tmp_path / f"{kind}{suffix}", PACKINGS[suffix]
    data = logs[kind].read_bytes()
    packed.write_bytes(pack(data[:50]) + pack(data[50:]))
    form, channels, messages = read(logs[kind])
    found = read(packed)
    assert [(each.time, each.message) for each in found[2]] == [(each.time, each.message) for each in messages]
    assert (found[0], [each[1:] for each in found[1]]) == (form, [each[1:] for each in channels])
    again = pickle.loads(pickle.dumps(rj.open(packed)))  # noqa: S301 - our own
    assert list(again.messages(raw=True)) == found[2]
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(packed.read_bytes())))
    if not kind.startswith(("a.rec", "a.delim")):
        assert read("-")[2] == messages


@pytest.mark.parametrize("damaged", [lambda data: data[:-9], lambda data: data[: len(data) // 2], lambda data: data[:-200] + b"x" * 200])
def test_what_is_whole_of_a_packed_log_is_read(damaged, tmp_path):
    path = write_mcap(tmp_path / "a.mcap", 5000, chunk_size=1000)
    packed = tmp_path / "a.mcap.gz"
    packed.write_bytes(damaged(gzip.compress(path.read_bytes())))
    problems, whole = [], list(rj.open(path).messages(["/a"], raw=True))
    with rj.open(packed, on_problem=problems.append) as log:
        found = list(log.messages(["/a"], raw=True))
    assert 1000 < len(found) <= len(whole)
    assert found == whole[: len(found)]
    assert problems or len(found) == len(whole)


def test_a_packed_log_leaves_room_on_the_disk(tmp_path, monkeypatch):
    packed = tmp_path / "a.mcap.gz"
    packed.write_bytes(gzip.compress(bytes(1 << 20)))
    monkeypatch.setattr(shutil, "disk_usage", lambda _: SimpleNamespace(free=1 << 20))
    with pytest.raises(LogError, match="more than half of the disk"):
        rj.open(packed)


@pytest.mark.parametrize("value", [b"a.mcap", io.BytesIO(), 7, None])
def test_what_is_no_path(value):
    with pytest.raises(TypeError, match="by its path or its address"):
        rj.open(value)
