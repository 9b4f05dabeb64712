"""Texts as recordings keep them, without the name of a file: `ros2msg`, `ros2idl`, services and actions, each for one of its types."""

from __future__ import annotations

import pytest

import rosetta_jit as rj

LINE = "=" * 80 + "\n"
ADD = "int64 a\nint64 b\n---\nint64 sum\n"
FIBONACCI = "int32 order\n---\nint32[] sequence\n---\nint32[] partial\n"
EVENT = ["info", "request", "response"]
BASIC = "module p { module msg { struct Basic { float f; }; }; };\n"


def names(type_, text, encoding="cdr"):
    return list(rj.Decoder.of(type_, encoding=encoding, schema=text, backend="interpreter").new().to_dict())


SERVICE = {"": ["request_message", "response_message", "event_message"], "_Event": EVENT, "_Request": ["a", "b"], "_Response": ["sum"]}


@pytest.mark.parametrize("header", ["", f"{LINE}SRV: p/srv/Add\n"], ids=["plain", "headed"])
@pytest.mark.parametrize("end", SERVICE)
def test_services(end, header):
    assert names(f"p/srv/Add{end}", header + ADD) == SERVICE[end]


ACTION = {
    "_Goal": ["order"],
    "_Result": ["sequence"],
    "_Feedback": ["partial"],
    "_FeedbackMessage": ["goal_id", "feedback"],
    "_SendGoal_Event": EVENT,
    "_SendGoal_Request": ["goal_id", "goal"],
    "_SendGoal_Response": ["accepted", "stamp"],
    "_GetResult_Event": EVENT,
    "_GetResult_Request": ["goal_id"],
    "_GetResult_Response": ["status", "result"],
}


@pytest.mark.parametrize("header", ["", f"{LINE}ACTION: p/action/Fib\n"], ids=["plain", "headed"])
@pytest.mark.parametrize("end", ACTION)
def test_actions(end, header):
    assert names(f"p/action/Fib{end}", header + FIBONACCI) == ACTION[end]


def test_services_of_ros1():
    assert names("p/AddRequest", ADD, "ros1") == ["a", "b"]
    assert names("p/AddResponse", ADD, "ros1") == ["sum"]


EVENT_OF_ROSBAG2 = """
00010000 01000000 21212e65 beda462b 010feb7d6c2aa9d20000000000001304 0000000001000000 00000000
01000000 00000000 0100000000000000 0300000000000000 00000000
"""
"""The first message of the bag `only_services` among rosbag2's own tests, which keeps the text of the service with it."""


def test_an_event_of_rosbag2():
    type_, data = "example_interfaces/srv/AddTwoInts_Event", bytes.fromhex(EVENT_OF_ROSBAG2)
    holder = rj.Decoder.of(type_, encoding="cdr", schema=ADD, backend="interpreter")(data)
    assert (holder.info.event_type, holder.info.sequence_number, holder.info.stamp.sec) == (1, 1, 1697521953)
    assert ([(each.a, each.b) for each in holder.request], len(holder.response)) == ([(1, 3)], 0)
    assert bytes(rj.Encoder.of(type_, encoding="cdr", schema=ADD, backend="interpreter")(holder)) == data


OTHER = f"{LINE}IDL: p/msg/Other\nmodule p {{ module msg {{ struct Other {{ long l; }}; }}; }};\n"


@pytest.mark.parametrize(
    "below",
    [
        "MSG: p/Basic\nfloat32 f\n",
        "MSG: p/msg/Basic\nfloat32 f\n",
        f"IDL: p/Basic\n{BASIC}",
        f"IDL: p/msg/Basic\n{BASIC}",
        f'IDL: p/msg/Basic\n#include "p/msg/Other.idl"\n{BASIC}{OTHER}',
    ],
)
def test_services_of_messages_in_either_language(below):
    text = f"{LINE}SRV: p/srv/Ask\np/Basic[] many\n---\np/msg/Basic one\n\n{LINE}{below}"
    assert names("p/srv/Ask_Request", text) == ["many"]
    decode = rj.Decoder.of("p/srv/Ask_Response", encoding="cdr", schema=text, backend="interpreter")
    assert decode(bytes.fromhex("00010000 0000c03f")).one.f == 1.5


def test_messages_of_services():
    """What writes all messages of a service out, one by one."""
    text = f"service_msgs/ServiceEventInfo info\np/srv/Add_Request[<=1] request\n{LINE}MSG: p/srv/Add_Request\nint64 a\n"
    assert names("p/srv/Add_Event", text) == ["info", "request"]
    assert names("p/srv/Add_Request", "int64 a\n") == ["a"]


def idl(name, text):
    return f"{LINE}IDL: {name}\n{text}"


