"""What is told about a mapping: the same as text, as a page and as JSON, and nothing of it harms."""

from __future__ import annotations

import json
from html.parser import HTMLParser

import pytest

import rosetta_jit as rj
from rosetta_jit.cli import main
from rosetta_jit.explain.content import explanation
from rosetta_jit.explain.page import as_page
from rosetta_jit.explain.text import as_text
from tests.golden import GOLDEN, check_golden

EVIL = "</title><script>alert(1)</script>\x1b[2J\u202e\"'&"
FILES = {
    "a.bottle-schema": '"a" (("yaw" :double (:unit :degree)) ("n" :int) ("list" (:list :double)) ("spare" :int))',
    "h.proto": """syntax = "proto2"; package h;
message Inner { required uint32 wide = 1; optional string note = 2; }
message H { required float angle = 1; repeated float list = 2; required Inner inner = 3; optional H next = 4; }""",
}
HEAD = 'import "a.bottle-schema"\nimport "h.proto"\ndata-holder: h.H\nwire-schema: a\n'
RULES = f"""{HEAD}rules:
  .angle <-> float32(radians(.yaw))
  len(.list) <-> len(.list)
  for i from 0 to len(.list)
    .list[i] <-> float32(.list[i])
  end
unpack-rules:
  reject "negative" when .n < 0
  .inner.wide = uint32(.n)
  ignore .spare
pack-rules:
  .n = int32(.inner.wide, saturate)
  .spare = 0
"""


@pytest.fixture
def mapping(tmp_path, monkeypatch):
    def write(text=RULES, name="m.mapping"):
        for each, content in {**FILES, name: text}.items():
            (tmp_path / each).write_text(content)
        monkeypatch.chdir(tmp_path)
        return name

    return write


def test_as_text(mapping):
    check_golden(GOLDEN / "explain" / "both.txt", as_text(explanation(mapping(), encoding="yarp4"), width=100) + "\n")


def test_as_narrow_text(mapping):
    told = as_text(explanation(mapping(), encoding="yarp4"), width=60)
    assert max(map(len, told.split("warning")[0].splitlines())) <= 60


def test_as_page(mapping):
    check_golden(GOLDEN / "explain" / "both.html", as_page(explanation(mapping(), encoding="yarp4")))


def test_what_it_says(mapping):
    found = explanation(mapping(), encoding="yarp4")
    unpack, pack = found.directions
    assert [line.block for line in unpack.lines] == ["rules"] * 4 + ["unpack-rules"] * 3
    assert [line.text for line in pack.lines[:4]] == [
        ".yaw = degrees(.angle)",
        "len(.list) = len(.list)",
        "for i from 0 to len(.list)",
        ".list[i] = .list[i]",
    ]
    assert unpack.lines[0].reads == (("yaw",),)
    assert unpack.lines[0].sets == (("angle",),)
    assert [note.text for note in unpack.lines[0].notes] == ["degree → radian", "float64 → float32, rounded to the nearest"]
    assert {(each.what, each.meant) for each in unpack.losses} == {
        (".spare", True),
        (".inner.note", False),
        (".next", False),
        (".angle, .list", True),
    }
    assert ("int32", True) in {(note.text.split(" → ")[1].split(",")[0], note.lossy) for line in pack.lines for note in line.notes[:1]}
    assert unpack.refusals == ("negative",)
    assert unpack.cost.cost.repeated[0].count == "len(.list)"


