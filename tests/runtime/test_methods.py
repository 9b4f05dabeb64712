"""Methods that serialise are compiled once their program is, and do as the functions in their place did."""

from __future__ import annotations

import copy
import gc
import inspect
import io
import pickle
import sys
import weakref

import pytest

import rosetta_jit as rj
from rosetta_jit.api import loading
from rosetta_jit.errors import DecodeError
from rosetta_jit.runtime.callable import is_native

PROTO = {"m.proto": 'syntax = "proto3";\nmessage M { repeated double xs = 1; string s = 2; M child = 3; }\n'}


def made():
    return rj.Decoder.of("M", schema=PROTO, encoding="protobuf", imports=["m.proto"]).holder_type


@pytest.mark.skipif(not is_native(), reason="no compiled methods")
def test_a_class_has_compiled_methods_of_its_own():
    cls = made()
    message = cls(xs=[1.0], s="a")
    data = message.SerializeToString()
    assert vars(cls)["SerializeToString"].program is cls.family_.programs.encode
    assert type(vars(cls)["FromString"]).__name__ == "Method"
    assert message.SerializeToString() == data
    assert cls.FromString(data) == message
    assert repr(cls.FromString) == "<method 'FromString' of 'M' objects>"


def test_calls_of_every_kind():
    cls = made()
    message = cls(xs=[1.0, 2.0], s="a")
    message.child.s = "b"
    for _ in range(3):  # Python at first, then compiled
        data = message.SerializeToString()
        assert message.SerializeToString(deterministic=True) == data
        assert cls.SerializeToString(message) == data
        bound = message.SerializeToString
        assert bound() == data
        other = cls()
        assert other.ParseFromString(data) == len(data)
        assert other.ParseFromString(memoryview(data)) == len(data)
        assert other.ParseFromString(bytearray(data)) == len(data)
        assert other == message
        assert cls.FromString(data) == message == other.FromString(bytearray(data))
        assert cls.FromString(cls.FromString(data).child.SerializeToString()).s == "b"
        other.child.ParseFromString(b"\x12\x01c")
        assert other.child.s == "c"
        with pytest.raises(DecodeError):
            other.ParseFromString(data[:-1])
        with pytest.raises(DecodeError):
            cls.FromString(data[:-1])
        for call, arguments in (
            (message.SerializeToString, [1]),
            (other.ParseFromString, []),
            (cls.FromString, []),
            (cls.SerializeToString, [3]),
        ):
            with pytest.raises((TypeError, AttributeError)):
                call(*arguments)
    assert list(inspect.signature(cls.ParseFromString).parameters) == ["self", "data"]


def test_a_subclass_may_do_otherwise():
    cls = made()

    class Loud(cls):
        __slots__ = ()

        def SerializeToString(self, **options):  # noqa: N802
            return super().SerializeToString(**options).upper()

    data = cls(s="abc").SerializeToString()
    loud = Loud.__new__(Loud)
    loud.__init__(s="abc")
    assert loud.SerializeToString() == data.upper()  # of a message of the same type, if of a class of somebody's own
    assert cls.FromString(data).s == "abc"


def test_files_of_genpy():
    imu = rj.Decoder.of("sensor_msgs/Imu", encoding="ros1").holder_type
    message = imu()
    message.header.frame_id = "f"

    class Closed:
        def write(self, data):
            raise OSError(len(data))

    for _ in range(3):
        file = io.BytesIO()
        assert message.serialize(file) is None
        assert message.serialize(buff=file) is None
        data = file.getvalue()[: file.tell() // 2]
        assert imu().deserialize(data).header.frame_id == "f"
        with pytest.raises(OSError, match=str(len(data))):
            message.serialize(Closed())
        with pytest.raises(AttributeError):
            message.serialize(3)


def test_nothing_is_counted_wrong():
    """Objects that calls take and give are let go of as often as they are kept."""
    cls = made()
    message = cls(s="abc")
    data = message.SerializeToString()
    file, counted = (
        io.BytesIO(),
        [cls, message, data, *(vars(cls)[name] for name in ("FromString", "SerializeToString") if name in vars(cls))],
    )
    other = cls()
    imu = rj.Decoder.of("std_msgs/String", encoding="ros1").holder_type(data="x")
    for _ in range(3):
        before = [sys.getrefcount(each) for each in counted]
        for _ in range(200):
            message.SerializeToString()
            other.ParseFromString(data)
            cls.FromString(data)
            imu.serialize(file)
            with pytest.raises(DecodeError):
                other.ParseFromString(b"\x0a")
        gc.collect()
        after = [sys.getrefcount(each) for each in counted]
    assert after == before


def test_a_class_ends_with_its_methods():
    cls = made()
    message = cls(s="a")
    message.SerializeToString()
    data = cls.FromString(message.SerializeToString()).SerializeToString()
    method = cls.FromString
    ends = weakref.ref(cls)
    del cls, message
    gc.collect()
    assert method(data).s == "a"
    del method
    loading._shared.cache_clear()
    gc.collect()
    assert ends() is None


def test_pickles_are_lanes():
    cls = made()
    message = cls(xs=[1.0] * 99, s="é")
    message.child.child.s = "x"
    for _ in range(20):
        message.s = "longer " * len(message.s)
        message.child.child.child.s = message.s = "b"
    for shown in (message, message.child):
        for copied in (pickle.loads(pickle.dumps(shown, 5)), copy.copy(shown)):  # noqa: S301
            assert copied == shown
            assert copied.SerializeToString() == shown.SerializeToString()
            copied.s = "own"
            assert shown.s != "own"
    text = pickle.dumps(message)
    mark = cls.family_.mark.encode()
    assert text.count(mark) == 1
    with pytest.raises(ValueError, match="another version"):
        pickle.loads(text.replace(mark, b"0" * len(mark)))  # noqa: S301
