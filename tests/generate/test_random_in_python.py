"""Random schemas and mappings through generated Python: what it reads, writes and refuses is what the library does."""

from __future__ import annotations

import random
from typing import Any

import pytest

import rosetta_jit as rj
from rosetta_jit.api.options import request_of, type_request
from rosetta_jit.generate.build import Wishes
from tests.generate.python import module, same
from tests.random_mappings.hostile import altered
from tests.random_mappings.message_types import some
from tests.random_mappings.rules import Filler
from tests.random_mappings.test_hostile import pair_of
from tests.random_mappings.test_wires import aim, counted, maker, mapping, source
from tests.random_mappings.wires import WIRES

MESSAGES = 12


def answer(decode, encode, data: bytes) -> str:
    try:
        found = decode(data)
    except ValueError as error:
        line = f" ({error.line})" if getattr(error, "line", "") and error.line not in error.detail else ""
        return f"{error.kind} {error.offset} [{error.path}] {error.detail}{line}"
    try:
        return f"ok {bytes(encode(found)).hex()}"
    except ValueError as error:
        return f"{error.kind} [{error.path}]"


def check(seed: int, wishes: Wishes) -> None:
    """A type as it is on the wire, and a mapping of it, whose objects are written as the other type."""
    rng = random.Random(seed)
    names = pair_of(seed)
    src, dst = source(rng, WIRES[names[0]]), aim(rng, WIRES[names[1]])
    files = mapping(src, dst, Filler(maker(rng, src), dst.constant).message(dst.message).text, "decode")
    wire: Any = {"schema": files, **src.wire.options}
    own, other = {**wire, "imports": list(src.files)}, {"schema": files, "imports": list(dst.files), **dst.wire.options}
    write = rj.Encoder.of(src.type_name, **{**own, **src.wire.written})
    plain = module(type_request("decode", src.type_name, own), ("decode", "encode"), wishes)
    mapped = module(request_of("decode", wire, mapping="m.mapping"), ("decode",), wishes)
    target = module(type_request("decode", dst.type_name, other), ("encode",), wishes)
    pairs = (
        (plain.decode, plain.encode, rj.Decoder.of(src.type_name, **own), rj.Encoder.of(src.type_name, **own)),
        (mapped.decode, target.encode, rj.Decoder("m.mapping", **wire), rj.Encoder.of(dst.type_name, **other)),
    )
    for number in range(MESSAGES):
        data = bytes(write(write.holder_type.from_dict(counted(src, some(rng, src.message, rng.choice([0, 1, 3, 4]))))))
        data = altered(rng, data) if number % 2 else data
        for decode, encode, *programs in pairs:
            found, wanted = answer(decode, encode, data), answer(*programs, data)
            assert same(found, wanted), (seed, names, files, data, found, wanted)


@pytest.mark.parametrize("seed", range(2))
def test_random_mappings(seed):
    check(seed, Wishes(numpy=seed == 1))


@pytest.mark.campaign
@pytest.mark.parametrize("block", range(20))
def test_campaign(block):
    for seed in range(100 * block + 1000, 100 * block + 1100):
        check(seed, Wishes(numpy=seed % 3 == 0))
