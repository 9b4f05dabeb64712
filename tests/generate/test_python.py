"""Generated Python does what the library does, without it."""

from __future__ import annotations

import ast
import re
import struct
import subprocess
import sys
from itertools import permutations
from pathlib import Path
from typing import get_type_hints

import numpy as np
import pytest

import rosetta_jit as rj
from rosetta_jit.api.options import request_of, type_request
from rosetta_jit.errors import MappingError, SchemaError
from rosetta_jit.generate.build import Wishes, generated
from tests.generate.corpora import corpora, numbers_in_texts
from tests.generate.driver import harmed
from tests.generate.python import BOTH, answer, answers_as_the_library, module, same, source_of
from tests.generate.test_c import CALLING, HOSTILE, SUBJECTS, TORSO
from tests.generate.test_cpp import OUTER
from tests.golden import GOLDEN, check_golden

MAPPINGS = Path(__file__).resolve().parents[2] / "mappings"
FEW = {"lcm exlcm.example_t", "corba RTC::TimedWChar little", "protobuf rj.OneOf", "protobuf rj.Maps", "protobuf rj.Tree"}
SIGNALLING = [bytes.fromhex(each) for each in ("0100807f", "ffffbfff", "0000a07f", "01008cff")]
QUIET = [bytes.fromhex(each) for each in ("0100c07f", "5634d27f")]
FLOATS = """syntax = "proto3"; package f; message Floats { float one = 1; repeated float many = 2; }"""


@pytest.mark.parametrize("arrays", ["", "numpy"])
def test_bits_of_nans(arrays):
    """Quiet ones keep all bits; signalling ones of 32 bits are quiet in a float of Python, and as they came in an array of numpy."""
    request = type_request("decode", "f.Floats", {"encoding": "protobuf", "schema": {"f.proto": FLOATS}})
    unit = module(request, BOTH, Wishes(numpy=bool(arrays)))
    for bits in [*SIGNALLING, *QUIET]:
        quiet = bits[:2] + bytes([bits[2] | 0x40]) + bits[3:]
        many = bits if arrays else quiet
        assert unit.encode(unit.decode(b"\x0d" + bits + b"\x12\x04" + bits)) == b"\x0d" + quiet + b"\x12\x04" + many
        wide = type_request("decode", "std_msgs/Float64", {"encoding": "ros1"})
        eight = b"\1\0\0\0" + bits[:2] + bytes([bits[2] & 0xF7 | 0xF0]) + bits[3:]
        other = module(wide)
        assert other.encode(other.decode(eight)) == eight


def test_no_other_bits_may_differ():
    assert same("ok 0100c07f", "ok 0100807f")
    assert same("ok 7fc00001", "ok 7f800001")
    assert not same("ok 0100807f", "ok 0100c07f")
    assert not same("ok 0000c07f", "ok 0000807f")  # an infinity
    assert not same("ok 41", "ok 01")
    assert not same("ok 0000c041", "ok 00008041")


@pytest.mark.parametrize("name", SUBJECTS)
def test_python_answers_as_the_library_does(name):
    request, good = SUBJECTS[name]
    of = (rj.Decoder, rj.Encoder) if request.mapping else (rj.Decoder.of, rj.Encoder.of)
    programs = [make(request.mapping or request.type, encoding=request.encoding) for make in of]
    answers_as_the_library(module(request), programs, harmed(good, 12, name))


@pytest.mark.parametrize("corpus", [each for each in corpora() if each.name in FEW], ids=lambda each: each.name)
def test_messages_of_peers(corpus):
    answers_as_the_library(module(corpus.request), corpus.programs(), harmed(list(corpus.messages[:4]), 4, corpus.name))


