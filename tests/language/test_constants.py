"""Constants that messages and modules declare, by name: of ROS, of LCM, of OMG IDL, in both directions and on all backends."""

from __future__ import annotations

import pytest

import rosetta_jit as rj

BACKENDS = ["llvm", "python", "interpreter"]
FILES = {
    "lab/msg/Goal.msg": """uint8 IDLE=0
uint8 ACTIVE=1
uint8 DONE=7
float32 GAIN=0.1
string UNIT=mm

uint8 status
float32 gain
string unit
int16 n
""",
    "lcmlab.lcm": """package lcmlab;
struct goal { const int32_t ON = 40, OFF = -2; const double SCALE = 2.5; const int64_t LARGE = 0x100000000;
  int32_t state; double gain; int64_t n; boolean is_fast; string unit; }""",
    "rtc.idl": "module RTC { const long LIMIT = 9; const boolean FAST = TRUE; };",
}
HEAD = """import "lab/msg/Goal.msg"
import "lcmlab.lcm"
import "rtc.idl"
data-holder: lcmlab.goal
wire-schema: lab/msg/Goal
"""
RULES = """rules:
  .state <-> table(.status) { Goal.ACTIVE = goal.ON, lab/msg/Goal.IDLE = lcmlab.goal.OFF, lab/Goal.DONE = RTC::LIMIT }
  .gain <-> .gain * goal.SCALE
  .n <-> .n + goal.LARGE
  .is_fast <-> RTC::FAST
  .unit <-> .unit
  reject "no unit of lengths" when .unit != Goal.UNIT
"""


def program(kind, rules=RULES, backend="interpreter", files=FILES):
    return kind("m.mapping", schema={**files, "m.mapping": HEAD + rules}, encoding="cdr", backend=backend)


@pytest.mark.parametrize("backend", BACKENDS)
def test_both_directions(backend):
    decode, encode = program(rj.Decoder, backend=backend), program(rj.Encoder, backend=backend)
    write = rj.Encoder.of("lab/msg/Goal", schema=FILES, imports=["lab/msg/Goal.msg"], encoding="cdr", backend="interpreter")
    assert decode.mapping is not None
    assert not decode.mapping.warnings, "what declares a constant is used"
    for status, state in ((1, 40), (0, -2), (7, 9)):
        message = write(write.holder_type.from_dict({"status": status, "gain": 2.0, "unit": "mm", "n": -3}))
        held = {"state": state, "gain": 5.0, "n": 2**32 - 3, "is_fast": True, "unit": "mm"}
        assert decode(message).to_dict() == held
        assert encode(encode.holder_type.from_dict(held)) == message
    wrong = write(write.holder_type.from_dict({"status": 1, "gain": 2.0, "unit": "m", "n": 0}))
    for use in (lambda: decode(wrong), lambda: encode(encode.holder_type.from_dict({"state": 3, "unit": "mm", "is_fast": True}))):
        with pytest.raises(rj.MessageError) as error:
            use()
        assert error.value.kind == "rejected"


def test_the_law_of_a_table_of_constants_is_exact():
    mapping = program(rj.Decoder, RULES.replace(" * goal.SCALE", "")).mapping
    assert mapping is not None
    laws = mapping.laws
    assert laws is not None
    assert not [loss for loss in laws.holders.losses if loss.place == ".state"]


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_constant_has_the_type_that_it_is_declared_with(backend):
    rules = "unpack-rules:\n  default .state\n  .gain = Goal.GAIN\n  default .n\n  .is_fast = .gain == Goal.GAIN\n  .unit = Goal.UNIT\n"
    rules += "  ignore .status\n  ignore .unit\n  ignore .n\n"
    decode = program(rj.Decoder, rules, backend)
    write = rj.Encoder.of("lab/msg/Goal", schema=FILES, imports=["lab/msg/Goal.msg"], encoding="cdr", backend="interpreter")
    found = decode(write(write.holder_type.from_dict({"gain": 0.1})))
    assert (found.gain, found.is_fast, found.unit) == (0.10000000149011612, True, "mm"), "0.1 as a float32 has it"


def problems(rules, files=FILES):
    with pytest.raises(rj.MappingError) as error:
        program(rj.Decoder, f"unpack-rules:\n  same names\n  .state = {rules}\n", files=files)
    return {each.code: each for each in error.value.diagnostics if each.severity == "error"}


def test_a_misspelt_constant_is_told_the_nearest():
    assert "did you mean `lab/msg/Goal.ACTIVE`?" in problems("Goal.ACTIVES")["unknown-name"].help
    assert "did you mean `lcmlab.goal.ON`?" in problems("lcmlab.goal.OM")["unknown-name"].help
    assert "did you mean `RTC::LIMIT`?" in problems("RTC::LIMITS")["unknown-name"].help


def test_a_short_name_of_several_constants_is_ambiguous():
    other = {**FILES, "lcmlab.lcm": FILES["lcmlab.lcm"].replace("struct goal", "struct Goal").replace("ON = 40", "ACTIVE = 40")}
    text = HEAD.replace("lcmlab.goal", "lcmlab.Goal") + "unpack-rules:\n  same names\n  .state = Goal.ACTIVE\n"
    with pytest.raises(rj.MappingError) as error:
        rj.Decoder("m.mapping", schema={**other, "m.mapping": text}, encoding="cdr", backend="interpreter")
    (problem,) = (each for each in error.value.diagnostics if each.code == "ambiguous-name")
    assert problem.notes == ("they are: `lab/msg/Goal.ACTIVE`, `lcmlab.Goal.ACTIVE`",)


def test_a_quotient_is_told_from_a_name_by_its_blanks():
    found = problems("table(.status) { 1 = status/unheard.OF, otherwise 4 / goal.OFF }")
    assert "put blanks around `/`" in found["unknown-name"].help


def test_two_files_that_give_one_constant_several_values():
    clash = {**FILES, "other.idl": "module RTC { const long LIMIT = 10; };"}
    text = HEAD + 'import "other.idl"\n' + RULES
    with pytest.raises(rj.MappingError) as error:
        rj.Decoder("m.mapping", schema={**clash, "m.mapping": text}, encoding="cdr", backend="interpreter")
    assert [each.code for each in error.value.diagnostics if each.severity == "error"] == ["conflicting-type"]
