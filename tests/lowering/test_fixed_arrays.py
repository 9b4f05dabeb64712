"""Arrays and bytes of fixed length within elements: rules read them where they lie in the message."""

from __future__ import annotations

import struct

import numpy as np
import pytest

import rosetta_jit as rj
from rosetta_jit.lowering.rules.in_place import obstacle
from rosetta_jit.pipeline.build import Build
from rosetta_jit.pipeline.request import Request

BACKENDS = ["llvm", "numba", "python", "interpreter"]
FILES = {
    "t/V.msg": "int16 a\nint16 b\n",
    "t/Part.msg": "uint8 kind\nuint8[5] data\nfloat32[3] values\nt/V[2] pairs\nint32 number\n",
    "t/In.msg": "uint32 n\nuint32 i\nt/Part[] parts\n",
    "t/Out.msg": "float64[] sums\nint16[] signals\nuint8 byte\nint16 pair\nint64 long\nuint8[] data\nbool same\n",
}
RULES = """import "t/In.msg" import "t/Out.msg" data-holder: t/Out wire-schema: t/In
unpack-rules:
  .sums[] = .parts[].values[0] + .parts[].values[2]
  .signals[] = signal(.parts[].data, "12|13@1-")
  .byte = .parts[.n].data[.i]
  .pair = .parts[.n].pairs[.i].b
  .long = len(.parts[.n].data) + len(.parts[.n].pairs)
  .data = .parts[.n].data
  .same = .parts[.n].data == "abcde"
  ignore rest
"""
PART = struct.Struct("<B5s3f4hi")


def message(n, i, parts):
    return struct.pack("<III", n, i, len(parts)) + b"".join(PART.pack(*part) for part in parts)


def some_parts(count):
    chosen = np.random.default_rng(1)
    return [
        (
            int(chosen.integers(256)),
            chosen.bytes(5) if number % 2 else b"abcde",
            *(float(each) for each in np.float32(chosen.normal(size=3))),
            *(int(each) for each in chosen.integers(-30000, 30000, 4)),
            number,
        )
        for number in range(count)
    ]


def expected(n, i, parts):
    signals = [int.from_bytes(part[1], "little") >> 12 & 0x1FFF for part in parts]
    return {
        "sums": [float(np.float32(part[2]) + np.float32(part[4])) for part in parts],
        "signals": [each - (each >> 12 << 13) for each in signals],
        "byte": parts[n][1][i],
        "pair": parts[n][6 + 2 * i],
        "long": 7,
        "data": list(parts[n][1]),
        "same": parts[n][1] == b"abcde",
    }


@pytest.mark.parametrize("borrow", [False, True])
@pytest.mark.parametrize("backend", BACKENDS)
def test_they_are_read(backend, borrow):
    decode = rj.Decoder("m.mapping", schema={**FILES, "m.mapping": RULES}, encoding="ros1", backend=backend, borrow=borrow)
    parts = some_parts(4)
    for n, i in ((0, 0), (3, 1), (2, 1)):
        found = decode(message(n, i, parts)).to_dict()
        assert {name: list(each) if isinstance(each, bytes | np.ndarray) else each for name, each in found.items()} == expected(n, i, parts)


def test_they_are_read_in_place():
    build = Build(Request("decode", mapping="m.mapping", encoding="ros1", files=tuple({**FILES, "m.mapping": RULES}.items())))
    assert obstacle(build.encoding, build.encoding.attempts, build.types.rules, "decode", build.types.schema) is None


@pytest.mark.parametrize("backend", BACKENDS)
def test_what_is_not_there_is_refused(backend):
    decode = rj.Decoder("m.mapping", schema={**FILES, "m.mapping": RULES}, encoding="ros1", backend=backend)
    whole = message(1, 1, some_parts(3))
    for n, i in ((3, 0), (2**32 - 1, 0), (0, 2), (0, 5), (2, 2**32 - 1)):
        with pytest.raises(rj.DecodeError) as error:
            decode(message(n, i, some_parts(3)))
        assert error.value.kind == "index"
    for size in range(len(whole)):
        with pytest.raises(rj.DecodeError) as error:
            decode(whole[:size])
        assert error.value.kind == "truncated"
    huge = struct.pack("<III", 0, 0, 2**32 - 1) + whole[12:]
    with pytest.raises(rj.DecodeError) as error:
        decode(huge)
    assert error.value.kind in ("truncated", "count")
