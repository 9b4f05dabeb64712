"""Mappings that use mappings: named with `via`, or found by type; of arrays, in either direction, and of types within themselves."""

from __future__ import annotations

import pytest

import rosetta_jit as rj

BACKENDS = ["llvm", "python", "interpreter"]

FILES = {
    "geo.proto": """syntax = "proto3"; package geo;
message Point { double x = 1; double y = 2; string label = 3; }
message Path { Point start = 1; Point end = 2; repeated Point between = 3; }
message Tree { int32 value = 1; repeated Tree kids = 2; Tree next = 3; }
""",
    "tree.proto": 'syntax = "proto3"; package wide; message Tree { int64 number = 1; repeated Tree kids = 2; Tree next = 3; }',
    "lab/msg/Point.msg": "float32 east\nfloat32 north\nstring label\n",
    "lab/msg/Path.msg": "Point start\nPoint end\nPoint[] between\n",
    "point.mapping": """import "geo.proto"
import "lab/msg/Point.msg"
data-holder: geo.Point
wire-schema: lab/msg/Point
rules:
  .x <-> .east * 1000
  .y <-> .north * 1000
  .label <-> .label
""",
    "path.mapping": """import "geo.proto"
import "lab/msg/Path.msg"
import "point.mapping"
data-holder: geo.Path
wire-schema: lab/msg/Path
rules:
  .start <-> .start via "point.mapping"
  same names
""",
    "back.mapping": """import "geo.proto"
import "lab/msg/Path.msg"
data-holder: lab/msg/Path
wire-schema: geo.Path
rules:
  .start <-> .end via "point.mapping"
  .end <-> .start via "point.mapping"
  .between <-> .between via "point.mapping"
""",
    "tree.mapping": """import "geo.proto"
import "tree.proto"
data-holder: geo.Tree
wire-schema: wide.Tree
rules:
  .value <-> int32(.number)
  .kids <-> .kids via "tree.mapping" to depth 2
  default .next
  ignore .next
""",
    "list.mapping": """import "geo.proto"
import "tree.proto"
data-holder: geo.Tree
wire-schema: wide.Tree
rules:
  .value <-> int32(.number)
  default .kids
  ignore .kids
  .next <-> .next via "list.mapping" to depth 3
""",
}


def programs(name, backend):
    return tuple(kind(name, schema=FILES, backend=backend) for kind in (rj.Decoder, rj.Encoder))


def wire(type_, *imports):
    return (
        rj.Decoder.of(type_, schema=FILES, imports=imports),
        rj.Encoder.of(type_, schema=FILES, imports=imports),
    )


def point(number, names=("x", "y"), scale=1000.0):
    return {names[0]: number * scale, names[1]: -number * scale, "label": f"p{number}"}


def path(**how):
    return {"start": point(1, **how), "end": point(2, **how), "between": [point(number, **how) for number in range(3, 40)]}


METRES = {"names": ("east", "north"), "scale": 1.0}


@pytest.mark.parametrize("backend", BACKENDS)
def test_messages_and_arrays_of_them(backend):
    decode, encode = programs("path.mapping", backend)
    plain, of_wire = wire("lab/msg/Path", "lab/msg/Path.msg")
    message = of_wire(of_wire.holder_type.from_dict(path(**METRES)))
    assert decode(message).to_dict() == path()
    assert plain(encode(decode(message))).to_dict() == path(**METRES)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_mapping_serves_both_ways_round(backend):
    decode, encode = programs("back.mapping", backend)
    _, of_wire = wire("geo.Path", "geo.proto")
    message = of_wire(of_wire.holder_type.from_dict(path()))
    swapped = path(**METRES)
    swapped["start"], swapped["end"] = swapped["end"], swapped["start"]
    assert decode(message).to_dict() == swapped
    assert encode(decode(message)) == message


def tree(depth, name="value", width=2):
    return {name: depth, "kids": [tree(depth - 1, name, width) for _ in range(width)] if depth else []}


@pytest.mark.parametrize("backend", BACKENDS)
def test_types_within_themselves_to_a_depth(backend):
    decode, encode = programs("tree.mapping", backend)
    _, of_wire = wire("wide.Tree", "tree.proto")
    for depth in range(3):
        message = of_wire(of_wire.holder_type.from_dict(tree(depth, "number")))
        assert decode(message).to_dict() == tree(depth)
        assert encode(decode(message)) == message
    with pytest.raises(rj.DecodeError, match="more than 2 messages within each other") as error:
        decode(of_wire(of_wire.holder_type.from_dict(tree(3, "number"))))
    assert error.value.kind == "rejected"
    with pytest.raises(rj.EncodeError, match="more than 2 messages"):
        encode(encode.holder_type.from_dict(tree(3)))


