"""Services and actions: the messages in their files, and those that genmsg, actionlib and rosidl make for them."""

from __future__ import annotations

import pytest

import rosetta_jit as rj
from rosetta_jit.frameworks.ros1.idl import parse as parse1
from rosetta_jit.frameworks.ros2.idl import parse as parse2
from rosetta_jit.frameworks.ros2.type_hash import rihs01
from rosetta_jit.parsing.search import SearchPath
from rosetta_jit.source import Source
from tests.frameworks.ros.ros_files import debian

ADD = "int64 a\nint64 b\n---\nint64 sum\n"
FIBONACCI = "# goal\nint32 order\n---\n# result\nint32[] sequence\n---\n# feedback\nint32[] sequence\n"
GOALS = "geometry_msgs/Pose pose\nstring name\n---\n---\nfloat32 SOON=0.5\nfloat32 left\n"


def read(parse, file, text):
    search = SearchPath.of()
    return parse(Source(file, text), search.find)


def own(schema, package):
    return {name: [each.name for each in struct.fields] for name, struct in schema.types.items() if name.startswith(f"{package}/")}


def test_services_of_ros1():
    schema = read(parse1, "pkg/srv/Add.srv", ADD)
    assert own(schema, "pkg") == {"pkg/AddRequest": ["a", "b"], "pkg/AddResponse": ["sum"]}


def test_services_of_ros2():
    schema = read(parse2, "pkg/srv/Add.srv", ADD)
    assert own(schema, "pkg") == {
        "pkg/srv/Add": ["request_message", "response_message", "event_message"],
        "pkg/srv/Add_Event": ["info", "request", "response"],
        "pkg/srv/Add_Request": ["a", "b"],
        "pkg/srv/Add_Response": ["sum"],
    }


SUMS = {
    "pkg/FibonacciAction": "f59df5767bf7634684781c92598b2406",
    "pkg/FibonacciActionGoal": "006871c7fa1d0e3d5fe2226bf17b2a94",
    "pkg/FibonacciActionResult": "bee73a9fe29ae25e966e105f5553dd03",
    "pkg/FibonacciActionFeedback": "73b8497a9f629a31c0020900e4148f07",
    "pkg/FibonacciGoal": "6889063349a00b249bd1661df429d822",
    "pkg/FibonacciResult": "b81e37d2a31925a0e8ae261a8699cb79",
    "pkg/FibonacciFeedback": "b81e37d2a31925a0e8ae261a8699cb79",
}
"""As actionlib_tutorials has them."""


def test_sums_of_actions():
    schema = read(parse1, "pkg/action/Fibonacci.action", FIBONACCI)
    assert {name: schema.types[name].option("md5sum") for name in own(schema, "pkg")} == SUMS


def test_sums_of_services():
    schema = read(parse1, "rospy_tutorials/srv/AddTwoInts.srv", ADD)
    request, response = schema.types["rospy_tutorials/AddTwoIntsRequest"], schema.types["rospy_tutorials/AddTwoIntsResponse"]
    assert request.option("service_md5sum") == response.option("service_md5sum") == "6a2e34150c00229791cc89ff309fff21"
    assert request.option("md5sum") == "36d09b846be0b371c5f190354dd3153e"
    assert response.option("md5sum") == "b88405221c77b1878a3cbbfff53428d7"


SERVICES = {
    "Plain": ADD,
    "Nothing": "---\n",
    "Dashes": "int8 a # first\n---------\nint8 b",
    "Constants": "int8 LOW=1\nbyte x\n---\nstring WORD= two words # kept \nchar y\n",
}


@pytest.mark.parametrize("name", SERVICES)
def test_genmsg_agrees(name):
    loader, gentools = debian("genmsg", "msg_loader"), debian("genmsg", "gentools")
    context = loader.MsgContext.create_default()
    theirs = loader.load_srv_from_string(context, SERVICES[name], f"pkg/{name}")
    schema = read(parse1, f"pkg/srv/{name}.srv", SERVICES[name])
    for half, end in ((theirs.request, "Request"), (theirs.response, "Response")):
        ours = schema.types[f"pkg/{name}{end}"]
        assert [each.name for each in ours.fields] == half.names
        assert ours.option("md5sum") == gentools.compute_md5(context, half)
        assert ours.option("service_md5sum") == gentools.compute_md5(context, theirs)


