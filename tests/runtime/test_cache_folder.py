"""A folder that somebody else could have written to is not used; one that cannot be written costs one warning."""

from __future__ import annotations

import errno
import os
import stat
import time
import warnings

import pytest

from rosetta_jit.errors import CacheWarning
from rosetta_jit.runtime.cache import stores
from rosetta_jit.runtime.cache.kernels import ENTRY, Cache
from rosetta_jit.runtime.cache.usage import USAGE
from rosetta_jit.runtime.limits import MAX_USAGE_RECORDS

needs_root = pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="only root can give a file away")


def demand_memory_only(cache):
    """The cache works, keeps nothing in its folder, and says so once."""
    with warnings.catch_warnings(record=True) as seen:
        warnings.simplefilter("always")
        cache.put("memory", {}, b"code")
        assert cache.get("memory").image == b"code"
        assert cache.get("planted") is None
    assert [warning.category for warning in seen] == [CacheWarning]
    assert cache.info().problem


@pytest.fixture
def planted(tmp_path):
    """A folder with a perfectly good entry, to be spoiled by each test."""
    cache = Cache(tmp_path / "cache")
    cache.put("planted", {}, b"code")
    return cache.folder


def test_the_folder_is_made_private(planted):
    assert stat.S_IMODE(planted.stat().st_mode) == 0o700
    assert stat.S_IMODE((planted / f"planted{ENTRY}").stat().st_mode) == 0o600


@pytest.mark.parametrize("mode", [0o770, 0o707, 0o777, 0o1777])
def test_a_folder_that_others_can_write(planted, mode):
    planted.chmod(mode)
    demand_memory_only(Cache(planted))
    assert not (planted / f"memory{ENTRY}").exists()


def test_a_symbolic_link(planted, tmp_path):
    link = tmp_path / "link"
    link.symlink_to(planted)
    demand_memory_only(Cache(link))


def test_a_file_instead_of_a_folder(tmp_path):
    (tmp_path / "file").write_text("")
    demand_memory_only(Cache(tmp_path / "file"))


def test_a_full_disk(planted, monkeypatch):
    cache = Cache(planted)

    def full(_self, _name, _data):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(stores.FolderStore, "write", full)
    with pytest.warns(CacheWarning, match="make room there, set ROSETTA_JIT_CACHE_DIR to another folder"):
        cache.put("kernel", {}, b"code")
    assert cache.get("kernel").image == b"code"
    assert cache.get("planted").image == b"code"


@needs_root
def test_a_folder_of_another_user(planted):
    os.chown(planted, 12345, -1)
    demand_memory_only(Cache(planted))


@needs_root
def test_a_file_of_another_user(planted):
    os.chown(planted / f"planted{ENTRY}", 12345, -1)
    with pytest.warns(CacheWarning, match="another user"):
        assert Cache(planted).get("planted") is None


def test_a_file_that_others_can_write(planted):
    (planted / f"planted{ENTRY}").chmod(0o666)
    with pytest.warns(CacheWarning, match="written by others"):
        assert Cache(planted).get("planted") is None


@pytest.mark.parametrize("plant", ["symlink", "fifo", "folder"])
def test_something_else_under_an_entry_s_name(planted, tmp_path, plant):
    file = planted / f"planted{ENTRY}"
    file.rename(tmp_path / "moved")
    match plant:
        case "symlink":
            file.symlink_to(tmp_path / "moved")
        case "fifo":
            os.mkfifo(file, 0o600)
        case _:
            file.mkdir(0o700)
    cache = Cache(planted)
    with pytest.warns(CacheWarning):
        assert cache.get("planted") is None
    assert [found.name for found in cache.verify()] == [f"planted{ENTRY}"]
    cache.put("planted", {}, b"again")
    assert cache.get("planted").image == b"again"


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root may write anywhere")
def test_a_folder_that_cannot_be_written_is_still_read(planted):
    planted.chmod(0o500)
    cache = Cache(planted)
    assert cache.get("planted").image == b"code"
    with pytest.warns(CacheWarning):
        cache.put("memory", {}, b"code")
    assert cache.get("memory").image == b"code"


@pytest.mark.parametrize("code", [errno.ENOSPC, errno.EROFS, errno.EDQUOT, errno.EACCES])
def test_a_full_or_read_only_disk(planted, monkeypatch, recwarn, code):
    class Full:
        def __enter__(self):
            return self

        def __exit__(self, *_):
            return None

        def write(self, _):
            raise OSError(code, os.strerror(code))

    monkeypatch.setattr(stores, "_create_file", lambda *_: Full())
    cache = Cache(planted)
    cache.put("memory", {}, b"code")
    cache.put("memory 2", {}, b"code")
    assert [os.strerror(code) in str(warning.message) for warning in recwarn.list] == [True]
    assert cache.get("memory").image == b"code"
    assert cache.get("planted").image == b"code"
    assert [path.name for path in planted.iterdir() if path.name != USAGE] == [f"planted{ENTRY}"]


def test_what_killed_writers_left_is_removed(planted):
    old, new = planted / f"x{ENTRY}.1.2.tmp", planted / f"x{ENTRY}.3.4.tmp"
    old.write_bytes(b"half")
    new.write_bytes(b"half")
    long_ago = time.time() - 2 * stores.STALE_S
    os.utime(old, (long_ago, long_ago))
    for _ in range(MAX_USAGE_RECORDS):
        Cache(planted).put("another", {}, b"")
    assert not old.exists()
    assert new.exists()


def test_a_system_that_cannot_tell_owners_keeps_memory_only(planted, monkeypatch):
    monkeypatch.setattr(os, "supports_dir_fd", set())
    demand_memory_only(Cache(planted))