@pytest.mark.parametrize("backend", BACKENDS)
def test_chains_that_may_end_anywhere(backend):
    decode, encode = programs("list.mapping", backend)
    _, of_wire = wire("wide.Tree", "tree.proto")

    def chain(length, name):
        rest = {"next": chain(length - 1, name)} if length > 1 else {}
        return {name: length, "kids": [], **rest}

    for length in (1, 2, 4):
        message = of_wire(of_wire.holder_type.from_dict(chain(length, "number")))
        assert decode(message).to_dict() == chain(length, "value")
        assert encode(decode(message)) == message
    with pytest.raises(rj.DecodeError, match="more than 3 messages within each other"):
        decode(of_wire(of_wire.holder_type.from_dict(chain(5, "number"))))


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        ('via "point.mapping"', 'via "pont.mapping"', "there is no mapping `pont.mapping`"),
        ('.start via "point.mapping"', '.start via "path.mapping"', "has no rules from lab/msg/Point to geo.Point"),
        ('.start <-> .start via "point.mapping"', '.start.x <-> .start.east via "point.mapping"', "these are float32 and float64"),
        ('.start <-> .start via "point.mapping"', '.start <-> 2 via "point.mapping"', "`via` maps a field"),
        ("same names", '.end <-> .end\n  .between <-> .between via "path.mapping"', "has no rules from"),
    ],
)
def test_wrong_uses(before, after, words):
    files = FILES | {"path.mapping": FILES["path.mapping"].replace(before, after)}
    with pytest.raises(rj.MappingError) as error:
        rj.Decoder("path.mapping", schema=files)
    assert words in str(error.value)


@pytest.mark.parametrize(("depth", "words"), [("", "used within itself"), (" to depth 99", "at most 16")])
def test_depth_must_be_said(depth, words):
    files = FILES | {"tree.mapping": FILES["tree.mapping"].replace(" to depth 2", depth)}
    with pytest.raises(rj.MappingError) as error:
        rj.Decoder("tree.mapping", schema=files)
    assert words in str(error.value)


def test_mappings_that_use_each_other_too_often_are_refused():
    rules = "\n".join(f'  .kids{number} = .kids{number} via "many.mapping" to depth 16' for number in range(4))
    fields = " ".join(f"repeated T kids{number} = {number + 1};" for number in range(4))
    files = {
        "a.proto": f'syntax = "proto3"; package a; message T {{ {fields} }}',
        "b.proto": f'syntax = "proto3"; package b; message T {{ {fields} }}',
        "many.mapping": f'import "a.proto"\nimport "b.proto"\ndata-holder: a.T\nwire-schema: b.T\nunpack-rules:\n{rules}\n',
    }
    with pytest.raises(rj.MappingError, match="more than 1000 times"):
        rj.Decoder("many.mapping", schema=files)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    ("rules", "order"),
    [
        (".xs <-> reversed(.xs)", [3, 2, 1, 0]),
        (".xs <-> planar(.xs, 2)", [0, 2, 1, 3]),
        (".xs <-> permuted(.xs, [1, 0])", [1, 0, 3, 2]),
        ("len(.xs) <-> len(.xs) for i from 0 to len(.xs) .xs[len(.xs) - 1 - i] <-> .xs[i] end", [3, 2, 1, 0]),
    ],
)
def test_arrays_in_another_order_in_each_message(rules, order, backend):
    """The checker tells the elements of an inner array from those of the array around it."""
    head = 'import "lab/A.msg" import "lab/B.msg" '
    texts = {
        **dict.fromkeys(("lab/Row.msg", "lab/Line.msg"), "float64[] xs\n"),
        "lab/A.msg": "Row[] rows\n",
        "lab/B.msg": "Line[] rows\n",
        "row.mapping": f"{head} data-holder: lab/Line wire-schema: lab/Row rules: {rules}",
        "m.mapping": f'{head} data-holder: lab/B wire-schema: lab/A rules: .rows <-> .rows via "row.mapping"',
    }
    decode, encode = (kind("m.mapping", schema=texts, encoding="ros1", backend=backend) for kind in (rj.Decoder, rj.Encoder))
    write = rj.Encoder.of("lab/A", schema=texts, imports=["lab/A.msg"], encoding="ros1", backend="interpreter")
    rows = [[1.0, 2.0, 3.0, 4.0], [], [5.0, 6.0, 7.0, 8.0]]
    message = write(write.holder_type.from_dict({"rows": [{"xs": row} for row in rows]}))
    assert decode(message).to_dict() == {"rows": [{"xs": [row[i] for i in order] if row else []} for row in rows]}
    assert encode(decode(message)) == message


