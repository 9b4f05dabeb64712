"""Arrays of varints without tags: those of one byte or two are read several at once."""

from __future__ import annotations

import random

import pytest

import rosetta_jit as rj

SIZES = {"int32": 32, "int64": 64, "uint32": 32, "uint64": 64, "sint32": 32, "sint64": 64, "bool": 1, "Open": 32}
FILE = (
    'syntax = "proto3";\npackage t;\nenum Open {{ NONE = 0; }}\nmessage M {{ repeated {0} a = 1; int32 b = 2; repeated {0} c = 3; {1} }}\n'
)


def programs(kind, more="", **options):
    schema = {"t.proto": FILE.format(kind, more)}
    return rj.Decoder.of("t.M", encoding="protobuf", schema=schema, **options), rj.Encoder.of("t.M", encoding="protobuf", schema=schema)


def varint(value, size=0):
    """As few bytes as it takes, or as many as are wanted."""
    rest, written = value % (1 << 64), bytearray()
    while rest >= 0x80 or len(written) + 1 < size:
        written.append(rest & 0x7F | 0x80)
        rest >>= 7
    return bytes([*written, rest])


def value_of(kind, raw):
    """The number that a varint of a kind stands for, by the specification (protobuf.dev, "Encoding")."""
    bits = SIZES[kind]
    if kind == "bool":
        return raw != 0
    low = raw % (1 << bits)
    if kind.startswith("s"):
        return low >> 1 ^ -(low & 1)
    return low - (1 << bits) if not kind.startswith("u") and low >> bits - 1 else low


def runs(rng, kind):
    """Varints of which neighbours are mostly of one size, of any size now and then, some of them longer than they must be."""
    found: list[tuple[int, bytes]] = []
    while len(found) < 60:
        style = rng.choice(["one", "two", "either", "padded", "longer", "any"])
        for _ in range(rng.randrange(1, 14)):
            size = rng.choice(
                {"one": [1], "two": [2], "either": [1, 2], "padded": [2], "longer": [3, 4, 5, 6], "any": [1, 2, 3, 5, 10]}[style]
            )
            most = 1 if kind == "bool" else (1 << min(7 * size, 64)) - 1
            raw = rng.randrange(128 if style == "padded" and kind != "bool" else most + 1)
            found.append((raw, varint(raw, size if style == "padded" else 0)))
    return found


def message(found):
    body = b"".join(written for _, written in found)
    return b"\x0a" + varint(len(body)) + body


@pytest.mark.parametrize("backend", ["llvm", "python"])
@pytest.mark.parametrize("kind", SIZES)
def test_runs_of_any_sizes(kind, backend):
    decode, encode = programs(kind, backend=backend)
    rng = random.Random(1)
    for _ in range(200 if backend == "llvm" else 10):
        found = runs(rng, kind)
        wanted = [value_of(kind, raw) for raw, _ in found]
        holder = decode(message(found) + b"\x10\x07")
        assert list(holder.a) == wanted
        assert holder.b == 7
        if backend == "llvm":
            assert list(decode(encode(holder)).a) == wanted
    again = runs(rng, kind)  # the array goes on behind another field
    assert list(decode(message(found) + b"\x10\x07" + message(again)).a) == wanted + [value_of(kind, raw) for raw, _ in again]


@pytest.mark.parametrize("size", [1, 2, 3])
def test_every_length_and_every_cut(size):
    decode, _ = programs("int64")
    for count in range(1, 20):
        found = [(raw, varint(raw)) for raw in range(3 << 7 * size - 6, (3 << 7 * size - 6) + count)]
        data = message(found)
        assert list(decode(data).a) == [raw for raw, _ in found]
        for end in range(2, len(data)):
            with pytest.raises(rj.DecodeError) as caught:
                decode(data[:end])
            assert caught.value.kind == "truncated"
            short = b"\x0a" + varint(end - 2) + data[2:end] + bytes(9)  # the array ends before its last number does
            whole = (end - 2) % size == 0
            if not whole:
                with pytest.raises(rj.DecodeError, match="beyond the array"):
                    decode(short[:-9] + b"\x01" * 9)
            else:
                assert len(decode(short[:-9]).a) == (end - 2) // size


def test_many_arrays_in_a_message_are_read_as_well():
    more = " ".join(f"repeated sint32 x{number} = {number};" for number in range(4, 40))
    decode, encode = programs("int32", more)
    holder = decode.new()
    for number in range(4, 40):
        getattr(holder, f"x{number}").extend(range(-number, 200, number))
    again = decode(encode(holder))
    assert all(list(getattr(again, f"x{number}")) == list(range(-number, 200, number)) for number in range(4, 40))
