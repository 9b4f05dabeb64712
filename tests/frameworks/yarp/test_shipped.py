"""Messages of the real YARP through the schemas that are shipped for their types."""

from __future__ import annotations

import json
import struct
from pathlib import Path

import pytest

import rosetta_jit as rj

VECTORS = Path(__file__).resolve().parents[2] / "vectors" / "yarp"
TYPES = {"matrix_2x3": "yarp.sig.Matrix", "matrix_1x1": "yarp.sig.Matrix", "sound_4x2": "yarp.sig.Sound"}
SOUND = {"samples": 4, "channels": 2, "sample_bytes": 2, "frequency": 16000, "data": [0, 100, 200, 300, 1, 101, 201, 301]}


def message(dialect, name):
    return next(bytes.fromhex(entry["hex"]) for entry in json.loads((VECTORS / f"{dialect}.json").read_text()) if entry["name"] == name)


def programs(name, dialect, backend):
    options = {"encoding": dialect, "backend": backend}
    return rj.Decoder.of(name, **options), rj.Encoder.of(name, **options)


@pytest.mark.parametrize("backend", ["numba", "python", "interpreter"])
@pytest.mark.parametrize(
    ("dialect", "name"), [("yarp3", "matrix_2x3"), ("yarp3", "matrix_1x1"), ("yarp3", "sound_4x2"), ("yarp4", "matrix_2x3")]
)
def test_messages_of_the_real_yarp(dialect, name, backend):
    decode, encode = programs(TYPES[name], dialect, backend)
    data = message(dialect, name)
    assert encode(decode(data)) == data


def test_values():
    decode, _ = programs("yarp.sig.Sound", "yarp3", "interpreter")
    assert decode(message("yarp3", "sound_4x2")).to_dict() == SOUND


def test_yarp4_adds_what_is_no_bottle():
    decode, _ = programs("yarp.sig.Sound", "yarp4", "interpreter")
    with pytest.raises(rj.DecodeError, match="count"):
        decode(message("yarp4", "sound_4x2"))


@pytest.mark.parametrize(("dialect", "tag"), [("yarp3", 10), ("yarp4", 20)])
def test_stamps(dialect, tag):
    decode, encode = programs("yarp.os.Stamp", dialect, "interpreter")
    data = struct.pack("<iiiiid", 256, 2, 1, 7, tag, 2.5)
    assert (decode(data).sequence, decode(data).time) == (7, 2.5)
    assert encode(decode(data)) == data
