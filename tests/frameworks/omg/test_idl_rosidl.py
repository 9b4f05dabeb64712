"""What rosidl writes is read as rosidl, rosbags and our front end of `.msg` files read it."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import pytest

from rosetta_jit.frameworks.omg.idl import parse
from rosetta_jit.frameworks.ros2.idl import parse as parse_msg
from tests.frameworks.omg.idl_files import IDL, ROSIDL, load_from, names, source
from tests.frameworks.omg.rosidl_shapes import shape

NAMES = names(ROSIDL)
MESSAGES = IDL / "ros2"
DEBIAN = "/usr/lib/python3/dist-packages"
needs_rosidl = pytest.mark.skipif(not Path(DEBIAN, "rosidl_parser").exists(), reason="rosidl is not installed")
needs_adapter = pytest.mark.skipif(not Path(DEBIAN, "em.py").exists(), reason="rosidl_adapter needs python3-empy")

CONVERT = """
import pathlib, sys
from rosidl_adapter.msg import convert_msg_to_idl
root, out = map(pathlib.Path, sys.argv[1:])
for path in sorted(root.rglob("*.msg")):
    package, inner = path.relative_to(root).parts[0], pathlib.Path(*path.relative_to(root).parts[1:])
    (out / package / inner.parent).mkdir(parents=True, exist_ok=True)
    convert_msg_to_idl(root / package, package, inner, out / package / inner.parent)
"""


def ours(folder, name):
    schema = parse(source(folder, name), load_from(folder))
    full = name.removesuffix(".idl").replace("/", "::")
    return shape(schema.types[full])


def debian(*arguments):
    done = subprocess.run(
        ["/usr/bin/python3", *map(str, arguments)], capture_output=True, text=True, env={"PYTHONPATH": DEBIAN}, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize("name", NAMES)
def test_as_the_msg_file(name):
    path = name.replace(".idl", ".msg")
    folder = MESSAGES if (MESSAGES / path).exists() else ROSIDL
    schema = parse_msg(source(folder, path), load_from(folder, MESSAGES))
    assert ours(ROSIDL, name) == shape(schema.types[name.removesuffix(".idl")])


@pytest.mark.parametrize("name", [name for name in NAMES if "Everything" not in name])
def test_as_rosbags(name):
    """The parser of rosbags reads neither `#include` before a module, nor wide strings."""
    from rosbags.interfaces import Nodetype
    from rosbags.typesys import get_types_from_idl

    def spelled(node):
        match node:
            case (Nodetype.BASE, ("string", bound)):
                return f"string<={bound}" if bound else "string"
            case (Nodetype.BASE, (word, _)):
                return {"octet": "byte"}.get(word, word)
            case (Nodetype.NAME, word):
                return word
            case (Nodetype.ARRAY, (element, length)):
                return f"{spelled(element)}[{length}]"
            case (Nodetype.SEQUENCE, (element, bound)):
                return spelled(element) + (f"[<={bound}]" if bound else "[]")
        raise AssertionError(node)

    text = "\n".join(line for line in (ROSIDL / name).read_text().splitlines() if not line.startswith(("#", "//")))
    constants, fields = get_types_from_idl(text)[name.removesuffix(".idl")]
    mine = ours(ROSIDL, name)
    theirs = [[field, spelled(node)] for field, node in fields if field != "structure_needs_at_least_one_member"]
    assert [field[:2] for field in mine["fields"]] == theirs
    assert mine["constants"] == [list(each) for each in constants]


@needs_rosidl
def test_as_rosidl():
    theirs = json.loads(debian(Path(__file__).with_name("dump_rosidl.py"), ROSIDL, *NAMES))
    assert {name.removesuffix(".idl"): ours(ROSIDL, name) for name in NAMES} == theirs


@needs_rosidl
@needs_adapter
def test_every_message_of_ros2(tmp_path):
    debian("-c", CONVERT, MESSAGES, tmp_path)
    made = names(tmp_path)
    assert len(made) > 100
    theirs = json.loads(debian(Path(__file__).with_name("dump_rosidl.py"), tmp_path, *made))
    assert {name.removesuffix(".idl"): ours(tmp_path, name) for name in made} == theirs
    for name in made:
        schema = parse_msg(source(MESSAGES, name.replace(".idl", ".msg")), load_from(MESSAGES))
        assert ours(tmp_path, name) == shape(schema.types[name.removesuffix(".idl")])


def test_comments_are_docs():
    everything = parse(source(ROSIDL, "rj_msgs/msg/Everything.idl"), load_from(ROSIDL)).types["rj_msgs::msg::Everything"]
    assert everything.doc == "every feature of .msg files"
