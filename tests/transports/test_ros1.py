"""Topics and services of ROS 1: against recorded connections of rospy, with each other, and with rosmaster and rospy where installed."""

from __future__ import annotations

import json
import os
import socket
import struct
import subprocess
import sys
from pathlib import Path

import pytest

import rosetta_jit as rj
from rosetta_jit.errors import AddressError, TransportError
from rosetta_jit.transports.base import Source
from rosetta_jit.transports.feeding import Feed, ProtocolError
from rosetta_jit.transports.opening import names as names_at
from rosetta_jit.transports.ros1.tcpros import header, messages, read_header
from rosetta_jit.transports.ros1.xmlrpc import ask as ask_node
from tests.transports.free import answers, free_port, running, until
from tests.transports.ros_master import Master

VECTORS = Path(__file__).resolve().parent.parent / "vectors" / "ros" / "tcpros.json"
LIVE = {each["name"]: each for each in json.loads(VECTORS.read_text())["connections"]}
STRING = "&type=std_msgs/String&md5=992ce8a1687cec8c8bd883ec73ca41d1"
DEBIAN = "/usr/bin/python3"
"""The interpreter that has Debian's rospy."""


def text(data):
    return struct.pack("<I", len(data)) + data


def read(stream, pieces=None):
    found, got = [], []

    def machine():
        found.append((yield from read_header()))
        yield from messages(lambda data: got.append(bytes(data)), 1000)

    feed = Feed(machine())
    for each in pieces or [stream]:
        feed.feed(each)
    return found, got, feed


def test_the_header_and_messages_of_rospy_are_read_wherever_a_read_ends():
    stream = bytes.fromhex(LIVE["publisher"]["server"])
    for at in range(len(stream) + 1):
        (fields,), got, feed = read(stream, [stream[:at], stream[at:]])
        assert (fields["type"], fields["latching"], fields["message_definition"]) == ("std_msgs/String", "1", "string data\n")
        assert got == [text(b"the first")]
        assert feed.is_between
        assert read(stream[:at])[2].is_between == (at in (155, len(stream)))


def test_headers_are_written_as_rospy_writes_them():
    for name in ("publisher", "service", "subscriber", "publisher_refuses"):
        stream = bytes.fromhex(LIVE[name]["client"] if name == "subscriber" else LIVE[name]["server"])
        (size,) = struct.unpack_from("<I", stream)
        (fields,), _, _ = read(stream[: 4 + size])
        assert header(fields) == stream[: 4 + size]


@pytest.mark.parametrize(
    ("stream", "said"),
    [
        (b"GET / HTTP/1.1\r\n", "a header of"),
        (b"\4\0\0\0\xff\xff\xff\x7f", "go beyond its end"),
        (b"\6\0\0\0\2\0\0\0ab", "without a value"),
        (b"\0\0\0\0\xff\xff\xff\xff", "more than max_message=1000"),
    ],
)
def test_what_is_no_tcpros_ends_its_connection(stream, said):
    with pytest.raises(ProtocolError, match=said):
        read(stream)


@pytest.fixture
def master():
    master = Master()
    yield master
    master.close()


@pytest.fixture
def at(master):
    return lambda name, more="": f"ros1:{name}?master={master.uri}{more}"


def test_messages_reach_subscribers_of_before_and_after(at):
    with (
        rj.subscribe(at("/chat", "&name=/one")) as early,
        rj.publish(at("/chat", f"{STRING}&latch=yes"), definition="string data\n") as sink,
    ):
        until(lambda: sink.connections)
        sink.send(text(b"hello"))
        one = early.take(5)
        assert (one.data, one.channel, one.type) == (text(b"hello"), "/chat", "std_msgs/String")
        assert one.attributes["definition"] == "string data\n"
        assert one.attributes["latching"]
        with rj.subscribe(at("/chat", f"{STRING}&name=/two")) as late, rj.subscribe(at("/chat")) as same_node:
            assert late.take(5).data == same_node.take(5).data == text(b"hello")
        assert names_at(at("/")) == [("/chat", "std_msgs/String")]
        assert (sink.flush(), dict(sink.lost), dict(early.lost)) == (True, {}, {})


def test_what_has_one_subscriber_goes_the_shortest_way(at):
    with rj.publish(at("/chat", STRING)) as sink, rj.publish(at("/kept", f"{STRING}&latch=yes")) as latched:
        assert not sink.at_once(text(b"nobody"))
        with rj.subscribe(at("/chat", "&name=/one")) as one, rj.subscribe(at("/kept", "&name=/one")) as late:
            until(lambda: sink.connections and latched.connections)
            assert sink.at_once(text(b"hello"))
            assert one.take(5).data == text(b"hello")
            assert (sink.messages, sink.bytes) == (1, len(text(b"hello")))
            assert not sink.at_once(bytes(sink._most + 1))
            assert not latched.at_once(text(b"hello"))  # it has to be kept for later ones
            with rj.subscribe(at("/chat", "&name=/two")):
                until(lambda: sink.connections == 2)
                assert not sink.at_once(text(b"both"))
            assert late.take(0.05) is None
        assert (sink.messages, dict(sink.lost), dict(latched.lost)) == (1, {}, {})
    assert not sink.at_once(text(b"closed"))


