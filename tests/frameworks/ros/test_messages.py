"""What lines of a `.msg` file become in the model."""

from __future__ import annotations

import pytest

from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.ros2.type_hash import rihs01
from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Field, Float, Int, NamedConstant, Optional, Ref, Schema, String, Struct
from tests.frameworks.ros.ros_files import alone, ros1_vectors

SEPARATOR = "=" * 80


def fields(text, dialect="ros1", **options):
    schema = alone(text, dialect=dialect, **options)
    struct = next(iter(schema.types.values()))
    return {each.name: each for each in struct.fields}


def types(text, dialect="ros1"):
    return [each.type for each in fields(text, dialect).values()]


def constants(text, dialect="ros1"):
    struct = next(iter(alone(text, dialect=dialect).types.values()))
    return {each.name: each.value for each in struct.constants}


def test_scalars_of_ros1():
    text = "bool a\nbyte b\nchar c\nint8 d\nuint64 e\nfloat32 f\nstring g\ntime h\nduration i"
    assert types(text) == [
        Bool("bool"),
        Int(8, signed=True, spelling="byte"),
        Int(8, signed=False, spelling="char"),
        Int(8, spelling="int8"),
        Int(64, signed=False, spelling="uint64"),
        Float(32, "float32"),
        String("utf-8", "string"),
        Ref("time"),
        Ref("duration"),
    ]


def test_scalars_of_ros2():
    assert types("byte b\nchar c\nwstring w\nstring<=7 s", "ros2") == [
        Int(8, signed=False, spelling="byte"),
        Int(8, signed=False, spelling="char"),
        String("utf-16", "wstring"),
        String("utf-8", "string", 7),
    ]


def test_arrays_of_ros1():
    text = "uint8[] a\nchar[3] b\nbyte[] c\nint8[2] d\nfloat64[0] e\ntime[] f"
    assert types(text) == [
        Bytes("uint8"),
        Bytes("char", 3),
        Array(Int(8, spelling="byte")),
        Array(Int(8, spelling="int8"), 2),
        Array(Float(64, "float64"), 0),
        Array(Ref("time")),
    ]


def test_arrays_of_ros2():
    assert types("byte[] a\nuint8[<=4] b\nstring<=2[<=3] c\nwstring<=5[6] d\nbool[] e", "ros2") == [
        Bytes("byte"),
        Bytes("uint8", maximum=4),
        Array(String("utf-8", "string", 2), maximum=3),
        Array(String("utf-16", "wstring", 5), 6),
        Array(Bool("bool")),
    ]


def test_time_is_a_struct():
    schema = alone("time stamp")
    assert [each.name for each in schema.types["time"].fields] == ["secs", "nsecs"]
    assert "duration" not in schema.types


def test_constants_of_ros1():
    text = "string S = a # b=c  \nint8 N=-5 # five\nfloat32 F =1.5\nbool T=True\nbool Z=0\nuint8  X =007\nchar C=65\nstring E="
    assert constants(text) == {"S": "a # b=c", "N": -5, "F": 1.5, "T": True, "Z": False, "X": 7, "C": 65, "E": ""}


def test_a_text_has_no_comment_behind_it():
    """In ROS 1 it goes on to the end of its line; what stands above it is its comment."""
    struct = alone("# the arm\nstring S=a #1\nint8 N=5 # five\nstring T=a #").types["pkg/Foo"]
    assert [each.doc for each in struct.constants] == ["the arm", "five", ""]


def test_constants_of_ros2():
    text = (
        "string S=\"a 'b' \\\"c\\\"\" # d\nuint8 H=0xff\nint32 B=-0b101\nbool T=TRUE\nbool O=1\nfloat64 F=-inf\nwstring W='é'\nstring R=a b"
    )
    assert constants(text, "ros2") == {
        "S": "a 'b' \"c\"",
        "H": 255,
        "B": -5,
        "T": True,
        "O": True,
        "F": float("-inf"),
        "W": "é",
        "R": "a b",
    }


def test_constants_keep_their_type():
    struct = alone("byte A=-1").types["pkg/Foo"]
    assert struct.constants == (NamedConstant("A", Int(8, spelling="byte"), -1),)


def test_defaults():
    found = fields(
        "int32 a -3\nstring b 'x, y'\nuint8[] c [1, 2]\nstring<=3[] d [\"p,q\", r]\nfloat32[2] e [1, .5]\nbool f\nbool[] g []", "ros2"
    )
    assert {name: each.default for name, each in found.items()} == {
        "a": -3,
        "b": "x, y",
        "c": b"\x01\x02",
        "d": None,
        "e": None,
        "f": None,
        "g": None,
    }
    assert [found[name].option("default") for name in "dega"] == ['["p,q", "r"]', "[1.0, 0.5]", "[]", None]


def test_optional_fields():
    text = "@optional float32 a\n@optional\n# of what follows\nint8 b\nint8 c"
    assert [isinstance(each, Optional) for each in types(text, "ros2")] == [True, True, False]


def test_definition_and_sum_are_options():
    struct = alone("# x\nint32  data\n", "pkg/Foo.msg").types["pkg/Foo"]
    assert struct.option("definition") == "# x\nint32  data\n"
    assert struct.option("md5sum") == "da5909fbe378aeaf85e547e830cc1bb7"


