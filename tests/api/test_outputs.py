"""What messages are written into: bytes and numbers, and nothing that Python refers to its objects with."""

from __future__ import annotations

import array
import ctypes
import mmap
import struct

import numpy as np
import pytest

import rosetta_jit as rj

TORSO = "yarp/icub/torso_state.mapping"
BACKENDS = pytest.mark.parametrize("backend", [None, "numba", "python"])


def objects():
    return np.array([object() for _ in range(20)], object)


REFERENCES = {
    "objects": objects,
    "a view of objects": lambda: memoryview(objects()),
    "objects in structs": lambda: np.array([(object(), 1.0)] * 20, [("a", "O"), ("b", "f8")]),
    "objects of ctypes": lambda: (ctypes.py_object * 20)(*objects()),
}
PLAIN = {
    "bytearray": lambda: bytearray(100),
    "numbers": lambda: np.zeros(20),
    "a view": lambda: memoryview(bytearray(100)),
    "rows": lambda: np.zeros((4, 25), np.uint8),
    "array": lambda: array.array("i", [0] * 25),
    "ctypes": ctypes.c_uint16 * 50,
    "mmap": lambda: mmap.mmap(-1, 4096),
    "a field with the letter in its name": lambda: np.zeros(20, [("On", "f8")]),
}


@BACKENDS
@pytest.mark.parametrize("kind", REFERENCES)
def test_references_to_objects_are_not_overwritten(kind, backend):
    """Each would end the process when the array ends."""
    encode = rj.Encoder.of("geometry_msgs/Point", encoding="ros1", backend=backend)
    bridge = rj.Bridge(TORSO, decode={"encoding": "yarp3", "backend": backend}, encode={"backend": backend})
    message = struct.pack("<ii3d", 266, 3, 10.0, -20.0, 30.0)
    target = REFERENCES[kind]()
    for write in (lambda: encode(encode.holder_type(x=1.0), target), lambda: encode.into(encode.holder_type(), target, 8)):
        with pytest.raises(BufferError, match="references to Python objects"):
            write()
    with pytest.raises(BufferError, match="references to Python objects"):
        bridge(message, target)


@BACKENDS
@pytest.mark.parametrize("kind", PLAIN)
def test_memory_of_numbers_is(kind, backend):
    encode = rj.Encoder.of("geometry_msgs/Point", encoding="ros1", backend=backend)
    holder, target = encode.holder_type(x=1.0, y=2.0, z=3.0), PLAIN[kind]()
    assert encode(holder, target) == 24
    assert memoryview(target).tobytes()[:24] == encode(holder)
    bridge = rj.Bridge(TORSO, decode={"encoding": "yarp3", "backend": backend}, encode={"backend": backend})
    message = struct.pack("<ii3d", 266, 3, 10.0, -20.0, 30.0)
    size = bridge(message, target)
    assert memoryview(target).tobytes()[:size] == bridge(message)
