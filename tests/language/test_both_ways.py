"""Conditions, checks and completions in rules for both directions, against what plain Python says they mean."""

from __future__ import annotations

import math
import re

import pytest

import rosetta_jit as rj
from tests.language.pairs import BACKENDS, codes, files, pair


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_condition_on_what_is_related(backend):
    made = pair(
        '("kind" :int) ("a" :double) ("b" :double)',
        "required int64 kind = 1; required double value = 2;",
        """rules:
  .kind <-> .kind * 2
  when .kind > 3 and .kind != 7
    .value <-> .a + 1.0
    ignore .b
  else
    .value <-> -.b
    ignore .a
  end
""",
        backend,
    )
    for kind in (3, 4, 7, 9):
        first = kind > 3 and kind != 7
        held = made.unpack(kind=kind, a=2.5, b=4.0)
        assert held == {"kind": 2 * kind, "value": 3.5 if first else -4.0}
        assert made.pack(**held) == {"kind": kind, "a": 2.5 if first else 0.0, "b": 0.0 if first else 4.0}
    assert made.refused(kind=5, value=1.0).kind == "range"


COLOURS = """rules:
  when .encoding == "mono8"
    .mode <-> h.Mode.GRAY
    .level <-> .level
  else when .encoding == "rgb8"
    .mode <-> h.Mode.RGB
    .level <-> .level * 2.0
  else when .encoding == "bgr8"
    .mode <-> h.Mode.BGR
    .level <-> .level - 1.0
  else
    reject "no such encoding"
  end end end
"""


@pytest.mark.parametrize("backend", BACKENDS)
def test_blocks_that_constants_tell_apart(backend):
    made = pair('("encoding" :string) ("level" :double)', "required Mode mode = 1; required double level = 2;", COLOURS, backend)
    for encoding, mode, level in (("mono8", "GRAY", 3.0), ("rgb8", "RGB", 6.0), ("bgr8", "BGR", 2.0)):
        assert made.unpack(encoding=encoding, level=3.0) == {"mode": mode, "level": level}
        assert made.pack(mode=mode, level=level) == {"encoding": encoding, "level": 3.0}
    with pytest.raises(rj.DecodeError, match="no such encoding"):
        made.unpack(encoding="jpeg", level=1.0)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_flag_of_the_wire(backend):
    made = pair(
        '("flag" :bool) ("n" :int)',
        "required string unit = 1; required int32 n = 2;",
        """rules:
  when .flag .unit <-> "degree" .n <-> .n else .unit <-> "radian" .n <-> int32(-.n) end
""",
        backend,
    )
    assert made.unpack(flag=True, n=5) == {"unit": "degree", "n": 5}
    assert made.unpack(flag=False, n=5) == {"unit": "radian", "n": -5}
    assert made.pack(unit="degree", n=4) == {"flag": True, "n": 4}
    assert made.pack(unit="radian", n=4) == {"flag": False, "n": -4}
    error = made.refused(unit="metre", n=4)
    assert error.kind == "rejected"
    assert 'is not `"radian"`, as the mapping says' in str(error)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_holder_of_the_other_block_is_refused(backend):
    """The blocks are told apart by `.big`; that `.n` is as the condition says is checked."""
    made = pair(
        '("n" :int)',
        "required bool big = 1; required int32 n = 2;",
        "rules:\n  when .n >= 100 .big <-> true .n <-> .n else .big <-> false .n <-> .n end\n",
        backend,
    )
    assert made.unpack(n=100) == {"big": True, "n": 100}
    assert made.pack(big=False, n=99) == {"n": 99}
    assert made.pack(big=True, n=100) == {"n": 100}
    for big, n in ((True, 99), (False, 100)):
        error = made.refused(big=big, n=n)
        assert error.kind == "rejected"
        assert "would be unpacked as if" in str(error)


@pytest.mark.parametrize("backend", BACKENDS)
def test_conditional_expressions(backend):
    made = pair(
        '("flag" :bool) ("kind" :int) ("a" :double) ("b" :double)',
        "required bool flag = 1; required double value = 2; required int32 state = 3; required double b = 4;",
        """rules:
  .flag <-> not .flag
  .value <-> 2.0 * (.a + 1.0 if .flag else -.a)
  .state <-> 7 if .kind == 1 else table(.kind) { 2 = 8, 3 = 9 }
  .b <-> .b
""",
        backend,
    )
    for flag in (True, False):
        for kind, state in ((1, 7), (2, 8), (3, 9)):
            held = made.unpack(flag=flag, kind=kind, a=3.0, b=1.0)
            assert held == {"flag": not flag, "value": 2 * (4.0 if flag else -3.0), "state": state, "b": 1.0}
            assert made.pack(**held) == {"flag": flag, "kind": kind, "a": 3.0, "b": 1.0}
    assert "no key" in str(made.refused(flag=True, value=1.0, state=10, b=0.0))