@pytest.mark.parametrize(
    ("file", "dialect", "name"),
    [
        ("a/b/geometry_msgs/msg/Pose.msg", "ros1", "geometry_msgs/Pose"),
        ("geometry_msgs/Pose.msg", "ros1", "geometry_msgs/Pose"),
        ("ros2/geometry_msgs/Pose.msg", "ros2", "geometry_msgs/msg/Pose"),
        ("/x/geometry_msgs/msg/Pose.msg", "ros2", "geometry_msgs/msg/Pose"),
        ("Pose.msg", "ros2", "Pose"),
        ("not-a-package/Pose.msg", "ros1", "Pose"),
    ],
)
def test_the_file_names_the_message(file, dialect, name):
    assert list(alone("int8 a", file, dialect).types) == [name]


def test_included_definitions_come_first():
    text = f"b/Bar x\n{SEPARATOR}\nMSG: b/Bar\nint8 mine\n"
    schema = alone(text, others={"b/msg/Bar.msg": "int8 other"})
    assert [each.name for each in schema.types["b/Bar"].fields] == ["mine"]
    assert schema.types["pkg/Foo"].option("definition") == "b/Bar x"
    assert schema.types["b/Bar"].option("definition") == "int8 mine\n"


def test_a_text_may_begin_with_its_name():
    text = f"{SEPARATOR}\nMSG: a/Foo\nBar x\n{SEPARATOR}\r\nMSG: a/msg/Bar \r\nint8 y\r\n"
    assert list(alone(text, "whatever.msg", "ros2").types) == ["a/msg/Foo", "a/msg/Bar"]


def test_the_texts_of_a_bag_come_back():
    """What genpy calls the full text can be put together from the definitions."""
    for name, known in ros1_vectors()["definitions"].items():
        schema = alone(known["definition"], f"{name}.msg")
        texts = {each.name: each.option("definition") for each in schema.types.values() if "/" in each.name}
        rest = [f"\n{SEPARATOR}\nMSG: {each}\n{text}" for each, text in texts.items() if each != name]
        assert len(known["definition"]) == len(texts[name] + "".join(rest))


@pytest.mark.parametrize("place", ["b/msg/Bar.msg", "b/Bar.msg", "around/b/Bar.msg", "around/b/msg/Bar.msg", "ros1/b/Bar.msg"])
def test_where_a_message_is_found(place):
    assert "b/Bar" in alone("b/Bar x", "around/pkg/msg/Foo.msg", others={place: "int8 y"}).types


def test_a_message_of_the_same_package_lies_beside():
    assert "pkg/Bar" in alone("Bar x", "pkg/Foo.msg", others={"Bar.msg": "int8 y"}).types
    with pytest.raises(SchemaError, match="unknown-message"):
        alone("b/Bar x", "pkg/Foo.msg", others={"Bar.msg": "int8 y"})


def test_the_header_of_ros1_is_that_of_std_msgs():
    others = {"std_msgs/msg/Header.msg": "uint32 seq", "pkg/msg/Header.msg": "int8 own"}
    assert types_of(alone("Header header", others=others)) == [Ref("std_msgs/Header")]
    assert types_of(alone("Header[] headers", others=others)) == [Array(Ref("pkg/Header"))]  # as genmsg has it


def types_of(schema):
    return [each.type for each in schema.types["pkg/Foo"].fields]


def test_lines_end_as_the_peers_have_it():
    assert list(fields("int8 a\r\n  \r\nint8 b \r\n")) == ["a", "b"]
    assert list(fields("int8 a # x\u2028int8 b", "ros2")) == ["a", "b"]
    assert list(fields("int8 a # x\u2028int8 b", "ros1")) == ["a"]


def test_unfit_types_have_no_hash():
    enum = Enum("m::E", (("A", 0),))
    struct = Struct("m::S", (Field("e", enum),))
    with pytest.raises(SchemaError, match="type-hash"):
        rihs01(struct, Schema({"m::S": struct}))


def test_hash_of_idl_types():
    """The names of `.idl` files; their `char` is a character."""
    message = alone("uint8 a\nbyte b\nBar[2] c", "p/msg/Foo.msg", "ros2", {"p/msg/Bar.msg": "float32[] d"})
    bar = Struct("p::msg::Bar", (Field("d", Array(Float(32, "float"))),))
    octets = Int(8, signed=False, spelling="uint8"), Int(8, signed=False, spelling="octet")
    foo = Struct("p::msg::Foo", (Field("a", octets[0]), Field("b", octets[1]), Field("c", Array(Ref("p::msg::Bar"), 2))))
    schema = Schema({"p::msg::Foo": foo, "p::msg::Bar": bar})
    assert rihs01(foo, schema) == rihs01(message.types["p/msg/Foo"], message)
    character = Struct("p::msg::Foo", (Field("a", Int(8, signed=False, spelling="char")), *foo.fields[1:]))
    assert rihs01(character, schema) != rihs01(foo, schema)


def test_comments_are_documentation():
    text = "# A reading.\n#\n# Of a sensor.\n\n# unrelated\n\n## above\nint8 a  # beside\nint8 b\n# of A\nint8 A=1 # one\n"
    struct = alone(text).types["pkg/Foo"]
    assert struct.doc == "A reading.\nOf a sensor."
    assert [each.doc for each in struct.fields] == ["above\nbeside", ""]
    assert [each.doc for each in struct.constants] == ["of A\none"]
    assert alone("# of a\nint8 a").types["pkg/Foo"].doc == ""
