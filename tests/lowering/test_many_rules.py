"""Mappings of many rules: they are proven as short ones are, and take work in proportion."""

from __future__ import annotations

import cProfile
import pstats

import pytest

import rosetta_jit as rj
from rosetta_jit.kernel.passes import order as passes
from rosetta_jit.pipeline.build import Build
from rosetta_jit.pipeline.request import Request
from tests.language.texts import BACKENDS

BOTTLE = {"w.bottle-schema": '"w" (("line" :string) ("unit" :string))'}
TOO_STEEP = 2.2
"""Times the work for twice the rules."""


def made_of_texts(count, value='lower(part(strip(.line), "/", #)) + "-" + upper(.unit)'):
    """So many texts, each made of others: the value with 0 to 4 for #."""
    fields = "".join(f" optional string x{number} = {number + 1};" for number in range(count))
    rules = "".join(f"  .x{number} = {value.replace('#', str(number % 5))}\n" for number in range(count))
    head = 'import "w.bottle-schema"\nimport "h.proto"\ndata-holder: H\nwire-schema: w\nunpack-rules:\n'
    return {**BOTTLE, "h.proto": f'syntax = "proto2"; message H {{{fields} }}', "m.mapping": head + rules}


@pytest.mark.parametrize("backend", BACKENDS)
def test_many_texts(backend):
    decode = rj.Decoder("m.mapping", schema=made_of_texts(24), encoding="yarp3", backend=backend)
    write = rj.Encoder.of("w", schema=BOTTLE, imports=["w.bottle-schema"], encoding="yarp3", backend="interpreter")
    found = decode(write(write.holder_type.from_dict({"line": " A/b/Cc//E\n", "unit": "mm"}))).to_dict()
    parts = ["a", "b", "cc", "", "e"]
    assert [found[f"x{number}"] for number in range(24)] == [f"{parts[number % 5]}-MM" for number in range(24)]


@pytest.mark.parametrize("backend", BACKENDS)
def test_texts_that_are_made_again_and_again(backend):
    """Each lies behind all before it, whose sizes nobody knows: LLVM would work on the sums for hours."""
    files = made_of_texts(24, 'lower(replace(lower(.unit + "A#"), "a", "xy")) + "."')
    decode = rj.Decoder("m.mapping", schema=files, encoding="yarp3", backend=backend)
    write = rj.Encoder.of("w", schema=BOTTLE, imports=["w.bottle-schema"], encoding="yarp3", backend="interpreter")
    found = decode(write(write.holder_type.from_dict({"line": "", "unit": "mAm"}))).to_dict()
    assert [found[f"x{number}"] for number in range(24)] == [f"mxymxy{number % 5}." for number in range(24)]


def rejecting(count, condition):
    """So many rejections: the condition with # for each number."""
    rules = "".join(f'  reject "no {number}" when {condition.replace("#", str(number))}\n' for number in range(count))
    head = 'import "w.bottle-schema"\nimport "h.proto"\ndata-holder: H\nwire-schema: w\nunpack-rules:\n  .n = .i\n'
    proto = 'syntax = "proto2"; message H { required int64 n = 1; }'
    return {"w.bottle-schema": '"w" (("i" :int64) ("x" :double) ("s" :string))', "h.proto": proto, "m.mapping": head + rules}


@pytest.mark.parametrize("backend", BACKENDS)
def test_many_rejections(backend):
    """More than LLVM is told of one value: the first that holds is named."""
    count = 150
    files = rejecting(count, '.i >= # and .i < # + 3 and .x > #.5 or .s == "s#"')
    decode = rj.Decoder("m.mapping", schema=files, encoding="yarp3", backend=backend)
    write = rj.Encoder.of("w", schema=files, imports=["w.bottle-schema"], encoding="yarp3", backend="interpreter")
    for i, x, s in [
        (-1, 1e9, ""),
        (0, 1.0, ""),
        (9, 8.0, ""),
        (70, 1e9, ""),
        (151, 1e9, ""),
        (-1, 0.0, "s147"),
        (152, 9.0, "s150"),
        (140, 138.9, ""),
    ]:
        expected = [number for number in range(count) if (number <= i < number + 3 and x > number + 0.5) or s == f"s{number}"]
        message = write(write.holder_type.from_dict({"i": i, "x": x, "s": s}))
        if not expected:
            assert decode(message).n == i
            continue
        with pytest.raises(rj.DecodeError, match=f"no {expected[0]}\\b"):
            decode(message)


@pytest.mark.parametrize("files", [made_of_texts, lambda count: rejecting(40 * count, '.s == "s#"')], ids=["texts", "rejections"])
def test_the_proof_takes_work_in_proportion(files):
    few, many = (_calls(files(count)) for count in (8, 16))
    assert many < TOO_STEEP * few


def _calls(files):
    """The calls that the passes and the proof of a decoder take: a clock that does not depend on the machine."""
    request = Request("decode", mapping="m.mapping", encoding="yarp3", files=tuple(files.items()))
    kernel = Build(request)._lowered("decode")
    clock = cProfile.Profile()
    clock.runcall(passes.run, kernel)
    return pstats.Stats(clock).total_calls
