"""Mappings of many rules: they are proven as short ones are, and take work in proportion."""

from __future__ import annotations

import cProfile
import pstats

import pytest

import rosetta_jit as rj
from rosetta_jit.lowering import passes
from rosetta_jit.pipeline import Build
from rosetta_jit.request import Request
from tests.lowering.texts import BACKENDS

BOTTLE = {"w.bottle-schema": '"w" (("line" :string) ("unit" :string))'}
TOO_STEEP = 2.6
"""Times the work for twice the rules."""


def made_of_texts(count):
    """So many texts, each made of others."""
    fields = "".join(f" optional string x{number} = {number + 1};" for number in range(count))
    rules = "".join(f'  .x{number} = lower(part(strip(.line), "/", {number % 5})) + "-" + upper(.unit)\n' for number in range(count))
    head = 'import "w.bottle-schema"\nimport "h.proto"\ndata-holder: H\nwire-schema: w\nunpack-rules:\n'
    return {**BOTTLE, "h.proto": f'syntax = "proto2"; message H {{{fields} }}', "m.mapping": head + rules}


@pytest.mark.parametrize("backend", BACKENDS)
def test_many_texts(backend):
    decode = rj.Decoder("m.mapping", schema=made_of_texts(24), encoding="yarp3", backend=backend)
    write = rj.Encoder.of("w", schema=BOTTLE, imports=["w.bottle-schema"], encoding="yarp3", backend="interpreter")
    found = decode(write(write.holder_type.from_dict({"line": " A/b/Cc//E\n", "unit": "mm"}))).to_dict()
    parts = ["a", "b", "cc", "", "e"]
    assert [found[f"x{number}"] for number in range(24)] == [f"{parts[number % 5]}-MM" for number in range(24)]


def test_the_proof_takes_work_in_proportion():
    few, many = (_calls(made_of_texts(count)) for count in (8, 16))
    assert many < TOO_STEEP * few


def _calls(files):
    """The calls that the passes and the proof of a decoder take: a clock that does not depend on the machine."""
    request = Request("decode", mapping="m.mapping", encoding="yarp3", files=tuple(files.items()))
    kernel = Build(request)._lowered("decode")
    clock = cProfile.Profile()
    clock.runcall(passes.run, kernel)
    return pstats.Stats(clock).total_calls