def test_where_values_are_rounded(mapping):
    """Arithmetic in float32, constants that no float32 is equal to, and integers that pack as the nearest; what only checks is no loss."""
    text = (
        HEAD
        + """rules:
  .angle <-> float32(.n * 0.1)
  len(.list) <-> 2
unpack-rules:
  .inner.wide = 1
  .list[0] = float32(.yaw) * 0.5
  .list[1] = 0.1
  ignore .list
  ignore .spare
pack-rules:
  ignore .inner.wide
  ignore .list
  .yaw = 0.0
  len(.list) = 0
  .spare = 0
"""
    )
    unpack, pack = explanation(mapping(text), encoding="yarp4").directions
    notes = {line.text: [note.text for note in line.notes] for line in (*unpack.lines, *pack.lines)}
    assert notes[".angle = float32(.n * 0.1)"] == ["float64 → float32, rounded to the nearest"]
    assert notes[".n = divide(.angle, 0.1)"] == ["float64 → int32, the nearest, refused where that does not unpack to the value"]
    assert "computed in float32, rounded" in notes[".list[0] = float32(.yaw) * 0.5"]
    assert notes[".list[1] = 0.1"] == ["0.1 → float32, rounded to 0.10000000149011612"]
    warnings = [each.message for each in rj.check("m.mapping").warnings if each.code == "rounded"]
    assert warnings == ["no float32 is 0.1: 0.10000000149011612 is the nearest"]


def test_one_way(mapping):
    text = HEAD + "unpack-rules:\n  .angle = 1.0\n  .inner.wide = 2\n  len(.list) = 0\n"
    told = as_text(explanation(mapping(text)))
    assert "one-way: there are no rules to pack" in told
    assert "warning[never-read]" in told


def test_as_json(mapping, capsys):
    assert main(["explain", mapping(), "--json", "--encoding", "yarp4"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["wire"]["type"] == "a"
    assert found["directions"][0]["lines"][0]["text"] == ".angle = float32(radians(.yaw))"
    assert found["warnings"][0]["severity"] == "warning"


def test_a_wrong_mapping_is_reported(mapping, capsys):
    assert main(["explain", mapping(HEAD + "unpack-rules:\n  .x = .y\n")]) == 1
    assert "error[unknown-field]" in capsys.readouterr().err


class Tags(HTMLParser):
    def __init__(self):
        super().__init__()
        self.tags = []

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))


def test_hostile_texts_are_escaped(mapping, tmp_path):
    quoted = EVIL.replace('"', '\\"')
    text = f'{HEAD}unpack-rules:\n  reject "{quoted}" when .n < 0\n  .angle = 1.0\n  .inner.wide = 2\n  len(.list) = 0\n'
    name = mapping(text, name="<b onclick=alert(1)>.mapping")
    assert main(["explain", name, "--html", "page.html"]) == 0
    page = (tmp_path / "page.html").read_text()
    tags = Tags()
    tags.feed(page)
    assert {tag for tag, _ in tags.tags}.isdisjoint({"script", "img", "b", "link", "iframe", "a", "object"})
    assert not any(name.startswith("on") or name in {"href", "src"} for _, attributes in tags.tags for name in attributes)
    assert "alert(1)" in page
    assert "\x1b" not in page
    assert "\u202e" not in page
    assert all(line.isprintable() for line in as_text(explanation(name)).splitlines())


def test_a_type_within_itself_and_a_huge_one_are_bounded(mapping, tmp_path):
    levels = " ".join(f"message L{n} {{ {' '.join(f'optional L{n + 1} f{k} = {k + 1};' for k in range(9))} }}" for n in range(7))
    name = mapping(HEAD.replace("h.H", "h.L0") + "unpack-rules:\n  default .f0\n")
    (tmp_path / "h.proto").write_text(f'syntax = "proto2"; package h; {levels} message L7 {{ optional L0 again = 1; }}')
    found = explanation(name)
    assert found.holder.more
    assert "and more fields" in as_text(found)
    assert "and more fields" in as_page(found)


@pytest.mark.parametrize(
    "mapping_", ["ros1/image.mapping", "ros1/joint_state.mapping", "ros1/time_reference.mapping", "yarp/icub/camera_image.mapping"]
)
def test_shipped_mappings(mapping_):
    found = explanation(mapping_)
    assert [each.name for each in found.directions] == ["unpack", "pack"]
    assert all(not isinstance(each.cost, str) for each in found.directions)
    assert found.warnings == ()


