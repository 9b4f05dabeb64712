"""The cache keeps what it was given, and nothing that was damaged since (reliability, row 11)."""

from __future__ import annotations

import itertools
import json
import marshal
import os
import sys
import threading
import warnings
from hashlib import sha256

import pytest
from platformdirs import user_cache_path

import rosetta_jit as rj
from rosetta_jit.errors import CacheWarning
from rosetta_jit.pipeline.build import Build
from rosetta_jit.runtime.cache import kernels
from rosetta_jit.runtime.cache.kernels import ENTRY, MANIFEST, Cache
from rosetta_jit.runtime.cache.sealed import MAGIC, DamagedError, seal, unseal
from rosetta_jit.runtime.cache.stores import MemoryStore

NAME = sha256(b"a kernel").hexdigest()
OTHER = sha256(b"another kernel").hexdigest()
HEADER = {"symbol": "decode", "sites": [["tag", ".angles[]"]]}
IMAGE = bytes(range(256))


@pytest.fixture
def cache(tmp_path):
    return Cache(tmp_path / "cache")


def entry_file(cache, name=NAME):
    return cache.folder / (name + ENTRY)


def test_what_was_put_is_got(cache):
    assert cache.get(NAME) is None
    cache.put(NAME, HEADER, IMAGE)
    for reader in (cache, Cache(cache.folder)):
        entry = reader.get(NAME)
        assert (entry.header, entry.image) == (HEADER, IMAGE)


def test_the_last_put_wins(cache):
    cache.put(NAME, HEADER, IMAGE)
    cache.put(NAME, {}, b"")
    assert (cache.get(NAME).header, cache.get(NAME).image) == ({}, b"")


def test_without_a_folder_entries_live_in_memory():
    cache = Cache(None)
    cache.put(NAME, HEADER, IMAGE)
    assert cache.get(NAME).image == IMAGE
    assert Cache(None).get(NAME) is None


def test_every_truncation_is_damage():
    data = seal(NAME, HEADER, b"code")
    for size in range(len(data)):
        with pytest.raises(DamagedError):
            unseal(NAME, data[:size])
    with pytest.raises(DamagedError):
        unseal(NAME, data + b"\0")


def test_every_flipped_byte_is_damage():
    data = seal(NAME, HEADER, b"code")
    for position in range(len(data)):
        for flip in (1, 0x80, 0xFF):
            altered = bytearray(data)
            altered[position] ^= flip
            with pytest.raises(DamagedError):
                unseal(NAME, bytes(altered))


WHOLE = marshal.dumps({"a": 1}, 2)


@pytest.mark.parametrize("header", [b"", b"{", WHOLE[:-1], WHOLE[1:], marshal.dumps([]), b"\xff"])
def test_a_header_that_is_no_dict_is_damage(header):
    payload = len(header).to_bytes(4, "little") + header
    digest = sha256(NAME.encode() + b"\0" + payload).digest()
    with pytest.raises(DamagedError):
        unseal(NAME, MAGIC + len(payload).to_bytes(8, "little") + digest + payload)


@pytest.mark.parametrize(
    "damage", [lambda data: data[:-1], lambda _: b"", lambda data: data[:60] + b"!" + data[61:], lambda data: b"#!" + data]
)
def test_a_damaged_entry_is_absent_warns_once_and_is_replaced(cache, damage, recwarn):
    cache.put(NAME, HEADER, IMAGE)
    entry_file(cache).write_bytes(damage(entry_file(cache).read_bytes()))
    assert cache.get(NAME) is None
    assert cache.get(NAME) is None
    assert [warning.category for warning in recwarn.list] == [CacheWarning]
    assert [found.name for found in cache.verify()] == [NAME + ENTRY]
    cache.put(NAME, HEADER, IMAGE)
    assert cache.get(NAME).image == IMAGE
    assert cache.verify() == ()


def test_an_entry_copied_over_another_is_damaged(cache):
    cache.put(NAME, HEADER, IMAGE)
    cache.put(OTHER, {}, b"other code")
    entry_file(cache, OTHER).write_bytes(entry_file(cache).read_bytes())
    with pytest.warns(CacheWarning, match="digest"):
        assert cache.get(OTHER) is None


def test_an_entry_of_another_format_version_is_damaged(cache):
    cache.put(NAME, HEADER, IMAGE)
    data = entry_file(cache).read_bytes()
    entry_file(cache).write_bytes(data[:7] + b"\x63" + data[8:])
    with pytest.warns(CacheWarning, match="version"):
        assert cache.get(NAME) is None


