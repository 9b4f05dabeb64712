"""Parameters and lists: what is said when a program is made, and what stands in the text."""

from __future__ import annotations

import json

import numpy as np
import pytest

import rosetta_jit as rj
from rosetta_jit.cli import main

BACKENDS = ["llvm", "python", "interpreter"]
HEAD = 'import "w.bottle-schema"\nimport "h.proto"\ndata-holder: H\nwire-schema: w\n'
SCHEMAS = {
    "w.bottle-schema": '"w" (("a" :double) ("n" :int) ("xs" (:list :double)) ("names" (:list :string)))',
    "h.proto": """syntax = "proto2";
message H {
  repeated string names = 1; repeated double angles = 2; required double scaled = 3; required string mode = 4; required bool fast = 5;
}""",
}
NAMES = ["yaw", "roll", "", "gelenk-ä"]
UNPACK = """parameter names: list of string
parameter scale: float64 = 2.0
parameter mode: string
parameter offsets: list of float64 = [1.0, 2.0, 3.0]
unpack-rules:
  .names = names
  len(.angles) = len(.xs)
  for i from 0 to len(.xs) .angles[i] = .xs[i] * offsets[i] end
  .scaled = .a * scale + offsets[.n]
  .mode = mode
  .fast = mode == "fast" and len(names) > 2
"""


def files(rules, **others):
    return {**SCHEMAS, "m.mapping": HEAD + rules, **others}


def wire(backend="interpreter", **values):
    encode = rj.Encoder.of("w", schema=SCHEMAS, imports=["w.bottle-schema"], encoding="yarp3", backend=backend)
    return encode(encode.holder_type.from_dict({"a": 1.5, "n": 2, "xs": [1.0, 2.0], "names": [], **values}))


def read(data):
    return rj.Decoder.of("w", schema=SCHEMAS, imports=["w.bottle-schema"], encoding="yarp3", backend="interpreter")(data).to_dict()


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("names", [[], NAMES, [f"joint{number}" for number in range(70)]])
def test_parameters_are_constants(backend, names):
    decode = rj.Decoder(
        "m.mapping", schema=files(UNPACK), encoding="yarp3", backend=backend, parameters={"names": names, "mode": "fast", "scale": 4}
    )
    held = decode(wire(a=1.5, n=1, xs=[1.0, 2.0, 4.0])).to_dict()
    assert held == {"names": names, "angles": [1.0, 4.0, 12.0], "scaled": 1.5 * 4 + 2.0, "mode": "fast", "fast": len(names) > 2}
    for n, xs in ((3, []), (-1, []), (0, [0.0] * 4)):
        with pytest.raises(rj.DecodeError, match="3 items") as error:
            decode(wire(n=n, xs=xs))
        assert error.value.kind == "index"


def test_arrays_of_numpy_are_lists():
    options = {"schema": files(UNPACK), "encoding": "yarp3", "backend": "interpreter"}
    offsets = np.array([0.5, 0.25])
    decode = rj.Decoder("m.mapping", parameters={"names": ("a",), "mode": "slow", "scale": np.float32(0.5), "offsets": offsets}, **options)
    held = decode(wire(a=3.0, n=1, xs=[8.0])).to_dict()
    assert (held["scaled"], held["angles"], held["names"], held["fast"]) == (1.75, [4.0], ["a"], False)


def test_each_value_is_a_program_of_its_own():
    """Also from the cache, which knows the request before the mapping is read."""
    options = {"schema": files(UNPACK), "encoding": "yarp3"}
    for scale in (2.0, 3.0, 2.0):
        decode = rj.Decoder("m.mapping", parameters={"names": [], "mode": "", "scale": scale}, **options)
        assert decode(wire(a=10.0, n=0)).scaled == 10 * scale + 1


