"""Elements that a key in an array beside tells: in both directions, for keys that are written down and for those of a list."""

from __future__ import annotations

import random

import pytest

import rosetta_jit as rj

BACKENDS = ["llvm", "python", "interpreter"]
SCHEMAS = {
    "lab/msg/Label.msg": "string text\nint32 id\n",
    "lab/msg/Group.msg": "string[] name\nfloat64[] position\nfloat32[] velocity\n",
    "lab/msg/State.msg": "Label[] labels\nuint8[] codes\nfloat64[3] fixed\nGroup arm\nGroup[] legs\n",
    "h.proto": """syntax = "proto3"; package lab;
message Arm { double elbow = 1; double wrist = 2; double speed = 3; }
message Held { double x = 1; int64 n = 2; bool t = 3; repeated double q = 4; }""",
}
HEAD = 'import "lab/msg/State.msg"\nimport "h.proto"\ndata-holder: lab.{}\nwire-schema: lab/msg/{}\n'
EMPTY = {"labels": [], "codes": b"", "fixed": [0, 0, 0], "arm": {"name": [], "position": [], "velocity": []}, "legs": []}
BOTH = """rules:
  .elbow <-> .position[.name[] = "elbow"]
  .wrist <-> .position[.name[] = "wrist"] * 2
  .speed <-> .velocity[.name[] = "elbow"]
pack-rules:
  .velocity[.name[] = "wrist"] = 0
"""
LISTED = """rules:
  len(.q) <-> len(joints)
  for i from 0 to len(joints)
    .q[i] <-> .position[.name[] = joints[i]]
  end
  ignore .velocity
  default .x
  default .n
  default .t
"""


def programs(rules, held, wire, backend, parameters=None, declared=""):
    files = {**SCHEMAS, "m.mapping": HEAD.format(held, wire).replace("data-holder", f"{declared}data-holder") + rules}
    options = {"schema": files, "backend": backend} | ({} if parameters is None else {"parameters": parameters})
    own = {"schema": SCHEMAS, "imports": ["lab/msg/State.msg"], "backend": "interpreter"}
    write, read = rj.Encoder.of(f"lab/msg/{wire}", **own), rj.Decoder.of(f"lab/msg/{wire}", **own)
    decode = rj.Decoder("m.mapping", **options)
    encode = rj.Encoder("m.mapping", **options) if rules.startswith("rules") else None
    return (
        lambda fields: decode(write(write.holder_type.from_dict(fields))).to_dict(),
        lambda fields: None if encode is None else read(encode(encode.holder_type.from_dict(fields))).to_dict(),
    )


def refused(kind, words, run, fields):
    with pytest.raises(rj.MessageError) as error:
        run(fields)
    assert error.value.kind == kind
    assert words in str(error.value)


@pytest.mark.parametrize("backend", BACKENDS)
def test_both_ways(backend):
    """Keys are written in the order of the text, and all arrays are as long."""
    unpack, pack = programs(BOTH, "Arm", "Group", backend)
    found = unpack({"name": ["x", "wrist", "elbow"], "position": [1, 2, 3.5], "velocity": [4, 5, 6]})
    assert found == {"elbow": 3.5, "wrist": 4.0, "speed": 6.0}
    assert pack(found) == {"name": ["elbow", "wrist"], "position": [3.5, 2.0], "velocity": [6.0, 0.0]}
    assert unpack(pack(found)) == found
    refused("index", '`.name` has no element that is "wrist"', unpack, {"name": ["elbow"], "position": [1], "velocity": [1]})
    twice = {"name": ["elbow", "wrist", "elbow"], "position": [1, 2, 3], "velocity": [1, 2, 3]}
    refused("index", '`.name` has more than one element that is "elbow"', unpack, twice)
    refused("index", "no such element", unpack, {"name": ["elbow", "wrist"], "position": [1], "velocity": [1, 2]})


