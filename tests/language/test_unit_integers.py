"""Integers in units: as floats and back, as other integers, rounded where a word says so; on all backends."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import rosetta_jit as rj

BACKENDS = ["llvm", "python", "interpreter"]


class Both:
    """A mapping between two bottles, in both directions."""

    def __init__(self, wire: str, holder: str, rules: str, backend: str = "interpreter") -> None:
        texts = {
            "w.bottle-schema": f'"w" ({wire})',
            "h.bottle-schema": f'"h" ({holder})',
            "m.mapping": 'import "w.bottle-schema"\nimport "h.bottle-schema"\ndata-holder: h\nwire-schema: w\n' + rules,
        }
        options: dict[str, Any] = {"schema": texts, "encoding": "yarp4", "backend": backend}
        own: dict[str, Any] = {**options, "imports": ["w.bottle-schema"], "backend": "interpreter"}
        self.decode, self.encode = rj.Decoder("m.mapping", **options), rj.Encoder("m.mapping", **options)
        self.read, self.write = rj.Decoder.of("w", **own), rj.Encoder.of("w", **own)
        self.laws = str(self.decode.mapping.laws) if self.decode.mapping is not None else ""

    def unpacked(self, **values: object) -> dict[str, Any]:
        return self.decode(self.write(self.write.holder_type.from_dict(values))).to_dict()

    def packed(self, **values: object) -> dict[str, Any]:
        return self.read(self.encode(self.encode.holder_type.from_dict(values))).to_dict()


EXACT = "messages: exact inverse\nholders: exact inverse"


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    ("unit", "target", "factor"), [("mm", "m", 1e-3), ("1e-7 degree", "degree", 1e-7), ("cm", "mm", 10.0), ("0.25 m", "2 m", 0.125)]
)
def test_integers_become_floats_and_come_back(backend, unit, target, factor):
    both = Both(f'("x" :int (:unit "{unit}"))', f'("x" :double (:unit "{target}"))', "rules:\n  .x <-> .x\n", backend)
    assert both.laws == EXACT
    for number in (0, 1, -7, 1234567891, 2**31 - 1, -(2**31)):
        assert both.unpacked(x=number) == {"x": number * factor}
        assert both.packed(x=number * factor) == {"x": number}
    for wrong in (0.3 * factor, 2.0**31 * factor, float("nan")):
        with pytest.raises(rj.EncodeError) as error:
            both.packed(x=wrong)
        assert (error.value.kind, error.value.path) == ("range", ".x")


@pytest.mark.parametrize("backend", BACKENDS)
def test_integers_become_other_integers_by_whole_factors(backend):
    both = Both(
        '("x" :int (:unit :m)) ("t" :int (:unit :s))',
        '("x" :int (:unit :mm)) ("t" :int64 (:unit :ns))',
        "rules:\n  .x <-> .x\n  .t <-> .t\n",
        backend,
    )
    assert both.laws == EXACT
    assert both.unpacked(x=-12, t=3) == {"x": -12_000, "t": 3_000_000_000}
    assert both.packed(x=5000, t=-2_000_000_000) == {"x": 5, "t": -2}
    with pytest.raises(rj.DecodeError) as beyond:
        both.unpacked(x=2**31 - 1, t=0)
    assert (beyond.value.kind, beyond.value.path) == ("range", ".x")
    with pytest.raises(rj.EncodeError) as remainder:
        both.packed(x=5001, t=0)
    assert (remainder.value.kind, remainder.value.path) == ("range", ".x")


@pytest.mark.parametrize("backend", BACKENDS)
def test_what_is_rounded_is_rounded_in_the_new_unit(backend):
    wire = '("f" :double (:unit :m)) ("i" :int (:unit :mm)) ("j" :int (:unit :mm))'
    holder = '("f" :int (:unit :mm)) ("i" :int (:unit :m)) ("j" :int (:unit :m))'
    rules = "rules:\n  .f <-> int32(.f, round)\n  .i <-> int32(float64(.i), round)\n  .j <-> int32(float64(.j), truncate)\n"
    both = Both(wire, holder, rules, backend)
    assert both.unpacked(f=0.0016, i=-1600, j=-1600) == {"f": 2, "i": -2, "j": -1}
    assert both.packed(f=2, i=-2, j=3) == {"f": 0.002, "i": -2000, "j": 3000}
    assert both.laws.splitlines()[:3] == [
        "messages: lossy",
        "  .f: it is rounded to a whole number",
        "  .i: it is rounded to a whole number",
    ]
    with pytest.raises(rj.DecodeError) as error:
        both.unpacked(f=3e6, i=0, j=0)
    assert (error.value.kind, error.value.path) == ("range", ".f")


@pytest.mark.parametrize("backend", BACKENDS)
def test_elements_of_arrays(backend):
    wire, holder = (
        '("a" (:list :int) (:unit :mm)) ("b" (:list :int) (:unit :m))',
        '("a" (:list :float32) (:unit :m)) ("b" (:list :int64) (:unit :um))',
    )
    both = Both(wire, holder, "rules:\n  .a[] <-> float32(.a[])\n  .b[] <-> .b[]\n", backend)
    assert both.unpacked(a=[1, -2500], b=[3]) == {"a": [float(np.float32(0.001)), -2.5], "b": [3_000_000]}
    assert both.packed(a=[float(np.float32(0.001)), -2.5], b=[3_000_000]) == {"a": [1, -2500], "b": [3]}


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("rules", ["  .a <-> .a\n  .b <-> .b\n", "  same names\n"])
def test_whole_arrays(rules, backend):
    """An array is converted as its elements are, whether its integers also get wider or not."""
    wire, holder = (
        f'("a" (:list :int) (:unit :{unit})) ("b" (:list :{kind}) (:unit :{unit}))' for unit, kind in (("m", "int"), ("mm", "int64"))
    )
    both = Both(wire, holder, "rules:\n" + rules, backend)
    assert both.laws == EXACT
    assert both.unpacked(a=[1, -2], b=[2**31 - 1]) == {"a": [1000, -2000], "b": [1000 * (2**31 - 1)]}
    assert both.packed(a=[], b=[-3000]) == {"a": [], "b": [-3]}
    with pytest.raises(rj.EncodeError) as remainder:
        both.packed(a=[1000, 5001], b=[])
    assert (remainder.value.kind, remainder.value.path) == ("range", ".a[1]")
    with pytest.raises(rj.DecodeError) as beyond:
        both.unpacked(a=[2**31 - 1], b=[])
    assert (beyond.value.kind, beyond.value.path) == ("range", ".a[0]")


def test_int64_in_floats_takes_its_word():
    both = Both('("t" :int64 (:unit :ns))', '("t" :double (:unit :s))', "rules:\n  .t <-> float64(.t)\n")
    assert both.unpacked(t=1_234_567_890_123) == {"t": 1_234_567_890_123 * 1e-9}
    assert both.packed(t=both.unpacked(t=1_234_567_890_123)["t"]) == {"t": 1_234_567_890_123}
    assert "large integers are rounded to a float" in both.laws