@pytest.mark.parametrize("backend", BACKENDS)
def test_tables_with_a_rest(backend):
    made = pair(
        '("kind" :int)',
        "required int32 state = 1;",
        "rules:\n  .state <-> table(.kind) { 1 = 10, 2 = 20, 5 = 20, otherwise 0 }\n",
        backend,
    )
    assert [made.unpack(kind=kind)["state"] for kind in (1, 2, 5, 6)] == [10, 20, 20, 0]
    assert [made.pack(state=state)["kind"] for state in (10, 20)] == [1, 2]
    assert "no key" in str(made.refused(state=0))


@pytest.mark.parametrize("backend", BACKENDS)
def test_rules_to_pack_complete_what_has_no_inverse(backend):
    made = pair(
        '("a" :double) ("b" :double) ("n" :int) ("values" (:list :double))',
        "required double sum = 1; required int32 low = 2; repeated double values = 3;",
        """rules:
  .sum <-> .a + .b
  .low <-> int32(.n & 7)
  len(.values) <-> .n & 7
  for i from 0 to .n & 7
    .values[i] <-> .values[i]
  end
pack-rules:
  .a = .sum / 2.0
  .b = .sum - .sum / 2.0
  .n = .low
  len(.values) = len(.values)
  for i from 0 to len(.values) .values[i] = .values[i] end
""",
        backend,
    )
    assert made.unpack(a=1.0, b=2.5, n=2, values=[1.0, 2.0]) == {"sum": 3.5, "low": 2, "values": [1.0, 2.0]}
    assert made.pack(sum=3.0, low=3, values=[1.0, 2.0, 3.0]) == {"a": 1.5, "b": 1.5, "n": 3, "values": [1.0, 2.0, 3.0]}


@pytest.mark.parametrize("rules", [".low <-> .n / 7 .n <-> .n", ".n <-> .n .low <-> .n / 7"])
def test_a_field_is_packed_from_the_relation_that_keeps_it(rules):
    """The other one is a check, which whatever was unpacked must pass."""
    made = pair('("n" :int64)', "required int64 n = 1; required int64 low = 2;", f"rules: {rules}")
    for number in (0, 6, -100, 2**63 - 1):
        held = made.unpack(n=number)
        assert made.pack(**held) == {"n": number}
    assert made.refused(n=6, low=1).kind == "rejected"


@pytest.mark.parametrize("backend", BACKENDS)
def test_the_last_unknown_of_several_fields(backend):
    made = pair(
        '("w" :int) ("h" :int)',
        "required int32 w = 1; required int64 area = 2;",
        "rules:\n  .area <-> .w * .h\n  .w <-> .w\n",
        backend,
    )
    assert made.unpack(w=3, h=4) == {"w": 3, "area": 12}
    assert made.pack(w=3, area=12) == {"w": 3, "h": 4}
    assert "remainder" in str(made.refused(w=5, area=12))


@pytest.mark.parametrize("backend", BACKENDS)
def test_conditions_compare_in_the_units_of_the_wire(backend):
    """A depth of 0.25 m is 250 mm: it is the millimetres that the condition is about."""
    texts = {
        "probe.bottle-schema": '"probe" (("depth" :double (:unit :mm)) ("x" :int) ("y" :int))',
        "sample.bottle-schema": '"sample" (("depth" :float32 (:unit :m)) ("x" :int))',
        "s.mapping": """import "probe.bottle-schema"
import "sample.bottle-schema"
data-holder: sample
wire-schema: probe
rules:
  .depth <-> .depth
  when .depth > 100.0 .x <-> .x ignore .y else .x <-> .y ignore .x end
""",
    }
    encode = rj.Encoder("s.mapping", schema=texts, encoding="yarp4", backend=backend)
    read = rj.Decoder.of("probe", schema=texts, imports=["probe.bottle-schema"], encoding="yarp4", backend="interpreter")
    assert read(encode(encode.holder_type.from_dict({"depth": 0.25, "x": 3}))).to_dict() == {"depth": 250.0, "x": 3, "y": 0}
    assert read(encode(encode.holder_type.from_dict({"depth": 0.0625, "x": 3}))).to_dict() == {"depth": 62.5, "x": 0, "y": 3}