BOTH = """parameter names: list of string
parameter gain: float64
rules:
  .names <-> names
  len(.angles) <-> len(names)
  reject "another number of joints" when len(.xs) != len(names)
  for i from 0 to len(names) .angles[i] <-> .xs[i] * gain end
  ignore .names
  .mode <-> "joints"
  .fast <-> true
  .scaled <-> .a
  ignore .n
pack-rules:
  len(.xs) = len(names)
"""


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("names", [NAMES, [f"joint{number}" for number in range(40)]])
def test_in_both_directions_parameters_are_checks(backend, names):
    options = {"schema": files(BOTH.replace("  ignore .names\n", "  ignore .names\n")), "encoding": "yarp3", "backend": backend}
    parameters = {"names": names, "gain": 4.0}
    decode, encode = (program("m.mapping", parameters=parameters, **options) for program in (rj.Decoder, rj.Encoder))
    xs = [float(number) for number in range(len(names))]
    held = decode(wire(a=2.0, n=0, xs=xs)).to_dict()
    assert held == {"names": names, "angles": [4 * x for x in xs], "mode": "joints", "fast": True, "scaled": 2.0}
    assert read(encode(encode.holder_type.from_dict(held))) == {"a": 2.0, "n": 0, "xs": xs, "names": []}
    for changed in ({"names": names[:-1]}, {"names": [*names[:-1], "other"]}, {"mode": "x"}, {"angles": [0.0]}):
        with pytest.raises(rj.EncodeError):
            encode(encode.holder_type.from_dict({**held, **changed}))
    with pytest.raises(rj.DecodeError, match="another number of joints"):
        decode(wire(xs=[*xs, 1.0]))


@pytest.mark.parametrize("backend", BACKENDS)
def test_lists_of_the_text(backend):
    rules = """parameter third: string = "pitch"
unpack-rules:
  .names = ["yaw", "roll", third]
  .angles = [1.0, .a, -.a * 2.0, .xs[0]]
  .scaled = [.a, 5.0, -.a][.n]
  .mode = ["slow", "fast", "faster"][.n]
  .fast = [false, true, true][.n]
"""
    rules = (
        rules.replace("[.a, 5.0, -.a][.n]", "pick")
        .replace('["slow", "fast", "faster"][.n]', "modes[.n]")
        .replace("[false, true, true][.n]", ".n > 0")
    )
    rules = rules.replace("pick", "numbers[.n]").replace(
        "unpack-rules",
        'parameter numbers: list of float64 = [-1.5, 5.0, 1.5]\nparameter modes: list of string = ["slow", "fast", "faster"]\nunpack-rules',
    )
    decode = rj.Decoder("m.mapping", schema=files(rules), encoding="yarp3", backend=backend)
    for n in range(3):
        assert decode(wire(a=1.5, n=n, xs=[9.0])).to_dict() == {
            "names": ["yaw", "roll", "pitch"],
            "angles": [1.0, 1.5, -3.0, 9.0],
            "scaled": [-1.5, 5.0, 1.5][n],
            "mode": ["slow", "fast", "faster"][n],
            "fast": n > 0,
        }


@pytest.mark.parametrize("backend", BACKENDS)
def test_texts_on_the_wire(backend):
    rules = """parameter names: list of string
pack-rules:
  .names = names
  .a = .scaled
  .n = 1
  .xs = [1.0, .scaled]
"""
    encode = rj.Encoder("m.mapping", schema=files(rules), encoding="yarp3", backend=backend, parameters={"names": NAMES})
    held = encode.holder_type.from_dict({"names": [], "angles": [], "scaled": 3.0, "mode": "", "fast": True})
    assert read(encode(held)) == {"a": 3.0, "n": 1, "xs": [1.0, 3.0], "names": NAMES}


def test_a_mapping_is_checked_for_all_values(tmp_path):
    for name, content in files(UNPACK + "  ignore .names\n").items():
        (tmp_path / name).write_text(content)
    assert [problem.code for problem in rj.check(str(tmp_path / "m.mapping"))] == []
    (tmp_path / "m.mapping").write_text(
        HEAD + UNPACK.replace(".names = names", "len(.names) = len(names) + 1\n for i from 0 to len(names) .names[i] = names[i] end")
    )
    with pytest.raises(rj.MappingError) as error:
        rj.check(str(tmp_path / "m.mapping"))
    assert [problem.code for problem in error.value.diagnostics] == ["coverage"]
    assert "len(names)" in str(error.value)