GEO = {
    "geo.proto": """syntax = "proto3"; package geo;
message Point { float x = 1; string label = 2; }
message Path { Point start = 1; Point end = 2; repeated Point between = 3; string name = 4; }
message Tree { int32 value = 1; repeated Tree kids = 2; }
message Wide { int64 number = 1; repeated Wide below = 2; }""",
    "lab/msg/Spot.msg": "float64 east\nstring label\n",
    "lab/msg/Track.msg": "Spot start\nSpot end\nSpot[] between\nstring name\n",
    "spot.mapping": """import "geo.proto"
import "lab/msg/Spot.msg"
data-holder: geo.Point
wire-schema: lab/msg/Spot
rules:
  .x <-> float32(.east * 1000)
  .label <-> .label
""",
    "track.mapping": """import "geo.proto"
import "lab/msg/Track.msg"
import "spot.mapping"
data-holder: geo.Path
wire-schema: lab/msg/Track
rules:
  .start <-> .end via "spot.mapping"
  .end <-> .start
  same names
""",
    "tree.mapping": """import "geo.proto"
data-holder: geo.Tree
wire-schema: geo.Wide
rules:
  .value <-> int32(.number)
  .kids <-> .below via "tree.mapping" to depth 2
""",
}


@pytest.fixture
def nested(tmp_path, monkeypatch):
    for name, content in GEO.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(content)
    monkeypatch.chdir(tmp_path)


@pytest.mark.usefixtures("nested")
def test_rules_of_other_mappings_stand_below_those_that_use_them():
    unpack, pack = explanation("track.mapping").directions
    inner = [(1, ".x = float32(.east * 1000)", "spot.mapping"), (1, ".label = .label", "spot.mapping")]
    assert [(line.depth, line.text, line.file) for line in unpack.lines] == [
        (0, '.start = .end via "spot.mapping"', ""),
        *inner,
        (0, ".end = .start", ""),
        *inner,
        (0, ".name = .name", ""),
        (0, ".between = .between", ""),
        *inner,
    ]
    assert [line.text for line in pack.lines if line.file] == [".east = divide(.x, 1000)", ".label = .label"] * 3
    assert (unpack.lines[0].sets, unpack.lines[0].reads) == ((("start",),), (("end",),))
    assert [(line.sets, line.reads) for line in unpack.lines if line.text.startswith(".x")] == [
        ((("start", "x"),), (("end", "east"),)),
        ((("end", "x"),), (("start", "east"),)),
        ((("between", "x"),), (("between", "east"),)),
    ]
    assert (".start.x, .end.x, .between[].x", True) in {(each.what, each.meant) for each in unpack.losses}


@pytest.mark.usefixtures("nested")
def test_a_mapping_is_not_opened_within_itself():
    unpack, pack = explanation("tree.mapping").directions
    assert [line.text for line in unpack.lines] == [".value = int32(.number)", '.kids = .below via "tree.mapping" to depth 2']
    assert [line.text for line in pack.lines] == [".number = .value", '.below = .kids via "tree.mapping" to depth 2']


@pytest.mark.usefixtures("nested")
def test_other_mappings_as_text_page_and_json(capsys):
    found = explanation("track.mapping")
    assert "\n  6  spot.mapping    .x = float32(.east * 1000)" in as_text(found)
    assert '<td class="block">spot.mapping</td><td class="rule" style="padding-left: 1.4rem">.x = float32(.east * 1000)' in as_page(found)
    assert main(["explain", "--json", "track.mapping"]) == 0
    lines = json.loads(capsys.readouterr().out)["directions"][0]["lines"]
    assert [line["file"] for line in lines[:4]] == ["", "spot.mapping", "spot.mapping", ""]


