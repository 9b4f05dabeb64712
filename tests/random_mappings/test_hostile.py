"""Altered messages of all wires through random rules: refused alike by all backends, or the same in all; protobuf's in any order."""

from __future__ import annotations

import random
from typing import Any

import numpy as np
import pytest

import rosetta_jit as rj
from tests.random_mappings.fields import plain
from tests.random_mappings.hostile import altered, mixed
from tests.random_mappings.message_types import Scalar, seen, some
from tests.random_mappings.rules import Filler
from tests.random_mappings.test_wires import aim, counted, maker, mapping, source, wanted, without_cases
from tests.random_mappings.wires import WIRES

MESSAGES = 30


def outcome(decode: Any, data: bytes) -> Any:
    try:
        return plain(without_cases(decode(data).to_dict()))
    except rj.DecodeError as error:
        return error.kind, error.path, error.offset, error.detail


def check_altered(seed: int, names: tuple[str, str], backends: list[str]) -> None:
    rng = random.Random(seed)
    src, dst = source(rng, WIRES[names[0]]), aim(rng, WIRES[names[1]])
    rules = Filler(maker(rng, src), dst.constant).message(dst.message)
    files = mapping(src, dst, rules.text, "decode")
    own = {"schema": files, "imports": list(src.files), "backend": "interpreter", **src.wire.options}
    write = rj.Encoder.of(src.type_name, **own, **src.wire.written)
    decoders = [rj.Decoder("m.mapping", schema=files, backend=backend, **src.wire.options) for backend in backends]
    plainly = [rj.Decoder.of(src.type_name, **{**own, "backend": backend}) for backend in backends]

    def message() -> tuple[dict[str, Any], bytes]:
        values = some(rng, src.message, rng.choice([0, 1, 3, 4]))
        return values, bytes(write(write.holder_type.from_dict(counted(src, values))))

    for _ in range(MESSAGES):
        data = altered(rng, message()[1])
        for group in (decoders, plainly):
            outcomes = [outcome(decode, data) for decode in group]
            assert outcomes[1:] == outcomes[:-1], (seed, names, files, data, outcomes)
    if src.wire.options["encoding"] == "protobuf":
        numbers = {3 * at + 1 for at, kind in enumerate(src.message.fields.values()) if isinstance(kind, Scalar)}
        for _ in range(MESSAGES):
            (values, data), (_, other) = message(), message()
            with np.errstate(all="ignore"):
                expected = wanted(rules, seen(src.message, values, requires=src.wire.requires))
            data = mixed(rng, data, other, numbers)
            for decode in decoders:
                found = outcome(decode, data)
                assert (found[:2] if isinstance(found, tuple) else found) == expected, (seed, names, files, values, data, found, expected)


def pair_of(seed: int) -> tuple[str, str]:
    rng = random.Random(f"bytes {seed}")
    names = [*WIRES, "proto2", "proto3", "proto2", "proto3"]
    return rng.choice(names), rng.choice(list(WIRES))


@pytest.mark.parametrize("seed", range(2))
def test_altered(seed):
    check_altered(seed, pair_of(seed), ["python", "llvm"])


@pytest.mark.campaign
@pytest.mark.parametrize("block", range(20))
def test_campaign(block):
    for seed in range(100 * block + 1000, 100 * block + 1100):
        check_altered(seed, pair_of(seed), ["python", "llvm"] if seed % 10 else ["python", "interpreter", "llvm", "numba"])