ROWS = """syntax = "proto2"; package PACKAGE; message Spot { required int32 n = 1; }
message Row { optional string name = 1; optional Spot spot = 2; oneof which { int32 a = 3; string b = 4; } required int32 kind = 5; }
message Rows { repeated Row rows = 1; LABEL Spot first = 2; }"""
ROW_RULES = """rules:
  when has(.name) .name <-> .name else default .name end
  .spot <-> .spot via "spot.mapping"
  .kind <-> .kind
  when .kind == 1 .a <-> .a else .b <-> .b end
"""


@pytest.mark.parametrize("backend", BACKENDS)
def test_what_elements_may_lack(backend):
    """Each element has what its own message had: a text, a message, one case or the other."""
    head = 'import "wire.proto" import "holder.proto" data-holder: holder.{0} wire-schema: wire.{0} '
    texts = {
        "wire.proto": ROWS.replace("PACKAGE", "wire").replace("LABEL", "optional"),
        "holder.proto": ROWS.replace("PACKAGE", "holder").replace("LABEL", "required"),
        "spot.mapping": head.format("Spot") + "rules: .n <-> int32(.n + 1)",
        "row.mapping": head.format("Row") + ROW_RULES,
        "m.mapping": head.format("Rows") + 'rules: .rows <-> .rows via "row.mapping" .first <-> .first via "spot.mapping"',
    }
    decode, encode = (kind("m.mapping", schema=texts, backend=backend) for kind in (rj.Decoder, rj.Encoder))
    write = rj.Encoder.of("wire.Rows", schema=texts, imports=["wire.proto"], backend="interpreter")
    rows = [{"kind": 1, "a": 5}, {"name": "", "spot": {"n": 3}, "kind": 2, "b": "x"}, {"spot": {"n": 4}, "kind": 3, "b": ""}]
    for some in (rows, rows[::-1], rows):
        message = write(write.holder_type.from_dict({"rows": some, "first": {"n": 0}}))
        unpacked = [{**row, **({"spot": {"n": row["spot"]["n"] + 1}} if "spot" in row else {})} for row in some]
        assert decode(message).to_dict() == {"rows": unpacked, "first": {"n": 1}}
        assert encode(decode(message)) == message
    with pytest.raises(rj.DecodeError, match="the required `n` is not there") as error:
        decode(write(write.holder_type.from_dict({"rows": rows})))
    assert (error.value.kind, error.value.path) == ("missing", ".first.n")


LEFT_ALONE = (
    ".parts[].u <-> .parts[].u ignore .parts[].v",
    ".parts[].u <-> .parts[].u ignore rest",
    "len(.parts) <-> len(.parts) for each from 0 to len(.parts) .parts[each].u <-> .parts[each].u end ignore .parts[].v",
    "len(.parts) <-> len(.parts) for i from 0 to len(.parts) .parts[i].u <-> .parts[i].u ignore .parts[i].v end",
)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("rules", LEFT_ALONE)
def test_fields_of_elements_that_a_mapping_leaves_alone_wherever_it_is_used(rules, backend):
    """The elements lie in a message, in a message of a message, or in one of an array's, whose loop no name of a mapping's own hides."""
    texts = {
        "lab/Part.msg": "int32 u\nstring v\n",
        "lab/Row.msg": "Part[] parts\n",
        "lab/Rows.msg": "Row[] rows\nRow one\n",
        "own/Part.msg": "int32 u\n",
        "own/Row.msg": "Part[] parts\n",
        "own/Rows.msg": "Row[] rows\nRow one\n",
    }
    head = "".join(f'import "{name}" ' for name in texts)
    uses = "".join(f'.{name} <-> .{name} via "row.mapping" ' for name in ("rows", "one"))
    texts |= {
        "row.mapping": f"{head} data-holder: own/Row wire-schema: lab/Row rules: {rules}",
        "m.mapping": f"{head} data-holder: own/Rows wire-schema: lab/Rows rules: {uses}",
    }
    decode, encode = (kind("m.mapping", schema=texts, encoding="ros1", backend=backend) for kind in (rj.Decoder, rj.Encoder))
    own = {"schema": texts, "imports": ["lab/Rows.msg"], "encoding": "ros1", "backend": "interpreter"}
    write, read = rj.Encoder.of("lab/Rows", **own), rj.Decoder.of("lab/Rows", **own)

    def row(count, text=""):
        return {"parts": [{"u": 10 * count + number, "v": text} for number in range(count)]}

    found = decode(write(write.holder_type.from_dict({"rows": [row(3, "x"), row(0), row(2, "y")], "one": row(1, "z")})))
    assert [[part.u for part in each.parts] for each in (*found.rows, found.one)] == [[30, 31, 32], [], [20, 21], [10]]
    assert read(encode(found)).to_dict() == {"rows": [row(3), row(0), row(2)], "one": row(1)}
    assert str(decode.mapping.laws.holders) == "exact inverse"
    assert {loss.place for loss in decode.mapping.laws.messages.losses} == {".rows[].parts[].v", ".one.parts[].v"}


