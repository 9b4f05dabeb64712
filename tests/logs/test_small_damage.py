"""Damage of the formats that are read message by message, of folders and of databases; and of bags, whose index has a form of its own."""

from __future__ import annotations

import random
import shutil
import sqlite3
import struct
from pathlib import Path

import pytest

import rosetta_jit as rj
from rosetta_jit.errors import LogError
from rosetta_jit.logs.bag.grammar import CHUNK, header_of
from rosetta_jit.logs.bag.writer import record, u32

from .made import time_of, write_bag
from .test_damage import codes, damage, read
from .test_folders import write_rosbag2
from .test_small_formats import event, tide, varint

COUNT = 12
DUMPED = Path(__file__).parent / "yarpdatadumper"


def texts():
    return [f"message {number} ".encode() * (number % 3 + 1) for number in range(COUNT)]


def tide_file():
    entries = [(7, time_of(number), event(each, 1_700_000_000_000_000 + number)) for number, each in enumerate(texts())]
    return tide([(7, b"/a/", b"rsb-event-0.9:.a.A")], entries)


SMALL = {
    "a.rec": b"".join(struct.pack("<dI", number, len(each)) + each for number, each in enumerate(texts())),
    "a.delimited": b"".join(varint(len(each)) + each for each in texts()),
    "a.tide": tide_file(),
}


@pytest.mark.parametrize("kind", SMALL)
def test_cut_at_each_byte(kind, tmp_path):
    whole, before = SMALL[kind], 0
    everything, found = read(tmp_path / kind, whole)
    assert (len(everything), found) == (COUNT, [])
    for size in range(len(whole)):
        try:
            messages, _ = read(tmp_path / kind, whole[:size])
        except LogError:
            assert size < 22
            continue
        assert messages == everything[: len(messages)]
        assert len(messages) >= before
        before = len(messages)
    assert before == COUNT - 1


@pytest.mark.parametrize("kind", SMALL)
def test_random_damage(kind, tmp_path):
    mutated(kind, SMALL[kind], tmp_path, 150)


@pytest.mark.campaign
@pytest.mark.parametrize("kind", SMALL)
def test_much_random_damage(kind, tmp_path):
    mutated(kind, SMALL[kind], tmp_path, 100_000)


def mutated(kind, whole, folder, count):
    dice = random.Random(kind)
    for _ in range(count):
        data = bytearray(whole)
        for _ in range(dice.randint(1, 3)):
            damage(data, dice)
        try:
            messages, _ = read(folder / kind, bytes(data))
        except LogError:
            continue
        assert sum(len(each.message) for each in messages) <= len(data)


@pytest.fixture(scope="module")
def database(tmp_path_factory):
    (file,) = write_rosbag2(tmp_path_factory.mktemp("database") / "a").glob("*.db3")
    return file.read_bytes()


def damaged_databases(database, folder, count):
    """Each is opened or refused; nothing is made up of bytes that are not there."""
    dice, opened = random.Random(1), 0
    for turn in range(count):
        data = bytearray(database)
        if turn % 3:
            for _ in range(dice.randint(1, 8)):
                damage(data, dice)
        else:
            del data[dice.randrange(len(data)) :]
        try:
            messages, _ = read(folder / "a.db3", bytes(data))
        except LogError:
            continue
        opened += 1
        assert sum(len(each.message) for each in messages) <= 2 * len(data)
    assert opened


def test_damaged_databases(database, tmp_path):
    damaged_databases(database, tmp_path, 60)


@pytest.mark.campaign
def test_many_damaged_databases(database, tmp_path):
    damaged_databases(database, tmp_path, 20_000)


def test_databases_cut_at_many_bytes(database, tmp_path):
    cut_databases(database, tmp_path, {*range(0, len(database), 1511), *range(4096, len(database), 4096), len(database) - 4095})


@pytest.mark.campaign
def test_databases_cut_at_each_byte(database, tmp_path):
    cut_databases(database, tmp_path, range(len(database)))


def cut_databases(database, tmp_path, sizes):
    """Where what is read is not all, or not the same, it is said that the file is cut."""
    everything = {(each.time, each.topic, each.message) for each in read(tmp_path / "a.db3", database)[0]}
    assert everything
    for size in sizes:
        try:
            messages, found = read(tmp_path / "a.db3", database[:size])
        except LogError:
            continue
        assert len(messages) <= len(everything)
        given = {(each.time, each.topic, each.message) for each in messages}
        assert given <= everything, size
        assert given == everything or "log-cut" in codes(found), size


@pytest.mark.parametrize("sizes", [[30] * 20, [100] * 3 + [5000] * 3, [20_000]], ids=str)
def test_messages_of_which_the_end_is_missing(sizes, tmp_path):
    """SQLite takes the missing bytes of its last page as zeros, in a leaf and in what overflows it: no message is made of these."""
    path = tmp_path / "a.db3"
    with sqlite3.connect(path) as database:
        database.execute("PRAGMA page_size = 1024")
        database.execute("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT)")
        database.execute("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB)")
        database.execute("INSERT INTO topics VALUES (1, '/a', 't/msg/X', 'cdr')")
        rows = [(number, bytes([number + 1]) * size) for number, size in enumerate(sizes)]
        database.executemany("INSERT INTO messages(topic_id, timestamp, data) VALUES (1, ?, ?)", rows)
    database.close()
    whole, left_out = path.read_bytes(), 0
    for size in range(len(whole) - 1023, len(whole), 41):
        try:
            messages, found = read(path, whole[:size])
        except LogError:  # a page that others hang on
            continue
        assert {(each.time, each.message) for each in messages} <= set(rows)
        assert "log-cut" in codes(found)
        left_out += len(rows) - len(messages)
    assert left_out


