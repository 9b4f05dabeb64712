"""Stubs: a type checker accepts them, and knows what a decoder gives; no name of a schema is more than a name there."""

from __future__ import annotations

import ast
import json
import subprocess
import sys

import pytest

from rosetta_jit.cli import main
from rosetta_jit.model.types import Array, Enum, Field, Float, Int, Ref, Schema, Struct
from rosetta_jit.runtime.holder import holder_class
from rosetta_jit.stubs.classes import MODULES
from rosetta_jit.stubs.module import stub

SCHEMA = """
syntax = "proto3"; package t;
enum Color { RED = 0; BLUE = 7; }
message Node { int32 v = 1; Node left = 2; repeated Node kids = 3; }
message Inner { double a = 1; string s = 2; }
message M {
  optional int32 n = 1; bytes raw = 2; repeated string names = 3; repeated Inner inners = 4;
  oneof pick { double number = 5; Inner inner = 6; }
  Color color = 7; map<int32, Inner> table = 8; Node tree = 9; repeated bool flags = 10;
  int32 int = 11; float float = 12; Inner Inner = 13; string to_dict = 14; string class = 15; string typing = 16; bool property = 17;
}
"""
USE = """
from typing import assert_type
import numpy as np
import imu, robot, status
from robot import decoder, encoder
m = decoder(b"")
assert_type(m.inners[0].a, float)
assert_type([each.a for each in m.inners], list[float])
assert_type(m.tree.kids[0].left.v, int)
assert_type(m.names[0], str)
assert_type(m.table[3].s, str)
assert_type(m.inners.add().s, str)
assert_type(m.float, float)
assert_type(m.Inner, robot.Inner)
assert_type(m.property, bool)
assert_type(robot.Inner(a=3).a, float)
assert_type(m.SerializeToString(), bytes)
assert_type(encoder(m), bytes)
assert_type(encoder(m, bytearray(9)), int)
m.raw = bytearray(b"x")
i = imu.decoder(b"")
assert_type(i.header.stamp.to_sec(), float)
assert_type(i.orientation_covariance.dtype, np.dtype[np.float64])
i.orientation_covariance = [0.5] * 9
assert_type(status.DiagnosticStatus(values=[]).values[0].key, str)
"""
WRONG = ["m.n = 'x'", "m.nothing", "m.inners[0].a.real_part", "m.inner = m.inner", "decoder(3)", "encoder(i)"]


