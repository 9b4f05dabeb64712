"""Routes that run, over sockets of this machine: what arrives, what targets are told, other files, and what comes back."""

from __future__ import annotations

import struct
import sys
import threading

import pytest

import rosetta_jit as rj
from rosetta_jit.bridge.announcing import announced
from rosetta_jit.bridge.checking import checked
from rosetta_jit.bridge.metrics import text
from rosetta_jit.bridge.table import rows
from rosetta_jit.bridge.translating import Bridged, Unchanged
from rosetta_jit.transports.loop import loop
from tests.bridge.routes import MAPPED, route
from tests.transports.free import free_port, until
from tests.transports.name_server import NameServer
from tests.transports.ros_master import Master


def test_messages_are_translated(run, bottles):
    source, target, raw = free_port(), free_port(), free_port()
    with rj.subscribe(f"tcp:{target}") as mapped, rj.subscribe(f"tcp:{raw}") as as_they_are:
        bridge, said = run(route(source, target, 'name = "a"', MAPPED) + route(source, raw, 'name = "b"'))
        with rj.publish(f"tcp:{source}") as robot:
            for each in bottles:
                robot.send(each)
            angles = rj.Decoder.of("rst.kinematics.JointAngles")
            found = [angles(mapped.take(5).data).angles[0] for _ in bottles]
            assert found == pytest.approx([float(number) for number in range(100)], rel=1e-6)
            assert [as_they_are.take(5).data for _ in bottles] == bottles
            robot.send(b"no bottle")
            robot.send(b"no bottle")
            until(lambda: bridge.snapshot()[0]["failed"])
            until(lambda: bridge.snapshot()[1]["sent"] == 102)
        one, two = bridge.snapshot()
        assert (one["taken"], one["sent"], two["sent"], one["dropped"]) == (102, 100, 102, {})
        assert (sum(one["failed"].values()), two["failed"]) == (2, {})
        assert len([line for line in said if "failed: " in line]) == 1  # the second of a kind is counted, and not said
        assert 0 < one["p50_us"] <= one["p99_us"]


def test_a_message_passes_through_few_functions(run, bottles):
    """Between messages of a thousand a second other programs have the processor's caches: each function takes 1.5 µs."""
    source, target, called = free_port(), free_port(), []

    def note(frame, event, _):
        if event == "call" and "rosetta_jit" in frame.f_code.co_filename:
            called.append(frame.f_code.co_name)

    with rj.subscribe(f"tcp:{target}", lambda message: arrived.append(message.data)), rj.publish(f"tcp:{source}?listen=yes") as robot:
        arrived = []
        bridge, _ = run(route(f"{source}?listen=no", f"{target}", MAPPED))
        until(lambda: robot.connections and bridge.snapshot()[0]["connections"] == {"source": 1, "target": 1})
        robot.send(bottles[0])
        until(lambda: arrived)
        loop().run(sys.setprofile, note)
        robot.send(bottles[1])
        until(lambda: len(arrived) == 2)
        loop().run(sys.setprofile, None)
    begun = called.index("_ready")
    there = called[begun : called.index("passed")]
    assert there == ["_ready", "receive", "take", "deliver", "at_once", "send"]


STATEFUL = {
    "wheel.bottle-schema": '"wheel" (("turns" :int64))',
    "wheel.proto": 'syntax = "proto2"; message Wheel { required int64 turned = 1; }',
    "wheel.mapping": """import "wheel.bottle-schema"
import "wheel.proto"
state last: int64 = 0
state seen: bool = false
state mean: float64 = 1e308
data-holder: Wheel
wire-schema: wheel
unpack-rules:
  .turned = .turns - last if seen else 0
  state last = .turns
  state seen = true
  state mean = mean * 10.0
""",
}


