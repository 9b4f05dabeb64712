"""One mistake gives one report, at its place, with the cause; what its help says loads where it is pasted."""

from __future__ import annotations

from dataclasses import dataclass

import pytest

from rosetta_jit.errors import MappingError
from rosetta_jit.frameworks.installed import Readers, installed
from rosetta_jit.language.check.mapping import check
from rosetta_jit.language.parse.mapping import parse
from rosetta_jit.parsing.search import SearchPath
from rosetta_jit.source import Source

FILES = {
    "lab/msg/Joint.msg": "string name\nfloat64 position\n",
    "lab/msg/State.msg": """uint8 IDLE=0
uint8 ACTIVE=1
uint32 seq
string frame
uint8 mode
float64 angle # turning [deg]
float64 dist # distance [m]
bool ready
float32 small
int64 big
float64[] positions
Joint[] joints
float32[3] xyz
""",
    "robot.proto": """syntax = "proto2"; package lab;
message Joint { required string name = 1; required double position = 2; }
message Robot { enum Mode { IDLE = 0; ACTIVE = 1; }
  required uint32 seq = 1; required string frame = 2; required Mode mode = 3;
  required double angle = 4; required double dist = 5;
  required bool ready = 6; required float small = 7; required int64 big = 8;
  repeated double positions = 9; repeated Joint joints = 10; repeated float xyz = 11; }""",
    "robot.units": "lab.Robot:\n  .angle: rad\n  .dist: mm\n",
    "joint.mapping": """import "lab/msg/Joint.msg"
import "robot.proto"
data-holder: lab.Joint
wire-schema: lab/msg/Joint
rules:
  same names
""",
}
FRONT_ENDS = Readers({name: installed()[name] for name in ("protobuf", "ros1", "ros2")})
RULES = """
  .seq <-> .seq
  .frame <-> .frame
  .mode <-> lab.Robot.Mode(.mode)
  .angle <-> .angle
  .dist <-> .dist
  .ready <-> .ready
  .small <-> .small
  .big <-> .big
  .positions <-> .positions
  .joints <-> .joints via "joint.mapping"
  .xyz <-> .xyz
"""
MAPPING = f"""import "lab/msg/State.msg"
import "robot.proto"
import "robot.units"
data-holder: lab.Robot
wire-schema: lab/msg/State
rules:{RULES}"""
ONE_WAY = MAPPING.replace("\nrules:", "\nunpack-rules:").replace("<->", "=")


@dataclass(frozen=True)
class Mistake:
    """What is written instead of a part of a right mapping; the report's code, the text at its caret, its help, and what the help comes to.

    ``mended`` is empty where the help leaves it open.
    """

    right: str
    wrong: str
    code: str
    caret: str
    help: str
    mended: str = ""
    mapping: str = MAPPING

    def text(self, written: str) -> str:
        assert self.right in self.mapping
        return self.mapping.replace(self.right, written, 1)


def one_way(right: str, wrong: str, code: str, caret: str, help_: str, mended: str = "") -> Mistake:
    return Mistake(right, wrong, code, caret, help_, mended, ONE_WAY)


