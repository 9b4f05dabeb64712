"""LCM, MQTT, zenoh, ROS 2 over zenoh and DDS, shared memory, by the clients of other projects; skipped where a client is absent."""

from __future__ import annotations

import shutil
import struct
import time

import pytest

import rosetta_jit as rj
from rosetta_jit.errors import AddressError, MissingPackage, TransportError
from rosetta_jit.transports.opening import names as names_at
from rosetta_jit.transports.ros2_names import plain
from tests.transports.free import answers, free_port, running, until

MOSQUITTO = shutil.which("mosquitto", path="/usr/sbin:/usr/bin:/usr/local/sbin")
STRING = b"\0\1\0\0\3\0\0\0hi\0\0"
"""A std_msgs/msg/String as CDR."""


def test_a_package_that_is_missing_is_named(monkeypatch):
    monkeypatch.setattr("rosetta_jit.transports.opening.find_spec", lambda _: None)
    for address, extra in (
        ("lcm:A", "lcm"),
        ("mqtt:a", "mqtt"),
        ("zenoh:a", "zenoh"),
        ("ros2-dds:/a", "cyclonedds"),
        ("iceoryx:a", "iceoryx"),
    ):
        with pytest.raises(MissingPackage, match=rf"pip install 'rosetta-jit\[{extra}\]'"):
            rj.subscribe(address)


@pytest.mark.parametrize(
    "address",
    ["lcm:", "lcm:a\nb", "mqtt:", "zenoh:a//b", "zenoh:/a", "ros2-zenoh:chatter", "ros2-dds:/a b?type=std_msgs/msg/String", "iceoryx:"],
)
def test_channels_that_are_none(address):
    with pytest.raises(AddressError, match="this is not"):
        rj.subscribe(address)


def test_lcm():
    pytest.importorskip("lcm")
    url = f"udpm://239.255.76.67:{free_port()}?ttl=0"
    with rj.subscribe("lcm:POSE.*", url=url) as source, rj.publish("lcm:POSE_LEFT", url=url) as sink:
        sink.send(struct.pack(">qd", 1234, 2.5))
        message = source.take(5)
        assert (message.data, message.channel, message.attributes) == (struct.pack(">qd", 1234, 2.5), "POSE_LEFT", {"fingerprint": 1234})
    with pytest.raises(TransportError, match="closed"):
        sink.send(b"x")
    with pytest.raises(TransportError, match="cannot open"):
        rj.subscribe("lcm:A", url="nonsense://")


@pytest.mark.skipif(MOSQUITTO is None, reason="mosquitto is not installed")
def test_mqtt():
    pytest.importorskip("paho")
    port = free_port()
    at = f"?port={port}"
    with pytest.raises(TransportError, match="no broker answers"):
        rj.publish(f"mqtt:a{at}")
    with running(MOSQUITTO, "-p", port) as broker:
        until(lambda: answers(port))
        with (
            rj.publish(f"mqtt:robot/left/joints{at}&qos=1&retain=yes") as sink,
            rj.subscribe(f"mqtt:robot/+/joints{at}&qos=1&max_message=1k") as source,
        ):
            sink.send(b"hello")
            message = source.take(5)
            assert (message.data, message.channel, message.attributes["qos"]) == (b"hello", "robot/left/joints", 1)
            sink.send(bytes(2000))
            sink.send(b"last", attributes={"retain": False})
            assert source.take(5).data == b"last"
            assert source.lost == {"a message of 2000 bytes, more than max_message=1024": 1}
            assert sink.flush()
            broker.kill()
            until(lambda: not sink.connections and not source.connections)
            sink.send(b"kept until the broker is back")
            with running(MOSQUITTO, "-p", port):
                until(lambda: source.connections and sink.connections)
                message = source.take(5)
                assert message.data == b"kept until the broker is back"
                assert (source.reconnects, sink.reconnects) == (1, 1)
    with pytest.raises(AddressError, match="without `\\+` and `#`"):
        rj.publish(f"mqtt:a/+{at}")