def test_conditions_on_parameters_leave_one_block():
    """What is in the other one need not be possible with these values."""
    rules = """parameter names: list of string
parameter mode: string
unpack-rules:
  .mode = names[2] if len(names) > 2 else mode
  when mode == "fast" .fast = true .scaled = .a else .fast = false .scaled = -.a end
  .names = []
  .angles = []
"""
    for names, mode in ((["a"], "slow"), (["a", "b", "c"], "fast")):
        options = {"schema": files(rules), "encoding": "yarp3", "backend": "interpreter"}
        decode = rj.Decoder("m.mapping", parameters={"names": names, "mode": mode}, **options)
        held = decode(wire(a=2.0)).to_dict()
        fast = mode == "fast"
        assert held == {"names": [], "angles": [], "mode": "c" if len(names) > 2 else mode, "fast": fast, "scaled": 2.0 if fast else -2.0}


REST = '  .names = []\n  .angles = []\n  .mode = "x"\n  .fast = true\n'


@pytest.mark.parametrize(
    ("declared", "given", "code", "text"),
    [
        ("x: int32", {}, "missing-parameter", '`parameters={"x": ...}`'),
        ("x: int32", {"x": 1, "y": 2}, "unknown-parameter", "no parameter `y`"),
        ("x: int32", {"x": 1.5}, "parameter", "int32 is needed, not 1.5"),
        ("x: int32", {"x": True}, "parameter", "int32 is needed, not True"),
        ("x: bool", {"x": 1}, "parameter", "bool is needed"),
        ("x: int8", {"x": 200}, "parameter", "200 does not fit int8"),
        ("x: float64", {"x": float("nan")}, "parameter", "not finite"),
        ("x: float32", {"x": 1e39}, "parameter", "does not fit float32"),
        ("x: float64", {"x": 10**400}, "parameter", "does not fit float64"),
        ("x: string", {"x": "a" * 1001}, "parameter", "at most 1000 bytes"),
        ("x: string", {"x": "\ud800"}, "parameter", "UTF-8"),
        ("x: list of string", {"x": ["a", 1]}, "parameter", "item 1: string is needed"),
        ("x: list of int8", {"x": 3}, "parameter", "a list of int8 is needed"),
        ("x: int8", {"x": [3]}, "parameter", "int8 is needed, not a list"),
        ("x: list of int8", {"x": [1] * 501}, "parameter", "at most 500 items"),
        ("x: list of string", {"x": ["a" * 1000] * 30}, "parameter", "together"),
        ("x: float", {"x": 1.0}, "parameter-type", "did you mean"),
        ("x: int32 = 1.5", {}, "parameter", "int32 is needed"),
        ("x: int32 = .a", {}, "parameter", "int32 is needed"),
        ("x: int32\nparameter x: int32", {"x": 1}, "repeated-parameter", ""),
        ("i: int32\nparameter x: float64 = 1.0", {"i": 1}, "shadowed", "a parameter is called `i`"),
    ],
)
def test_values_that_a_parameter_cannot_have(declared, given, code, text):
    rules = f"parameter {declared}\nunpack-rules:\n{REST}  .scaled = x for i from 0 to 0 .angles[i] = 1.0 end\n"
    with pytest.raises(rj.MappingError) as error:
        rj.Decoder("m.mapping", schema=files(rules), encoding="yarp3", backend="interpreter", parameters=given)
    assert code in [problem.code for problem in error.value.diagnostics]
    assert text in str(error.value)


@pytest.mark.parametrize(
    ("rule", "code"),
    [
        (".scaled = names", "not-indexable"),
        (".scaled = [1.0, 2.0]", "not-indexable"),
        (".scaled = 1.0 + numbers", "list-needed"),
        (".scaled = numbers[3]", "index-range"),
        (".scaled = numbers[-1]", "index-range"),
        (".scaled = numbers[.a]", "integer-needed"),
        (".scaled = one[0]", "not-indexable"),
        (".scaled = nothing[0]", "not-indexable"),
        (".scaled = names[.n]", "type-clash"),
        (".scaled = len(one)", "text-needed"),
        ('.scaled = 1.0 .angles = [1.0, "a"]', "type-clash"),
        (".scaled = 1.0 .angles = [1.0", "syntax"),
    ],
)
def test_lists_where_they_cannot_be(rule, code):
    head = 'parameter names: list of string = ["a"]\nparameter numbers: list of float64 = [1.0, 2.0, 3.0]\nparameter one: float64 = 1.0\n'
    rules = head + f"unpack-rules:\n{REST if '.angles' not in rule else REST.replace('  .angles = []', '')}  {rule}\n"
    with pytest.raises(rj.MappingError) as error:
        rj.Decoder("m.mapping", schema=files(rules), encoding="yarp3", backend="interpreter")
    assert code in [problem.code for problem in error.value.diagnostics]


