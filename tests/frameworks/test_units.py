"""How each IDL says units: what becomes of `Field.unit` and `Field.part_units`."""

from __future__ import annotations

from pathlib import Path

import pytest

import rosetta_jit as rj
from rosetta_jit.frameworks.installed import Readers, installed
from rosetta_jit.frameworks.protobuf.descriptors import from_file_descriptor_set
from rosetta_jit.model.serial import from_plain, to_plain
from rosetta_jit.model.types import Ref
from rosetta_jit.parsing.search import Reading, SearchPath
from rosetta_jit.source import shipped_folders
from tests.frameworks.protobuf.proto_files import SHIPPED

PROTO = """syntax = "{}"; package lab; import "rosetta_jit/unit.proto";
message Arm {{ {label} double x = 1 [(rosetta_jit.unit) = "degree"]; repeated double joints = 2 [(.rosetta_jit.unit) = "rad, rad, m"];
{label} double free = 3; }}"""
PROTO2, PROTO3 = PROTO.format("proto2", label="optional"), PROTO.format("proto3", label="")
EXPECTED = {"x": ("degree", ()), "joints": (None, (((0,), "rad"), ((1,), "rad"), ((2,), "m"))), "free": (None, ())}


def fields(schema, name):
    return {field.name: (field.unit, field.part_units) for field in schema.types[name].fields}


def read(file, text, framework=None):
    search = SearchPath.of(files={file: text})
    source = search.find(file)
    return Readers(installed(), framework).find(file)(source, search.loader(Reading(), source))


@pytest.mark.parametrize("text", [PROTO2, PROTO3])
def test_an_option_of_protobuf(text):
    assert fields(read("arm.proto", text), "lab.Arm") == EXPECTED


@pytest.mark.parametrize("text", [PROTO2, PROTO3])
def test_the_descriptors_of_protoc(text, tmp_path):
    from grpc_tools import protoc

    (tmp_path / "arm.proto").write_text(text)
    idl = next(folder for folder in shipped_folders() if (folder / "rosetta_jit").is_dir())
    arguments = [f"-I{tmp_path}", f"-I{idl}", f"-I{SHIPPED}", "--include_imports", f"--descriptor_set_out={tmp_path / 'set'}", "arm.proto"]
    assert protoc.main(["protoc", *arguments]) == 0
    schema = from_file_descriptor_set((tmp_path / "set").read_bytes())
    assert fields(schema, "lab.Arm") == EXPECTED


@pytest.mark.parametrize("framework", ["corba", "ros2"])
def test_the_annotation_of_idl(framework):
    text = 'module lab { struct Arm { @unit("degree") double x; @unit(value="rad, rad, m") double joints[3]; double free; }; };'
    schema = read("arm.idl", text, framework)
    name = next(name for name in schema.types if name.endswith("Arm"))
    assert fields(schema, name) == EXPECTED


MSG = """# Comments before the first field, in [inches].

float32 angle_min        # start angle of the scan [rad]
float32 share            # in [0, 1]
# how far
# it sees [m]
float32[] ranges
float32 two              # [m] or [s]
float32 free
"""


def test_comments_of_ros2():
    """As rosidl_adapter reads them; those of ROS 1 say nothing."""
    units = {"angle_min": "rad", "share": None, "ranges": "m", "two": None, "free": None}
    schema = read("lab/msg/Scan.msg", MSG, "ros2")
    assert {name: unit for name, (unit, _) in fields(schema, "lab/msg/Scan").items()} == units
    schema = read("ros1/lab/Scan.msg", MSG, "ros1")
    assert {unit for unit, _ in fields(schema, "lab/Scan").values()} == {None}


def test_comments_of_ros2_reach_idl_files():
    files = {
        "lab/msg/Scan.msg": "float32 angle_min # [rad]\n",
        "lab/msg/All.idl": '#include "lab/msg/Scan.idl"\nmodule lab { module msg { struct All { lab::msg::Scan scan; }; }; };',
    }
    search = SearchPath.of(files=files)
    source = search.find("lab/msg/All.idl")
    schema = Readers(installed(), "ros2").find(source.name)(source, search.loader(Reading(), source))
    assert fields(schema, next(name for name in schema.types if name.endswith("Scan"))) == {"angle_min": ("rad", ())}


def test_options_of_bottle_schemas():
    text = '"arm" (("x" :double (:unit :degree)) ("joints" (:list :double) (:units :rad "rad" :m)) ("free" :double))'
    assert fields(read("arm.bottle-schema", text), "arm") == EXPECTED
    same = read("arm.bottle-schema", '"arm" (("a" (:list :double (:length 2)) (:units :m :m)))')
    assert fields(same, "arm") == {"a": ("m", ())}


@pytest.mark.parametrize(
    ("options", "code"),
    [("(:list :double) (:units)", "option"), ("(:list :double) (:units 1)", "option"), (":double (:units :m :m)", "option")],
)
def test_wrong_options_of_bottle_schemas(options, code):
    with pytest.raises(rj.SchemaError) as error:
        read("arm.bottle-schema", f'"arm" (("a" {options}))')
    assert [code in problem.code for problem in error.value.diagnostics] == [True]


def test_units_stay_with_types_that_are_kept():
    schema = read("arm.proto", PROTO3)
    assert fields(from_plain(to_plain(Ref("lab.Arm"), schema))[1], "lab.Arm") == EXPECTED


def test_the_option_is_shipped():
    (found,) = [folder / "rosetta_jit/unit.proto" for folder in shipped_folders() if (folder / "rosetta_jit/unit.proto").is_file()]
    assert "76210" in Path(found).read_text()