@pytest.mark.parametrize(
    ("type_", "good"), [("geometry_msgs/Twist", struct.pack("<6d", *range(6))), ("std_msgs/Bool", b"\1"), ("std_msgs/Time", b"\2" * 8)]
)
def test_messages_that_are_numbers_alone(type_, good):
    """They are packed at once, if that can be."""
    unit = module(type_request("decode", type_, {"encoding": "ros1"}))
    programs = rj.Decoder.of(type_, encoding="ros1"), rj.Encoder.of(type_, encoding="ros1")
    answers_as_the_library(unit, programs, harmed([good], 8, type_))
    if type_ == "geometry_msgs/Twist":
        with pytest.raises(unit.EncodeError, match="range"):
            unit.encode(unit.Twist(linear=unit.Vector3(x="1")))


NESTED = """syntax = "proto3"; package n;
message Point { double x = 1; float y = 2; repeated sint32 z = 3; }
message All {
  Point point = 1; repeated Point points = 2; map<string, Point> places = 3; map<int32, string> names = 4;
  optional double half = 7; optional string note = 8;
  oneof choice { int64 number = 5; Point place = 6; string text = 9; bytes raw = 10; }
}
"""


def test_messages_within_others_are_written_from_the_objects():
    """Behind their lengths, whatever is there of them: fields with their default, -0.0, cases with the value 0, nothing at all."""
    given = {"encoding": "protobuf", "schema": {"n.proto": NESTED}}
    request = type_request("decode", "n.All", given)
    assert "_encode_" not in source_of(request, ("encode",))
    unit, encode, decode = module(request), rj.Encoder.of("n.All", **given), rj.Decoder.of("n.All", **given)
    point, wide = unit.Point(x=-0.0, y=1.5, z=[-1, 300]), unit.Point(x=float("nan"), z=[*range(200)])
    assert unit.encode(unit.All()) == b""
    present = {"point": {}, "half": 0.0, "note": ""}
    assert unit.encode(unit.All(point=unit.Point(), half=0.0, note="")) == encode(encode.holder_type.from_dict(present))
    for made in (
        unit.All(point=point, choice=("number", 0)),
        unit.All(points=[point, wide, unit.Point()], choice=("place", wide)),
        unit.All(places={"a": point, "": wide}, names={-1: "x", 7: ""}, choice=("text", "")),
        unit.All(choice=("raw", b"\0" * 20000), half=1.5, note="é" * 100),
    ):
        message = unit.encode(made)
        assert encode(decode(message)) == message
        assert repr(unit.decode(message)) == repr(made)
    wrong = [unit.All(point=unit.Point(x="1")), unit.All(points=[None]), unit.All(names={2**40: ""}), unit.All(choice=("number", "x"))]
    for made in wrong:
        with pytest.raises(unit.EncodeError):
            unit.encode(made)


def test_wide_texts_are_written_in_code_units():
    """Those of ROS 2, which its bytes have as UTF-16; bounded ones, and behind other fields, too."""
    given = {"encoding": "cdr", "schema": "uint8 before\nwstring wide\nfloat64 after\nwstring<=9 bounded\nwstring[] many\n"}
    request = type_request("decode", "w/msg/Wide", given)
    unit, encode = module(request), rj.Encoder.of("w/msg/Wide", **given)
    values = {"before": 1, "wide": "aé€😀", "after": 0.5, "bounded": "x", "many": ["", "ab"]}
    message = encode(encode.holder_type.from_dict(values))
    assert unit.encode(unit.Wide(**values)) == message
    answers_as_the_library(unit, (rj.Decoder.of("w/msg/Wide", **given), encode), harmed([bytes(message)], 12, "wide"))


def test_decimal_numbers():
    request, programs, messages = numbers_in_texts()
    answers_as_the_library(module(request), programs, harmed(messages, 12, "numbers"))


@pytest.mark.campaign
@pytest.mark.parametrize("corpus", corpora(), ids=lambda each: each.name)
def test_all_messages_of_peers(corpus):
    answers_as_the_library(module(corpus.request), corpus.programs(), harmed(list(corpus.messages), 4, corpus.name))