def test_state_is_shown_and_begins_anew_with_the_source_and_with_the_route(run, tmp_path):
    """A robot that was started again counts from 0: the difference to what it said before would mean nothing."""
    for name, content in STATEFUL.items():
        (tmp_path / name).write_text(content)
    write = rj.Encoder.of("wheel", schema=STATEFUL, imports=["wheel.bottle-schema"], encoding="yarp4")
    read = rj.Decoder.of("Wheel", schema=STATEFUL, imports=["wheel.proto"], encoding="protobuf")
    source, target = free_port(), free_port()
    text_of = [
        route(source, target, 'name = "a"', *more, 'mapping = "wheel.mapping"\ndecode = { encoding = "yarp4" }')
        for more in ((), ("queue = 7",))
    ]
    with rj.subscribe(f"tcp:{target}") as there:

        def turned(*turns):
            with rj.publish(f"tcp:{source}") as robot:
                for each in turns:
                    robot.send(write(write.holder_type.from_dict({"turns": each})))
                return [read(there.take(5).data).turned for _ in turns]

        bridge, said = run(text_of[0])
        assert bridge.snapshot()[0]["state"] == {"decode.last": 0, "decode.seen": False, "decode.mean": 1e308}
        assert turned(10, 12, 15) == [0, 2, 3]
        assert bridge.snapshot()[0]["state"] == {"decode.last": 15, "decode.seen": True, "decode.mean": "inf"}
        assert "state: decode.last 15, decode.seen True, decode.mean inf" in "\n".join(rows(bridge.snapshot()))
        shown = text(bridge.snapshot())
        assert 'rosetta_jit_bridge_state{route="a",variable="decode.last"} 15.0\n' in shown
        assert 'rosetta_jit_bridge_state{route="a",variable="decode.seen"} 1.0\n' in shown
        until(lambda: not bridge.snapshot()[0]["connections"]["source"])
        bridge.reload(bridge.configuration)
        assert bridge.snapshot()[0]["state"]["decode.last"] == 15  # a route that did not change goes on
        assert turned(3, 4) == [0, 1]
        assert [line for line in said if "begins anew" in line] == ["a: its source came back, and the state of its mapping begins anew"]
        (tmp_path / "bridge.toml").write_text(text_of[1])
        bridge.reload(checked(str(tmp_path / "bridge.toml")))
        assert bridge.snapshot()[0]["state"]["decode.last"] == 0
        assert turned(9, 10) == [0, 1]


TO_ROS1 = 'decode_type = "std_msgs/msg/Bool"\nencode_type = "std_msgs/Bool"\ndecode = { encoding = "cdr" }\nencode = { encoding = "ros1" }'
BOOL = "8b94c1b53db61fb6aed406028ad6332a"
"""The md5 sum of std_msgs/Bool, as `rosmsg md5` says it."""


def test_the_target_gets_to_know_the_type(run):
    """Its name, md5 sum and text come from what the route writes: a subscriber of ROS 1 that asks for them is served."""
    master, source = Master(), free_port()
    at = f"ros1:/{{}}?master={master.uri}"
    try:
        with rj.subscribe(at.format("on") + f"&type=std_msgs/Bool&md5={BOOL}&name=/reader") as there:
            run(f'[[route]]\nsource = "tcp:{source}"\ntarget = "{at.format("on")}"\n{TO_ROS1}\n')
            with rj.publish(f"tcp:{source}") as robot:
                until(lambda: there.connections)
                robot.send(b"\0\1\0\0\1")
                message = there.take(5)
            assert (message.data, message.type, message.attributes["md5"]) == (b"\1", "std_msgs/Bool", BOOL)
            assert message.attributes["definition"] == "bool data\n"
        assert not there.lost
    finally:
        master.close()


def test_a_source_of_another_type_is_refused_and_said(run):
    """Its messages could be read, as something that they are not."""
    master, target = Master(), free_port()
    at = f"ros1:/on?master={master.uri}"
    mapping = (
        'decode_type = "std_msgs/Bool"\nencode_type = "std_msgs/msg/Bool"\ndecode = { encoding = "ros1" }\nencode = { encoding = "cdr" }'
    )
    try:
        with (
            rj.publish(f"{at}&type=std_msgs/UInt8&md5=7c8164229e7d2c17eb95e9231617fdee&name=/other") as other,
            rj.subscribe(f"tcp:{target}"),
        ):
            bridge, said = run(f'[[route]]\nname = "a"\nsource = "{at}"\ntarget = "tcp:{target}"\n{mapping}\n')
            until(lambda: said)
            other.send(b"\1")
            (shown,) = bridge.snapshot()
            assert "the publisher refuses: another" in said[0]
            assert (shown["taken"], list(shown["dropped"].values())) == (0, [0])
            bridge.stop(0.2)
    finally:
        master.close()


