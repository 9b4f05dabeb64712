"""Threads that share decoders, encoders, holders, views and batches get what is right, or `InUse`; none ends the process."""

from __future__ import annotations

import subprocess
import sys

import pytest

import rosetta_jit as rj
from tests.api.sharing import CHOICES, KINDS


def share(kind, seconds):
    command = [sys.executable, "-m", "tests.api.sharing", kind, str(seconds)]
    ended = subprocess.run(command, check=False, capture_output=True, text=True, timeout=seconds + 120)
    assert ended.returncode == 0, f"{ended.returncode}: {ended.stdout}\n{ended.stderr[-3000:]}"


@pytest.mark.parametrize("kind", KINDS)
def test_sharing(kind):
    share(kind, 1.5)


@pytest.mark.campaign
@pytest.mark.parametrize("kind", KINDS)
def test_sharing_for_long(kind):
    share(kind, 120)


@pytest.mark.parametrize("view", ["items", "values"])
def test_pairs_of_a_map_that_are_gone_are_not_put_back(view):
    options = {"schema": CHOICES, "imports": ["choices.proto"], "encoding": "protobuf"}
    decode, encode = rj.Decoder.of("p.C", **options), rj.Encoder.of("p.C", **options)
    holder = decode(encode(encode.holder_type.from_dict({"k": {1: "one", 2: "two"}})), decode.new())
    pairs = iter(getattr(holder.k, view)())
    next(pairs)
    decode(b"", holder)
    with pytest.raises(KeyError):
        next(pairs)
    assert holder.to_dict()["k"] == {}
