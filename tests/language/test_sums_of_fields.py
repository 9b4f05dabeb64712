"""As many relations as fields, each of which adds multiples of them: packing solves them together."""

from __future__ import annotations

import numpy as np
import pytest

import rosetta_jit as rj
from rosetta_jit.errors import MappingError
from tests.language.pairs import BACKENDS, pair

ROUNDED = "it is rounded, by as much as the other fields of its sums are large"


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_sum_and_a_difference_of_floats(backend):
    made = pair(
        '("left" :double) ("right" :double)',
        "required double speed = 1; required double turn = 2;",
        "rules:\n  .speed <-> (.right + .left) * 0.5\n  .turn <-> (.right - .left) / 0.4\n",
        backend,
    )
    assert made.unpack(left=1.0, right=2.0) == {"speed": 1.5, "turn": pytest.approx(2.5, rel=1e-15)}
    assert made.pack(speed=1.5, turn=2.5) == {"left": 1.0, "right": 2.0}
    assert [(loss.place, loss.why) for loss in made.decode.mapping.laws.messages.losses] == [(".right", ROUNDED), (".left", ROUNDED)]


def test_the_solution_is_that_of_numpy():
    made = pair(
        '("a" :double) ("b" :double) ("c" :double)',
        "required double x = 1; required double y = 2; required double z = 3;",
        """rules:
  .x <-> -(.a * 3.0 - .b / 8.0) + 1.0
  .y <-> degrees(.a + .b + 0.25 * (.c - .a))
  .z <-> .c - 0.5 * .b
""",
    )
    matrix = np.array([[-3.0, 0.125, 0.0], np.degrees([0.75, 1.0, 0.25]), [0.0, -0.5, 1.0]])
    for wanted in np.random.default_rng(0).normal(size=(20, 3)):
        found = made.pack(**dict(zip("xyz", matrix @ wanted + [1.0, 0.0, 0.0], strict=True)))
        assert np.allclose(list(found.values()), wanted, rtol=1e-12)


@pytest.mark.parametrize("backend", BACKENDS)
def test_integers_are_solved_without_rounding(backend):
    made = pair(
        '("a" :int) ("b" :int)',
        "required int64 sum = 1; required int64 difference = 2;",
        "rules:\n  .sum <-> .a + .b\n  .difference <-> .a - .b\n",
        backend,
    )
    assert str(made.decode.mapping.laws) == "messages: exact inverse\nholders: exact inverse"
    for a, b in ((7, -3), (-(2**31), 2**31 - 1), (0, 0)):
        assert made.pack(**made.unpack(a=a, b=b)) == {"a": a, "b": b}
    refused = made.refused(sum=3, difference=2)
    assert (refused.kind, refused.path) == ("range", ".a")
    assert made.refused(sum=2**40, difference=0).kind == "range"


def test_unsigned_integers_and_conversions():
    made = pair(
        '("a" :uint8) ("b" :uint8)',
        "required uint32 sum = 1; required sint32 twice = 2;",
        "rules:\n  .sum <-> uint32(.a + .b)\n  .twice <-> int32((.a - .b) * 2)\n",
    )
    assert str(made.decode.mapping.laws) == "messages: exact inverse\nholders: exact inverse"
    assert made.unpack(a=3, b=200) == {"sum": 203, "twice": -394}
    assert made.pack(sum=203, twice=-394) == {"a": 3, "b": 200}
    assert made.refused(sum=203, twice=-393).kind == "range"
    assert made.refused(sum=2, twice=8).path == ".b"


@pytest.mark.parametrize("backend", BACKENDS)
def test_integers_of_which_floats_are_computed_are_the_nearest(backend):
    made = pair(
        '("left" :int) ("right" :int)',
        "required double way = 1; required double turn = 2;",
        "rules:\n  .way <-> (.left + .right) * 0.001\n  .turn <-> (.right - .left) * 0.007\n",
        backend,
    )
    assert str(made.decode.mapping.laws.holders) == "exact inverse"
    for left, right in ((0, 0), (1, 2), (-70001, 3), (2**31 - 1, -(2**31))):
        assert made.pack(**made.unpack(left=left, right=right)) == {"left": left, "right": right}
    assert made.refused(way=0.0015, turn=0.0).kind == "rejected"


