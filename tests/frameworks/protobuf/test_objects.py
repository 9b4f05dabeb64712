"""Messages of protobuf's own package as encoders take them, and decoders fill and make them."""

from __future__ import annotations

import pytest

import rosetta_jit as rj


@pytest.fixture(scope="module")
def theirs(native):
    return native("second.All")


@pytest.fixture(scope="module")
def programs(theirs):
    return rj.Encoder.of(theirs, encoding="protobuf-partial"), rj.Decoder.of(theirs, encoding="protobuf-partial")


def filled(theirs):
    message = theirs(i32=1, fl=-0.0, flag=False, text="é", data=b"\xff", color=1, ints=[1, 2], counts={"a": 1})
    message.inner.deep.d = 0.5
    message.child.child.i64 = 3
    message.inners.add(x=4)
    message.MergeFromString(b"\xf8\xff\x7f\x05")  # a field that nobody knows
    return message


def test_there_and_back(programs, theirs):
    encode, decode = programs
    message = filled(theirs)
    data = message.SerializePartialToString()
    assert encode(message) == data
    assert decode(encode(message)).SerializePartialToString() == data
    assert decode.to(data, theirs) == message
    other = theirs(text="before", word="before")
    assert decode.into(data, other) is other
    assert other == message
    assert not theirs.FromString(encode(theirs())).HasField("i32")


def test_one_object_after_another(programs, theirs):
    """Nothing is left of the object before, nor of one that failed."""
    encode, decode = programs
    messages = [filled(theirs), theirs(), theirs(text="é" * 100), theirs(ints=range(1000))]
    for message in messages + messages:
        data = message.SerializePartialToString()
        assert encode(message) == data
        assert encode.size(message) == len(data)
        assert decode.to(data, theirs) == message
        buffer = bytearray(2 + len(data))
        assert encode(message, buffer, 2) == len(buffer)
        assert buffer[2:] == data
        with pytest.raises(BufferError):
            encode(message, buffer, 3)
        with pytest.raises(rj.DecodeError):
            decode.to(data + b"\x0a\x7f", theirs)


def test_within_a_dict_and_in_a_list(programs, theirs, native):
    encode, _ = programs
    message = filled(theirs)
    inner = message.inners[0]
    assert theirs.FromString(encode({"inner": message.inner, "inners": [inner, inner]})) == theirs(
        inner=message.inner, inners=[inner, inner]
    )
    with pytest.raises(TypeError, match=r"a message of second\.All\.Inner is needed, not of second\.All"):
        encode({"inner": message})


def test_another_type_is_refused(programs, native):
    encode, decode = programs
    wrong = native("third.Plain")
    with pytest.raises(TypeError, match=r"a message of second\.All is needed, not of third\.Plain"):
        encode(wrong())
    with pytest.raises(TypeError, match=r"not of third\.Plain"):
        decode.to(b"", wrong)


def test_a_type_of_the_same_name_is_refused_too():
    from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

    def made(kind):
        file = descriptor_pb2.FileDescriptorProto(name="t.proto", package="t", syntax="proto3")
        file.message_type.add(name="M").field.add(name="x", number=1, type=kind, label=1)
        pool = descriptor_pool.DescriptorPool()
        return message_factory.GetMessageClass(pool.AddSerializedFile(file.SerializeToString()).message_types_by_name["M"])

    encode = rj.Encoder.of(made(5), encoding="protobuf")
    assert encode(made(5)(x=-1)) == made(5)(x=-1).SerializeToString()
    with pytest.raises(TypeError, match=r"not of t\.M: t\.M\.x is another"):
        encode(made(17)(x=-1))


def test_from_a_schema_file():
    pytest.importorskip("grpc_tools")
    from bench.peers.protobuf import message_class
    from bench.subjects import RST_ANGLES, RST_IMAGE

    for subject in (RST_ANGLES, RST_IMAGE):
        theirs = message_class(subject)
        value = theirs.FromString(subject.message)
        assert subject.encoder()(value) == subject.message
        assert subject.decoder().to(subject.message, theirs) == value