WIRE = '("kind" :int) ("a" :double) ("b" :double) ("values" (:list :double))'
HOLDER = "required int32 kind = 1; required double a = 2; repeated double values = 3;"


@pytest.mark.parametrize(
    ("rules", "code", "text"),
    [
        ("when .kind > 3 .a <-> .a else .a <-> -.a end", "alike-blocks", "relate `.kind` to the holder"),
        (
            "when .kind == 3 .kind <-> 1 .a <-> .a else .kind <-> 2 .a <-> .b end",
            "undetermined-field",
            "`.kind` is where the condition does not",
        ),
        ("when .kind == 3 .kind <-> 1 .a <-> .a else .kind <-> 1 .a <-> .b end", "alike-blocks", ""),
        ('reject "no" when .kind > 3', "unknown-condition", "`.kind`"),
        (".a <-> .a * .b", "several-fields", "`.a = ...`, `.b = ...`"),
        (".a <-> floor(.b)", "no-inverse", "say in `pack-rules:` what the wire is to have: `.b = ...`"),
        (".a <-> .values[.kind]", "index-reads", "nothing says what this index is"),
        (".values[.kind] <-> .a", "index-reads", "nothing says what this index is"),
        ("for i from 0 to .kind .values[i] <-> .values[i] end", "unknown-bound", ""),
        (".a <-> " + " + ".join(["(.a if .kind == 1 else .b)"] * 20), "too-many-ways", "more than"),
    ],
)
def test_what_packing_cannot_know(rules, code, text):
    with pytest.raises(rj.MappingError) as error:
        rj.Decoder("m.mapping", schema=files(WIRE, HOLDER, f"rules:\n  {rules}\n"), encoding="yarp3", backend="interpreter")
    assert code in [problem.code for problem in error.value.diagnostics]
    assert text in str(error.value)


def test_rules_to_pack_complete_a_condition():
    rules = """rules:
  when .kind > 3 .a <-> .a else .a <-> .b end
  .values <-> .values
  .kind <-> 3
pack-rules:
  .kind = 3
  .a = 0.0
  .b = .a
"""
    assert codes(WIRE, HOLDER, rules) == ["alike-blocks"]


def test_relations_that_multiply_are_bounded():
    """What is known of each field names the one before twice."""
    wire = " ".join(f'("f{number}" :double)' for number in range(60))
    holder = " ".join(f"required double f{number} = {number + 1};" for number in range(60))
    rules = "".join(f"  .f{number} <-> .f{number} + .f{number - 1} + .f{number - 1}\n" for number in range(1, 60))
    assert "too-complex" in codes(wire, holder, f"rules:\n  .f0 <-> .f0\n{rules}")


def kernels(wire: str, holder: str, rules: str) -> list[str]:
    made = pair(wire, holder, rules)
    return [re.sub(r"\w+\.mapping:\d+:\d+", "", program.stage("kernel")) for program in (made.decode, made.encode)]


def test_blocks_are_what_one_would_write():
    """The checks included: they have the same words."""
    wire, holder = (
        '("encoding" :string) ("n" :int) ("level" :double)',
        "required Mode mode = 1; required int32 n = 2; required float level = 3;",
    )
    derived = """rules:
  .n <-> int32(.n + 1)
  when .encoding == "mono8" .mode <-> h.Mode.GRAY .level <-> float32(.level)
  else when .encoding == "rgb8" .mode <-> h.Mode.RGB .level <-> float32(.level / 2.0) else reject "no such encoding" end end
"""
    written = """unpack-rules:
  .n = int32(.n + 1)
  when .encoding == "mono8" .mode = h.Mode.GRAY .level = float32(.level)
  else when .encoding == "rgb8" .mode = h.Mode.RGB .level = float32(.level / 2.0) else reject "no such encoding" end end
pack-rules:
  .n = int32(.n - 1)
  when .mode == h.Mode.GRAY
    .encoding = "mono8"
    .level = .level
  else
    .encoding = "rgb8"
    reject "`.mode` is not `h.Mode.RGB`, as the mapping says" when .mode != h.Mode.RGB
    .level = .level * 2.0
  end
"""
    assert kernels(wire, holder, derived) == kernels(wire, holder, written)


