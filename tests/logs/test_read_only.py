"""Logs in folders that this process may not write: all that is in them is read, and nothing is left beside them or elsewhere."""

from __future__ import annotations

import os
import shutil
import sqlite3
import subprocess
import sys
from pathlib import Path

import pytest

import rosetta_jit as rj

from .made import write_mcap
from .test_folders import COUNT, write_rosbag2

UNPRIVILEGED = ["setpriv", "--bounding-set=-dac_override,-dac_read_search", "--inh-caps=-dac_override,-dac_read_search"]
"""Root as any other user: it may write only what says so."""

PROGRAM = """
import sys, rosetta_jit as rj
from pathlib import Path
log = rj.open(sys.argv[1])
try:
    Path(sys.argv[1], "x").write_bytes(b"") if Path(sys.argv[1]).is_dir() else Path(sys.argv[1]).with_name("x").write_bytes(b"")
except PermissionError:
    print(sum(1 for _ in log.messages(raw=True)), log["/a"].to_arrow()["x"].to_pylist(), sep="\\n")
"""

pytestmark = [
    pytest.mark.skipif(os.name != "posix", reason="folders of other systems have no such rights"),
    pytest.mark.skipif(
        os.name == "posix" and os.geteuid() == 0 and not shutil.which("setpriv"), reason="root may write anywhere, and setpriv is missing"
    ),
]


def read(path, folder, temporary):
    """How many messages there are, and a column, in a process that may not write to the log's folder; nothing is there behind it."""
    before = sorted(each.name for each in folder.iterdir())
    folder.chmod(0o555)
    try:
        command = [*(UNPRIVILEGED if os.geteuid() == 0 else []), sys.executable, "-c", PROGRAM, str(path)]
        environment = {**os.environ, "TMPDIR": str(temporary)}
        done = subprocess.run(command, capture_output=True, text=True, check=False, env=environment, cwd=Path(rj.__file__).parents[1])
    finally:
        folder.chmod(0o755)
    assert done.returncode == 0, done.stderr
    assert sorted(each.name for each in folder.iterdir()) == before
    count, column = done.stdout.splitlines()
    return int(count), column


EVERYTHING = COUNT + 10, str([number / 4 for number in range(COUNT)])


@pytest.fixture
def temporary(tmp_path):
    """Where copies are made; none is left there."""
    folder = tmp_path / "temporary"
    folder.mkdir()
    yield folder
    assert not list(folder.iterdir())


def test_mcap(tmp_path, temporary):
    folder = tmp_path / "logs"
    folder.mkdir()
    path = write_mcap(folder / "a.mcap", COUNT)
    assert read(path, folder, temporary) == EVERYTHING


def into_wal(file):
    """A database in its WAL mode, from which nobody reads."""
    database = sqlite3.connect(file)
    assert database.execute("PRAGMA journal_mode = WAL").fetchone() == ("wal",)
    return database


@pytest.mark.parametrize("is_folder", [True, False])
def test_a_database_with_a_wal_mode(tmp_path, temporary, is_folder):
    """As rosbag2's profile `resilient` writes them. SQLite makes a file beside such a database even to read it."""
    folder = write_rosbag2(tmp_path / "a")
    (file,) = folder.glob("*.db3")
    into_wal(file).close()
    assert read(folder if is_folder else file, folder, temporary) == EVERYTHING


@pytest.mark.parametrize("has_index", [True, False])
def test_a_wal_that_was_left_has_rows_that_count(tmp_path, temporary, has_index):
    """A recorder was killed: rows that are in the WAL alone are read, with its index beside it and without."""
    folder = write_rosbag2(tmp_path / "a")
    (file,) = folder.glob("*.db3")
    database = into_wal(file)
    rows = database.execute("SELECT topic_id, timestamp, data FROM messages ORDER BY id DESC LIMIT 7").fetchall()
    database.execute("DELETE FROM messages WHERE id > (SELECT MAX(id) - 7 FROM messages)")
    database.commit()
    database.execute("PRAGMA wal_checkpoint(TRUNCATE)")
    database.executemany("INSERT INTO messages (topic_id, timestamp, data) VALUES (?, ?, ?)", reversed(rows))
    database.commit()
    kept = tmp_path / "kept"
    shutil.copytree(folder, kept)
    database.close()
    if not has_index:
        (kept / f"{file.name}-shm").unlink()
    assert (kept / f"{file.name}-wal").stat().st_size > 0
    assert read(kept, kept, temporary) == EVERYTHING