SET = "bool data\n---\nbool success\nstring message\n"
SUM = "09fb03525b03e7ea1fd3992bafd87e16"
"""The md5 sum of such a service, as `rossrv md5 std_srvs/SetBool` says it."""


def test_who_asks_a_service_gets_to_know_its_type(run, tmp_path):
    (tmp_path / "own").mkdir()
    (tmp_path / "own" / "Set.srv").write_text(SET)
    master, inner = Master(), free_port()
    half = '{ encoding = "ros1", imports = ["own/Set.srv"] }'
    at = f"ros1:/set?master={master.uri}"
    try:
        with rj.serve(f"tcp:{inner}", lambda message: bytes(message.data) + bytes(4)):
            request = f'{{ decode_type = "own/SetRequest", decode = {half}, encode = {half} }}'
            bridge, _ = run(f'[[rpc]]\nserve = "{at}"\ncall = "tcp:{inner}"\nrequest = {request}\n')
            with rj.call(f"{at}&md5={SUM}&name=/one") as ask:
                assert ask(b"\1").data == b"\1" + bytes(4)
            with rj.call(f"{at}&md5={'0' * 32}&name=/two") as ask, pytest.raises(rj.TransportError, match="another md5"):
                ask(b"\1")
            bridge.stop(0.2)
    finally:
        master.close()


@pytest.mark.parametrize(
    ("target", "told"),
    [
        ("ros1:/on", {"type", "md5", "definition"}),
        ("ros1:/on?type=std_msgs/Bool", {"md5", "definition"}),
        ("ros1:/on?type=own/Bool", set()),  # of which nothing is known
        ("ros2-dds:/on", set()),  # it is a type of ROS 1
        ("tcp:9000", set()),
    ],
)
def test_what_an_address_says_goes_first(target, told):
    bridge = rj.Bridge.of("std_msgs/msg/Bool", "std_msgs/Bool", decode={"encoding": "cdr"}, encode={"encoding": "ros1"})
    assert announced(target, Bridged(bridge)).keys() == told
    assert announced(target, Unchanged()) == {}


def test_services(run, bottles):
    """An answer that goes through, one that cannot be translated, and messages that ask."""
    outer, inner, source = free_port(), free_port(), free_port()
    asked = []

    def answer(message):
        asked.append(message.data)
        return b"ok " + message.data

    with rj.serve(f"tcp:{inner}", answer):
        bridge, said = run(
            f'[[rpc]]\nname = "as it is"\nserve = "tcp:{outer}"\ncall = "tcp:{inner}"\n'
            f'[[rpc]]\nname = "mapped"\nserve = "tcp:{source}"\ncall = "tcp:{inner}"\nrequest = {{ between = ["yarp3", "yarp4"] }}\n'
        )
        with rj.call(f"tcp:{outer}") as ask:
            assert ask(b"question").data == b"ok question"
        with rj.call(f"tcp:{source}") as ask:
            bottle = struct.pack("<iid", 266, 1, 1.5)
            assert ask(bottle).data == b"ok " + struct.pack("<iid", 276, 1, 1.5)
            with pytest.raises(rj.TransportError, match="closed"):
                ask(bottle[:-1])
        assert [each["sent"] for each in bridge.snapshot()] == [1, 1]
        assert any("truncated" in line for line in said)
        bridge.stop()
        asks, _ = run(f'[[route]]\nsource = "tcp:{outer}"\ncall = "tcp:{inner}"\n')
        with rj.publish(f"tcp:{outer}") as robot:
            robot.send(b"command")
            until(lambda: asks.snapshot()[0]["sent"] == 1)
        assert asked[-1] == b"command"


def test_questions_that_are_too_many_are_counted(run):
    outer, inner, goes_on = free_port(), free_port(), threading.Event()
    with rj.serve(f"tcp:{inner}", lambda message: bytes(message.data) if goes_on.wait(5) else b""):
        bridge, said = run(f'[[rpc]]\nname = "a"\nserve = "tcp:{outer}?queue=1"\ncall = "tcp:{inner}"\n')
        asks = [rj.call(f"tcp:{outer}") for _ in range(3)]
        answered = []
        threads = [threading.Thread(target=lambda each=each: answered.append(each(b"question").data)) for each in asks[:2]]
        for number, each in enumerate(threads):
            each.start()
            until(lambda: bridge.snapshot()[0]["taken"] == 1)
            until(lambda number=number: len(bridge.live["a"].server._questions) == number)
        with pytest.raises(rj.TransportError, match="closed"):
            asks[2](b"one more")
        goes_on.set()
        for each in threads:
            each.join()
        for each in asks:
            each.close()
    assert answered == [b"question"] * 2
    assert bridge.snapshot()[0]["dropped"] == {"queue full": 1}
    assert "a: 1 dropped: queue full" in said