def test_what_depends_on_the_type_of_a_field_is_shown(mapping, tmp_path):
    mapping()
    (tmp_path / "w.bottle-schema").write_text('"w" (("at" :double) ("spelt" :string) ("whole" :int64) ("n" :int))')
    (tmp_path / "s.proto").write_text(
        'syntax = "proto2"; package s; message S { required int64 secs = 1; required int32 nanos = 2; required int64 ns = 3;'
        "required string number = 4; required string digits = 5; }"
    )
    text = """import "w.bottle-schema"
import "s.proto"
data-holder: s.S
wire-schema: w
rules:
  .secs <-> seconds(.at)
  .nanos <-> int32(fraction(.at))
  .ns <-> nanoseconds(.spelt)
  .number <-> text(.whole)
  .digits <-> text(.n)
"""
    (tmp_path / "m.mapping").write_text(text)
    pack = explanation("m.mapping", encoding="yarp4").directions[1]
    assert [line.text for line in pack.lines] == [
        ".at = timestamp(.secs, .nanos)",
        ".spelt = iso8601(.ns)",
        ".whole = integer(.number)",
        ".n = integer(.digits)",
    ]


def test_cases_are_shown_as_rules_name_them(mapping, tmp_path):
    mapping()
    (tmp_path / "u.idl").write_text("""module u {
  union Un switch (long) { case 1: long a; case 2: double n; };
  @final struct Pair { Un u; long x; };
  @final struct Same { Un u; long x; };
};""")
    text = """import "u.idl"
data-holder: "u::Pair"
wire-schema: "u::Same"
rules:
  same names except .u
unpack-rules:
  .u.n = .u.n + 0.5
  ignore .u.a
pack-rules:
  .u.n = .u.n
"""
    (tmp_path / "m.mapping").write_text(text)
    found = explanation("m.mapping", encoding="cdr")
    unpack, pack = found.directions
    assert {each.what for each in (*unpack.losses, *pack.losses)} == {".u.a", ".u._d"}
    assert ".u.n" in {row.path for row in found.wire.rows}
    assert "_u." not in as_text(found, width=100)
    assert "_u." not in as_page(found)
    laws = rj.check("m.mapping").laws
    assert [loss.place for loss in laws.messages.losses] == [".u.n", ".u._d", ".u.a"]


def test_each_rule_of_a_relation_is_noted_by_what_it_does(mapping, tmp_path):
    """One line of text sets several fields, each with a conversion of its own, or none."""
    mapping()
    (tmp_path / "w.bottle-schema").write_text('"w" (("secs" :int64) ("nanos" :int) ("a" (:list :int)) ("b" (:list :int)))')
    proto = "message S { enum Order { UP = 0; DOWN = 1; } required int64 ns = 1; required Order order = 2; repeated int32 a = 3; }"
    (tmp_path / "s.proto").write_text(f'syntax = "proto2"; package s; {proto}')
    text = """import "w.bottle-schema"
import "s.proto"
data-holder: s.S
wire-schema: w
rules:
  .ns <-> nanoseconds(.secs, .nanos)
  .a by .order <-> { s.S.Order.UP = .a, s.S.Order.DOWN = reversed(.a) }
  ignore .b
"""
    (tmp_path / "m.mapping").write_text(text)
    unpack, pack = explanation("m.mapping", encoding="yarp4").directions
    assert unpack.lines[1].text == ".a by .order = { s.S.Order.UP = .a }"
    secs, nanos = pack.lines[:2]
    assert (secs.text, secs.sets, secs.notes) == (".secs = floor_divide(.ns, 1000000000)", (("secs",),), ())
    assert (nanos.sets, [note.text for note in nanos.notes]) == ((("nanos",),), ["int64 → int32, refused where it does not fit"])


def test_items_of_a_list_are_shown_one_by_one(mapping, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "300")  # however long the name of the file is
    text = f"{HEAD}unpack-rules:\n  default .inner\n  .angle = float32(.yaw)\n  .list = [1.0, float32(.list[0])]\n  ignore rest\n"
    assert main(["explain", mapping(text), "--encoding", "yarp4"]) == 0
    lines = [line for line in capsys.readouterr().out.splitlines() if ".list" in line and "rules" in line]
    shown = [line.split("unpack-rules", 1)[1].strip() for line in lines]
    noted = ".list[1] = float32(.list[0])   \u00b7 float64 \u2192 float32, rounded to the nearest"
    assert shown == ["len(.list) = 2", ".list[0] = 1.0", noted]