HASHES = [
    ("example_interfaces/srv/AddTwoInts", ADD, "", "e118de6bf5eeb66a2491b5bda11202e7b68f198d6f67922cf30364858239c81a"),
    ("example_interfaces/action/Fibonacci", FIBONACCI, "_SendGoal", "d1a57fb2a4afe8c21e34fb10db206f16ce6729b28531141472df92277c55b557"),
    ("example_interfaces/action/Fibonacci", FIBONACCI, "_GetResult", "1b0de0d5d29dc955d92f546706568428632771db13ec84c15ec1c1a59f424a57"),
]
"""As they are published, in documentation of rmw_zenoh and in tests of others."""


@pytest.mark.parametrize(("name", "text", "service", "digits"), HASHES)
def test_type_hashes(name, text, service, digits):
    kind = name.split("/")[1]
    schema = read(parse2, f"{name}.{kind}", text)
    assert rihs01(schema.types[name + service], schema) == f"RIHS01_{digits}"


@pytest.mark.parametrize(("kind", "text"), [("srv", ADD), ("srv", "---"), ("action", FIBONACCI), ("action", GOALS)])
def test_rosidl_agrees(kind, text):
    parser = debian("rosidl_adapter", "parser")
    schema = read(parse2, f"pkg/{kind}/Name.{kind}", text)
    if kind == "srv":
        whole = parser.parse_service_string("pkg", "Name", text)
        parts = [whole.request, whole.response]
    else:
        whole = parser.parse_action_string("pkg", "Name", text)
        parts = [whole.goal, whole.result, whole.feedback]
    for part in parts:
        ours = schema.types[f"pkg/{kind}/{part.msg_name}"]
        assert [each.name for each in ours.fields] == ([each.name for each in part.fields] or ["structure_needs_at_least_one_member"])
        assert [each.name for each in ours.constants] == [each.name for each in part.constants]


FOUND = [
    ("ros1", "probe/AddRequest", "srv/Add.srv", ADD, "ros1", "01000000000000000200000000000000", {"a": 1, "b": 2}),
    ("ros1", "probe/AddResponse", "srv/Add.srv", ADD, "ros1", "0300000000000000", {"sum": 3}),
    ("ros2", "probe/srv/Add_Request", "srv/Add.srv", ADD, "cdr", "0001000001000000000000000200000000000000", {"a": 1, "b": 2}),
    ("ros1", "probe/FibonacciGoal", "action/Fibonacci.action", FIBONACCI, "ros1", "05000000", {"order": 5}),
    ("ros2", "probe/action/Fibonacci_Result", "action/Fibonacci.action", FIBONACCI, "cdr", "000100000100000007000000", {"sequence": [7]}),
]


@pytest.mark.parametrize("named", [True, False])
@pytest.mark.parametrize(("framework", "name", "file", "text", "encoding", "data", "value"), FOUND, ids=[each[1] for each in FOUND])
def test_found_on_the_search_path(framework, name, file, text, encoding, data, value, named, tmp_path):
    path = tmp_path / "probe" / file
    path.parent.mkdir(parents=True)
    path.write_text(text)
    options = {"framework": framework} if named else {"encoding": encoding}
    decode = rj.Decoder.of(name, search_path=[tmp_path], backend="interpreter", **options)
    encode = rj.Encoder.of(name, search_path=[tmp_path], backend="interpreter", **options)
    holder = decode(bytes.fromhex(data))
    assert holder.to_dict() == value
    assert bytes(encode(holder)) == bytes.fromhex(data)


def test_a_sent_goal():
    given = {"schema": {"probe/action/Go.action": GOALS}, "encoding": "cdr", "backend": "interpreter"}
    encode = rj.Encoder.of("probe/action/Go_SendGoal_Request", **given)
    goal = encode.holder_type()
    goal.goal_id.uuid = bytes(range(16))
    goal.goal.name = "home"
    again = rj.Decoder.of("probe/action/Go_SendGoal_Request", **given)(encode(goal))
    assert (bytes(again.goal_id.uuid), again.goal.name) == (bytes(range(16)), "home")


def test_holders_of_ros1():
    kind = rj.Decoder.of("probe/AddRequest", schema={"probe/srv/Add.srv": ADD}, framework="ros1", backend="interpreter").holder_type
    assert (kind._type, kind._md5sum, kind.__slots__) == ("probe/AddRequest", "36d09b846be0b371c5f190354dd3153e", ("a", "b"))