def test_words_are_names_where_they_cannot_be_words():
    rules = "parameter list: float64 = 1.0\nparameter of: list of float64 = [2.0]\nparameter names: int32 = 0\n"
    rules += f"unpack-rules:\n{REST}  .scaled = list + of[names]\n"
    decode = rj.Decoder("m.mapping", schema=files(rules), encoding="yarp3", backend="interpreter")
    assert decode(wire()).scaled == 3.0


@pytest.mark.parametrize("value", [None, {"a": 1}, [[1]], b"x", object()])
def test_what_is_no_value(value):
    with pytest.raises(TypeError, match="parameter 'mode'"):
        rj.Decoder("m.mapping", schema=files(UNPACK), encoding="yarp3", parameters={"mode": value})


def test_types_without_a_mapping_have_no_parameters():
    with pytest.raises(rj.SchemaError, match="no mapping"):
        rj.Decoder.of("w", schema=SCHEMAS, imports=["w.bottle-schema"], encoding="yarp3", backend="interpreter", parameters={"a": 1})


def test_on_the_command_line(tmp_path, capsys):
    for name, content in files(UNPACK).items():
        (tmp_path / name).write_text(content)
    (tmp_path / "message").write_bytes(wire(a=1.0, n=0))
    command = ["decode", str(tmp_path / "m.mapping"), str(tmp_path / "message"), "--encoding", "yarp3", "--json"]
    assert main([*command, "--parameter", 'names=["a"]', "--parameter", "mode=fast", "--parameter", "scale=3.5"]) == 0
    shown = json.loads(capsys.readouterr().out)
    assert (shown["names"], shown["mode"], shown["scaled"]) == (["a"], "fast", 4.5)
    assert main([*command, "--parameter", "mode=fast"]) != 0
    assert "missing-parameter" in capsys.readouterr().err
    with pytest.raises(SystemExit):
        main([*command, "--parameter", 'names={"a": 1}'])


def test_places_that_choose_items_are_bounded():
    """A line of text may name the same long list many times."""
    rules = f"parameter xs: list of float64\nunpack-rules:\n{REST}  .scaled = {' + '.join(['xs[.n]'] * 30)}\n"
    with pytest.raises(rj.MappingError) as error:
        rj.Decoder("m.mapping", schema=files(rules), encoding="yarp3", backend="interpreter", parameters={"xs": [1.0] * 500})
    assert [problem.code for problem in error.value.diagnostics if problem.severity == "error"] == ["many-cases"]


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("prefix", ["", "map/"])
def test_a_prefix_that_may_be_empty(prefix, backend):
    texts = {
        "a.bottle-schema": '"a" (("frame" :string) ("tool" :string))',
        "lab/B.msg": "string frame\nstring tool\n",
        "m.mapping": 'import "a.bottle-schema" import "lab/B.msg" parameter prefix: string = "" data-holder: lab/B wire-schema: a '
        "rules: .frame <-> prefix + .frame .tool <-> .tool + prefix",
    }
    given = {"schema": texts, "encoding": "yarp4", "backend": backend, "parameters": {"prefix": prefix}}
    decode, encode = rj.Decoder("m.mapping", **given), rj.Encoder("m.mapping", **given)
    values = {"frame": f"{prefix}arm", "tool": f"hand{prefix}"}
    assert decode(encode(encode.holder_type.from_dict(values))).to_dict() == values


def test_an_unused_parameter_hides_no_mistake():
    texts = {
        "lab/A.msg": "int64 x\nint64 y\n",
        "m.mapping": 'import "lab/A.msg" parameter p: int64 = 1 data-holder: lab/A wire-schema: lab/A '
        "unpack-rules: same names pack-rules: .x = .x",
    }
    with pytest.raises(rj.MappingError) as error:
        rj.Encoder("m.mapping", schema=texts, encoding="ros1", backend="python")
    assert [each.code for each in error.value.diagnostics if each.severity == "error"] == ["never-set"]


