"""What mappings in both directions guarantee. `test_random_laws` shows that they do."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

import rosetta_jit as rj

if TYPE_CHECKING:
    from rosetta_jit.language.laws.guarantees import Laws

HEAD = 'import "wire.bottle-schema"\nimport "holder.proto"\ndata-holder: h.Holder\nwire-schema: wire\n'


def files(wire: str, holder: str, rules: str) -> dict[str, str]:
    proto = f'syntax = "proto2"; package h; enum Mode {{ GRAY = 0; RGB = 1; BGR = 2; }} message Holder {{ {holder} }}'
    return {"wire.bottle-schema": f'"wire" ({wire})', "holder.proto": proto, "m.mapping": HEAD + rules}


def laws(wire: str, holder: str, rules: str) -> Laws:
    made = rj.Decoder("m.mapping", schema=files(wire, holder, rules), encoding="yarp3", backend="interpreter").mapping
    assert made is not None
    assert made.laws is not None
    return made.laws


def test_the_torso():
    made = rj.check("yarp/icub/torso_state.mapping").laws
    assert made is not None
    assert (made.messages.kind, made.holders.kind) == ("rounded", "exact")
    rounding = dict(made.messages.rounded)[".yaw"]
    assert (rounding.ulp, rounding.bits) == (2, 32)
    assert str(made.holders) == "exact inverse"
    assert ".yaw: 2 ulp of float32" in str(made)


ONE = (
    '("x" :int) ("y" :double) ("s" :string) ("n" :int64)',
    "required int32 x = 1; required double y = 2; required Mode s = 3; required int64 n = 4;",
)
REST = {
    "x": ".x <-> .x",
    "y": ".y <-> .y",
    "s": '.s <-> table(.s) { "mono8" = h.Mode.GRAY, "rgb8" = h.Mode.RGB, "bgr8" = h.Mode.BGR }',
    "n": ".n <-> .n",
}


@pytest.mark.parametrize(
    ("field", "rule", "messages", "holders"),
    [
        ("x", ".x <-> .x", "", ""),
        ("x", ".x <-> int32(7 - .x)", "", ""),
        ("x", ".x <-> int32(.x ^ 5)", "", ""),
        ("x", ".x <-> int32(.n, saturate)", ".n: values that do not fit are saturated", ""),
        ("x", ".x <-> int32(.x / 4)", ".x: `/` drops remainders", ""),
        ("y", ".y <-> .y * 4.0 - 1.5", "rounded .y", "rounded .y"),
        ("y", ".y <-> float64(.n)", ".n: large integers are rounded to a float", ""),
        ("x", ".x <-> int32(.y, round)", ".y: it is rounded to a whole number", ""),
        ("x", ".x <-> int32(.y)", "", ""),
        ("s", '.s <-> table(.s) { "a" = h.Mode.GRAY, "b" = h.Mode.GRAY }', '.s: "b" comes back as "a"', ""),
        (
            "s",
            '.s <-> table(.s) { "a" = h.Mode.RGB, otherwise h.Mode.GRAY }',
            ".s: all values without an entry of the table become 0",
            "",
        ),
        ("x", "default .x ignore .x", ".x: it is left out: 0, empty or absent", ".x: it is left out: 0, empty or absent"),
    ],
)
def test_what_comes_back(field, rule, messages, holders):
    """Every relation packs as a check or as an inverse, so that nothing else is lost on the way."""
    used = {name for name in REST if f".{name} " in f"{rule} ".split("<->")[-1].replace(")", " ").replace(",", " ")}
    wire_fields = used or {field}
    others = [text for name, text in REST.items() if name != field and name not in wire_fields]
    missing = [f"default .{name}" for name in REST if name != field and name in wire_fields]
    ignored = [f"ignore .{name}" for name in ("x", "y", "s", "n") if name == field and name not in wire_fields]
    made = laws(*ONE, "rules:\n  " + "\n  ".join([rule, *others, *missing, *ignored]) + "\n")
    found = [f"{loss.place}: {loss.why}" for loss in made.messages.losses if loss.place == f".{next(iter(wire_fields))}"]
    assert (found or [f"rounded {place}" for place, _ in made.messages.rounded] or [""])[0] == messages
    back = [f"{loss.place}: {loss.why}" for loss in made.holders.losses if loss.place == f".{field}"]
    assert (back or [f"rounded {place}" for place, _ in made.holders.rounded] or [""])[0] == holders


def test_blocks_follow_their_conditions():
    rules = """rules:
  when .s == "mono8" .s <-> h.Mode.GRAY .y <-> .y else when .s == "rgb8" .s <-> h.Mode.RGB .y <-> -.y else reject "no" end end
  .n <-> .n
  when .n > 5 .x <-> .x else .x <-> int32(-.x) end
