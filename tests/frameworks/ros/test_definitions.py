"""Every definition at hand is to us what it is to the peers' parsers, and has the same sums and hashes."""

from __future__ import annotations

import json

import pytest

from rosetta_jit.frameworks.ros2.idl import DUMMY
from rosetta_jit.frameworks.ros2.type_hash import rihs01
from rosetta_jit.model.types import Array, Bool, Bytes, Float, Int, Ref, String
from tests.frameworks.ros.ros_files import IDL, VECTORS, alone, debian, files, name_of, ros1_vectors, shipped

SUMS = json.loads((VECTORS / "md5sums.json").read_text())
CHAR = {"std_msgs/msg/Char", "service_msgs/msg/ServiceEventInfo"}
"""Messages whose hash rosbags gets wrong: `char` in a .msg is `uint8` (rosidl_adapter's MSG_TYPE_TO_IDL), not a character."""
CHAR_HASHES = {
    "std_msgs/msg/Char": "RIHS01_3ad2d04dd29ba19d04b16659afa3ccaedd691914b02a64e82e252f2fa6a586a9",
    "service_msgs/msg/ServiceEventInfo": "RIHS01_41bcbbe07a75c9b52bc96bfd5c24d7f0fc0a08c0cb7921b3373c5732345a6f45",
}


def store(name):
    typesys = pytest.importorskip("rosbags.typesys")
    return typesys.get_typestore(typesys.Stores[name])


def test_as_many_as_there_are():
    assert len(files("ros1-2012")) == 65 + 32
    assert {name_of(path) for path in files("ros1")} == set(SUMS)
    assert len(files("ros2")) > 150


def test_sums_are_those_of_the_packages():
    for path in files("ros1"):
        name = name_of(path)
        assert shipped(path).types[name].option("md5sum") == SUMS[name], name


def test_sums_are_those_of_rosbags():
    types = store("ROS1_NOETIC")
    checked = 0
    for path in files("ros1"):
        peer = name_of(path).replace("/", "/msg/")
        if peer in types.fielddefs:
            assert shipped(path).types[name_of(path)].option("md5sum") == types.generate_msgdef(peer)[1], peer
            checked += 1
    assert checked > 120


def test_sums_of_concatenated_definitions():
    for name, known in ros1_vectors()["definitions"].items():
        struct = alone(known["definition"], f"{name}.msg").types[name]
        assert struct.option("md5sum") == known["md5sum"], name


def test_old_definitions_need_only_each_other():
    for path in files("ros1-2012"):
        assert all("/ros1-2012/" in source for source in shipped(path).sources)
    marker = shipped(IDL / "ros1-2012/visualization_msgs/Marker.msg").types["visualization_msgs/Marker"]
    assert marker.option("md5sum") == "18326976df9d29249efc939e00342cde"


@pytest.mark.parametrize("distribution", ["ROS2_JAZZY", "ROS2_KILTED"])
def test_hashes_are_those_of_rosbags(distribution):
    types = store(distribution)
    checked = 0
    for path in files("ros2"):
        name = name_of(path)
        if name in types.fielddefs and name not in CHAR:
            schema = shipped(path)
            assert rihs01(schema.types[name], schema) == types.hash_rihs01(name), name
            checked += 1
    assert checked > 150


def test_hashes_with_characters_are_those_of_ros():
    for path in files("ros2"):
        name = name_of(path)
        if name in CHAR_HASHES:
            assert rihs01(shipped(path).types[name], shipped(path)) == CHAR_HASHES[name]


