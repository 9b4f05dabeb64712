"""Damaged logs: what is whole is read, and each damage is said in words; nothing crashes, hangs or takes more memory than the file."""

from __future__ import annotations

import bz2
import random
import struct
import tracemalloc

import lz4.frame
import pytest
import zstandard

import rosetta_jit as rj
from rosetta_jit.errors import LogError
from rosetta_jit.logs.limits import MAX_RECORD_BYTES
from rosetta_jit.logs.reading.compression import Scratch, decompressed

from .made import write_bag, write_lcm, write_mcap, write_old_bag

COUNT = 12


@pytest.fixture(scope="module")
def logs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("whole")
    return {
        "chunked.mcap": write_mcap(folder / "chunked.mcap", COUNT, chunk_size=300).read_bytes(),
        "lz4.mcap": write_mcap(folder / "lz4.mcap", COUNT, "lz4", chunk_size=300).read_bytes(),
        "loose.mcap": write_mcap(folder / "loose.mcap", COUNT, chunked=False).read_bytes(),
        "a.bag": write_bag(folder / "a.bag", COUNT).read_bytes(),
        "bz2.bag": write_bag(folder / "bz2.bag", COUNT, "bz2").read_bytes(),
        "lz4.bag": write_bag(folder / "lz4.bag", COUNT, "lz4").read_bytes(),
        "old.bag": write_old_bag(folder / "old.bag", COUNT).read_bytes(),
        "a.lcmlog": write_lcm(folder / "a.lcmlog", COUNT).read_bytes(),
    }


KINDS = ("chunked.mcap", "lz4.mcap", "loose.mcap", "a.bag", "bz2.bag", "lz4.bag", "old.bag", "a.lcmlog")


def read(path, data):
    """The messages of a damaged log, and what is said of it."""
    path.write_bytes(data)
    found = []
    with rj.open(path, on_problem=found.append) as log:
        messages = list(log.messages(raw=True))
    return messages, found


@pytest.mark.parametrize("kind", KINDS)
def test_cut_at_many_bytes(kind, logs, tmp_path):
    cut(kind, logs, tmp_path, 11)


@pytest.mark.campaign
@pytest.mark.parametrize("kind", KINDS)
def test_cut_at_each_byte(kind, logs, tmp_path):
    cut(kind, logs, tmp_path, 1)


def cut(kind, logs, tmp_path, step):
    """What was read of a shorter file is read of a longer one, too."""
    whole, path, before = logs[kind], tmp_path / kind, 0
    everything, found = read(path, whole)
    assert not found
    for size in sorted({*range(0, len(whole), step), *range(len(whole) - 40, len(whole))}):
        try:
            messages, found = read(path, whole[:size])
        except LogError as error:
            assert size < 14, error  # noqa: PT017
            continue
        assert messages == everything[: len(messages)]
        assert len(messages) >= before
        assert found or kind == "a.lcmlog"
        before = len(messages)
    assert before >= len(everything) - 1


@pytest.mark.parametrize("kind", KINDS)
def test_random_damage(kind, logs, tmp_path):
    mutated(kind, logs[kind], tmp_path, 150)


@pytest.mark.campaign
@pytest.mark.parametrize("kind", KINDS)
def test_much_random_damage(kind, logs, tmp_path):
    mutated(kind, logs[kind], tmp_path, 100_000)


NUMBERS = (0, 1, 0x7F, 0xFF, 0xFFFF, 0x7FFFFFFF, 0xFFFFFFFF, 1 << 40, (1 << 63) - 1, (1 << 64) - 1)


def mutated(kind, whole, folder, count):
    dice = random.Random(kind)
    tracemalloc.start()
    for _ in range(count):
        data = bytearray(whole)
        for _ in range(dice.randint(1, 3)):
            damage(data, dice)
        tracemalloc.reset_peak()
        try:
            messages, _ = read(folder / kind, bytes(data))
        except LogError:
            continue
        assert len(messages) < 10 * COUNT
        assert tracemalloc.get_traced_memory()[1] < 64 << 20
    tracemalloc.stop()