@pytest.mark.parametrize("wrong", [None, 1.5, "two", b"\1", "\ud800"], ids=repr)
def test_values_of_any_type_in_a_database(wrong, tmp_path):
    """SQLite lets each column hold anything: what is no topic and no message is left out, and the others are read."""
    path = tmp_path / "a.db3"
    with sqlite3.connect(path) as database:
        database.execute("CREATE TABLE topics(id, name, type, serialization_format)")
        database.execute("CREATE TABLE messages(id, topic_id, timestamp, data)")
        database.execute("CREATE TABLE message_definitions(topic_type, encoding, encoded_message_definition)")
        octets = wrong.encode("utf-8", "surrogatepass") if isinstance(wrong, str) else wrong
        value = "CAST(? AS TEXT)" if isinstance(wrong, str) else "?"
        database.execute("INSERT INTO topics VALUES (1, '/a', 't/msg/X', 'cdr')")
        for columns in (f"{value}, '/b', 't/msg/X', 'cdr'", f"2, {value}, 't/msg/X', 'cdr'", f"3, '/c', {value}, {value}"):
            database.execute(f"INSERT INTO topics VALUES ({columns})", [octets] * columns.count("?"))  # noqa: S608 - our own words
        for columns in ("1, 1, 5, x'07'", f"2, {value}, 6, x'07'", f"3, 1, {value}, x'07'", f"4, 1, 7, {value}", f"{value}, 1, 8, x'07'"):
            database.execute(f"INSERT INTO messages VALUES ({columns})", [octets] * columns.count("?"))  # noqa: S608 - our own words
        database.execute(f"INSERT INTO message_definitions VALUES ({value}, {value}, {value})", [octets] * 3)  # noqa: S608 - our own words
    database.close()
    messages, found = read(path, path.read_bytes())
    data = octets if isinstance(octets, bytes) else b""
    assert [(each.time, each.topic, each.message) for each in messages] == [(5, "/a", b"\7"), (7, "/a", data), (8, "/a", b"\7")]
    assert set(codes(found)) == {"log-row"}
    assert {"/a", "/c"} <= set(rj.open(path, on_problem=list[object]().append).topics)


def test_a_cut_folder_of_yarpdatadumper(tmp_path):
    cut_folder(tmp_path / "bottle_cli", 3)


@pytest.mark.campaign
def test_a_folder_of_yarpdatadumper_cut_at_each_byte(tmp_path):
    cut_folder(tmp_path / "bottle_cli", 1)


def cut_folder(folder, step):
    shutil.copytree(DUMPED / "bottle_cli", folder)
    whole, before = (folder / "data.log").read_bytes(), 0
    everything = list(rj.open(folder).messages(raw=True))
    for size in range(0, len(whole), step):
        (folder / "data.log").write_bytes(whole[:size])
        found = []
        messages = list(rj.open(folder, on_problem=found.append).messages(raw=True))
        assert messages == everything[: len(messages)]
        assert len(messages) >= before
        assert set(codes(found)) <= {"log-cut"}
        before = len(messages)
    dice = random.Random(3)
    for _ in range(100):
        data = bytearray(whole)
        damage(data, dice)
        (folder / "data.log").write_bytes(data)
        assert len(list(rj.open(folder, on_problem=list[object]().append).messages(raw=True))) <= 2 * len(everything)


def chunk_of(data):
    """Where the first chunk of a bag is, its header, and where its data begin."""
    at = 13
    while True:
        header, begin = header_of(data[at:])
        if header[b"op"] == bytes([CHUNK]):
            return at, header, begin
        at += begin + int.from_bytes(data[at + begin - 4 : at + begin], "little")


@pytest.mark.parametrize(
    ("field", "value", "said"),
    [
        (b"compression", b"none", "promises"),
        (b"compression", b"bz9", "'bz9', which is not known"),
        (b"size", u32(0xFFFFFFFF), "more than the limit"),
        (b"size", u32(1 << 30), "promises 1073741824 bytes"),
    ],
)
def test_chunks_of_bags_that_lie(tmp_path, field, value, said):
    data = write_bag(tmp_path / "a.bag", 40, "bz2").read_bytes()
    everything, _ = read(tmp_path / "a.bag", data)
    at, header, begin = chunk_of(data)
    size = int.from_bytes(data[at + begin - 4 : at + begin], "little")
    content = data[at + begin : at + begin + size]
    fields = {name.decode(): text for name, text in {**header, field: value}.items()}
    lying = data[:at] + record(content, **fields) + data[at + begin + size :]
    messages, found = read(tmp_path / "b.bag", lying)
    assert any(said in each.message for each in found)
    assert {each.message for each in messages} <= {each.message for each in everything}
    assert messages


@pytest.mark.parametrize("off", [1, -7, 1 << 40])
def test_an_index_of_a_bag_that_lies(tmp_path, off):
    """A chunk is elsewhere than the index says: it is found, and no message is lost or there twice."""
    data = write_bag(tmp_path / "a.bag", 200).read_bytes()
    everything, _ = read(tmp_path / "a.bag", data)
    at, _, begin = chunk_of(data)
    at += begin + int.from_bytes(data[at + begin - 4 : at + begin], "little")  # of the second chunk, which indices are before
    while header_of(data[at:])[0][b"op"] != bytes([CHUNK]):
        _, begin = header_of(data[at:])
        at += begin + int.from_bytes(data[at + begin - 4 : at + begin], "little")
    place = data.rindex(b"chunk_pos=" + struct.pack("<Q", at)) + len(b"chunk_pos=")
    messages, found = read(tmp_path / "b.bag", data[:place] + struct.pack("<Q", at + off) + data[place + 8 :])
    assert sorted(messages) == sorted(everything)
    assert "log-index" in codes(found)