PRESENT = """import "wire.proto"
import "holder.proto"
data-holder: h.Holder
wire-schema: w.Wire
rules:
  when has(.speed) .pace <-> .speed * 2.0 .name <-> .name else default .pace .name <-> .name end
  when not has(.label) default .label else .label <-> .label end
"""
PRESENT_FILES = {
    "wire.proto": """syntax = "proto2"; package w;
message Wire { optional double speed = 1; required int32 name = 2; optional string label = 3; }""",
    "holder.proto": """syntax = "proto2"; package h;
message Holder { optional double pace = 1; required int32 name = 2; optional string label = 3; }""",
}


@pytest.mark.parametrize("backend", BACKENDS)
def test_what_is_there_on_one_side_is_on_the_other(backend):
    texts = {**PRESENT_FILES, "m.mapping": PRESENT}
    decode, encode = (program("m.mapping", schema=texts, backend=backend) for program in (rj.Decoder, rj.Encoder))
    write = rj.Encoder.of("w.Wire", schema=texts, imports=["wire.proto"], backend="interpreter")
    for extra in ({}, {"speed": 2.5}, {"label": ""}, {"label": "a", "speed": 0.0}):
        message = write(write.holder_type.from_dict({"name": 3, **extra}))
        held = decode(message)
        assert held.to_dict().get("pace") == (2 * extra["speed"] if "speed" in extra else None)
        assert encode(held) == message


def test_a_field_that_both_blocks_set_says_not_which():
    rules = PRESENT.replace("default .pace .name", ".pace <-> 1.0 .name")
    with pytest.raises(rj.MappingError) as error:
        rj.Encoder("m.mapping", schema={**PRESENT_FILES, "m.mapping": rules}, backend="interpreter")
    assert "alike-blocks" in [problem.code for problem in error.value.diagnostics]


@pytest.mark.parametrize("backend", BACKENDS)
def test_checks_of_floats_are_to_the_bit(backend):
    """-0 is not what 0 is unpacked to, nor 0 what -0 is; a NaN is one whatever its bits are."""
    holder = "required double a = 1; required double b = 2; required double zero = 3; required float minus = 4;"
    made = pair('("v" :double)', holder, "rules:\n.a <-> .v\n.b <-> .v * 2.0\n.zero <-> 0.0\n.minus <-> -0.0\n", backend)
    for value in (0.0, -0.0, 1.5, math.nan, -math.inf):
        found = made.unpack(v=value)
        assert repr(found) == repr({"a": value, "b": value * 2.0, "zero": 0.0, "minus": -0.0})
        assert repr(made.pack(**found)) == repr({"v": value})
    good = {"a": 0.0, "b": 0.0, "zero": 0.0, "minus": -0.0}
    for name, value in (("b", -0.0), ("zero", -0.0), ("minus", 0.0), ("zero", math.nan), ("a", -0.0)):
        assert made.refused(**{**good, name: value}).kind == "rejected"


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("zero", ["0", "0.0"])
def test_the_sign_of_a_zero_that_tells_a_block(backend, zero):
    rules = f'rules:\nwhen .kind == 1\n.a <-> {zero}\nelse\n.a <-> 1.5\nend\nreject "kind" when .kind != 1 and .kind != 2\n'
    made = pair('("kind" :int)', "required double a = 1;", rules + "pack-rules:\n.kind = 1 if .a == 0.0 else 2\n", backend)
    assert made.pack(a=0.0) == {"kind": 1}
    assert made.refused(a=-0.0).kind == "rejected"


@pytest.mark.parametrize("backend", BACKENDS)
def test_bits_of_an_integer(backend):
    """Bits that are masked and those above them are digits: both come back, and what has more bits than its mask is refused."""
    rules = "rules:\n  .low <-> int32(.word & 15)\n  .high <-> int32(.word >> 4)\n"
    both = pair('("word" :int)', "required int32 low = 1; required int32 high = 2;", rules, backend)
    assert "exact inverse" in str(both.decode.mapping.laws)
    assert "lossy" not in str(both.decode.mapping.laws)
    for word in (0, 15, 16, -77, 2**31 - 1, -(2**31)):
        found = both.unpack(word=word)
        assert found == {"low": word & 15, "high": word >> 4}
        assert both.pack(**found) == {"word": word}
    assert both.refused(low=16, high=0).kind == "rejected"
    assert both.refused(low=0, high=1 << 28).kind == "range"