def damage(data, dice):
    at = dice.randrange(len(data))
    match dice.randrange(5):
        case 0:
            data[at] ^= 1 << dice.randrange(8)
        case 1:
            size = dice.choice((1, 2, 4, 8))
            data[at : at + size] = struct.pack("<Q", dice.choice(NUMBERS))[:size]
        case 2:
            del data[at : at + dice.randint(1, 64)]
        case 3:
            data[at:at] = bytes(dice.randint(1, 64))
        case 4:
            other = dice.randrange(len(data))
            data[at:at] = data[other : other + dice.randint(1, 200)]


def chunk_at(data):
    """Where the first chunk of an MCAP file is."""
    at = 8
    while data[at] != 6:
        at += 9 + int.from_bytes(data[at + 1 : at + 9], "little")
    return at


def codes(found):
    return [each.code for each in found]


def test_a_checksum_that_fails(logs, tmp_path):
    data = bytearray(logs["chunked.mcap"])
    data[chunk_at(data) + 9 + 24] ^= 1
    everything, _ = read(tmp_path / "a.mcap", logs["chunked.mcap"])
    messages, found = read(tmp_path / "a.mcap", bytes(data))
    assert codes(found) == ["log-checksum"]
    assert messages == everything[len(everything) - len(messages) :]
    assert 0 < len(messages) < len(everything)
    assert list(rj.open(tmp_path / "a.mcap", check=False).messages(raw=True)) == everything


@pytest.mark.parametrize("claimed", [1 << 40, MAX_RECORD_BYTES])
def test_a_chunk_that_promises_much(logs, tmp_path, claimed):
    data = bytearray(logs["chunked.mcap"])
    at = chunk_at(data)
    data[at + 25 : at + 33] = struct.pack("<Q", claimed)
    messages, found = read(tmp_path / "a.mcap", bytes(data))
    assert codes(found) == ["log-chunk"]
    assert messages


RLE = b"\x28\xb5\x2f\xfd\xc0\x00" + struct.pack("<Q", MAX_RECORD_BYTES) + (100 << 3 | 3).to_bytes(3, "little") + b"a"
"""A frame of zstd that says that it holds a gigabyte, and has a block of a hundred times the letter a."""


@pytest.mark.parametrize(
    ("compression", "body"),
    [
        ("zstd", zstandard.ZstdCompressor(write_content_size=False).compress(b"a" * 100)),
        ("zstd", RLE),
        ("lz4", lz4.frame.compress(b"a" * 100)),
        ("bz2", bz2.compress(b"a" * 100)),
    ],
    ids=["zstd", "zstd-lies", "lz4", "bz2"],
)
def test_the_memory_for_a_chunk_that_promises_much(compression, body):
    """As much as its bytes can become: a chunk of some hundred bytes is none of a gigabyte."""
    tracemalloc.start()
    found, wrong = decompressed("a.mcap", compression, memoryview(body), MAX_RECORD_BYTES, Scratch())
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 8 << 20
    assert wrong
    assert found.tobytes() == b"a" * len(found)
    assert len(found) == 100 or body is RLE


def test_zeros_of_which_a_chunk_has_many():
    """Of all that is compressed, nothing stands for more bytes."""
    zeros = bytes(64 << 20)
    for compression, body in (("zstd", zstandard.compress(zeros, 19)), ("lz4", lz4.frame.compress(zeros)), ("bz2", bz2.compress(zeros))):
        found, wrong = decompressed("a.mcap", compression, memoryview(body), len(zeros), Scratch())
        assert (found.tobytes() == zeros, wrong) == (True, "")


def test_a_compression_that_is_not_known(logs, tmp_path):
    data = logs["lz4.mcap"].replace(b"lz4", b"xyz", 1)
    messages, found = read(tmp_path / "a.mcap", data)
    assert codes(found) == ["log-chunk"]
    assert "'xyz', which is not known" in found[0].message
    assert messages