XYZ = "  .xyz <-> .xyz\n"
MODE = "lab.Robot.Mode(.mode)"
MISTAKES = {
    "unit-of-another-field": Mistake(".angle <-> .angle", ".angle <-> .dist", "unit", ".dist", "assign another field"),
    "unit-the-wrong-way": Mistake("<-> .angle", "<-> degrees(.angle)", "unit", "degrees(.angle)", "`radians(...)`", "<-> radians(.angle)"),
    "no-argument": Mistake("<-> .angle", "<-> radians()", "arguments", "radians()", "docs/language.md"),
    "array-as-a-number": Mistake(
        "<-> .positions", "<-> .positions * 2", "operand", ".positions", "`.positions[]` is each of its elements", ""
    ),
    "brackets-on-the-left-alone": Mistake(
        ".positions <-> .positions",
        ".positions[] <-> .positions * 2",
        "no-count",
        ".positions[]",
        "`.positions[] <-> .positions[] * 2`",
        ".positions[] <-> .positions[] * 2",
    ),
    "brackets-on-the-right-alone": Mistake(
        ".positions <-> .positions",
        ".positions <-> .positions[] * 2",
        "no-count",
        ".positions[]",
        "`.positions[] <-> .positions[] * 2`",
        ".positions[] <-> .positions[] * 2",
    ),
    "too-wide": Mistake("<-> .small", "<-> .angle", "lossy-conversion", ".angle", "`float32(.angle)` rounds to the nearest"),
    "number-for-a-flag": Mistake("<-> .ready", "<-> .mode", "lossy-conversion", ".mode", "`bool(.mode)`"),
    "length-as-a-member": Mistake("<-> .seq", "<-> .positions.length", "no-fields", ".length", "`len(.positions)` is how many"),
    "text-and-number": Mistake("<-> .frame", '<-> "f" + .seq', "text-needed", ".seq", "`text(.seq)`"),
    "last-element": Mistake("<-> .big", "<-> int64(.positions[-1])", "index-range", "-1", "`.positions[len(.positions) - 1]`"),
    "field-of-an-array": one_way(
        "= .frame",
        "= .joints.name",
        "no-fields",
        ".name",
        "of each element: `.joints[].name`; of one: `.joints[0].name`",
    ),
    "constant-as-a-text": Mistake("<-> .ready", '<-> .mode == "IDLE"', "not-comparable", '.mode == "IDLE"', "`lab/msg/State.IDLE`"),
    "constant-that-is-compared": one_way("= .ready", "= .mode == ACTIVE", "unknown-name", "ACTIVE", "`lab/msg/State.ACTIVE`"),
    "constant-that-is-set": Mistake(f"<-> {MODE}", "<-> IDLE", "unknown-name", "IDLE", "`lab.Robot.IDLE`"),
    "constant-in-another-case": Mistake(
        f"<-> {MODE}",
        "<-> lab.Robot.Mode.Idle if .mode == 0 else lab.Robot.Mode.ACTIVE",
        "unknown-name",
        "lab.Robot.Mode.Idle",
        "did you mean `lab.Robot.Mode.IDLE`?",
    ),
    "enum-without-its-package": Mistake(
        f"<-> {MODE}", "<-> Mode(.mode)", "unknown-function", "Mode(.mode)", "`lab.Robot.Mode(...)`", f"<-> {MODE}"
    ),
    "mean-without-brackets": one_way(
        "= .angle", "= mean(.positions)", "reduction", "mean(.positions)", "`mean(.positions[])`", "= mean(.positions[])"
    ),
    "count-without-brackets": one_way(
        "= .big", "= count(.positions > 2)", "reduction", "count(.positions > 2)", "`count(.positions[] > 2)`", "= count(.positions[] > 2)"
    ),
    "key-as-an-index": one_way("= .angle", '= .joints["elbow"].position', "integer-needed", '"elbow"', '`.joints[.key = "elbow"]`'),
    "length-in-rules": Mistake(
        XYZ, "".join(f"  .xyz[{i}] <-> .xyz[{i}]\n" for i in range(3)), "length-never-set", ".xyz[0] <-> .xyz[0]", "`len(.xyz) <-> 3`"
    ),
    "length-one-way": one_way(
        "  .xyz = .xyz\n",
        "  for i from 0 to 3\n    .xyz[i] = .xyz[i]\n  end\n",
        "length-never-set",
        ".xyz[i] = .xyz[i]",
        "add `len(.xyz) = ...`",
    ),
    "variable-of-no-loop": one_way(
        "  .xyz = .xyz\n",
        "  len(.xyz) = 3\n  for i from 0 to 3\n    .xyz[i] = .xyz[j]\n  end\n",
        "unknown-name",
        "j",
        "the variable of this loop is `i`",
    ),
    "block-with-if": Mistake("  .seq <-> .seq\n", "  if .ready\n    .seq <-> .seq\n  end\n", "syntax", "if", "`when condition`"),
    "raise": Mistake(XYZ, f'{XYZ}  raise "no"\n', "syntax", "raise", '`reject "why" when condition`'),
    "length-by-another-name": Mistake(XYZ, "  length(.xyz) <-> 3\n", "syntax", "length", "a length is set by `len`: `len(.a)`"),
    "bracket-too-many": Mistake("<-> .angle", "<-> radians(.angle))", "syntax", ")", "no bracket is open that `)` closes: leave it out"),
    "cast": Mistake("<-> .small", "<-> (float) .small", "syntax", ".small", "`float32(.small)`", "<-> float32(.small)"),
    "second-value": Mistake("<-> .seq", "<-> .seq .big", "syntax", ".big", "an operator, or a line, is missing before it"),
    "import-in-angles": Mistake(
        'import "robot.proto"', "import <robot.proto>", "syntax", "<", 'write `import "robot.proto"`', 'import "robot.proto"'
    ),
    "import-from": Mistake('import "robot.proto"', 'from "robot.proto" import Robot', "syntax", "from", '`import "x.proto"`'),
    "rules-without-their-block": Mistake("rules:\n", "", "syntax", ".seq", "rules stand behind `rules:`"),
    "type-that-is-a-word": Mistake(
        "lab/msg/State\n", "lab/msg/state\n", "unknown-type", "lab/msg/state", "did you mean `lab/msg/State`?", "lab/msg/State\n"
    ),
}


