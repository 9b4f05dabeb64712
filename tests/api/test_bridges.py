"""Bridges do what a decoder and an encoder do, one after the other; their errors are those of the two."""

from __future__ import annotations

import pickle
import sys
import threading
import time
from itertools import pairwise

import numpy as np
import pytest

import rosetta_jit as rj

TORSO = "yarp/icub/torso_state.mapping"
FILES = {
    "held/Held.msg": "string name\nuint8[] data\nheld/Part[] parts\nfloat64[] numbers\nuint8 kind\n",
    "held/Part.msg": "uint8[] data\nuint8 id\n",
    "wire/Wire.msg": "uint8 kind\nuint8[] data\nwire/Part[] parts\nstring name\nfloat32[] numbers\n",
    "wire/Part.msg": "uint8 id\nuint8[] data\n",
}
HELD = """
import "held/Held.msg"
import "wire/Wire.msg"
data-holder: held/Held
wire-schema: wire/Wire
unpack-rules:
  .name = .name
  .kind = .kind
  when .kind == 7
    .data = reversed(.data, 2)
  else
    .data = .data
  end
  .parts[].id = .parts[].id
  .parts[].data = .parts[].data
  .numbers[] = .numbers[]
"""
DECODE = {"encoding": "ros1", "schema": {**FILES, "held.mapping": HELD}}
ENCODE = {"encoding": "ros1", "schema": FILES}


@pytest.fixture(scope="module", params=["llvm", "python"])
def backend(request):
    return request.param


@pytest.fixture(scope="module")
def bridge(backend):
    """From a bottle of three angles to what protobuf makes of them."""
    return rj.Bridge(TORSO, decode={"encoding": "yarp4", "backend": backend}, encode={"backend": backend})


@pytest.fixture(scope="module")
def held(backend):
    """Fields of bytes that are handed on, and one of which a rule may change."""
    return rj.Bridge("held.mapping", decode={**DECODE, "backend": backend}, encode={**ENCODE, "backend": backend})


@pytest.fixture(scope="module")
def bottle():
    return rj.Encoder(TORSO, encoding="yarp4")({"angles": [0.25, -1.0, 2.0]})


@pytest.fixture(scope="module")
def wire():
    return rj.Encoder.of("wire/Wire", **ENCODE)


@pytest.fixture(scope="module")
def by_two_calls():
    decode, encode = rj.Decoder("held.mapping", **DECODE), rj.Encoder.of("held/Held", **ENCODE)
    return lambda message: encode(decode(message))


def wires(wire):
    """Messages that take more and more room."""
    for size in (0, 3, 4, 60, 3000):
        for kind in (0, 7) if size % 2 == 0 else (0,):
            parts = [{"id": number, "data": bytes([number]) * number} for number in range(size % 100)]
            yield wire({"kind": kind, "data": bytes(range(20)) * size, "parts": parts, "name": "é" * size, "numbers": list(range(size))})


def test_a_mapping_and_the_holders_own_wire(bridge, bottle):
    message = bridge(bottle)
    assert list(rj.Decoder.of("rst.kinematics.JointAngles")(message).angles) == pytest.approx([0.25, -1.0, 2.0])
    back = rj.Bridge(None, TORSO, encode={"encoding": "yarp3"})
    assert list(rj.Decoder(TORSO, encoding="yarp3")(back(message)).angles) == pytest.approx([0.25, -1.0, 2.0])


def test_two_mappings(bottle):
    there = rj.Bridge(TORSO, TORSO, decode={"encoding": "yarp4"}, encode={"encoding": "yarp3"})
    assert list(rj.Decoder(TORSO, encoding="yarp3")(there(bottle)).angles) == pytest.approx([0.25, -1.0, 2.0])


def test_bytes_are_what_two_calls_give(held, wire, by_two_calls):
    for message in wires(wire):
        assert held(message) == held(bytearray(message)) == by_two_calls(message)


def test_into_a_buffer(held, wire, by_two_calls):
    for message in wires(wire):
        expected = by_two_calls(message)
        buffer = bytearray(len(expected) + 10)
        written = held.into(message, buffer)
        assert buffer[:written] == expected
        with pytest.raises(BufferError, match=f"takes {written} bytes"):
            held.into(message, memoryview(buffer)[: written - 1])
        del buffer[:]  # nothing is kept of it