@pytest.mark.parametrize("backend", BACKENDS)
def test_factors_may_be_parameters(backend):
    made = pair(
        '("speed" :double) ("turn" :double)',
        "required double left = 1; required double right = 2;",
        "rules:\n  .left <-> .speed - .turn * half\n  .right <-> .speed + half * .turn\n",
        backend,
        head="parameter half: float64 = 0.25\n",
    )
    assert made.unpack(speed=1.0, turn=2.0) == {"left": 0.5, "right": 1.5}
    assert made.pack(left=0.5, right=1.5) == {"speed": 1.0, "turn": 2.0}


def test_a_factor_may_be_what_another_relation_says():
    made = pair(
        '("a" :double) ("b" :double) ("scale" :double)',
        "required double sum = 1; required double other = 2; required double scale = 3;",
        "rules:\n  .scale <-> .scale\n  .sum <-> .a + .b + .scale\n  .other <-> .scale * .a - .b\n",
    )
    assert made.pack(**made.unpack(a=1.0, b=2.0, scale=3.0)) == {"a": 1.0, "b": 2.0, "scale": 3.0}


@pytest.mark.parametrize("backend", BACKENDS)
def test_sums_of_elements(backend):
    made = pair(
        '("wheels" (:list (:bottle ("left" :double) ("right" :double))))',
        "repeated double sum = 1; repeated double difference = 2;",
        "rules:\n  .sum[] <-> .wheels[].left + .wheels[].right\n  .difference[] <-> .wheels[].left - .wheels[].right\n",
        backend,
    )
    wheels = [{"left": 1.0, "right": 2.0}, {"left": 3.0, "right": -1.0}]
    assert made.pack(**made.unpack(wheels=wheels)) == {"wheels": wheels}


def test_rules_to_pack_come_first():
    made = pair(
        '("a" :double) ("b" :double)',
        "required double sum = 1; required double difference = 2;",
        "rules:\n  .sum <-> .a + .b\n  .difference <-> .a - .b\npack-rules:\n  .a = .sum\n  .b = .difference\n",
    )
    assert made.pack(sum=1.0, difference=2.0) == {"a": 1.0, "b": 2.0}


@pytest.mark.parametrize(
    ("first", "second"),
    [
        (".a + .b", "2.0 * .a + 2.0 * .b"),
        (".a * .b + .a", ".a - .b"),
        ("sin(.a) + .b", ".a - .b"),
        (".a / .b", ".a + .b"),
    ],
)
def test_what_sums_do_not_say_is_reported(first, second):
    with pytest.raises(MappingError, match="cannot be solved together"):
        pair(
            '("a" :double) ("b" :double)', "required double x = 1; required double y = 2;", f"rules:\n  .x <-> {first}\n  .y <-> {second}\n"
        )


def test_a_misspelt_field_of_another_relation_is_the_cause():
    rules = "rules:\n  .speed <-> (.right + .left) * 0.5\n  .turn <-> (.rigt - .left) / 0.4\n"
    with pytest.raises(MappingError) as caught:
        pair('("left" :double) ("right" :double)', "required double speed = 1; required double turn = 2;", rules)
    assert [each.code for each in caught.value.diagnostics] == ["unknown-field"]


def test_a_robot_with_a_wheel_at_each_side():
    name, given = "drives/differential.mapping", {"parameters": {"radius": 0.05, "track": 0.4}}
    decode, encode = rj.Decoder(name, **given), rj.Encoder(name, **given)
    read, write = rj.Decoder.of("rosetta_jit/WheelSpeeds"), rj.Encoder.of("rosetta_jit/WheelSpeeds")
    twist = decode(write(write.holder_type.from_dict({"left": 10.0, "right": 12.0})))
    assert (twist.linear.x, twist.angular.z) == pytest.approx((0.55, 0.25))
    wheels = read(encode(twist))
    assert (wheels.left, wheels.right) == pytest.approx((10.0, 12.0), rel=1e-14)
    twist.linear.y = 0.1
    with pytest.raises(rj.EncodeError) as error:
        encode(twist)
    assert error.value.kind == "rejected"
