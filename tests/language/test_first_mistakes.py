"""What somebody new to the language, or used to another one, gets wrong: the first report is the cause, and its help can be pasted."""

from __future__ import annotations

from dataclasses import dataclass

import pytest

from rosetta_jit.diagnostics import render
from rosetta_jit.errors import MappingError
from rosetta_jit.frameworks.installed import Readers, installed
from rosetta_jit.language.check.mapping import check
from rosetta_jit.language.parse.mapping import parse
from rosetta_jit.parsing.search import SearchPath
from rosetta_jit.source import Source

FILES = {
    "lab/msg/Pose.msg": "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n",
    "lab/msg/Joint.msg": "string name\nfloat64 position\n",
    "lab/msg/State.msg": """uint8 IDLE=0
uint8 BUSY=1
string frame
uint32 seq
float64[] position
float64[] velocity
string[] name
Joint[] joints
uint8 mode
uint8[] data
Pose pose
bool ok
float64 angle
""",
    "robot.proto": """syntax = "proto2"; package lab;
message Item { required string name = 1; required double value = 2; }
message Robot { enum Mode { IDLE = 0; BUSY = 1; }
 required string frame = 1; required int32 seq = 2; repeated double position = 3; repeated float velocity = 4;
 repeated string name = 5; repeated Item items = 6; required Mode mode = 7; optional bytes data = 8; optional bool ok = 9;
 optional double roll = 10; optional double pitch = 11; optional double yaw = 12; optional double total = 13;
 optional string label = 14; }""",
}
FRONT_ENDS = Readers({name: installed()[name] for name in ("protobuf", "ros1", "ros2")})
IMPORTS = 'import "lab/msg/State.msg"\nimport "robot.proto"\n'
HEAD = f"{IMPORTS}data-holder: lab.Robot\nwire-schema: lab/msg/State\n"
JOINED = f"{IMPORTS}data-holder: lab.Robot\nwire-schema left: lab/msg/State\nwire-schema right: lab/msg/Pose\n"
UNPACK = "unpack-rules:\n  .frame = .frame\n  .seq = int32(.seq)\n  .mode = lab.Robot.Mode(.mode)\n"
BOTH = "rules:\n  .frame <-> .frame\n  .seq <-> int32(.seq)\n  .mode <-> lab.Robot.Mode(.mode)\n"
REST = "  ignore rest\n  default rest\n"


@dataclass(frozen=True)
class Mistake:
    """Lines with a mistake, the code of its report, and what the help says; ``head`` stands before the lines, ``tail`` behind."""

    text: str
    code: str
    help: str
    head: str = HEAD + UNPACK
    tail: str = REST


def syntax(text: str, help_: str, head: str = HEAD + UNPACK, tail: str = REST) -> Mistake:
    return Mistake(text, "syntax", help_, head, tail)