def test_the_text_is_the_same_every_time():
    check_golden(GOLDEN / "generate" / "torso_state.py.txt", generated(TORSO, "python", BOTH, "torso_state")["torso_state.py"])


def test_arrays_and_texts_are_read_and_written_without_rows():
    """Lists are made and taken where the message has them: golden for a message with all kinds of them."""
    request = type_request("decode", "sensor_msgs/JointState", {"encoding": "ros1"})
    check_golden(GOLDEN / "generate" / "joint_state.py.txt", generated(request, "python", BOTH, "joint_state")["joint_state.py"])


def test_a_module_needs_the_standard_library_alone(tmp_path):
    (tmp_path / "torso.py").write_text(generated(TORSO, "python", BOTH, "torso")["torso.py"])
    message = struct.pack("<ii3d", 266, 3, 90.0, 0.0, -90.0)
    said = f"import torso; print(torso.decode({message!r}).angles); print(torso.encode(torso.JointAngles([0.0] * 3)).hex())"
    said = f"import sys; sys.path.insert(0, {str(tmp_path)!r}); {said}"
    done = subprocess.run(
        [sys.executable, "-I", "-S", "-c", f"import sys; sys.path.insert(0, {str(tmp_path)!r}); {said}"],
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.splitlines() == ["[1.5707963705062866, 0.0, -1.5707963705062866]", struct.pack("<ii3d", 266, 3, 0.0, 0.0, 0.0).hex()]


def test_a_hostile_schema_stays_in_its_place():
    unit = module(type_request("decode", "evil/Outer", {"encoding": "ros1", "schema": HOSTILE + OUTER}))
    rows = (
        struct.pack("<If", 1, 2.5)
        + struct.pack("<I", 2)
        + b"ab"
        + bytes([7])
        + struct.pack("<2q", -1, 1)
        + struct.pack("<I", 1)
        + b"x"
        + bytes(12)
    )
    message = struct.pack("<id", 5, 0.5) + struct.pack("<I", 3) + b'*/"' + bytes([1, 0, 1, 1]) + struct.pack("<I", 2) + b"\0\1" + rows
    assert answer(unit, message) == f"ok {message.hex()}"


@pytest.mark.parametrize(
    "name", ["data", "end", "most", "sites", "indices", "self", "parts", "target", "np", "Struct", "field", "call_end"]
)
def test_types_are_called_as_the_module_calls_its_own(name):
    """A class of that name would be hidden by a parameter or a variable, or hide what the module needs."""
    schema = f"{name} one\n{name}[] more\n===\nMSG: evil/{name}\nint16 x\nstring y\n"
    unit = module(type_request("decode", "evil/Outer", {"encoding": "ros1", "schema": schema}))
    element = struct.pack("<hI2s", 7, 2, b"ab")
    message = element + struct.pack("<I", 2) + element + element
    assert answer(unit, message) == f"ok {message.hex()}"


NAMED_AS_TYPES = """syntax = "proto3"; package t;
message M {
  repeated int32 list = 1; repeated int32 other = 2; map<string, int32> dict = 3; map<string, float> more = 4; bytes bytes = 5;
  int32 int = 6; double float = 7; string str = 8; M M = 9; repeated M us = 10; int32 np = 11; repeated double doubles = 12;
  bool bool = 13; bool flag = 14; optional string Any = 15; int32 range = 16; int32 npt = 17; int32 _builtins = 18; repeated M tuple = 19;
}
"""


@pytest.mark.parametrize("arrays", ["", "numpy"])
def test_fields_are_called_as_the_types_of_others(arrays):
    """The body of a class finds its own fields before the names of Python's types."""
    given = {"encoding": "protobuf", "schema": {"t.proto": NAMED_AS_TYPES}}
    unit = module(type_request("decode", "t.M", given), wishes=Wishes(numpy=bool(arrays)))
    encode = rj.Encoder.of("t.M", **given)
    inner = {"int": 5, "float": 1.5, "str": "s", "bool": True, "bytes": b"b"}
    names = {"list": [1, 2], "other": [3], "dict": {"a": 1}, "more": {"b": 0.5}, "M": inner, "us": [inner], "doubles": [0.25]}
    message = bytes(encode(encode.holder_type.from_dict({**inner, **names, "np": 1, "Any": "any", "range": 2, "npt": 3, "tuple": [inner]})))
    assert answer(unit, message) == f"ok {message.hex()}"
    said = get_type_hints(unit.M)
    assert (said["int"], said["flag"], said["unknown_fields"]) == (int, bool, bytes)
    assert unit.M() == unit.M()


def test_loops_that_do_nothing_are_not_printed():
    """Of points that may lack a coordinate each is checked where it is written, and a loop that did so before has nothing left."""
    unit = module(request_of("decode", {}, mapping="ros1/grid_cells.mapping"))
    programs = rj.Decoder("ros1/grid_cells.mapping"), rj.Encoder("ros1/grid_cells.mapping")
    head = struct.pack("<4I2f", 7, 1, 2, 0, 0.5, 0.5)
    messages = [head + struct.pack("<I", count) + struct.pack(f"<{3 * count}d", *range(3 * count)) for count in (0, 1, 5)]
    answers_as_the_library(unit, programs, harmed(messages, 12, "cells"))
    point = type(unit.decode(messages[1]).points[0])
    with pytest.raises(unit.EncodeError, match="required"):
        unit.encode(unit.PointCloud3DFloat(points=[point(x=1.0, y=2.0)]))


@pytest.mark.campaign
@pytest.mark.parametrize("directions", [BOTH, ("decode",), ("encode",)])
def test_every_shipped_mapping_is_a_module(directions):
    """In both directions, or in the one that there is."""
    written = 0
    for path in sorted(MAPPINGS.rglob("*.mapping")):
        name = str(path.relative_to(MAPPINGS))
        try:
            request = request_of("decode", {"encoding": "yarp3"} if name.startswith("yarp/") else {}, mapping=name)
            text = source_of(request, directions)
        except (MappingError, SchemaError) as error:
            if not re.search("wire-unsaid|not-generated|no-rules", str(error)):
                raise
            continue
        compile(text, name, "exec")
        written += 1
    assert written > 60


def test_docs_of_a_schema_are_docs():
    """What ends a string, or begins a line, in a schema does neither in the module."""
    schema = 'int32 x # """ + exit() #\\\nint32 y # \\"""\nstring s="""x\n'
    text = source_of(type_request("decode", "a/B", {"encoding": "ros1", "schema": schema}))
    calls = {node.func.id for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)}
    assert "exit" not in calls


