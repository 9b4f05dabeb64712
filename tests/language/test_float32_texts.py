"""A float32 as text: its digits, read as a float64 and rounded, are that float32 again.

So its digits are chosen (`rosetta_jit.kernel.decimals.shortest`): the fewest of which that is true. Nine always are enough: they are within
0.17 of half the distance to the next float32, and the float64 nearest to them is off by 2**-29 of it more. The campaign asks each float32.
"""

from __future__ import annotations

import numpy as np
import pytest

import rosetta_jit as rj
from tests.language.texts import BACKENDS, decoder

FILES = {
    "t/F.msg": "float32[] f\n",
    "m.mapping": """import "t/F.msg"
data-holder: t/F
wire-schema: t/F
unpack-rules:
  .f[] = float32(number(text(.f[])))
""",
}
CLOSE = float.fromhex("0x1.5c87fap-84")
"""The one float32 that takes a digit more than if its text were rounded once: the float64 nearest to 7.038531e-26 lies in the middle
between it and its neighbour, and is rounded to the neighbour. C++'s `to_chars` writes these digits."""

FINITE = 0x7F800000
"""The first pattern of bits that is no finite float32."""

PARTS = 16


def there_and_back(decode: rj.Decoder, patterns: np.ndarray) -> np.ndarray:
    """The bits of floats of these bits, through a text and back."""
    message = np.uint32(len(patterns)).tobytes() + patterns.astype("<u4").tobytes()
    return np.asarray(decode(message).f).view(np.uint32)


@pytest.mark.parametrize("backend", BACKENDS)
def test_the_one_that_takes_a_digit_more(backend):
    run = decoder({"s": "text(.f)"}, backend)
    assert [run(f=each)["s"] for each in (CLOSE, -CLOSE)] == ["7.0385307e-26", "-7.0385307e-26"]
    assert run(f=float(np.nextafter(np.float32(CLOSE), np.float32(1))))["s"] == "7.038531e-26"


def test_floats_come_back():
    decode = rj.Decoder("m.mapping", schema=FILES, encoding="ros1")
    chosen = np.random.default_rng(0).integers(0, FINITE, 100_000, dtype=np.uint32)
    close = np.float32(CLOSE).view(np.uint32) + np.arange(-100, 100, dtype=np.int64)
    edges = np.uint32([0, 1, 2, 0x7FFFFF, 0x800000, 0x3F800000, FINITE - 1, FINITE])
    for sign in (0, 1 << 31):
        patterns = np.concatenate([chosen, close.astype(np.uint32), edges]) | np.uint32(sign)
        assert np.array_equal(there_and_back(decode, patterns), patterns)


@pytest.mark.campaign
@pytest.mark.parametrize("part", range(PARTS))
def test_every_float_comes_back(part):
    decode, size = rj.Decoder("m.mapping", schema=FILES, encoding="ros1"), FINITE // PARTS
    for first in range(part * size, (part + 1) * size, 1 << 20):
        patterns = np.arange(first, min(first + (1 << 20), (part + 1) * size), dtype=np.uint32)
        assert np.array_equal(there_and_back(decode, patterns), patterns)


@pytest.mark.parametrize(
    ("unpack", "pack", "holders"),
    [
        (".f = float32(number(.s))", ".s = text(.f)", ""),
        (".f = float32(number(.s))", ".s = text(.f, 3)", "it cannot be shown that its value comes back"),
        (".f = float32(number(.s) * 2)", ".s = text(.f * 0.5)", "it cannot be shown that its value comes back"),
        (".f = -float32(number(.s))", ".s = text(-.f)", ""),
        (".f = float32(number(upper(.s)))", ".s = text(.f)", "it cannot be shown that its value comes back"),
    ],
)
def test_laws(unpack, pack, holders):
    head = 'import "t/S.msg" import "t/G.msg" data-holder: t/G wire-schema: t/S\n'
    files = {"t/S.msg": "string s\n", "t/G.msg": "float32 f\n", "m.mapping": f"{head}unpack-rules:\n  {unpack}\npack-rules:\n  {pack}\n"}
    laws = rj.check("m.mapping", schema=files).laws
    assert [loss.why for loss in laws.holders.losses] == ([holders] if holders else [])
    assert laws.messages.losses
    if not holders and "-" not in pack:
        assert laws.messages.losses[0].why == "it is rounded to a float32, and a number is written in one way, however it was spelt"
