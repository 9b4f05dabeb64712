"""Entries of maps as hardly anybody writes them, in generated Python: without a key, with two, in any order, with fields of other types."""

from __future__ import annotations

import random

import pytest

import rosetta_jit as rj
from rosetta_jit.api.options import type_request
from tests.generate.driver import expected, harmed
from tests.generate.python import answer, module, protobuf, same

MAPS = (("int32", "string"), ("string", "S"), ("bool", "double"), ("sint64", "E"), ("fixed32", "bytes"), ("string", "uint64"))
FIELDS = " ".join(f"map<{key}, {value}> m{number} = {number};" for number, (key, value) in enumerate(MAPS, 1))
BODY = f"""
    enum E {{ ZERO = 0; ONE = 1; }}
    message S {{ int32 number = 1; string text = 2; repeated int32 numbers = 3; }}
    message Row {{ {FIELDS} }}
    message M {{ {FIELDS} repeated Row rows = 9; Row row = 10; }}
"""
OTHERS = (b"\x18\x05", b"\x1a\x01x", b"\x1b\x1c", b"\x25abcd")
"""Fields that no entry has."""


def field(chance: random.Random, kind: str, number: int) -> bytes:
    tag = number << 3
    match kind:
        case "string" | "bytes":
            return sized(number, chance.choice((b"", b"a", b"bc", "ä".encode())))
        case "S":
            parts = (b"\x08\x01", b"\x08\xac\x02", b"\x12\x01t", b"\x1a\x02\x01\x02", b"\x18\x05", b"\x30\x01")
            return sized(number, b"".join(chance.choices(parts, k=chance.randrange(4))))
        case "double":
            return bytes([tag | 1]) + bytes(chance.choices((0, 1, 7), k=8))
        case "fixed32":
            return bytes([tag | 5]) + bytes(chance.choices((0, 1, 7), k=4))
        case _:
            return bytes([tag]) + chance.choice((b"\0", b"\1", b"\2", b"\x7f", b"\x80\x01", b"\xff\xff\xff\xff\x0f", b"\xff" * 9 + b"\x01"))


def sized(number: int, part: bytes) -> bytes:
    return bytes([number << 3 | 2, len(part)]) + part


def entry(chance: random.Random, number: int) -> bytes:
    kinds = {1: MAPS[number - 1][0], 2: MAPS[number - 1][1]}
    parts: list[bytes] = []
    for _ in range(chance.randrange(5)):
        which, kind = chance.choice((1, 2)), chance.random()
        parts.append(field(chance, kinds[which] if kind < 0.9 else kinds[3 - which], which) if kind < 0.95 else chance.choice(OTHERS))
    return sized(number, b"".join(parts))


@pytest.mark.parametrize("seed", range(3))
def test_entries_become_what_the_library_makes_of_them(seed):
    """Of two entries with one key the library's rows have both, which it writes again: of them the last one stands, for both."""
    given, chance = protobuf(BODY), random.Random(seed)
    unit, programs = module(type_request("decode", "t.M", given)), (rj.Decoder.of("t.M", **given), rj.Encoder.of("t.M", **given))
    messages: list[bytes] = []
    for _ in range(60):
        entries, rows = ([entry(chance, chance.randrange(1, 7)) for _ in range(chance.randrange(4))] for _ in range(2))
        messages.append(b"".join((*entries, sized(chance.choice((9, 10)), b"".join(rows)[:127]))))
    for message in harmed(messages, 3, f"entries {seed}"):
        found, wanted = answer(unit, message), expected(*programs, message)
        if not same(found, wanted):
            assert (found[:3], wanted[:3]) == ("ok ", "ok "), (message.hex(), found, wanted)
            written = bytes.fromhex(wanted[3:])
            assert len(written) > len(found[3:]) // 2
            assert unit.decode(written) == unit.decode(message)
            assert answer(unit, written) == found