def test_functions_of_the_mapping_are_the_programs_own(tmp_path):
    (tmp_path / "calling.mapping").write_text(CALLING)
    unit = module(request_of("decode", {"encoding": "yarp3"}, mapping=str(tmp_path / "calling.mapping")), ("decode",))

    def halved(number):
        if number < 0:
            raise unit.Refused
        return number / 2

    unit.functions["halved"] = halved
    assert unit.decode(struct.pack("<ii3d", 266, 3, 90.0, 0.0, 0.0)).angles == pytest.approx([0.785398], rel=1e-6)
    with pytest.raises(unit.DecodeError, match="rejected"):
        unit.decode(struct.pack("<ii3d", 266, 3, -90.0, 0.0, 0.0))


def test_objects_that_cannot_be_written():
    unit = module(SUBJECTS["joints"][0])
    with pytest.raises(unit.EncodeError, match="range"):
        unit.encode(unit.JointState(name=[1]))
    with pytest.raises(unit.EncodeError, match="range"):
        unit.encode(unit.JointState(header=unit.Header(seq=-1)))


SCALARS = ("float", "double", "int32", "sint64", "uint32", "fixed64", "sfixed32", "bool")


@pytest.mark.parametrize("wishes", [Wishes(), Wishes(numpy=True)], ids=["", "numpy"])
def test_cases_of_one_union_that_are_numbers_of_several_types(wishes):
    pairs = list(permutations(SCALARS, 2))
    unions = " ".join(f"oneof u{i} {{ {a} a{i} = {2 * i + 1}; {b} b{i} = {2 * i + 2}; }}" for i, (a, b) in enumerate(pairs))
    schema = {"u.proto": f'syntax = "proto3"; package p; message U {{ {unions} }}'}
    options = {"schema": schema, "imports": ["u.proto"], "encoding": "protobuf"}
    made, encode = module(type_request("encode", "p.U", options), ("decode", "encode"), wishes), rj.Encoder.of("p.U", **options)
    for way in "ab":
        values = {f"{way}{i}": _value_of(pair["ab".index(way)]) for i, pair in enumerate(pairs)}
        message = bytes(encode(encode.holder_type(**values)))
        own = made.U(**{f"u{i}": (name, value) for i, (name, value) in enumerate(values.items())})
        assert (bytes(made.encode(own)), made.decode(message)) == (message, own)