MISTAKES = [
    # words of other languages in ours
    syntax("  when .ok\n    .total = 1\n  else if .mode == 1\n    .total = 2\n  end\n", "`else when condition`; each `when` has an `end`"),
    syntax("  .total = cos .angle\n", "`cos(.angle)`"),
    syntax("  .total = cos .angle\n", "`cos(.angle)`", tail=""),
    syntax("  .data = .data[0..4]\n", "`.a[0 to 3]` are the first three elements"),
    syntax("state count: int64\n", "it has a first value: `state count: int64 = 0`", HEAD, UNPACK + REST),
    syntax("state last: float64\n", "`state last: float64 = 0.0`", HEAD, UNPACK + REST),
    syntax("parameter names: list\n", "`parameter names: list of float64`", HEAD, UNPACK + REST),
    Mistake("  .total = .position[]\n", "many-elements", "`.total = .position[0]`, or one value of all: `.total = sum(.position[])`"),
    Mistake("  .position[] = .position where .velocity[] > 1\n", "type-clash", "each element is written with `[]`: `.position[]`"),
    # brackets, commas, quotes
    syntax("  .total = .position[0\n", "a bracket is not closed: `]` is missing before"),
    syntax("  .total = sqrt(.angle\n  .label = .frame\n", "a bracket is not closed: `)` is missing before"),
    syntax('  .label = table(.frame) { "a" = "b"\n', "a bracket is not closed: `}` is missing before"),
    syntax("  .total = atan2(.pose.x .pose.y)\n", "a comma is missing before it"),
    syntax("  .position = [.pose.x .pose.y]\n", "a comma is missing before it"),
    syntax("  .position = [.pose.x, .pose.y,]\n", "leave out the comma before it"),
    syntax("  reject 'bad frame' when .seq == 0\n", "a text stands in double quotes"),
    syntax('  reject "bad frame when .seq == 0\n', "close the text"),
    syntax("  .items = .joints via joint.mapping\n", 'write `via "joint.mapping"`'),
    # characters that look like others
    syntax("  .label\u00a0= .frame\n", "U+00A0 NO-BREAK SPACE: write a plain blank"),
    syntax("  .label = .fra\u200bme\n", "U+200B ZERO WIDTH SPACE, which is not seen: delete it"),
    syntax("  .label \uff1d .frame\n", "write the plain character `=`"),
    syntax("  .total = sqrt\uff08.angle)\n", "write the plain character `(`"),
    syntax("  .label = .\ufb01eld\n", "write the plain characters `fi`"),
    syntax("  .total = .angle \u2212 1.0\n", "write the plain character `-`"),
    syntax("  .total = .angle \u00b7 2\n", "write the plain character `*`"),
    syntax("  .ok = .seq \u2264 3\n", "write the plain characters `<=`"),
    syntax("  .label \u2190 .frame\n", "write the plain character `=`"),
    syntax("  .total = \u03c0\n", "write the plain characters `pi`"),
    syntax("  .total = .angle\u00b2\n", "a square is `x * x`"),
    syntax("  .total = 90\u00b0\n", "`radians(x)` turns degrees into radians"),
    syntax("  reject \u201cbad\u201d when .seq == 0\n", 'write the plain character `"`'),
    # numbers
    syntax("  .total = 1,5\n", "decimals stand behind a point: `1.5`"),
    syntax("  .total = 1_000.0\n", "the digits of a number stand together"),
    syntax("  .total = 1.\n", "a digit stands behind the point"),
    syntax("  .total = 1.0f\n", "a number ends with its digits"),
    # operators and words of other languages
    syntax("  .ok = 0 < .seq < 10\n", "comparisons do not chain"),
    syntax('  .ok = .frame <> "a"\n', "values are unequal by `!=`"),
    syntax('  .ok = .frame is "a"\n', "values are compared by `==`"),
    syntax('  .ok = .frame in ["a", "b"]\n', "`x == a or x == b`"),
    syntax('  .label = f"joint {.seq}"\n', 'texts are joined by `+`: `"joint " + text(.n)`'),
    syntax("  .position = .position[0:3]\n", "`.a[0 to 3]`"),
    syntax("  .position = [x * 2 for x in .position]\n", "`.a[] = f(.b[])`"),
    syntax("  .label = .frame.upper()\n", "`upper(.frame)`"),
    syntax('  .label = split(.frame, "/")[0]\n', '`part(x, "/", 0)`'),
    syntax("  when .ok\n    .label = .frame\n  elif .seq > 2\n    .label = .frame\n  end\n", "`else when condition`"),
    syntax('  .label = table(.frame) { "a": "b" }\n', '`"key" = value`'),
    syntax('  .label = table(.frame) { "a" => "b" }\n', '`"key" = value`'),
    syntax('  .label = table(.frame) { "a" = "b", default = "c" }\n', "`otherwise value`"),
    syntax("  reject when .seq == 0\n", '`reject "why" when condition`'),
    syntax('  reject "x" if .seq == 0\n', '`reject "why" when condition`'),
    # blocks and rules
    syntax("  len(.position) = 2\n  for i from 0 to 2\n    .position[i] = .angle\n", "the `for` of line 10 has no `end`"),
    syntax("  when .ok\n    .label = .frame\n  else when .ok\n    .label = .frame\n  end\n", "the `when` of line 9 has no `end`"),
    syntax("  .position = .position when .position > 0\n", "elements are chosen by `where`"),
    syntax("  .total * 2 <-> .pose.x\n", "left of `<->` stands a place alone", HEAD + BOTH),
    syntax("  ignore .pose, .angle\n", "`ignore .pose ignore .b`"),
    syntax("  .total = .joints[name = 3].position\n", "a field begins with a dot: `.name`"),
    syntax("  .total <=> .pose.x\n", "a place is related to a value by `<->`", HEAD + BOTH),
    syntax("  .position += .angle\n", "a place is set once for a message"),
    syntax("  .total = .angle if .ok\n", "`a if condition else b`"),
    syntax("  ignore *\n", "`ignore rest`"),
    syntax("  ignore .pose.*\n", "`ignore .pose` is said of all of it"),
    syntax('  .label = "a"b"\n', "written with a backslash"),
    syntax("limit: 4MB\n", "`limit: 4000000`", HEAD, UNPACK),
    # declarations
    syntax("state n = 0\n", "`state n: int64 = 0`", HEAD, UNPACK),
    syntax("  n = n + 1\n", "a state variable is set by `state n = ...`", HEAD + "state n: int64 = 0\n" + UNPACK),
    syntax("parameter k = 1.0\n", "`parameter k: float64`", HEAD, UNPACK),
    syntax("parameter k: list[float64]\n", "`list of float64`", HEAD, UNPACK),
    syntax("wire-schema lab/msg/State\n", "`wire-schema: lab/msg/State`", f"{IMPORTS}data-holder: lab.Robot\n", UNPACK),
    Mistake("  .total = k\n", "parameter-type", "did you mean `float64`?", HEAD + "parameter k: double = 1.0\n" + UNPACK),
    Mistake("  .total = .k\n", "unknown-field", "`k` is a parameter, which has no dot", HEAD + "parameter k: float64 = 1.0\n" + UNPACK),
    # names
    Mistake("  .total = average(.position[])\n", "many-elements", "`mean(.a[])`"),
    Mistake("  .total = to_rad(.angle)\n", "unknown-function", "`radians(x)`"),
    Mistake("  .total = index()\n", "unknown-function", "in a rule with `[]`"),
    Mistake("  .label = .wire.frame\n", "unknown-field", "`.frame`"),
    Mistake("  .label = msg.frame\n", "unknown-name", "`.frame`"),
    Mistake("  .label = lab/msg/State.frame\n", "unknown-name", "`.frame`"),
    Mistake("  .roll = euler(.pose).rol\n", "no-component", "did you mean `roll`?"),
    Mistake("  .pose.x <-> .total\n", "unknown-field", "turn the relation round", HEAD + BOTH),
    Mistake("  ignore .roll\n", "unknown-field", "`default .roll`", HEAD + BOTH),
    Mistake("  default .pose\n", "unknown-field", "`ignore .pose`", HEAD + BOTH),
    Mistake("  len(.position) = 2\n  for i from 0 to 2\n    .position[.i] = 1.0\n  end\n", "unknown-field", "`i` is a loop variable"),
    Mistake('  .data = .data\n  .ok = crc(.data, "crc32") == 0\n', "checksum", 'did you mean "CRC-32"?'),
    # types
    Mistake("  .total = .position[-1]\n", "index-range", "`.position[len(.position) - 1]`"),
    Mistake("  .total = .angle ^ 2\n", "operand", "a square is `x * x`"),
    Mistake("  .total = .ok\n", "type-clash", "`int8(.ok)`"),
    Mistake("  .items = .joints\n", "type-clash", '`.a = .b via "x.mapping"`'),
    Mistake("  .label = .frame[0 to 3]\n", "not-indexable", "`slice(.frame, 0, 3)`"),
    Mistake("  .position[] = .position\n", "no-count", "`.position[] = .position[]`"),
    Mistake('  .total = .position["elbow"]\n', "integer-needed", '`.position[.keys[] = "elbow"]`'),
    Mistake('  .total = .joints[.name == "elbow"].position\n', "key-field", '`[.name = "elbow"]`'),
    Mistake("  .position = .position where .name\n", "condition", '`.name[] == "..."`'),
    Mistake('  .frame = .frame\n  .seq = int32(.seq)\n  .mode = "BUSY"\n', "type-clash", "`lab.Robot.Mode.BUSY`", HEAD + "unpack-rules:\n"),
    Mistake("  len(.position) = 2\n  .position[0] = .angle\n  .position[0] = .angle\n", "set-twice", "remove one of the rules"),
    # wires
    Mistake("unpack-rules:\n  .label = .frame\n  .frame = .left.frame\n", "unknown-field", "write `.left.frame`", JOINED),
    Mistake("unpack-rules:\n  .total = .left.x\n  .frame = .left.frame\n", "unknown-field", "it is `.right.x`", JOINED),
]


@pytest.mark.parametrize("mistake", MISTAKES, ids=lambda each: ascii(each.text.strip())[1:60])
def test_mistake(mistake: Mistake) -> None:
    text = mistake.head + mistake.text + mistake.tail
    with pytest.raises(MappingError) as error:
        check(parse(Source("m.mapping", text)), FRONT_ENDS, SearchPath(files=tuple(FILES.items())))
    first, *others = error.value.diagnostics
    assert (first.severity, first.code) == ("error", mistake.code), render(first)
    assert mistake.help in first.help
    assert [each.code for each in others if each.severity == "error" and each.code not in (mistake.code, "never-set")] == []


def test_lines_of_any_kind_and_byte_order_marks() -> None:
    text = "\ufeff" + (HEAD + UNPACK + REST).replace("\n", "\r\n")
    assert check(parse(Source("m.mapping", text)), FRONT_ENDS, SearchPath(files=tuple(FILES.items()))).unpack
