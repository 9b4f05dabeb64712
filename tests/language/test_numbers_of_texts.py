"""Numbers that a text lists: relations to all of them turn round together, and so does one rule for several places."""

from __future__ import annotations

import pytest

import rosetta_jit as rj
from tests.language.pairs import BACKENDS, codes, pair


@pytest.mark.parametrize("backend", [*BACKENDS, "llvm"])
@pytest.mark.parametrize(
    "rules",
    [
        'rules:\n  .x, .n, .y <-> number(split(.t, ", "))\n',
        'rules:\n  .n <-> number(part(.t, ", ", 1))\n  .y <-> number(part(.t, ", ", 2))\n  .x <-> number(part(.t, ", ", 0))\n',
    ],
)
def test_numbers_of_a_text(rules, backend):
    both = pair('("t" :string)', "required double x = 1; required double n = 2; required double y = 3;", rules, backend)
    assert both.unpack(t="1.5, -2, 1e100") == {"x": 1.5, "n": -2.0, "y": 1e100}
    assert both.pack(x=0.1, n=-2.5, y=1e-7) == {"t": "0.1, -2.5, 1e-07"}
    for text in ("1, 2", "1, 2, 3, 4"):
        with pytest.raises(rj.DecodeError) as error:
            both.unpack(t=text)
        assert error.value.kind in {"index", "rejected"}


def test_integers_of_a_text_in_one_direction():
    rules = 'unpack-rules:\n  .x, .y = integer(split(.t, ";"))\npack-rules:\n  .t = text(.x) + ";" + text(.y)\n'
    both = pair('("t" :string)', "required int64 x = 1; required int64 y = 2;", rules)
    assert both.unpack(**both.pack(x=-5, y=7)) == {"x": -5, "y": 7}
    with pytest.raises(rj.DecodeError) as error:
        both.unpack(t="1;2;3")
    assert error.value.kind == "rejected"


def test_numbers_are_not_separated_by_what_they_are_written_with():
    holder = "required double x = 1; required double y = 2;"
    assert codes('("t" :string)', holder, 'rules:\n  .x, .y <-> number(split(.t, "."))\n') == ["no-inverse"]


def test_a_part_that_no_relation_reads():
    rules = 'rules:\n  .x <-> number(part(.t, ",", 0))\n  .y <-> number(part(.t, ",", 2))\n'
    assert codes('("t" :string)', "required double x = 1; required double y = 2;", rules) == ["no-inverse"] * 2


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_text_of_numbers(backend):
    rules = 'rules:\n  .t <-> text(.x) + ", " + text(.n) + ", " + text(.y)\n'
    both = pair('("x" :double) ("n" :int) ("y" :double)', "required string t = 1;", rules, backend)
    assert both.unpack(x=0.1, n=-2, y=1e100) == {"t": "0.1, -2, 1e+100"}
    assert both.pack(t="0.10, -2, 1e100") == {"x": 0.1, "n": -2, "y": 1e100}
    for text, kind in (("1, 2", "rejected"), ("1, 2, 3, 4", "rejected"), ("1, 2.5, 3", "text"), ("1, 3000000000, 3", "range")):
        assert both.refused(t=text).kind == kind


def test_a_text_of_numbers_that_nothing_separates():
    wire = '("x" :double) ("y" :double) ("s" :string)'
    for value in ('text(.x) + "." + text(.y)', 'text(.x) + "," + text(.y) + ";" + text(.x)', '.s + "," + text(.y)', "text(.x) + text(.y)"):
        assert codes(wire, "required string t = 1;", f"rules:\n  .t <-> {value}\n  ignore rest\n") == ["several-fields"]