def test_another_type_is_refused_and_said(at):
    with rj.publish(at("/chat", STRING)) as sink:
        for more in ("&md5=00000000000000000000000000000000", "&type=std_msgs/Int8"):
            with rj.subscribe(at("/chat", f"{more}&name=/bad")) as source:
                until(lambda: source.lost)
                assert "the publisher refuses: another" in next(iter(source.lost))
                assert not source.messages
        assert not sink.connections
        with pytest.raises(TransportError, match="says its type"):
            rj.publish(at("/other", "&type=std_msgs/String"))
        with pytest.raises(TransportError, match="already"):
            rj.publish(at("/chat", STRING))


def test_a_publisher_may_die_and_come_back(at, master):
    with rj.subscribe(at("/chat", "&name=/listener")) as source:
        for number in range(2):
            with rj.publish(at("/chat", f"{STRING}&name=/talker")) as sink:
                until(lambda: sink.connections)
                sink.send(text(b"%d" % number))
                assert source.take(5).data == text(b"%d" % number)
            until(lambda: not source.connections)
        assert source.reconnects == 1


def test_a_publisher_that_dies_in_the_middle_of_a_message(at, master):
    """By hand: the recorded answer of rospy's publisher, cut."""
    stream = bytes.fromhex(LIVE["publisher"]["server"])
    with socket.create_server(("127.0.0.1", 0)) as listening:
        port = listening.getsockname()[1]
        fake = Master()  # answers requestTopic, too
        fake.requestTopic = lambda *_: [1, "", ["TCPROS", "127.0.0.1", port]]
        master.registerPublisher("/fake", "/chat", "std_msgs/String", fake.uri)
        with rj.subscribe(at("/chat")) as source:
            peer, _ = listening.accept()
            with peer:
                wanted = peer.recv(4096)
                assert b"topic=/chat" in wanted
                peer.sendall(stream[:-3])
                until(lambda: source.connections)
            until(lambda: source.lost)
            assert source.lost == {"the connection ended in the middle of a message": 1}
            peer, _ = listening.accept()  # and it is tried again
            with peer:
                peer.recv(4096)
                peer.sendall(stream)
                assert source.take(5).data == text(b"the first")
        fake.close()


def test_a_master_may_restart(at, master, monkeypatch):
    monkeypatch.setattr("rosetta_jit.transports.ros1.node.HEARTBEAT_S", 0.05)
    with rj.publish(at("/chat", f"{STRING}&name=/talker")) as sink, rj.subscribe(at("/chat", "&name=/listener")) as source:
        until(lambda: sink.connections)
        port = master.port
        master.close()
        sink.send(text(b"meanwhile"))
        assert source.take(5).data == text(b"meanwhile")
        again = Master(port)
        until(lambda: again.publishers.get("/chat") and again.subscribers.get("/chat"))
        again.close()
        master.server = Source("nothing", None, None)  # closed already
        master.server.shutdown = master.server.server_close = lambda: None


def test_without_a_master_it_is_said_or_waited_for():
    port = free_port()
    with pytest.raises(TransportError, match="no answer"):
        rj.subscribe(f"ros1:/chat?master=http://127.0.0.1:{port}")
    with rj.subscribe(f"ros1:/chat?master=http://127.0.0.1:{port}&patient=yes"):
        late = Master(port)
        until(lambda: late.subscribers.get("/chat"))
    late.close()


def test_services_answer_and_fail(at):
    def answer(message):
        if message.data == b"bad":
            raise ValueError("no such thing")
        return bytes(message.data).upper()

    with rj.serve(at("/up"), answer) as server, rj.call(at("/up", "&name=/asker")) as ask:
        assert ask(b"abc").data == b"ABC"
        with pytest.raises(TransportError, match="ValueError: no such thing"):
            ask(b"bad")
        assert ask(b"").data == b""
        assert (server.connections, server.lost) == (1, {"the answer failed": 1})
    with rj.call(at("/up")) as ask, pytest.raises(TransportError, match="knows no such service"):
        ask(b"")


def test_a_service_of_rospy_as_it_was_recorded(at, master):
    stream = bytes.fromhex(LIVE["service"]["server"])
    with socket.create_server(("127.0.0.1", 0)) as listening:
        master.services["/trig"] = f"rosrpc://127.0.0.1:{listening.getsockname()[1]}"
        with rj.call(at("/trig")) as ask:
            parts = [stream[: 4 + 0x69], *(b"\1" + text(text(b"done").join([b"\1", b""])),) * 2]
            import threading

            def play():
                peer, _ = listening.accept()
                with peer:
                    peer.recv(4096)
                    for each in parts:
                        peer.sendall(each)
                        peer.recv(4096)

            thread = threading.Thread(target=play)
            thread.start()
            assert ask(b"").data == b"\1" + text(b"done")
            assert ask(b"").data == b"\1" + text(b"done")
        thread.join()