def module(*structs):
    return f"module p {{ module msg {{ {' '.join(structs)} }}; }};\n"


A = module("struct A { p::msg::B b; sequence<C> many; };")
B = module("// about A\nstruct B { double x; };")
C = module("struct C { B b; string text; };")
INCLUDED = '#include "p/msg/B.idl"\n#include "p/msg/C.idl"\n'


@pytest.mark.parametrize("order", ["ABC", "CBA", "BCA"])
@pytest.mark.parametrize("includes", ["", INCLUDED], ids=["bare", "included"])
@pytest.mark.parametrize("type_", ["p/msg/A", "p/A", "p::msg::A"])
def test_ros2idl(order, includes, type_):
    texts = {"A": includes + A, "B": B, "C": '#include "p/msg/B.idl"\n' + C if includes else C}
    text = "\n".join(idl(f"p/msg/{each}", texts[each]) for each in order)
    assert names(type_, text) == ["b", "many"]


def test_ros2idl_with_shipped_messages():
    text = idl("p/msg/A", '#include "std_msgs/msg/Header.idl"\n' + module("struct A { std_msgs::msg::Header header; };"))
    decode = rj.Decoder.of("p/msg/A", encoding="cdr", schema=text, backend="interpreter")
    assert decode.new().header.frame_id == ""


def test_ros2idl_as_a_file_and_with_constants():
    text = idl("p/msg/A", module("module A_Constants { const long MOST = 3; };", "struct A { sequence<long, A_Constants::MOST> few; };"))
    for file in ("p/msg/A.idl", "p/msg/A.msg"):
        decode = rj.Decoder.of("p/msg/A", encoding="cdr", schema={file: text}, backend="interpreter")
        assert decode.holder_type.MOST == 3


def test_plain_idl():
    """MCAP's `omgidl`, which has no lines of `=`."""
    assert names("p::A", "// of mine\nmodule p { @final struct A { long x; }; };") == ["x"]
    assert names("A", "@appendable struct A { long y; };", "cdr2") == ["y"]


HOSTILE = [
    f"{LINE}IDL: p/msg/A\n",
    f"{LINE}IDL: p/msg\n{A}",
    f"{LINE}IDL: ../../etc/A\n{A}",
    idl("p/msg/A", A),
    idl("p/msg/A", A) + idl("p/msg/B", module("struct B { A a; };")) + idl("p/msg/C", C),
    idl("p/msg/A", '#include "p/msg/A.idl"\nmodule p {'),
    f"{LINE}SRV: p/srv/A\nint8 a\n",
    f"{LINE}SRV: p/msg/A\nint8 a\n---\n",
    f"{LINE}ACTION: p/action/A\nint8 a\n---\n",
    f"int8 a\n{LINE}JSON: p/B\nint8 b",
    f"{LINE}{LINE}",
    "/*" * 50_000,
]


@pytest.mark.parametrize("text", HOSTILE, ids=range(len(HOSTILE)))
def test_refused(text):
    for type_ in ("p/msg/A", "p/srv/A_Event"):
        with pytest.raises(rj.SchemaError):
            names(type_, text)


# --- headers without their package, and names with the folder -----------------------------------------------------------------


@pytest.mark.parametrize("word", ["Header", "std_msgs/Header", "std_msgs/msg/Header"])
@pytest.mark.parametrize("encoding", ["cdr", "ros1"])
def test_headers(word, encoding):
    found = rj.Decoder.of("p/A", encoding=encoding, schema=f"{word} header\n", backend="interpreter").new()
    assert found.header.frame_id == ""
    own = f"{word} header\n{LINE}MSG: std_msgs/Header\nint8 mine\n"
    assert rj.Decoder.of("p/A", encoding=encoding, schema=own, backend="interpreter").new().to_dict() == {"header": {"mine": 0}}


def test_arrays_of_headers():
    assert names("p/msg/A", "Header[] all\nHeader[2] two\n") == ["all", "two"]


def test_a_header_of_the_own_package_comes_first():
    text = f"Header header\n{LINE}MSG: p/Header\nint8 mine\n"
    assert rj.Decoder.of("p/msg/A", encoding="cdr", schema=text, backend="interpreter").new().to_dict() == {"header": {"mine": 0}}
    files = {"p/msg/A.msg": "Header header\n", "p/msg/Header.msg": "int8 mine\n"}
    decode = rj.Decoder.of("p/msg/A", encoding="cdr", schema=files, imports=["p/msg/A.msg"], backend="interpreter")
    assert decode.new().to_dict() == {"header": {"mine": 0}}


def test_only_a_word_alone_is_of_another_package():
    with pytest.raises(rj.SchemaError, match="no definition of `p/msg/Header`"):
        names("p/msg/A", "Header one\np/Header two\n")