def test_a_manifest_answers_while_its_files_are_unchanged(cache, tmp_path):
    mapping, absent = tmp_path / "a.mapping", tmp_path / "preferred.proto"
    mapping.write_text("one")
    files = {str(mapping): sha256(b"one").hexdigest(), str(absent): None}
    assert cache.get_manifest("request") is None
    cache.put_manifest("request", files, NAME)
    assert cache.get_manifest("request") == NAME
    absent.write_text("now found first")
    assert cache.get_manifest("request") is None
    absent.unlink()
    mapping.write_text("two")
    assert cache.get_manifest("request") is None
    mapping.unlink()
    assert cache.get_manifest("request") is None


def test_a_damaged_manifest_is_absent(cache):
    cache.put_manifest("request", {}, NAME)
    file = cache.folder / ("request" + MANIFEST)
    file.write_bytes(file.read_bytes()[:-3])
    with pytest.warns(CacheWarning):
        assert cache.get_manifest("request") is None


@pytest.mark.parametrize("folder", [True, False])
def test_what_was_not_used_for_longest_is_evicted(tmp_path, folder):
    size = len(seal("0", {}, IMAGE))
    cache = Cache(tmp_path / "cache" if folder else None, max_bytes=4 * size - 1)
    for name in "012":
        cache.put(name, {}, IMAGE)
        if folder:
            os.utime(entry_file(cache, name), (int(name), int(name)))
    cache.get("0")
    cache.put("3", {}, IMAGE)
    assert [name for name in "0123" if cache.get(name) is not None] == ["0", "2", "3"]
    assert cache.info().size_bytes <= cache.max_bytes


def test_info_counts_and_clear_removes_only_what_is_ours(cache):
    assert cache.info().entries == 0
    assert not cache.folder.exists()
    cache.put(NAME, HEADER, IMAGE)
    cache.put_manifest("request", {}, NAME)
    (cache.folder / "notes.txt").write_text("mine")
    info = cache.info()
    assert (info.entries, info.manifests, info.problem) == (1, 1, "")
    assert info.size_bytes > len(IMAGE)
    assert cache.clear() == 2
    assert [path.name for path in cache.folder.iterdir()] == ["notes.txt"]


def test_the_environment_names_or_disables_the_default(tmp_path, monkeypatch):
    monkeypatch.setenv("ROSETTA_JIT_CACHE_DIR", str(tmp_path / "mine"))
    assert Cache.default().folder == tmp_path / "mine"
    assert Cache.default() is Cache.default()
    monkeypatch.setenv("ROSETTA_JIT_CACHE", "off")
    cache = Cache.default()
    cache.put(NAME, HEADER, IMAGE)
    assert cache.get(NAME) is None
    assert not (tmp_path / "mine").exists()


def test_where_nothing_is_kept_no_program_needs_a_name(monkeypatch):
    """It is a digest of the kernels' text, which takes a twentieth of a large type's compile."""
    monkeypatch.setenv("ROSETTA_JIT_CACHE", "off")
    monkeypatch.setattr(Build, "text", property(lambda _: pytest.fail("asked for")))
    decode = rj.Decoder.of("std_msgs/Header", encoding="ros1")
    assert decode(bytes(16)).to_dict()["frame_id"] == ""


@pytest.mark.parametrize("named", [None, "", "/somewhere/else"])
def test_the_default_folder_is_where_users_have_caches(monkeypatch, named):
    """Where platformdirs says; an import that a warm start on Linux does without."""
    monkeypatch.delenv("ROSETTA_JIT_CACHE_DIR", raising=False)
    monkeypatch.delenv("ROSETTA_JIT_CACHE", raising=False)
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    if named is not None:
        monkeypatch.setenv("XDG_CACHE_HOME", named)
    kernels._default.cache_clear()
    assert Cache.default().folder == user_cache_path("rosetta_jit", appauthor=False)
    kernels._default.cache_clear()


def test_a_header_keeps_its_order():
    header = {"b": 1, "a": {"z": 1.5, "y": None}}
    assert json.dumps(unseal(NAME, seal(NAME, header, b"")).header) == json.dumps(header)


def test_reading_and_writing_a_good_cache_is_silent(cache):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        cache.put(NAME, HEADER, IMAGE)
        cache.get(NAME)
        cache.get(OTHER)


def test_threads_list_the_files_of_a_process_while_others_write_and_remove_some():
    store, stop, interval = MemoryStore(), threading.Event(), sys.getswitchinterval()

    def change():
        for number in itertools.count():
            store.write(f"{number % 1000}", b"x")
            store.remove(f"{(number + 500) % 1000}")
            if stop.is_set():
                return

    sys.setswitchinterval(1e-6)
    thread = threading.Thread(target=change)
    thread.start()
    try:
        for number in range(2000):
            assert all(each.size_bytes == 1 for each in store.stored())
            assert store.read(f"{number % 1000}") in (None, b"x")
    finally:
        sys.setswitchinterval(interval)
        stop.set()
        thread.join()