def test_zenoh():
    pytest.importorskip("zenoh")
    place = f"tcp/127.0.0.1:{free_port()}"
    with rj.subscribe("zenoh:robot/**", listen=place) as source, rj.publish("zenoh:robot/arm", connect=place) as sink:
        until(lambda: sink.send(b"find") and source.take(0.05))
        while source.take(0.2):
            pass
        sink.send(b"hello", attributes={"attachment": b"more", "encoding": "application/cdr"})
        message = source.take(5)
        assert (message.data, message.channel, message.type) == (b"hello", "robot/arm", "application/cdr")
        assert message.attributes["attachment"] == b"more"
        with (
            rj.serve("zenoh:up", lambda question: bytes(question.data).upper() if question.data else 1 // 0, listen=place),
            rj.call("zenoh:up", connect=place) as ask,
            rj.call("zenoh:nobody", connect=place) as nobody,
        ):
            until(lambda: works(ask))
            assert ask(b"abc").data == b"ABC"
            with pytest.raises(TransportError, match="ZeroDivisionError"):
                ask(b"")
            with pytest.raises(TransportError, match="nobody answers"):
                nobody(b"x")
    with pytest.raises(TransportError, match="cannot open a session"):
        rj.subscribe("zenoh:a", listen="nonsense/1")


def works(ask):
    try:
        return ask(b"x", timeout=1)
    except TransportError:
        return None


def test_ros2_over_zenoh():
    pytest.importorskip("zenoh")
    place, hash_ = f"tcp/127.0.0.1:{free_port()}", "RIHS01_" + "0" * 64
    how = {"type": "std_msgs/msg/String", "hash": hash_}
    with rj.subscribe("ros2-zenoh:/chatter", listen=place) as source, rj.publish("ros2-zenoh:/chatter", connect=place, **how) as sink:
        until(lambda: sink.send(STRING) and source.take(0.05))
        while source.take(0.2):
            pass
        sink.send(STRING, time=1_700_000_000_000_000_001)
        message = source.take(5)
        assert (message.data, message.channel, message.type, message.sent) == (
            STRING,
            "/chatter",
            "std_msgs/msg/String",
            1_700_000_000_000_000_001,
        )
        assert message.attributes["hash"] == hash_
        assert message.attributes["sequence"] == sink.messages
        assert names_at(f"ros2-zenoh:/?listen={place}") == [("/chatter", "std_msgs/msg/String")]
        with rj.subscribe(f"zenoh:0/chatter/**?listen={place}") as below:  # the names that rmw_zenoh gives them
            sink.send(STRING)
            assert below.take(5).channel == f"0/chatter/std_msgs::msg::dds_::String_/{hash_}"
    with pytest.raises(TransportError, match="says its type and its hash"):
        rj.publish("ros2-zenoh:/chatter", type="std_msgs/msg/String")


def test_both_forms_of_rmw_zenohs_attachments():
    pytest.importorskip("zenoh")
    from rosetta_jit.transports.zenoh.ros2 import attachment_of

    gid = bytes(range(16))
    plain_form = struct.pack("<qqB", 5, 17, 16) + gid
    named = b"\x0fsequence_number" + plain_form[:8] + b"\x10source_timestamp" + plain_form[8:16] + b"\x0asource_gid" + plain_form[16:]
    assert attachment_of(plain_form) == attachment_of(named) == {"sequence": 5, "sent": 17, "gid": gid.hex()}
    for wrong in (b"", b"x" * 33, plain_form[:-1], named[:-1], named + b"x", b"\x0fsequence_number"):
        assert attachment_of(wrong) == {}


def test_ros2_over_dds():
    pytest.importorskip("cyclonedds")
    more = "?type=std_msgs/msg/String&domain=77"
    with rj.subscribe(f"ros2-dds:/chatter{more}") as source, rj.publish(f"ros2-dds:/chatter{more}") as sink:
        until(lambda: sink.connections and source.connections)
        sink.send(STRING, time=1_700_000_000_000_000_001)
        message = source.take(5)
        assert (message.data, message.channel, message.type, message.sent) == (
            STRING,
            "/chatter",
            "std_msgs/msg/String",
            1_700_000_000_000_000_001,
        )
        for data in (b"\0\1\0\0hello world!", b"\0\7\0\0" + b"\xff" * 40, b"\0\1\0\0" + bytes(range(200)) * 100):
            sink.send(data)
            assert source.take(5).data == data
        for wrong, said in ((b"x", "four bytes"), (b"\0\0\0\0" + bytes(8), "big-endian")):
            with pytest.raises(TransportError, match=said):
                sink.send(wrong)
    assert plain("std_msgs::msg::dds_::String_") == "std_msgs/msg/String"
    with pytest.raises(TransportError, match="say `type=`"):
        rj.subscribe("ros2-dds:/chatter")


def test_a_reader_of_cyclonedds_with_a_type_of_its_own():
    pytest.importorskip("cyclonedds")
    from cyclonedds.domain import DomainParticipant
    from cyclonedds.idl import make_idl_struct
    from cyclonedds.sub import DataReader
    from cyclonedds.topic import Topic

    text = make_idl_struct("String_", "std_msgs::msg::dds_::String_", {"data": str})
    participant = DomainParticipant(77)
    reader = DataReader(participant, Topic(participant, "rt/own", text))
    with rj.publish("ros2-dds:/own", type="std_msgs/msg/String", domain=77, struct=text) as sink:
        until(lambda: sink.connections)
        sink.send(STRING)
        found = []
        until(lambda: found.extend(reader.take()) or found)
        assert found[0].data == "hi"


def test_shared_memory():
    pytest.importorskip("iceoryx2")
    name = f"iceoryx:test/{free_port()}/{time.time_ns()}"
    with rj.subscribe(name) as source, rj.publish(name, first=100) as sink:
        for data in (b"abc", b"", b"x" * 300_000):
            assert sink.send(data)
            assert source.take(5).data == data
        assert sink.connections == 1
    first = []
    with rj.subscribe(name, lambda message: first.append(message.data[0])), rj.publish(name) as sink:  # as it lies in shared memory
        sink.send(b"abc")
        until(lambda: first == [ord("a")])
    with pytest.raises(TransportError, match="closed"):
        sink.send(b"x")