def test_what_is_written_by_keys_is_found_again():
    files = {**SCHEMAS, "m.mapping": HEAD.format("Arm", "Group") + BOTH}
    laws = rj.check("m.mapping", schema=files).laws
    assert [loss.place for loss in laws.holders.losses] == []
    by_key = [loss.place for loss in laws.messages.losses if loss.why == "it becomes that of the element which a key tells"]
    assert by_key == [".position[0]", ".position[1]", ".velocity[0]"]


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_list_of_keys(backend):
    rng = random.Random(5)
    names = [f"joint{number}" for number in range(12)]
    joints = rng.sample(names, 7)
    unpack, pack = programs(LISTED, "Held", "Group", backend, {"joints": joints}, "parameter joints: list of string\n")
    for _ in range(4):
        rng.shuffle(names)
        values = {name: rng.random() for name in names}
        found = unpack({"name": names, "position": list(values.values()), "velocity": []})
        assert found["q"] == [values[name] for name in joints]
        assert pack(found) == {"name": joints, "position": found["q"], "velocity": []}


def test_a_list_has_no_key_twice():
    with pytest.raises(rj.MappingError, match='the list has "a" twice'):
        programs(LISTED, "Held", "Group", "interpreter", {"joints": ["a", "b", "a"]}, "parameter joints: list of string\n")


def test_a_list_that_is_not_given_is_checked(tmp_path):
    files = {**SCHEMAS, "m.mapping": "parameter joints: list of string\n" + HEAD.format("Held", "Group") + LISTED}
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    laws = rj.check(tmp_path / "m.mapping", search_path=[tmp_path]).laws
    assert [loss.place for loss in laws.holders.losses] == [".x", ".n", ".t"], "a list that is given has no key twice"


RULES = """unpack-rules:
  .x = {}
  .n = {}
  .t = {}
  len(.q) = 0
  ignore .arm
"""


def held(backend, x="0", n="0", t="false"):
    return programs(RULES.format(x, n, t), "Held", "State", backend)[0]


@pytest.mark.parametrize("backend", BACKENDS)
def test_keys_in_messages_and_numbers(backend):
    labels = [{"text": "b", "id": 7}, {"text": "a", "id": 9}]
    state = {**EMPTY, "labels": labels, "codes": bytes([5, 6]), "fixed": [1.5, 2.5, 3.5]}
    run = held(backend, '.fixed[.labels[].text = "a"]', "int64(.labels[.codes[] = 5].id)", "has(.codes[.labels[].id = 9])")
    assert run(state) == {"x": 2.5, "n": 7, "t": True, "q": []}
    run = held(backend, "0", "index(.codes[.labels[].id = 9])", 'has(.fixed[.labels[].text = "c"])')
    assert run(state) == {"x": 0.0, "n": 1, "t": False, "q": []}


@pytest.mark.parametrize("backend", BACKENDS)
def test_has_asks_for_the_element_too(backend):
    run = held(backend, "0", "0", 'has(.arm.velocity[.arm.name[] = "b"])'.replace(".arm.name", ".name"))
    for velocity, there in (([], False), ([1], False), ([1, 2], True)):
        assert run({**EMPTY, "arm": {"name": ["a", "b"], "position": [], "velocity": velocity}})["t"] is there


@pytest.mark.parametrize("backend", BACKENDS)
def test_within_an_array_of_messages(backend):
    rules = """unpack-rules:
  len(.q) = len(.legs)
  for i from 0 to len(.legs) .q[i] = .legs[i].position[.name[] = "hip"] end
  .x = 0
  .n = 0
  .t = false
"""
    run = programs(rules, "Held", "State", backend)[0]
    legs = [{"name": ["knee", "hip"], "position": [1, 2], "velocity": []}, {"name": ["hip"], "position": [3], "velocity": []}]
    assert run({**EMPTY, "legs": legs})["q"] == [2, 3]