def test_what_is_refused_beyond_a_depth_is_neither_lost_nor_unread():
    files = {
        "leaf.proto": 'syntax = "proto3"; package lab; message Leaf { int32 value = 1; repeated Leaf leaves = 2; }',
        "twig.proto": 'syntax = "proto3"; package lab; message Twig { int32 value = 1; repeated Twig twigs = 2; }',
        "m.mapping": """import "leaf.proto"
import "twig.proto"
data-holder: lab.Twig
wire-schema: lab.Leaf
rules:
  .value <-> .value
  .twigs <-> .leaves via "m.mapping" to depth 2
""",
    }
    found = rj.check("m.mapping", schema=files)
    assert not found.checked.warnings
    assert str(found.laws) == "messages: exact inverse\nholders: exact inverse"


def test_cases_of_elements_are_set_in_some_blocks():
    """Each element has another case of its union: no case is one that no rule sets."""
    files = {
        "t/msg/E.msg": "uint8 D=1\nuint8 I=2\nuint8 kind\nfloat64 d\nint64 i\n",
        "t/msg/Es.msg": "E[] es\n",
        "u.proto": 'syntax = "proto3"; package u; message E { oneof v { double d = 1; int64 i = 2; } } message Es { repeated E es = 1; }',
        "e.mapping": """import "t/msg/E.msg"
import "u.proto"
data-holder: u.E
wire-schema: t/msg/E
rules:
  when .kind == t/msg/E.D
    .d <-> .d
    ignore .i
  else when .kind == t/msg/E.I
    .i <-> .i
    ignore .d
  else
    reject "no kind"
  end end
""",
        "m.mapping": """import "t/msg/Es.msg"
import "u.proto"
data-holder: u.Es
wire-schema: t/msg/Es
rules:
  .es <-> .es via "e.mapping"
""",
    }
    laws = rj.check("m.mapping", schema=files).laws
    assert {each.why for each in laws.holders.losses} == {"it cannot be shown by which block of a `when` it comes back"}
    assert str(rj.check("e.mapping", schema=files).laws.holders) == "exact inverse"


@pytest.mark.parametrize("backend", BACKENDS)
def test_an_array_of_a_fixed_length_takes_as_many_messages(backend):
    files = {
        "arm.proto": 'syntax = "proto3"; package lab; message Joint { double q = 1; } message Arm { repeated Joint joints = 1; }',
        "t/msg/Joint.msg": "float64 q\n",
        "t/msg/Arm.msg": "Joint[2] joints\n",
        "joint.mapping": """import "t/msg/Joint.msg"
import "arm.proto"
data-holder: lab.Joint
wire-schema: t/msg/Joint
rules:
  .q <-> .q * 2.0
""",
        "m.mapping": """import "t/msg/Arm.msg"
import "arm.proto"
data-holder: lab.Arm
wire-schema: t/msg/Arm
rules:
  .joints <-> .joints via "joint.mapping"
""",
    }
    decode, encode = (each("m.mapping", schema=files, backend=backend) for each in (rj.Decoder, rj.Encoder))
    arm = {"joints": [{"q": 1.0}, {"q": -2.5}]}
    assert decode(encode(encode.holder_type.from_dict(arm))).to_dict() == arm
    for joints in ([], [{"q": 1.0}], [{"q": 1.0}] * 3):
        with pytest.raises(rj.EncodeError, match="the arrays have different lengths"):
            encode(encode.holder_type.from_dict({"joints": joints}))