@pytest.mark.parametrize("distribution", ["ROS1_NOETIC", "ROS2_JAZZY", "ROS2_KILTED"])
def test_every_type_of_the_peer(distribution):
    """Texts that rosbags writes, with all definitions concatenated: our trees are its trees, our sums and hashes its own."""
    types = store(distribution)
    dialect = "ros1" if "ROS1" in distribution else "ros2"
    for name in types.fielddefs:
        package, kind, short = name.split("/")
        if kind != "msg" or (dialect == "ros1" and package == "builtin_interfaces"):
            continue
        text, sum_ = types.generate_msgdef(name, ros_version=int(dialect[-1]))
        schema = alone(text, f"{package}/{short}.msg", dialect)
        struct = schema.types[f"{package}/{short}" if dialect == "ros1" else name]
        assert tree(schema) == peer_tree(text, name, dialect)
        if dialect == "ros1":
            assert struct.option("md5sum") == sum_, name
        elif "char" not in text:
            assert rihs01(struct, schema) == types.hash_rihs01(name), name


@pytest.mark.parametrize("folder", ["ros1", "ros1-2012", "ros2"])
def test_trees_of_shipped_files(folder):
    for path in files(folder):
        name = name_of(path)
        text = path.read_text()
        alike = shipped(path).types[name]
        assert struct_tree(alike) == peer_tree(text, name, folder)[name if "/msg/" in name else name.replace("/", "/msg/")]


@pytest.mark.parametrize("folder", ["ros1", "ros1-2012"])
def test_what_genmsg_reads(folder):
    loader = debian("genmsg", "msg_loader")
    for path in files(folder):
        name = name_of(path)
        spec = loader.load_msg_from_string(loader.MsgContext.create_default(), path.read_text(), name)
        struct = shipped(path).types[name]
        assert spec.names == [each.name for each in struct.fields]
        assert spec.types == [spelled(each.type) for each in struct.fields]
        assert [(each.type, each.name, each.val) for each in spec.constants] == constants(struct)


def test_what_rosidl_adapter_reads():
    parser = debian("rosidl_adapter", "parser")
    for path in files("ros2"):
        package, _, short = name_of(path).split("/")
        spec = parser.parse_message_string(package, short, path.read_text())
        struct = shipped(path).types[name_of(path)]
        expected = [(str(each.type), each.name, each.default_value) for each in spec.fields]
        assert [(spelled(each.type).replace("/msg/", "/"), each.name, each.default) for each in declared(struct)] == expected
        assert [(each.type, each.name, each.value) for each in spec.constants] == constants(struct)


def constants(struct):
    return [(each.type.spelling, each.name, each.value) for each in struct.constants]


def spelled(type_):
    match type_:
        case Ref(name):
            return name
        case Bytes(word, length, maximum):
            return f"{word}[{size(length, maximum)}]"
        case Array(element, length, maximum):
            return f"{spelled(element)}[{size(length, maximum)}]"
        case String(_, word, maximum):
            return word if maximum is None else f"{word}<={maximum}"
        case Bool(word) | Int(_, _, word) | Float(_, word):
            return word


def size(length, maximum):
    return f"<={maximum}" if maximum is not None else "" if length is None else str(length)


def tree(schema):
    structs = {name: each for name, each in schema.types.items() if "/" in name}
    return {name if "/msg/" in name else name.replace("/", "/msg/"): struct_tree(each) for name, each in structs.items()}


def struct_tree(struct):
    return [(name, kind, value) for kind, name, value in constants(struct)], [(each.name, spelled(each.type)) for each in declared(struct)]


def declared(struct):
    """The fields that the text has: a message without any gets one."""
    return [each for each in struct.fields if each.name != DUMMY]


def peer_tree(text, name, dialect):
    typesys = pytest.importorskip("rosbags.typesys")
    return {
        each: (constants_, [(field, peer_spelled(of, dialect == "ros2")) for field, of in fields])
        for each, (constants_, fields) in typesys.get_types_from_msg(text, name).items()
    }


def peer_spelled(of, ros2):
    kind, inside = of
    if kind == 1:
        return f"{inside[0]}<={inside[1]}" if inside[1] else inside[0]
    if kind == 2:
        short = inside if ros2 else inside.replace("/msg/", "/")
        return {"builtin_interfaces/Time": "time", "builtin_interfaces/Duration": "duration"}.get(short, short)
    element, number = inside
    return f"{peer_spelled(element, ros2)}[{'' if not number else number if kind == 3 else f'<={number}'}]"
