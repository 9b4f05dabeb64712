"""`.msg` and `.idl` files of ROS 2 that refer to each other."""

from __future__ import annotations

import pytest

import rosetta_jit as rj
from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.ros2.idl import parse, parse_idl
from rosetta_jit.frameworks.ros2.type_hash import rihs01
from rosetta_jit.model.types import same_name
from rosetta_jit.source import Source
from tests.frameworks.omg.rosidl_shapes import shape
from tests.frameworks.ros.ros_files import SHIPPED, files, name_of

MSG_PART = {"probe/msg/Part.msg": "# A part\nuint8 KIND=3\nfloat64 weight 1.5\nbyte[<=4] code\nstring<=5 word\n"}
IDL_PART = {
    "probe/msg/Part.idl": """module probe { module msg {
        module Part_Constants { const uint8 KIND = 3; };
        struct Part { @default(value=1.5) double weight; sequence<octet, 4> code; string<5> word; };
    }; };"""
}
MSG_WHOLE = {"probe/msg/Whole.msg": "Part[] parts\nstd_msgs/Header header\nbool last\n"}
IDL_WHOLE = {
    "probe/msg/Whole.idl": """#include "probe/msg/Part.idl"
        #include "std_msgs/msg/Header.idl"
        module probe { module msg {
            struct Whole { sequence<probe::msg::Part> parts; std_msgs::msg::Header header; boolean last; };
        }; };"""
}
MIXES = [(MSG_WHOLE, MSG_PART), (MSG_WHOLE, IDL_PART), (IDL_WHOLE, MSG_PART), (IDL_WHOLE, IDL_PART)]
VALUE = {"parts": [{"weight": 2.0, "code": b"\1\2", "word": "two"}], "last": True}


def program(kind, whole, part):
    return kind.of("probe/msg/Whole", encoding="cdr", schema={**whole, **part}, imports=list(whole), backend="interpreter")


def find(texts):
    return lambda name: Source(name, texts[name]) if name in texts else SHIPPED.find(name)


def schema_of(whole, part):
    name, text = next(iter(whole.items()))
    read = parse if name.endswith(".msg") else parse_idl
    return read(Source(name, text), find({**whole, **part}))


def struct(schema, name):
    return next(each for full, each in schema.types.items() if same_name(full, name))


@pytest.mark.parametrize(("whole", "part"), MIXES)
def test_the_same_bytes(whole, part):
    expected = program(rj.Encoder, MSG_WHOLE, MSG_PART)
    encode, decode = program(rj.Encoder, whole, part), program(rj.Decoder, whole, part)
    data = bytes(expected(expected.holder_type(**VALUE)))
    assert bytes(encode(encode.holder_type(**VALUE))) == data
    assert decode(data).parts[0].word == "two"


@pytest.mark.parametrize(("whole", "part"), MIXES)
def test_the_same_types(whole, part):
    ours, plain = schema_of(whole, part), schema_of(MSG_WHOLE, MSG_PART)
    for name in ("probe/msg/Whole", "probe/msg/Part", "std_msgs/msg/Header"):
        assert shape(struct(ours, name)) == shape(struct(plain, name))
        assert rihs01(struct(ours, name), ours) == rihs01(struct(plain, name), plain)


def test_every_shipped_message():
    shipped = files("ros2")
    text = "".join(f'#include "{name_of(path)}.idl"\n' for path in shipped)
    schema = parse_idl(Source("all.idl", text), SHIPPED.find)
    for path in shipped:
        source = Source(str(path), path.read_text("utf-8"))
        plain = struct(parse(source, SHIPPED.find), name_of(path))
        ours = schema.types[plain.name.replace("/", "::")]
        assert shape(ours) == shape(plain)
        assert [each.doc for each in ours.fields if each.doc] == [each.doc for each in plain.fields if each.doc]


EVERYTHING = r"""# "quoted" \ and more
wstring WIDE="wide é"
string TEXT='it\'s'
float64 HALF=-0.5
int64 LOW=-9223372036854775808
@optional
int32 module
bool struct true
string default "say \"hi\" \\n"
string[] sequence ["a, (b)", '[c]', "d"]
int8[3] octet [1, -2, 3]
bool[<=2] any [true, false]
uint8[<=4] union [7]
wstring<=3 wide "é"
"""


def test_everything():
    """Keywords of IDL as names, and whatever must be escaped."""
    name = "probe/msg/Everything"
    plain = parse(Source(f"{name}.msg", EVERYTHING), find({}))
    ours = parse_idl(Source("root.idl", f'#include "{name}.idl"'), find({f"{name}.msg": EVERYTHING}))
    one, other = struct(ours, name), struct(plain, name)
    assert [each.name for each in one.fields] == [each.name for each in other.fields]
    assert [each.value for each in one.constants] == [each.value for each in other.constants]
    assert [(each.default, each.options) for each in one.fields] == [(each.default, each.options) for each in other.fields]
    assert (one.doc, type(one.fields[0].type)) == (other.doc, type(other.fields[0].type))


def test_services_and_actions():
    given = {"probe/action/Go.action": "Part part\n---\n---\n", "probe/srv/Ask.srv": "Part[] parts\n---\n", **IDL_PART}
    for kind, request in (("action/Go.action", "probe/action/Go_SendGoal_Request"), ("srv/Ask.srv", "probe/srv/Ask_Request")):
        name = f"probe/{kind}"
        schema = parse(Source(name, given[name]), find(given))
        plain = parse(Source(name, given[name]), find({**given, **MSG_PART}))
        assert rihs01(struct(schema, request), schema) == rihs01(struct(plain, request), plain)


def test_what_the_text_itself_defines():
    """As in MCAP: the definition there comes before that of a file."""
    text = MSG_WHOLE["probe/msg/Whole.msg"] + "Other other\n" + "=" * 80 + "\nMSG: std_msgs/Header\nint8 own\n"
    other = {"probe/msg/Other.idl": "module probe { module msg { struct Other { long x; }; }; };"}
    schema = parse(Source("probe/msg/Whole.msg", text), find({**other, **MSG_PART}))
    assert [each.name for each in struct(schema, "std_msgs/msg/Header").fields] == ["own"]


WRONG = [
    ("a message that is wrong", {"probe/msg/Part.msg": "int32 Weight\n"}, "cannot be the name of a field"),
    ("a message that needs itself", {"probe/msg/Part.msg": "Whole whole\n"}, "Whole"),
    ("a message that IDL cannot write", {"probe/msg/Part.msg": "float64 x inf\n"}, "IDL cannot write `inf`"),
    ("nothing", {}, "probe/msg/Part.idl"),
]


@pytest.mark.parametrize(("part", "words"), [each[1:] for each in WRONG], ids=[each[0] for each in WRONG])
def test_reports(part, words):
    with pytest.raises(SchemaError, match=words):
        schema_of(IDL_WHOLE, part)