@pytest.mark.parametrize(("inner", "given", "added"), [("= 7", {}, 3), ("", {}, 3), ("= 7", {"p": 9}, 9)])
def test_a_mapping_hands_its_defaults_on(inner, given, added):
    """And what is handed on is not unused."""
    head = 'import "lab/A.msg" import "lab/B.msg" '
    texts = {
        **dict.fromkeys(("lab/In.msg", "lab/Inner.msg"), "int64 x"),
        "lab/A.msg": "In a",
        "lab/B.msg": "Inner a",
        "i.mapping": f"{head} parameter p: int64 {inner} data-holder: lab/Inner wire-schema: lab/In rules: .x <-> .x + p",
        "m.mapping": f'{head} parameter p: int64 = 3 data-holder: lab/B wire-schema: lab/A rules: .a <-> .a via "i.mapping"',
    }
    decode = rj.Decoder("m.mapping", schema=texts, encoding="ros1", backend="python", parameters=given)
    assert decode(bytes(8)).to_dict() == {"a": {"x": added}}
    assert decode.mapping.warnings == ()


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_loop_over_an_empty_list_has_no_rounds(backend):
    """There is no item whose type could be known, and none is needed."""
    rules = """parameter joints: list of string
unpack-rules:
  default .angles
  default .scaled
  default .mode
  default .fast
  len(.names) = len(joints)
  for i from 0 to len(joints)
    .names[i] = joints[i] + "!"
  end
"""
    for joints in ([], ["yaw"]):
        decode = rj.Decoder("m.mapping", schema=files(rules), encoding="yarp3", backend=backend, parameters={"joints": joints})
        assert decode(wire()).to_dict()["names"] == [f"{joint}!" for joint in joints]


def test_an_item_of_an_empty_list_is_refused():
    rules = "parameter offsets: list of float64\nunpack-rules:\n  .scaled = offsets[.n]\n"
    with pytest.raises(rj.MappingError) as error:
        rj.Decoder("m.mapping", schema=files(rules), encoding="yarp3", backend="interpreter", parameters={"offsets": []})
    assert "the list has no items" in str(error.value)


@pytest.mark.parametrize(("kind", "value"), [("float64", 2**53 + 1), ("float32", 2**24 + 1)])
def test_an_integer_that_its_float_lacks_is_refused(kind, value):
    rules = f"parameter scale: {kind}\nunpack-rules:\n  .scaled = scale\n"
    with pytest.raises(rj.MappingError) as error:
        rj.Decoder("m.mapping", schema=files(rules), encoding="yarp3", backend="interpreter", parameters={"scale": value})
    assert f"{value} does not fit {kind}" in str(error.value)


@pytest.mark.parametrize(("relation", "text"), [("prefix + .s", "v1/"), (".s + prefix", "/v1"), ("prefix + .s", "")])
def test_a_text_beside_a_field_is_taken_away_whatever_it_is(tmp_path, relation, text):
    """The mapping is checked, and its laws are known, before the text is."""
    schemas = {
        "w.bottle-schema": '"w" (("s" :string))',
        "h.proto": 'syntax = "proto2"; message H { required string s = 1; }',
        "m.mapping": f"{HEAD}parameter prefix: string\nrules:\n  .s <-> {relation}\n",
    }
    for name, content in schemas.items():
        (tmp_path / name).write_text(content)
    laws = rj.check(tmp_path / "m.mapping").laws
    assert laws is not None
    assert {laws.messages.kind, laws.holders.kind} == {"exact"}
    options = {"schema": schemas, "encoding": "yarp3", "backend": "interpreter", "parameters": {"prefix": text}}
    decode, encode = rj.Decoder("m.mapping", **options), rj.Encoder("m.mapping", **options)
    whole = text + "topic" if relation.startswith("prefix") else "topic" + text
    message = encode(encode.holder_type.from_dict({"s": whole}))
    assert b"topic" in message
    assert (text.encode() in message) == (not text)
    assert decode(message).to_dict() == {"s": whole}