"""
    made = laws(*ONE, rules)
    assert (made.messages.kind, made.holders.kind) == ("exact", "exact")


def test_a_condition_on_what_is_rounded_may_take_the_other_block():
    """The wire's value is not the holder's: near the limit, another block may be packed than was unpacked."""
    rules = REST["s"] + "\n  .n <-> .n\n  .y <-> .y * 0.1\n  when .y > 0.5 .x <-> .x else .x <-> int32(-.x) end\n"
    made = laws(*ONE, f"rules:\n  {rules}")
    assert any("which block" in loss.why for loss in made.messages.losses)


def test_loops_permutations_and_checks():
    made = laws(
        '("values" (:list :double)) ("a" :double) ("b" :double) ("points" (:list (:bottle ("u" :int) ("v" :double))))',
        "message P { required int32 u = 1; required double v = 2; } repeated double values = 1; repeated double pair = 2;"
        "repeated P points = 3; required double copy = 4;",
        """rules:
  .values <-> .values
  .pair <-> [.b, .a]
  len(.points) <-> len(.points)
  for i from 0 to len(.points)
    .points[i].u <-> .points[i].u
    .points[i].v <-> -.points[i].v
  end
  .copy <-> .b
""",
    )
    assert str(made) == "messages: exact inverse\nholders: exact inverse"


def test_two_blocks_by_hand_have_laws_too():
    made = laws(
        '("a" :double) ("k" :int)',
        "required double a = 1; required int32 k = 2;",
        "unpack-rules:\n  .a = .a + 1.0\n  .k = .k\npack-rules:\n  .a = .a + 1.0\n  .k = .k\n",
    )
    assert [loss.why for loss in made.messages.losses] == ["it comes back as another value"]


@pytest.mark.parametrize(
    ("fields", "unpack", "pack", "messages", "holders"),
    [
        ("int64 int64", ".v = .v", ".v = int8(.v)", "a conversion does not take it", ""),
        ("int64 int64", ".v = int8(.v)", ".v = .v", "", "a conversion does not take it"),
        ("int64 int64", ".v = .v", 'reject "too much" when .v > 5 .v = .v', 'on the way back: "too much"', ""),
        ("int64 int64", 'reject "too much" when .v > 5 .v = .v', 'reject "too much" when .v > 5 .v = .v', "", ""),
        ("int16 double", ".v = .v * 0.01", ".v = int16(.v * 100.0)", "rounding leaves a fraction", None),
        ("int16 double", ".v = .v * 0.01", ".v = int16(.v * 100.0, round)", "", None),
        ("int16 double", ".v = .v * 0.5", ".v = int16(.v * 2.0)", "", None),
        ("float64 double", ".v = .v", ".v = int32(.v)", "a conversion does not take it", ""),
        ("float64 double", ".v = .v", ".v = float32(.v, exact)", "a conversion does not take it", ""),
        ("float32 double", ".v = .v", ".v = float32(.v, exact)", "", ""),
        ("float64 float", ".v = float32(.v, exact)", ".v = .v", "", ""),
    ],
)
def test_refusals_on_the_way_back_are_losses(fields, unpack, pack, messages, holders):
    wire, holder = fields.split()
    texts = {
        "p/W.msg": f"{wire} v\n",
        "h.proto": f'syntax = "proto2"; message H {{ required {holder} v = 1; }}',
        "m.mapping": f'import "p/W.msg" import "h.proto" data-holder: H wire-schema: p/W unpack-rules: {unpack} pack-rules: {pack}',
    }
    made = rj.Decoder("m.mapping", schema=texts, encoding="ros1", backend="interpreter").mapping.laws
    for law, why in ((made.messages, messages), (made.holders, holders)):
        if why is not None:
            assert [loss.why for loss in law.losses if why in loss.why] if why else not law.losses, str(made)


def test_one_way_mappings_have_none():
    texts = files('("a" :double)', "required double a = 1;", "unpack-rules:\n  .a = .a\n")
    mapping = rj.Decoder("m.mapping", schema=texts, encoding="yarp3", backend="interpreter").mapping
    assert mapping is not None
    assert mapping.laws is None
    assert rj.Decoder.of("wire", schema=texts, imports=["wire.bottle-schema"], backend="interpreter").mapping is None


def test_what_a_condition_says_of_a_table_is_known():
    """In a block for one constant its table has one key, and in the other that key no more: all of them come back."""
    rules = """rules:
  .s <-> table(.n) { 0 = h.Mode.GRAY, 1 = h.Mode.RGB, 2 = h.Mode.BGR }
  when .n == 1
    .x <-> .x
  else
    ignore .x
  end
"""
    made = laws('("n" :int) ("x" :double)', "required Mode s = 1; optional double x = 2;", rules)
    assert [loss.place for loss in made.holders.losses] == [".x"]
    assert [loss.place for loss in made.messages.losses] == [".x"]