@pytest.fixture
def written(tmp_path, monkeypatch):
    """Runs the command; gives the text of the file that it writes."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("ROSETTA_JIT_PATH", str(tmp_path))

    def write(file, *arguments):
        assert main(["stubs", *arguments, "-o", str(tmp_path / file)]) == 0
        return (tmp_path / file).read_text()

    return write


def test_a_type_checker_knows_what_a_decoder_gives(tmp_path, written):
    (tmp_path / "t.proto").write_text(SCHEMA)
    written("robot.pyi", "t.M", "--import", "t.proto")
    written("imu.pyi", "sensor_msgs/Imu", "--encoding", "ros1")
    written("status.pyi", "diagnostic_msgs/DiagnosticStatus", "--encoding", "ros1")  # which has a field `values`
    (tmp_path / "use.py").write_text(USE + "\n".join(WRONG))
    (tmp_path / "pyrightconfig.json").write_text(json.dumps({"typeCheckingMode": "standard", "pythonVersion": "3.11"}))
    checker = [sys.executable, "-m", "basedpyright", "--pythonpath", sys.executable, "--outputjson", "-p", str(tmp_path)]
    answer = subprocess.run(checker, capture_output=True, text=True, cwd=tmp_path, check=False)
    errors = [each for each in json.loads(answer.stdout)["generalDiagnostics"] if each["severity"] == "error"]
    first = USE.count("\n")
    assert {each["file"] for each in errors} == {str(tmp_path / "use.py")}
    assert sorted({each["range"]["start"]["line"] - first for each in errors}) == list(range(len(WRONG))), errors


def test_units_shapes_and_values_stand_beside_fields(tmp_path, written):
    (tmp_path / "t.proto").write_text(SCHEMA)
    (tmp_path / "j.bottle-schema").write_text('"j" (("angle" :double (:unit "degree")) ("grid" (:list :int (:length 3))))')
    text = written("robot.pyi", "t.M", "--import", "t.proto")
    assert "    color: builtins.int  # Color: RED = 0, BLUE = 7\n" in text
    assert "    n: builtins.int  # int32, may be absent\n" in text
    assert "    # class: by `getattr` or `to_dict`; text\n" in text
    assert "def orientation_covariance(self) -> numpy.ndarray[typing.Any, numpy.dtype[numpy.float64]]: ...  # float64[9]\n" in written(
        "imu.pyi", "sensor_msgs/Imu", "--encoding", "ros1"
    )
    assert "angle: float  # float64, degree\n" in written("j.pyi", "j", "--encoding", "yarp3")


def test_a_mapping_gives_the_types_of_its_holder(written, capsys):
    assert main(["stubs", "yarp/icub/torso_state.mapping"]) == 0
    text = capsys.readouterr().out
    assert "class JointAngles(rosetta_jit.frameworks.protobuf.manners.ProtobufMessage):" in text
    assert "decoder, encoder = rosetta_jit.Decoder('yarp/icub/torso_state.mapping')" in text
    assert text == written("torso.pyi", "yarp/icub/torso_state.mapping")


@pytest.mark.parametrize("what", ["yarp/icub/torso_state.mapping", "std_msgs/Empty", "sensor_msgs/Imu", "diagnostic_msgs/DiagnosticArray"])
def test_what_is_imported_is_used(what, capsys):
    """Strict checkers report the rest."""
    options = [] if what.endswith(".mapping") else ["--encoding", "ros1"]
    assert main(["stubs", what, *options]) == 0
    tree = ast.parse(capsys.readouterr().out)
    imported = {alias.name for node in tree.body if isinstance(node, ast.Import) for alias in node.names}
    names = {ast.unparse(node) for node in ast.walk(tree) if isinstance(node, ast.Attribute | ast.Name)}
    assert imported <= names


HOSTILE = [
    "x: int\nimport os",
    "a; import os #",
    '"""',
    "'''",
    "é",
    "class",
    "__x",
    "a b",
    "lanes_",
    "self",
    "int",
    "# type: ignore",
    "x\\",
]
"""Names of fields, of structs and of enums' values: front ends refuse them, other programs make types without one."""


def test_names_of_schemas_stay_names():
    cells = [Struct(f"p.{name}", (Field("x", Float(64), unit=name),)) for name in HOSTILE]
    fields = [Field(name, Int(32), unit=name, doc=name) for name in HOSTILE]
    nested = [Field(f"nested{number}", Array(Ref(each.name))) for number, each in enumerate(cells)]
    colors = Enum("p.\n#", tuple((name, number) for number, name in enumerate(HOSTILE)))
    whole = Struct('p."""\nimport os', (*fields, *nested, Field("color", colors)))
    schema = Schema({each.name: each for each in (whole, *cells)})
    text = stub(holder_class(Ref(whole.name), schema).family_, "p.x\nimport os", {"encoding": "\nimport os"}, is_mapping=False)
    tree = ast.parse(text)
    assert text.isascii()
    assert {type(node) for node in tree.body} <= {ast.Import, ast.ClassDef, ast.AnnAssign}
    imports = [node for node in ast.walk(tree) if isinstance(node, ast.Import | ast.ImportFrom)]
    assert all(node in tree.body for node in imports)
    assert {alias.name.split(".")[0] for node in imports for alias in node.names} <= set(MODULES)


def test_what_is_not_there_is_an_error(capsys):
    assert main(["stubs", "no/such.mapping"]) == 1
    assert "no/such.mapping" in capsys.readouterr().err


def test_programs_of_several_wires(tmp_path):
    for name, text in {"t.proto": SCHEMA, "two.mapping": WIRES}.items():
        (tmp_path / name).write_text(text)
    assert main(["stubs", str(tmp_path / "two.mapping"), "-o", str(tmp_path / "two.pyi")]) == 0
    text = (tmp_path / "two.pyi").read_text()
    assert "decoders, encoders = rosetta_jit.Decoders(" in text
    decoders = next(each for each in ast.parse(text).body if isinstance(each, ast.ClassDef) and each.name == "Decoders")
    assert [each.target.id for each in decoders.body if isinstance(each, ast.AnnAssign)] == ["left"]  # `holder` is a property


WIRES = """import "t.proto"
data-holder: t.Inner
wire-schema left: t.Inner
wire-schema holder: t.Inner
unpack-rules:
  .a = .left.a
  .s = .holder.s
  ignore rest
"""