def test_another_file(run, tmp_path):
    one, two, target, other = (free_port() for _ in range(4))
    with rj.subscribe(f"tcp:{target}") as first, rj.subscribe(f"tcp:{other}") as second:
        bridge, _ = run(route(one, target, 'name = "a"'))
        with rj.publish(f"tcp:{one}") as robot:
            robot.send(b"1")
            assert first.take(5).data == b"1"
            (tmp_path / "bridge.toml").write_text(route(one, target, 'name = "a"') + route(two, other, 'name = "b"'))
            bridge.reload(checked(str(tmp_path / "bridge.toml")))
            robot.send(b"2")
            assert first.take(5).data == b"2"
            with rj.publish(f"tcp:{two}") as more:
                more.send(b"3")
                assert second.take(5).data == b"3"
            assert [each["taken"] for each in bridge.snapshot()] == [2, 1]  # the first one was left alone
        (tmp_path / "bridge.toml").write_text(route(two, other, 'name = "b"'))
        bridge.reload(checked(str(tmp_path / "bridge.toml")))
        assert [each["route"] for each in bridge.snapshot()] == ["b"]


def test_what_cannot_be_opened_is_tried_again(run):
    source, target = free_port(), free_port()
    with rj.subscribe(f"tcp:{source}") as in_the_way:
        bridge, said = run(route(source, target))
        assert "taken" in bridge.snapshot()[0]["problem"]
        assert any("taken" in line for line in said)
        in_the_way.close()
        until(lambda: not bridge.snapshot()[0]["problem"])
        bridge.stop(0.2)
        assert bridge.snapshot()[0]["problem"] == "closed"


def test_why_a_route_never_ran_is_said_at_the_end(run):
    source = free_port()
    with rj.subscribe(f"tcp:{source}"):
        bridge, _ = run(route(source, free_port()))
        bridge.stop(0.2)
    assert "taken" in bridge.snapshot()[0]["problem"]


def test_channels_are_found(run):
    """Ports that a pattern names, also one that comes later; each becomes a route with its own target."""
    names, target = NameServer(), free_port()
    server = f"?server=127.0.0.1:{names.port}"
    try:
        with rj.subscribe(f"tcp:{target}") as there, rj.publish(f"yarp:/icub/head/state:o{server}") as head:
            bridge, _ = run(f'[[route]]\nname = "all"\nsource = "yarp:/icub/*/state:o{server}"\ntarget = "tcp:{target}"\n')
            until(lambda: head.connections)
            head.send(struct.pack("<iid", 266, 1, 1.5))
            assert there.take(5).data == struct.pack("<iid", 266, 1, 1.5)
            with rj.publish(f"yarp:/icub/torso/state:o{server}") as torso:
                until(lambda: torso.connections)
                torso.send(struct.pack("<iid", 266, 1, 2.5))
                assert there.take(5).data == struct.pack("<iid", 266, 1, 2.5)
            assert [each["route"] for each in bridge.snapshot()] == ["all /icub/head/state:o", "all /icub/torso/state:o"]
            bridge.stop(0.5)
    finally:
        names.close()


def test_a_target_that_comes_back(run):
    """What it did not take while it was away is what it gets first."""
    source, target = free_port(), free_port()
    there = rj.subscribe(f"tcp:{target}")
    bridge, _ = run(route(source, target))
    with rj.publish(f"tcp:{source}") as robot:
        robot.send(b"first")
        assert there.take(5).data == b"first"
        there.close()
        until(lambda: not next(iter(bridge.live.values()))._sink.connections)
        for number in range(20):
            robot.send(bytes([number]))
        until(lambda: bridge.snapshot()[0]["taken"] == 21)
        with rj.subscribe(f"tcp:{target}") as again:
            assert [again.take(10).data for _ in range(20)] == [bytes([number]) for number in range(20)]