def reports(text: str) -> MappingError | None:
    source = Source("robot.mapping", text)
    try:
        check(parse(source), FRONT_ENDS, SearchPath(files=tuple(FILES.items())))
    except MappingError as error:
        return error
    return None


def test_the_mapping_is_right():
    assert reports(MAPPING) is None
    assert reports(ONE_WAY) is None


@pytest.mark.parametrize("mistake", MISTAKES.values(), ids=MISTAKES)
def test_one_report_with_the_cause(mistake: Mistake):
    found = reports(mistake.text(mistake.wrong))
    assert found is not None
    errors = [each for each in found.diagnostics if each.severity == "error"]
    (only,) = errors
    span = only.span
    assert span is not None
    assert (only.code, span.source.text[span.start : span.end]) == (mistake.code, mistake.caret)
    assert mistake.help in only.help


MENDED = {name: each for name, each in MISTAKES.items() if each.mended}


@pytest.mark.parametrize("mistake", MENDED.values(), ids=MENDED)
def test_what_the_help_says_loads(mistake: Mistake):
    assert reports(mistake.text(mistake.mended)) is None


def test_fields_that_no_rule_sets_come_behind_what_is_wrong_in_rules():
    found = reports(MAPPING.replace(".seq <-> .seq", ".seq <-> .positions").replace("  .big <-> .big\n", ""))
    assert found is not None
    assert [each.code for each in found.diagnostics] == ["type-clash", "never-set"]


def test_what_is_wrong_in_a_schema_comes_alone_where_a_mapping_uses_another():
    """Types that could not be read say nothing of how the used mapping's relations are turned round."""
    files = {
        "lab.idl": """module lab { enum Kind { FREE }; struct Joint { unsigned short flags; Kind kind; };
struct Arm { sequence<Joint> joints; }; };""",
        "j.proto": 'syntax = "proto3"; package lab; message J { bool on = 1; uint32 mode = 2; } message Js { repeated J joints = 1; }',
        "j.mapping": """import "lab.idl"
import "j.proto"
data-holder: lab.J
wire-schema: lab::Joint
rules:
  .on <-> .flags & 1 != 0
  .mode <-> .flags >> 2 & 7
""",
    }
    text = 'import "lab.idl"\nimport "j.proto"\ndata-holder: lab.Js\nwire-schema: lab::Arm\nrules:\n  .joints <-> .joints via "j.mapping"\n'
    front_ends = Readers({name: installed()[name] for name in ("protobuf", "corba")})
    with pytest.raises(MappingError) as error:
        check(parse(Source("m.mapping", text)), front_ends, SearchPath(files=tuple(files.items())))
    assert [each.code for each in error.value.diagnostics] == ["used-name"]
