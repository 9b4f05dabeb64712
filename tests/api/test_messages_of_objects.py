"""What messages are read from: bytes and numbers, and nothing that Python refers to its objects with, whose bytes are addresses."""

from __future__ import annotations

import array
import ctypes
import struct

import numpy as np
import pytest

import rosetta_jit as rj

TORSO = "yarp/icub/torso_state.mapping"
MESSAGE = struct.pack("<3d", 1.0, -2.0, 3.0)
STATE = struct.pack("<ii3d", 266, 3, 10.0, -20.0, 30.0)
BACKENDS = pytest.mark.parametrize("backend", [None, "numba", "python"])


def objects():
    return np.array([b"a", None, "c"], object)


REFERENCES = {
    "objects": objects,
    "a view of objects": lambda: memoryview(objects()),
    "objects in structs": lambda: np.array([(object(), 1.0)], [("a", "O"), ("b", "f8")]),
    "objects of ctypes": lambda: (ctypes.py_object * 3)(*objects()),
}
PLAIN = {
    "bytes": bytes,
    "bytearray": bytearray,
    "numbers": np.frombuffer,
    "octets": lambda message: np.frombuffer(message, np.uint8),
    "a view": memoryview,
    "a view of numbers": lambda message: memoryview(message).cast("d"),
    "rows": lambda message: np.frombuffer(message, np.uint8).reshape(-1, 8),
    "array": lambda message: array.array("d", message),
    "ctypes": (ctypes.c_double * 3).from_buffer_copy,
    "a field with the letter in its name": lambda message: np.frombuffer(message, [("On", "f8")]),
    "texts of bytes": lambda message: np.frombuffer(message, "S12"),
}


def refused():
    return pytest.raises(BufferError, match=r"has references to Python objects, and no bytes of a message")


@BACKENDS
@pytest.mark.parametrize("kind", REFERENCES)
@pytest.mark.parametrize("borrow", [False, True])
def test_references_to_objects_are_no_message(kind, borrow, backend):
    decode = rj.Decoder.of("geometry_msgs/Point", encoding="ros1", backend=backend, borrow=borrow)
    given = REFERENCES[kind]()
    holder = decode(MESSAGE)
    for read in (decode, lambda message: decode(message, decode.new()), lambda message: decode.many([MESSAGE, message])):
        with refused():
            read(given)
    with pytest.raises(TypeError, match="offsets are places in one buffer, and not in a"):
        decode.many(given, np.array([0, 24]))
    assert (holder.x, holder.y, holder.z) == (1.0, -2.0, 3.0)


@BACKENDS
@pytest.mark.parametrize("kind", REFERENCES)
def test_nor_one_for_a_bridge(kind, backend):
    bridge = rj.Bridge(TORSO, decode={"encoding": "yarp3", "backend": backend}, encode={"backend": backend})
    given = REFERENCES[kind]()
    for read in (bridge, lambda message: bridge(message, bytearray(100)), lambda message: bridge.many([STATE, message])):
        with refused():
            read(given)


@BACKENDS
@pytest.mark.parametrize("kind", PLAIN)
@pytest.mark.parametrize("borrow", [False, True])
def test_numbers_are(kind, borrow, backend):
    decode = rj.Decoder.of("geometry_msgs/Point", encoding="ros1", backend=backend, borrow=borrow)
    given = PLAIN[kind](MESSAGE)
    for point in (decode(given), decode(given, decode.new()), *decode.many([given, MESSAGE]), *decode.many(given, np.array([0, 24]))):
        assert (point.x, point.y, point.z) == (1.0, -2.0, 3.0)


def test_an_array_of_messages_is_a_list_of_them():
    batch = rj.Decoder.of("geometry_msgs/Point", encoding="ros1").many(np.array([MESSAGE, MESSAGE], object))
    assert batch.x.tolist() == [1.0, 1.0]


@pytest.mark.parametrize(
    ("type_", "encoding", "method"),
    [("std_msgs/String", "ros1", "deserialize"), ("google.protobuf.Timestamp", "protobuf", "ParseFromString")],
)
def test_methods_of_holders_refuse_them(type_, encoding, method):
    holder = rj.Decoder.of(type_, encoding=encoding).new()
    with refused():
        getattr(holder, method)(objects())