def test_another_type_of_a_service_is_refused(at):
    with (
        rj.serve(at("/up", "&md5=" + "1" * 32), lambda _: b""),
        rj.call(at("/up", "&md5=" + "2" * 32)) as ask,
        pytest.raises(TransportError, match="another md5 sum") as caught,
    ):
        ask(b"")
    assert caught.value.kind == "type"


def test_garbage_and_a_hundred_connections_cost_nobody_else(at, master):
    with rj.publish(at("/chat", STRING)) as sink, rj.subscribe(at("/chat")) as source:
        until(lambda: sink.connections)
        uri = next(iter(master.publishers["/chat"]))
        place = ask_node(uri, "requestTopic", "/x", "/chat", [["TCPROS"]])
        peers = [socket.create_connection((place[1], place[2])) for _ in range(100)]
        for number, each in enumerate(peers):
            each.sendall(b"garbage" * 100 if number % 2 else header({"topic": "/nope"}))
        for each in peers:
            while each.recv(4096):
                pass
            each.close()
        for method, arguments in (
            ("nonsense", ()),
            ("requestTopic", ()),
            ("requestTopic", ("/x", "/nope", [])),
            ("requestTopic", ("/x", "/chat", [])),
        ):
            with pytest.raises(TransportError):
                ask_node(uri, method, *arguments)
        sink.send(text(b"still"))
        assert source.take(5).data == text(b"still")


def test_a_slow_subscriber_loses_its_own_messages_with_a_counter(at, master):
    with rj.publish(at("/chat", STRING)) as sink, rj.subscribe(at("/chat")) as source:
        until(lambda: sink.connections)
        place = ask_node(next(iter(master.publishers["/chat"])), "requestTopic", "/x", "/chat", [["TCPROS"]])
        with socket.create_connection((place[1], place[2])) as slow:
            slow.sendall(header({"callerid": "/slow", "topic": "/chat", "type": "std_msgs/String", "md5sum": "*"}))
            until(lambda: sink.connections == 2)
            message = text(bytes(1 << 20))
            for _ in range(60):
                sink.send(message)
                assert source.take(5).data == message
            dropped = sink.lost["the subscriber is too slow"]
            assert dropped > 10
        until(lambda: sink.connections == 1)
        until(lambda: sink.lost["the subscriber went away"])
        assert 10 <= sink.lost["the subscriber went away"] <= 60 - dropped  # 16 MiB waited


def test_names_that_ros_does_not_have():
    for wrong in ("chat", "/a b", "/1", "/a//b", "/a/"):
        with pytest.raises(AddressError, match="a name of ROS 1"):
            rj.subscribe(f"ros1:{wrong}")


NODE = """
import rospy
from std_msgs.msg import String
from std_srvs.srv import Trigger, TriggerResponse
rospy.init_node("peer")
back = rospy.Publisher("/back", String, queue_size=10)
while not back.get_num_connections():
    rospy.sleep(0.01)
rospy.Subscriber("/chat", String, lambda message: back.publish(message.data.upper()))
rospy.Service("/trig", Trigger, lambda _: TriggerResponse(True, "done"))
rospy.wait_for_service("/ours", 20)
back.publish(rospy.ServiceProxy("/ours", Trigger)().message)
rospy.spin()
"""
MASTER = "import sys, time, rosmaster.master as m; n = m.Master(int(sys.argv[1])); n.start(); time.sleep(1000)"


def has_rospy():
    if not Path(DEBIAN).exists():
        return False
    return subprocess.run([DEBIAN, "-c", "import rospy, rosmaster, std_srvs"], capture_output=True, check=False).returncode == 0


@pytest.mark.skipif(
    sys.platform != "linux" or not Path("/usr/lib/python3/dist-packages/rospy").exists(), reason="Debian's python3-rospy is not installed"
)
def test_with_rosmaster_and_rospy(tmp_path):
    if not has_rospy():
        pytest.skip("python3-rospy, python3-rosmaster and python3-std-srvs are not all installed")
    port = free_port()
    env = {
        **os.environ,
        "ROS_MASTER_URI": f"http://127.0.0.1:{port}",
        "ROS_IP": "127.0.0.1",
        "ROS_HOME": str(tmp_path),
        "HOME": str(tmp_path),
    }
    trigger = "&type=std_srvs/Trigger&md5=937c9679a518e3a18d831e57125ea522"
    with running(DEBIAN, "-c", MASTER, port, env=env):
        until(lambda: answers(port))
        at = f"?master=http://127.0.0.1:{port}"
        with (
            rj.serve(f"ros1:/ours{at}{trigger}", lambda _: b"\1" + text(b"ours")),
            rj.publish(f"ros1:/chat{at}{STRING}&latch=yes") as chat,
            rj.subscribe(f"ros1:/back{at}") as back,
            running(DEBIAN, "-c", NODE, env=env),
            rj.call(f"ros1:/trig{at}{trigger}") as ask,
        ):
            assert chat.send(text(b"hello"))
            got = [back.take(20), back.take(20)]
            assert {each.data for each in got} == {text(b"HELLO"), text(b"ours")}
            assert (got[0].type, got[0].attributes["callerid"]) == ("std_msgs/String", "/peer")
            assert ask(b"").data == b"\1" + text(b"done")
