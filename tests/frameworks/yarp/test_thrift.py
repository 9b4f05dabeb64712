"""What YARP's Thrift declares: the messages of the real YARP, what is refused and where, and texts that mean harm."""

from __future__ import annotations

import json
import struct
from contextlib import suppress
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rosetta_jit as rj
from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.yarp.thrift.front_end import parse
from rosetta_jit.model.types import Array, Float, Int
from rosetta_jit.source import Source
from tests.golden import GOLDEN, check_golden

VECTORS = Path(__file__).resolve().parents[2] / "vectors" / "yarp"
SERVICE = (VECTORS / "service.thrift").read_text()
TYPES = {
    "struct_All": "All",
    "struct_Inner": "Inner",
    "req_set_pos": "Svc.set_pos.request",
    "req_set_pos_str": "Svc.set_pos.call",
    "rep_set_pos": "Svc.set_pos.reply",
    "rep_set_pos_str": "Svc.set_pos.reply",
    "req_get_encs": "Svc.get_encs.call",
    "rep_get_encs": "Svc.get_encs.reply",
    "req_hello": "Svc.hello.request",
    "rep_hello": "Svc.hello.reply",
}
ALL = {"k": 4 - 1, "s": "six", "m": "RUN", "st": [7, 8], "inn": {"a": 10, "b": 10.5}, "lld": [[1.0], [2.0, 3.0]], "mp": {"k": 9.0}}
WRONG = sorted((GOLDEN / "thrift").glob("*.thrift"))


def messages(dialect):
    found = {entry["name"]: bytes.fromhex(entry["hex"]) for entry in json.loads((VECTORS / f"thrift-{dialect}.json").read_text())}
    return {name: found[name] for name in TYPES if name in found}


@pytest.mark.parametrize("backend", ["llvm", "python", "interpreter"])
@pytest.mark.parametrize("dialect", ["yarp3", "yarp4"])
def test_what_the_real_yarp_writes(dialect, backend):
    for name, data in messages(dialect).items():
        options = {"schema": {"service.thrift": SERVICE}, "encoding": dialect, "backend": backend}
        decode, encode = rj.Decoder.of(TYPES[name], **options), rj.Encoder.of(TYPES[name], **options)
        assert encode(decode(data)) == data, name


@pytest.mark.parametrize("dialect", ["yarp3", "yarp4"])
def test_values(dialect):
    decode = rj.Decoder.of("All", schema={"service.thrift": SERVICE}, encoding=dialect, backend="interpreter")
    found = decode(messages(dialect)["struct_All"]).to_dict()
    assert {name: found[name] for name in ALL} == ALL
    assert (found["f"], found["i"], found["d"], found["lb"]) == (True, -1, 5.5, [True, False])


TREE = "struct S { 1: i32 a; 2: list<S> kids; 3: string name }"


@pytest.mark.parametrize("backend", ["llvm", "python", "interpreter"])
@pytest.mark.parametrize("dialect", ["yarp3", "yarp4"])
def test_lists_of_the_struct_itself(dialect, backend):
    options = {"schema": {"a.thrift": TREE}, "encoding": dialect, "backend": backend}
    decode, encode = rj.Decoder.of("S", **options), rj.Encoder.of("S", **options)
    leaf = {"a": 3, "kids": [], "name": "z"}
    data = struct.pack("<4i", 256, 3, 1, 1) + struct.pack("<2i", 256, 2)
    inner = struct.pack("<4i", 256, 3, 1, 3) + struct.pack("<2i", 256, 0) + struct.pack("<ii1s", 4, 1, b"z")
    data += inner * 2 + struct.pack("<ii1s", 4, 1, b"r")
    assert decode(data).to_dict() == {"a": 1, "kids": [leaf, leaf], "name": "r"}
    assert encode(decode(data)) == data
    assert rj.Decoder.of("S", schema={"a.thrift": TREE}, backend="python")(data).to_dict()["name"] == "r"


@pytest.mark.parametrize(
    "text",
    [
        "struct S { 1: map<string, S> x }",
        "struct S { 1: list<list<S>> x }",
        "struct S { 1: T t } struct T { 1: list<S> x }",
        "struct T { 1: S s } struct S { 1: list<S> x }",
    ],
)
def test_other_recursion_has_no_encoding(text):
    with pytest.raises(SchemaError, match="only-in-lists"):
        rj.Decoder.of(text.split()[1], schema={"a.thrift": text}, encoding="yarp4")


def test_a_service_has_the_functions_of_what_it_extends():
    files = {"base.thrift": "namespace yarp lab\nservice Base { i32 ask(1: i32 q); void stop_it() }"}
    found = read('include "base.thrift"\nservice Middle extends base.Base {}\nservice Arm extends Middle { double ask() }', files)
    names = {name for name in found.types if name.startswith("Arm.")}
    assert names == {f"Arm.{each}" for each in ("ask.request", "ask.reply", "stop_it.request", "stop_it.call", "stop_it.reply")}
    assert found.types["Arm.ask.reply"].fields[0].type == Float(64, "float64")  # its own
    assert found.types["Middle.ask.reply"].fields[0].type == Int(32, spelling="int32")


def read(text, files=None):
    texts = {name: Source(name, each) for name, each in (files or {}).items()}
    return parse(Source("a.thrift", text), texts.get)


def test_names_defaults_and_constants():
    found = read("namespace yarp lab.arm\nconst i32 LIMIT = 0x10\nstruct S { 1: i32 a = 7; 2: optional list<double> b }")
    assert found.constants["lab.arm.LIMIT"].value == 16
    first, second = found.types["lab.arm.S"].fields
    assert (first.default, first.type, second.type) == (7, Int(32, spelling="int32"), Array(Float(64, "float64")))


def test_includes_and_native_types():
    files = {"vector.thrift": 'struct Vector { 1: list<double> content } (yarp.name = "yarp::sig::Vector" yarp.includefile = "x")'}
    found = read('include "vector.thrift"\nstruct S { 1: vector.Vector v }', files)
    assert found.types["S"].fields[0].type == Array(Float(64, "float64"))


@pytest.mark.parametrize("path", WRONG, ids=lambda path: path.stem)
def test_report(path):
    with pytest.raises(SchemaError) as caught:
        parse(Source(path.name, path.read_text()), lambda _: None)
    check_golden(path.with_suffix(".err"), f"{caught.value}\n")


@given(st.text(alphabet="structlienumap<>{}()[]:;,=\"'*/# \n0x1.e+", max_size=80))
@settings(max_examples=300, deadline=None)
def test_any_text_is_read_or_refused(text):
    with suppress(SchemaError):
        read(text)


@pytest.mark.parametrize(
    "text",
    [
        "list<" * 5000,
        "struct S { 1: " + "list<" * 3000 + "i32" + ">" * 3000 + " x }",
        "const list<i32> X = " + "[" * 5000,
        "const i32 X = " + "9" * 5000,
        "typedef a b typedef b a struct S { 1: a x }",
        "struct S { 1: list<S> x } struct T { 1: T x }",
        "/*" * 10000,
        "service A { " + " ".join(f"void f{i}()" for i in range(9000)) + " } service B extends A {}",
        " ".join(f"service S{i} extends S{i + 1} {{}}" for i in range(5000)),
    ],
)
def test_hostile_texts(text):
    with pytest.raises(SchemaError):
        read(text)
