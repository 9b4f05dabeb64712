"""Messages of the real RTT: their values, bit for bit, and back to the same bytes."""

from __future__ import annotations

import json
import struct
from functools import cache
from pathlib import Path

import pytest

import rosetta_jit as rj

RECORDED = json.loads((Path(__file__).parents[2] / "vectors" / "orocos" / "rtt-mqueue.json").read_text())
RECORDS = RECORDED["records"]
BACKENDS = ["llvm", "python", "interpreter"]


@cache
def programs(type_, backend):
    options = {"schema": RECORDED["definitions"], "encoding": "rtt-mqueue", "backend": backend}
    return rj.Decoder.of(type_, **options), rj.Encoder.of(type_, **options)


def check(held, value):
    """Whether what a holder shows is what was recorded."""
    match value:
        case {"fields": fields}:
            for name, each in fields:
                check(held[name] if isinstance(held, dict) else getattr(held, name), each)
        case {"items": items}:
            assert len(held) == len(items)
            for one, each in zip(held, items, strict=True):
                check(one, each)
        case {"values": values, "type": type_}:
            code = "f" if "float" in type_ else "d"
            assert [struct.pack(code, each) for each in held] == [struct.pack(code, float(each)) for each in values]
        case {"hex": text}:
            assert bytes(held) == bytes.fromhex(text)
        case {"value": scalar, "type": "float" | "double"}:
            assert struct.pack("d", held) == struct.pack("d", float(scalar))
        case {"value": scalar}:
            assert held == scalar


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("number", range(len(RECORDS)))
def test_decodes_and_encodes_back(number, backend):
    record = RECORDS[number]
    decode, encode = programs(record["type"], backend)
    data = bytes.fromhex(record["bytes"])
    held = decode(data)
    value = record["value"]
    if record["type"].startswith("std::vector"):
        check(held.data, value)
    else:
        check(held, value)
    assert encode(held) == data


@pytest.mark.parametrize("record", RECORDS[::3], ids=lambda record: record["type"])
def test_a_message_cut_short_is_refused(record):
    decode, _ = programs(record["type"], "python")
    data = bytes.fromhex(record["bytes"])
    for size in range(len(data)):
        with pytest.raises(rj.DecodeError):
            decode(data[:size])