def test_a_buffer_may_be_that_of_the_message(held, wire, by_two_calls):
    message = wire({"data": bytes(range(100)), "parts": [{"data": b"12", "id": 3}], "name": "here"})
    buffer = bytearray(message) + bytes(100)
    written = held.into(memoryview(buffer)[: len(message)], buffer)
    assert buffer[:written] == by_two_calls(message)


def test_a_buffer_must_be_writable(bridge, bottle):
    with pytest.raises(BufferError):
        bridge.into(bottle, bytes(100))
    with pytest.raises(TypeError):
        bridge(bottle, bytearray(100), 0)
    with pytest.raises(TypeError):
        bridge("no bytes")


def test_many(held, wire, by_two_calls):
    messages = [*wires(wire)] * 2
    expected = [by_two_calls(message) for message in messages]
    offsets = np.cumsum([5, *map(len, messages)], dtype=np.int64)
    for found, ends in (held.many(messages), held.many(b"12345" + b"".join(messages), offsets)):
        assert [found[begin:end].tobytes() for begin, end in pairwise(ends)] == expected
    empty, ends = held.many([])
    assert empty.size == 0
    assert ends.tolist() == [0]


def test_errors_are_the_decoders(held, wire):
    message = wire({"parts": [{"data": b"1234"}], "name": "n"})
    decode = rj.Decoder("held.mapping", **DECODE)
    for size in range(len(message)):
        with pytest.raises(rj.DecodeError) as expected:
            decode(message[:size])
        with pytest.raises(rj.DecodeError) as found:
            held(message[:size])
        assert str(found.value) == str(expected.value)
    with pytest.raises(rj.DecodeError) as found:
        held.many([message, message[:-1]])
    assert found.value.path == f"[1]{expected.value.path}"
    with pytest.raises(ValueError, match="fall, or leave the buffer"):
        held.many(message, np.array([0, len(message) + 1]))


def test_errors_are_the_encoders(backend):
    back = rj.Bridge(None, TORSO, decode={"backend": backend}, encode={"encoding": "yarp3", "backend": backend})
    message = rj.Encoder.of("rst.kinematics.JointAngles")({"angles": [1, 2]})
    with pytest.raises(rj.EncodeError, match="no such element"):
        back(message)
    with pytest.raises(rj.EncodeError) as found:
        back.many([message])
    assert found.value.path.startswith("[0]")


def test_mappings_that_do_not_meet():
    with pytest.raises(rj.MappingError, match=r"fills `rst\.kinematics\.JointAngles`.*packs `rst\.vision\.Image`"):
        rj.Bridge(TORSO, "yarp/icub/camera_image.mapping", decode={"encoding": "yarp3"}, encode={"encoding": "yarp3"})
    with pytest.raises(rj.MappingError, match="no side of the bridge"):
        rj.Bridge(None)
    with pytest.raises(TypeError, match="decode="):
        rj.Bridge(TORSO, encoding="yarp3")
    other = {"schema": {**FILES, "held/Part.msg": "uint8[] data\nuint16 id\n"}, "encoding": "ros1"}
    with pytest.raises(rj.MappingError, match="not the same fields"):
        rj.Bridge.of("held/Held", decode=ENCODE, encode=other)


def test_types_of_two_frameworks_meet_if_they_have_the_same_fields():
    bridge = rj.Bridge.of("geometry_msgs/Twist", "geometry_msgs/msg/Twist", decode={"encoding": "ros1"}, encode={"encoding": "cdr"})
    twist = {"linear": {"x": 1.0, "y": 2.0, "z": 3.0}, "angular": {"z": -1.0}}
    assert bridge(rj.Encoder.of("geometry_msgs/Twist", encoding="ros1")(twist)) == rj.Encoder.of("geometry_msgs/msg/Twist")(twist)


