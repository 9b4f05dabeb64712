"""Fields that a rejection for both directions compares with a constant: packing writes the one value that unpacking lets through."""

from __future__ import annotations

import pytest

import rosetta_jit as rj
from tests.language.pairs import BACKENDS, files, pair

HOLDER = "required double a = 1;"


@pytest.mark.parametrize("backend", BACKENDS)
def test_constants_are_packed(backend):
    wire = '("id" :int) ("big" :bool) ("on" :bool) ("unit" :string) ("a" :double)'
    rules = 'rules:\n.a <-> .a\nreject "id" when .id != 0x201 or .big\nreject "off" when not .on\nreject "{.unit}" when "mm" != .unit\n'
    both = pair(wire, HOLDER, rules, backend)
    assert str(both.decode.mapping.laws) == "messages: exact inverse\nholders: exact inverse"
    good = {"id": 0x201, "big": False, "on": True, "unit": "mm", "a": 1.5}
    assert both.unpack(**good) == {"a": 1.5}
    assert both.pack(a=1.5) == good
    for wrong in ({"id": 1}, {"big": True}, {"on": False}, {"unit": "m"}):
        with pytest.raises(rj.DecodeError) as error:
            both.unpack(**{**good, **wrong})
        assert error.value.kind == "rejected"


@pytest.mark.parametrize("backend", BACKENDS)
def test_what_the_block_to_pack_says_counts(backend):
    rules = 'rules:\n.a <-> .a\nreject "no" when .id != 3\npack-rules:\n.id = 3 if .a > 0.0 else 4\n'
    assert pair('("id" :int) ("a" :double)', HOLDER, rules, backend).pack(a=-1.0) == {"id": 4, "a": -1.0}


@pytest.mark.parametrize(
    "rules",
    [
        'reject "no" when .id > 3',
        'reject "no" when .id != 3 and .a > 0.0',
        'reject "no" when .id == 3',
        'reject "no" when .id % 4 != 3',
        'reject "no" when .x != 0.0',
        'same names except .a reject "no" when .id != 3',
    ],
)
def test_what_says_no_single_value_is_refused(rules):
    holder = HOLDER + (" required int32 id = 2;" if "same" in rules else "")
    with pytest.raises(rj.MappingError) as error:
        rj.Decoder(
            "m.mapping",
            schema=files('("id" :int) ("x" :double) ("a" :double)', holder, f"rules:\n  .a <-> .a\n  {rules}\n"),
            encoding="yarp3",
        )
    assert "unknown-condition" in [problem.code for problem in error.value.diagnostics]


def test_the_sign_of_a_zero_that_is_not_packed():
    """A condition does not tell -0 from 0, so that a message with -0 may come back with 0."""
    rules = 'rules:\n.a <-> .a\nreject "no" when .zero != 0.0\npack-rules:\n.zero = 0.0\n'
    both = pair('("zero" :double) ("a" :double)', HOLDER, rules)
    assert [loss.place for loss in both.decode.mapping.laws.messages.losses] == [".zero"]
    both = pair('("zero" :double) ("a" :double)', HOLDER, rules.replace("0.0", "1.5"))
    assert both.decode.mapping.laws.messages.kind == "exact"
