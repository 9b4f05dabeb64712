"""One SQLite file of a rosbag2: the tables `topics` and `messages`, and `message_definitions` since Iron.

The file is opened for reading alone, and asked for tables, never for views: a view can be a program without an end.
"""

from __future__ import annotations

import shutil
import sqlite3
import struct
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from weakref import finalize

from rosetta_jit.catalogue import logs as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.errors import LogError
from rosetta_jit.logs.base import Block, Connection, Extent, Piece, Wanted
from rosetta_jit.logs.limits import MAX_RECORD_BYTES
from rosetta_jit.logs.reading.blocks import blocks_of
from rosetta_jit.logs.reading.storage import WINDOW, Storage, open_storage
from rosetta_jit.logs.rosbag2.pages import Pages

HEADER_BYTES, MOST_OF_PAGE = 100, 1 << 16
"""Of the file's header, and the size of a page that it writes as 1: https://www.sqlite.org/fileformat.html, section 1.3."""

READ_VERSION, WAL_VERSION = 19, b"\2"
"""Where the header says how the file is read, and what it says in WAL mode: section 1.3.2 there."""

PRIMARY = 0xFF
"""The bits of an error's code that say which it is: https://www.sqlite.org/rescode.html, section 3."""

ENCODINGS = {"cdr": "cdr", "ros_v1": "ros1"}
TABLES = {"topics": ("id", "name", "type", "serialization_format"), "messages": ("id", "topic_id", "timestamp", "data")}


class SqliteReader:
    """An open SQLite file of a rosbag2."""

    def __init__(self, storage: Storage, tell: Callable[[Diagnostic], None], *, check: bool) -> None:
        del check  # it has no checksums
        self._name, self._tell = storage.name, tell
        self.facts, self.pieces = {"storage": "sqlite3"}, (Piece(storage.size),)
        try:
            self._database = _connected(_with_wal(storage), self)
            finalize(self, self._database.close)
            self._database.text_factory = _kept
            self._database.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, MAX_RECORD_BYTES)
            self._check_tables()
            self.connections = self._defined()
            first, last = self._database.execute("SELECT MIN(timestamp), MAX(timestamp) FROM messages").fetchone()
        except (sqlite3.Error, ValueError, OverflowError) as error:
            raise LogError((words.unreadable(storage.name, str(error)),)) from error
        self.extent = Extent(first, last) if isinstance(first, int) and isinstance(last, int) else None
        self._cut = self._cut_rows(storage)

    def blocks(self, wanted: Wanted) -> Iterator[Block]:
        return blocks_of(self._messages(wanted))

    def _cut_rows(self, storage: Storage) -> set[int] | None:
        """The numbers of messages of which bytes are missing: SQLite takes those as zeros. None of a file that is whole."""
        page, usable, promised = _sizes(storage.read(0, HEADER_BYTES))
        if storage.size >= promised:
            return None
        self._tell(words.file_cut(storage.name, storage.size, promised))
        found = Pages(storage, page, usable).rows_cut(self._root)
        if found:
            self._tell(words.rows_cut(storage.name, len(found)))
        return found

    def _check_tables(self) -> None:
        self._database.execute("PRAGMA trusted_schema = OFF")
        rows = self._database.execute("SELECT name, type, rootpage FROM sqlite_master WHERE sql NOT LIKE 'CREATE VIRTUAL%'").fetchall()
        found, roots = {name: type_ for name, type_, _ in rows}, {name: root for name, _, root in rows}
        for table, columns in TABLES.items():
            there = {each[1] for each in self._database.execute(f"PRAGMA table_info({table})")}
            if found.get(table) != "table" or not there.issuperset(columns):
                raise LogError((words.not_a(self._name, "rosbag2 file: it has no tables `topics` and `messages`"),))
        self._root = roots["messages"] if isinstance(roots["messages"], int) else 0
        self._has_definitions = found.get("message_definitions") == "table"

    def _defined(self) -> dict[int, Connection]:
        counts = dict(self._database.execute("SELECT topic_id, COUNT(*) FROM messages GROUP BY topic_id").fetchall())
        definitions: dict[str, tuple[str, bytes]] = {}
        if self._has_definitions:
            rows = self._database.execute("SELECT topic_type, encoding, encoded_message_definition FROM message_definitions")
            definitions = {_text(type_): (_text(encoding), _octets(text)) for type_, encoding, text in rows if text}
        found: dict[int, Connection] = {}
        for number, topic, type_, encoding in self._database.execute("SELECT id, name, type, serialization_format FROM topics"):
            if not isinstance(number, int):
                self._tell(words.bad_row(self._name, "topics", "its `id` is no number"))
                continue
            language, text = definitions.get(_text(type_), ("", b""))
            known = ENCODINGS.get(_text(encoding), _text(encoding))
            found[number] = Connection(number, _text(topic), _text(type_), known, language, text, int(counts.get(number, 0)))
        return found

    def _messages(self, wanted: Wanted) -> Iterator[tuple[int, int, int, bytes]]:
        query, parameters = _query(wanted, "messages" if self._cut is None else "messages NOT INDEXED")  # whose end may be missing, too
        try:
            for number, topic, time_ns, data in self._database.execute(query, parameters):
                if self._cut and number in self._cut:
                    continue
                if not isinstance(topic, int) or not isinstance(time_ns, int):
                    self._tell(words.bad_row(self._name, "messages", "its topic or its time is no number"))
                    continue
                yield topic, time_ns, time_ns, _octets(data)
        except sqlite3.Error as error:
            self._tell(words.stopped(self._name, str(error)))