def test_what_a_publisher_says_of_the_type_that_is_written():
    there = rj.Bridge.of("geometry_msgs/Twist", "geometry_msgs/msg/Twist", decode={"encoding": "ros1"}, encode={"encoding": "cdr"})
    back = rj.Bridge.of("geometry_msgs/msg/Twist", "geometry_msgs/Twist", decode={"encoding": "cdr"}, encode={"encoding": "ros1"})
    hash_ = "RIHS01_9c45bf16fe0983d80e3cfe750d6835843d265a9a6c46bd2e609fcddde6fb8d2a"
    assert there.announced("ros2") == {"type": "geometry_msgs/msg/Twist", "hash": hash_}
    told = back.announced("ros1")
    assert (told["type"], told["md5"]) == ("geometry_msgs/Twist", "9f195f881246fdfa2798d1d3eebca84a")
    assert "MSG: geometry_msgs/Vector3" in told["definition"]
    encode = rj.Encoder.of("geometry_msgs/Twist", encoding="ros1")
    assert (encode.announced("ros1"), encode.announced("ros2")) == (told, {})
    assert (there.announced("ros1"), back.announced("ros2"), rj.Bridge.between("yarp3", "yarp4").announced("ros1")) == ({}, {}, {})
    assert rj.Bridge(TORSO, decode={"encoding": "yarp4"}).announced("protobuf") == {"type": ".rst.kinematics.JointAngles"}


def test_a_pickle_is_its_recipe(bridge, bottle):
    assert pickle.loads(pickle.dumps(bridge))(bottle) == bridge(bottle)  # noqa: S301 - our own bytes
    assert repr(bridge) == "<Bridge from yarp/icub/torso_state.mapping, yarp4 to the same message>"


def test_the_cache_has_it(tmp_path, monkeypatch, bottle):
    monkeypatch.setenv("ROSETTA_JIT_CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.delenv("ROSETTA_JIT_CACHE", raising=False)
    made = rj.Bridge(TORSO, decode={"encoding": "yarp4"})(bottle)
    monkeypatch.setattr("rosetta_jit.pipeline.bridge.BridgeBuild.kernels", property(lambda _: pytest.fail("compiled again")))
    assert rj.Bridge(TORSO, decode={"encoding": "yarp4"})(bottle) == made


def test_many_runs_without_the_interpreter_lock(bottle):
    """Nothing else lets this thread run while the other one is in its calls: Python asks for no switch meanwhile."""
    bridge = rj.Bridge(TORSO, decode={"encoding": "yarp4"})
    messages, offsets = bottle * 100_000, np.arange(100_001) * len(bottle)
    inside, seen, before = [False], False, sys.getswitchinterval()

    def run():
        for _ in range(100):
            inside[0] = True
            bridge.many(messages, offsets)
            inside[0] = False
            if seen:
                return

    thread = threading.Thread(target=run)
    sys.setswitchinterval(1000)
    try:
        thread.start()
        while thread.is_alive() and not seen:
            time.sleep(0.0005)
            seen = inside[0]
        thread.join()
    finally:
        sys.setswitchinterval(before)
    assert seen


def test_threads_share_a_bridge(wire, by_two_calls):
    """Lanes grow all the time, in each thread, so that all find them in use."""
    messages = [*wires(wire)][::-1]
    expected = [by_two_calls(message) for message in messages]
    wrong = []
    held = rj.Bridge("held.mapping", decode=DECODE, encode=ENCODE)

    def run():
        for _ in range(20):
            wrong.extend(number for number, message in enumerate(messages) if held(message) != expected[number])
            found, ends = held.many(messages)
            if found.tobytes() != b"".join(expected) or ends[-1] != found.size:
                wrong.append("many")

    threads = [threading.Thread(target=run) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


def test_numbers_of_messages_go_on(backend):
    files = {"a/A.msg": "uint32 n\n", "b/B.msg": "uint32 n\n"}
    rules = 'import "a/A.msg"\nimport "b/B.msg"\ndata-holder: a/A\nwire-schema: b/B\nunpack-rules:\n  ignore .n\n  .n = uint32(counter())\n'
    half = {"encoding": "ros1", "backend": backend, "schema": {**files, "count.mapping": rules}}
    bridge = rj.Bridge("count.mapping", decode=half, encode=half)
    first = [int.from_bytes(bridge(bytes(4)), "little") for _ in range(3)]
    with pytest.raises(rj.DecodeError):
        bridge(b"1")
    found, _ = bridge.many([bytes(4)] * 3)
    assert [*first, *found.view(np.uint32)] == [first[0] + number for number in range(6)]


def test_stages_are_those_of_both_halves(bridge):
    assert bridge.stage("kernel").count("kernel ") >= 3
    assert "define" in bridge.stage("llvm")