def test_an_index_that_lies(logs, tmp_path):
    """The places of chunks in it are others: from there on the file is read record by record, and nothing is lost."""
    data = logs["chunked.mcap"]
    everything, _ = read(tmp_path / "a.mcap", data)
    place = data.rindex(struct.pack("<Q", chunk_at(data)))
    lying = data[:place] + struct.pack("<Q", chunk_at(data) + 5) + data[place + 8 :]
    path = tmp_path / "a.mcap"
    path.write_bytes(lying)
    found = []
    assert list(rj.open(path, check=False, on_problem=found.append).messages(raw=True)) == everything
    assert set(codes(found)) == {"log-index"}


def test_an_index_without_some_chunks(logs, tmp_path):
    """What the index does not cover is read all the same."""
    data = logs["chunked.mcap"]
    everything, _ = read(tmp_path / "a.mcap", data)
    summary = int.from_bytes(data[-28:-20], "little")
    at = summary
    while data[at] != 8:
        at += 9 + int.from_bytes(data[at + 1 : at + 9], "little")
    size = 9 + int.from_bytes(data[at + 1 : at + 9], "little")
    path = tmp_path / "a.mcap"
    path.write_bytes(data[:at] + data[at + size :])
    found = []
    assert list(rj.open(path, check=False, on_problem=found.append).messages(raw=True)) == everything


def test_two_types_of_one_topic(tmp_path):
    from mcap.writer import Writer

    path = tmp_path / "a.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        for name, text in (("t/msg/A", b"int32 x"), ("t/msg/B", b"int16 y"), ("t/msg/A", b"float32 x")):
            channel = writer.register_channel("/x", "cdr", writer.register_schema(name, "ros2msg", text))
            writer.add_message(channel, log_time=1, publish_time=1, data=b"\0\1\0\0\7\0\0\0"[: 8 if "A" in name else 6])
        writer.finish()
    log = rj.open(path)
    with pytest.raises(LogError, match="several types: `t/msg/A`, `t/msg/B`"):
        log["/x"]
    assert log["/x", "t/msg/B"]["y"].tolist() == [7]
    with pytest.raises(LogError, match="of `t/msg/A` by several definitions"):
        log["/x", "t/msg/A"]
    assert [str(each.message) for each in log.messages()] == ["t.msg.A(x=7)", "t.msg.B(y=7)", "t.msg.A(x=9.80908925027372e-45)"]


@pytest.mark.parametrize("data", [b"", b"no log", b"#ROSBAG V3.0\n", b"\x89MCAP0\r\n"])
def test_what_is_no_log(tmp_path, data):
    (tmp_path / "a.bin").write_bytes(data)
    if data.startswith(b"\x89"):
        assert not rj.open(tmp_path / "a.bin", on_problem=list[object]().append).topics
        return
    with pytest.raises(LogError, match="log-"):
        rj.open(tmp_path / "a.bin")


def test_what_cannot_be_opened(tmp_path):
    for path in (tmp_path, tmp_path / "nothing", "/dev/zero", "x\0y", "nothing://at-all"):
        with pytest.raises(LogError, match="log-"):
            rj.open(path)


def test_messages_of_a_channel_that_is_not_defined(logs, tmp_path):
    whole = bytearray(logs["loose.mcap"])
    at = 8
    while whole[at] != 5:
        at += 9 + int.from_bytes(whole[at + 1 : at + 9], "little")
    everything, _ = read(tmp_path / "a.mcap", bytes(whole))
    whole[at + 9] = 77
    messages, found = read(tmp_path / "a.mcap", bytes(whole))
    assert messages == everything[1:]
    assert [each.message for each in found if each.code == "log-channel"] == [
        f"{tmp_path / 'a.mcap'}: messages are of channel 77, which the log does not define"
    ]