def _value_of(scalar):
    return {"bool": True, "float": -1.5, "double": 2.25}.get(scalar, 7)


@pytest.mark.parametrize("type_", ["rj.Scalars", "rj3.All"])
@pytest.mark.parametrize("value", [2**40, -(2**40), 1.0, "1"])
def test_integers_that_their_fields_cannot_hold(type_, value):
    """Also where they are written in as many bytes as they need."""
    (corpus,) = [each for each in corpora() if each.name == f"protobuf {type_}"]
    unit = module(corpus.request, ("encode",))
    made = getattr(unit, type_.partition(".")[2])
    for name in ("i32", "u32", "s32", "fx32", "sf32", "e"):
        with pytest.raises(unit.EncodeError, match="range"):
            unit.encode(made(**{name: value}))


def test_what_the_host_tells():
    """Messages are counted by the module, decoded and encoded ones together."""
    schema = {
        "a.bottle-schema": '"a" (("value" :int))',
        "b.proto": 'syntax = "proto3"; package b; message Number { int32 value = 1; int64 now = 2; }',
        "m.mapping": 'import "a.bottle-schema"\nimport "b.proto"\ndata-holder: b.Number\nwire-schema: a\nunpack-rules:\n'
        "  .value = int32(counter() + .value)\n  .now = now()\n",
    }
    unit = module(request_of("decode", {"schema": schema, "encoding": "yarp3"}, mapping="m.mapping"), ("decode",))
    unit.now = lambda: 17
    message = struct.pack("<iii", 257, 1, 40)
    assert [(found.value, found.now) for found in map(unit.decode, [message] * 3)] == [(40, 17), (41, 17), (42, 17)]


# --- arrays of numpy's -------------------------------------------------------------------------------------------------------------

NUMPY = Wishes(numpy=True)
ARRAYS = {"lcm exlcm.example_t", "ros2 test_interface_files/UnboundedSequences big"}


@pytest.mark.parametrize("name", SUBJECTS)
def test_with_arrays_of_numpy_it_answers_as_the_library_does(name):
    request, good = SUBJECTS[name]
    of = (rj.Decoder, rj.Encoder) if request.mapping else (rj.Decoder.of, rj.Encoder.of)
    programs = [make(request.mapping or request.type, encoding=request.encoding) for make in of]
    answers_as_the_library(module(request, wishes=NUMPY), programs, harmed(good, 4, name))


@pytest.mark.parametrize("corpus", [each for each in corpora() if each.name in ARRAYS], ids=lambda each: each.name)
def test_messages_of_peers_as_arrays_of_numpy(corpus):
    answers_as_the_library(module(corpus.request, wishes=NUMPY), corpus.programs(), harmed(list(corpus.messages[:2]), 2, corpus.name))