def _with_wal(storage: Storage) -> Path:
    """The file, or a copy of one that is elsewhere: with its WAL, if it has one, as the newest rows may be there alone."""
    path = storage.local(".db3").resolve()
    if "://" not in storage.name or path == storage.path.resolve() or storage.read(READ_VERSION, 1) != WAL_VERSION:
        return path
    try:
        wal = open_storage(f"{storage.name}-wal")
    except LogError:  # there is none
        return path
    with path.with_name(f"{path.name}-wal").open("wb") as file:
        for at in range(0, wal.size, WINDOW):
            file.write(wal.read(at, WINDOW))
    wal.close()
    return path


def _connected(path: Path, reader: SqliteReader) -> sqlite3.Connection:
    """The file, for reading. In its WAL mode SQLite makes a file beside it even then, which a folder that is not ours to write refuses.

    There the file is read as one that nobody changes, if no WAL is beside it; else a copy of both is, as long as the reader is there.
    """
    database = _opened(path, "mode=ro")
    try:
        database.execute("SELECT COUNT(*) FROM sqlite_master")
    except sqlite3.OperationalError as error:
        if error.sqlite_errorcode & PRIMARY not in (sqlite3.SQLITE_READONLY, sqlite3.SQLITE_CANTOPEN):
            raise
        database.close()
        wal = path.with_name(f"{path.name}-wal")
        if not wal.exists() or not wal.stat().st_size:
            return _opened(path, "mode=ro&immutable=1")
        folder = Path(tempfile.mkdtemp(prefix="rosetta-jit-"))
        finalize(reader, shutil.rmtree, folder, ignore_errors=True)
        for each in (path, wal):
            shutil.copyfile(each, folder / each.name)
        return _opened(folder / path.name, "mode=ro")
    return database


def _opened(path: Path, mode: str) -> sqlite3.Connection:
    return sqlite3.connect(f"{path.as_uri()}?{mode}", uri=True, check_same_thread=False)


def _sizes(header: bytes) -> tuple[int, int, int]:
    """The bytes of a page, those of it that SQLite uses, and those that the file has, by its header; 0 where that does not say."""
    page, reserved, change, pages, said_at = struct.unpack_from(">16xH2xB3xII60xI", header)
    size = MOST_OF_PAGE if page == 1 else page
    return size, size - reserved, pages * size if change == said_at else 0


def _query(wanted: Wanted, table: str) -> tuple[str, list[int]]:
    conditions, parameters = list[str](), list[int]()
    if wanted.connections is not None:
        conditions.append(f"topic_id IN ({', '.join('?' for _ in wanted.connections)})")
        parameters += wanted.connections
    for moment, condition in ((wanted.start_ns, "timestamp >= ?"), (wanted.end_ns, "timestamp < ?")):
        if moment is not None:
            conditions.append(condition)
            parameters.append(moment)
    where = f" WHERE {' AND '.join(conditions)}" if conditions else ""
    return f"SELECT id, topic_id, timestamp, data FROM {table}{where} ORDER BY timestamp, id", parameters  # noqa: S608 - of our own words


def _kept(octets: bytes) -> str:
    """Text of which `_octets` gives all bytes again, whatever they are."""
    return octets.decode("utf-8", "surrogateescape")


def _text(value: object) -> str:
    """A column of text, which may hold anything: what is no UTF-8 is replaced."""
    return _octets(value).decode("utf-8", "replace") if isinstance(value, (str, bytes)) else str(value)


def _octets(value: object) -> bytes:
    match value:
        case bytes():
            return value
        case str():
            return value.encode("utf-8", "surrogateescape")
        case _:
            return b""
