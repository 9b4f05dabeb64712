"""No message makes a holder larger than a stated multiple of its bytes, unless the mapping says so."""

from __future__ import annotations

import struct
import time

import numpy as np
import pytest

import rosetta_jit as rj
from rosetta_jit.runtime.run import ELEMENTS_A_BYTE, GRACE_BYTES

FILES = {
    "t/In.msg": "int64 n\n",
    "t/Point.msg": "float64 x\nfloat64[16] more\n",
    "t/Out.msg": "float64[] a\nPoint[] points\nstring[] names\n",
    "m.mapping": """import "t/In.msg"
import "t/Out.msg"
data-holder: t/Out
wire-schema: t/In
unpack-rules:
  len(.a) = .n
  for i from 0 to .n
    .a[i] = 1.0
  end
  len(.points) = 0
  len(.names) = 0
""",
}
LIMIT = "wire-schema: t/In\nlimit: {}\n"
MOST = GRACE_BYTES // 8 + 8 * ELEMENTS_A_BYTE
"""Doubles out of a message of eight bytes."""
BACKENDS = ["llvm", "interpreter"]


def decoder(text: str = FILES["m.mapping"], backend: str = "llvm", limit: int | None = None) -> rj.Decoder:
    said = "wire-schema: t/In\n" if limit is None else LIMIT.format(limit)
    return rj.Decoder(
        "m.mapping", schema={**FILES, "m.mapping": text.replace("wire-schema: t/In\n", said)}, encoding="ros1", backend=backend
    )


def size(holder) -> int:
    return sum(buffer.size for buffer in holder.lanes_.buffers)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_length_out_of_a_number(backend):
    decode = decoder(backend=backend)
    most = MOST if backend == "llvm" else 1_000
    assert len(decode(struct.pack("<q", most)).a) == most
    for count in (MOST + 1, 2 * MOST, 1 << 40):
        holder = decode.new()
        with pytest.raises(rj.DecodeError, match="limit:") as error:
            decode(struct.pack("<q", count), holder)
        assert (error.value.kind, error.value.path) == ("count", ".a")
        assert size(holder) < 2 * GRACE_BYTES


def test_a_mapping_says_how_much_it_means():
    decode = decoder(limit=8_000_000)
    assert len(decode(struct.pack("<q", 1_000_000)).a) == 1_000_000
    with pytest.raises(rj.DecodeError, match="8000000 bytes besides"):
        decode(struct.pack("<q", 1_000_000 + 8 * ELEMENTS_A_BYTE + 1))
    assert len(decoder(limit=0)(struct.pack("<q", 500)).a) == 500
    with pytest.raises(rj.DecodeError):
        decoder(limit=0)(struct.pack("<q", 8 * ELEMENTS_A_BYTE + 1))


@pytest.mark.parametrize("limit", [str(1 << 41), "9" * 5_000, "0x" + "f" * 30])
def test_a_limit_is_a_number_of_bytes(limit):
    with pytest.raises(rj.MappingError, match="a limit is at most"):
        decoder(limit=limit)
    with pytest.raises(rj.MappingError, match="stands twice"):
        decoder(limit=f"1\nlimit: {2}")


def test_a_parameter_may_be_called_limit():
    text = (
        FILES["m.mapping"]
        .replace("data-holder", "parameter limit: int64 = 3\ndata-holder")
        .replace("= .n\n", "= limit\n")
        .replace("to .n", "to limit")
    )
    assert len(decoder(text)(bytes(8)).a) == 3


def test_many_messages_are_measured_one_by_one():
    """Those before do not count, nor do their bytes."""
    decode = decoder()
    good, bad = struct.pack("<q", 100_000), struct.pack("<q", 1 << 24)
    batch = decode.many(good * 20, np.arange(21) * 8)
    assert len(batch[19].a) == 100_000
    with pytest.raises(rj.DecodeError, match="limit:") as error:
        decode.many(good * 20 + bad, np.arange(22) * 8)
    assert error.value.path == "[20].a"


@pytest.mark.parametrize("backend", [each for each in BACKENDS if each != "interpreter"])  # which takes a minute for a megabyte of text
def test_elements_that_come_one_by_one(backend):
    """Each asks for little; together they are as much."""
    text = FILES["m.mapping"].replace(
        "len(.names) = 0", 'len(.names) = .n\n  for i from 0 to .n\n    .names[i] = "' + "x" * 2_000 + '"\n  end'
    )
    decode = decoder(text.replace("= .n\n  for i from 0 to .n\n    .a[i] = 1.0\n  end", "= 0"), backend)
    assert len(decode(struct.pack("<q", 100)).names) == 100
    with pytest.raises(rj.DecodeError, match="limit:") as error:
        decode(struct.pack("<q", 5_000))
    assert error.value.path == ".names"


def test_arrays_of_fixed_length_are_part_of_their_element():
    """One point is seventeen numbers, whatever its message says of them."""
    text = FILES["m.mapping"].replace(
        "len(.points) = 0", "len(.points) = .n\n  for i from 0 to .n\n    .points[i].x = 1.0\n    default .points[i].more\n  end"
    )
    decode = decoder(text)
    assert decode(struct.pack("<q", 5_000)).points[4_999].more.tolist() == [0.0] * 16


WIRES = {
    "ros1": ("t/A", {"t/E.msg": "", "t/A.msg": "E[] e\n"}, struct.pack("<I", 0xFFFFFFFF)),
    "cdr": ("t/msg/A", {"t/msg/E.msg": "", "t/msg/A.msg": "E[] e\n"}, b"\0\1\0\0" + struct.pack("<I", 0xFFFFFFFF)),
    "lcm": ("A", {"A.lcm": "struct E { } struct A { int32_t n; E e[n]; }"}, None),
    "protobuf": ("t.A", {"a.proto": 'syntax = "proto3"; package t; message E {} message A { repeated E e = 1; }'}, b"\n\0" * 10_000),
}


@pytest.mark.parametrize("encoding", WIRES)
def test_elements_without_bytes(encoding):
    """A count of elements that take no bytes is not backed by any."""
    type_, files, data = WIRES[encoding]
    decode = rj.Decoder.of(type_, schema=files, encoding=encoding, imports=[next(reversed(files))])
    if data is None:
        write = rj.Encoder.of(type_, schema=files, encoding=encoding, imports=[next(reversed(files))])
        data = write(write.holder_type())[:8] + struct.pack(">i", 0x7FFFFFFF)
    start = time.process_time()
    kinds: list[str] = []
    try:
        decode(data)
    except rj.DecodeError as error:
        kinds.append(error.kind)
    assert kinds in ([], ["count"], ["truncated"])
    assert size(decode._shared.holder) < 2 * GRACE_BYTES + 64 * ELEMENTS_A_BYTE * len(data)
    assert time.process_time() - start < 10