@pytest.mark.campaign
@pytest.mark.parametrize("corpus", corpora(), ids=lambda each: each.name)
def test_all_messages_of_peers_as_arrays_of_numpy(corpus):
    answers_as_the_library(module(corpus.request, wishes=NUMPY), corpus.programs(), harmed(list(corpus.messages), 4, corpus.name))


def test_arrays_of_numpy_have_the_types_of_their_fields():
    unit = module(SUBJECTS["joints"][0], wishes=NUMPY)
    sent = unit.JointState(name=["a", "b"], position=np.array([1.5, -2.0]), velocity=[3, 4], effort=np.array([5, 6], ">i2"))
    message = bytearray(unit.encode(sent))
    found = unit.decode(message)
    for name, values in (("position", [1.5, -2.0]), ("velocity", [3, 4]), ("effort", [5, 6])):
        array = getattr(found, name)
        assert (array.dtype, array.tolist()) == (np.float64, values)
        assert array.flags.writeable
        assert array.dtype.isnative
    message[:] = bytes(len(message))
    assert found.position.tolist() == [1.5, -2.0], "a copy, which the message has no part in"
    assert found == unit.JointState(name=["a", "b"], position=[1.5, -2.0], velocity=np.array([3.0, 4.0]), effort=np.array([5.0, 6.0]))
    assert found != unit.JointState(name=["a", "b"], position=np.zeros(2))
    assert unit.JointState() == unit.JointState()
    with pytest.raises(TypeError, match="unhashable"):
        hash(found)


def test_arrays_of_numpy_can_be_views():
    unit = module(SUBJECTS["joints"][0], wishes=NUMPY)
    found = unit.decode(unit.encode(unit.JointState(position=np.arange(3.0))), copy=False)
    assert found.position.tolist() == [0.0, 1.0, 2.0]
    assert not found.position.flags.owndata
    assert not found.position.flags.writeable
    swapped = module(type_request("decode", "exlcm.example_t", {"encoding": "lcm"}), wishes=NUMPY)
    ranges = swapped.decode(swapped.encode(swapped.example_t(num_ranges=2, ranges=[1, -2])), copy=False).ranges
    assert (ranges.dtype, ranges.dtype.isnative, ranges.tolist()) == (np.int16, True, [1, -2])


@pytest.mark.parametrize(
    "ranges",
    [[1.0, 2.0], [1, 40000], np.array([[1, 2]]), ["1", "2"], np.array([1, 2**40]), [None, 1]],
    ids=["float", "range", "2d", "text", "wide", "none"],
)
def test_arrays_that_are_not_the_fields_are_refused(ranges):
    unit = module(type_request("decode", "exlcm.example_t", {"encoding": "lcm"}), wishes=NUMPY)
    with pytest.raises(unit.EncodeError):
        unit.encode(unit.example_t(num_ranges=2, ranges=ranges))


def test_other_languages_have_no_arrays_of_numpy():
    with pytest.raises(SchemaError, match="no-numpy"):
        generated(TORSO, "c", BOTH, "torso", NUMPY)


def test_arrays_of_the_fields_type_are_written_as_they_lie():
    """Every other element, elements turned around, none; and not those of two dimensions."""
    unit = module(type_request("decode", "exlcm.example_t", {"encoding": "lcm"}), wishes=NUMPY)
    wanted = unit.encode(unit.example_t(num_ranges=3, ranges=[1, -2, 300]))
    made = np.array([1, 0, -2, 0, 300], np.int16)
    for ranges in (made[::2], made[::2].astype(">i2"), np.array([1, -2, 300], np.int16), np.array([1, -2, 300], np.int64)):
        assert unit.encode(unit.example_t(num_ranges=3, ranges=ranges)) == wanted
    with pytest.raises(unit.EncodeError):
        unit.encode(unit.example_t(num_ranges=1, ranges=np.zeros((1, 2), np.int16)))
