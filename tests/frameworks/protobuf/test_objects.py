"""Messages of protobuf's own package as encoders take them, and decoders fill and make them."""

from __future__ import annotations

import gc
import random

import pytest

import rosetta_jit as rj
from rosetta_jit.runtime.callable import is_native
from tests.random_mappings.hostile import altered


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


def made(text, name):
    """The class of a message in a file of protobuf's, as its own package makes it."""
    from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

    file = descriptor_pb2.FileDescriptorProto(name="h.proto", package="h", syntax=text)
    message = file.message_type.add(name=name)
    message.field.add(name="text", number=1, type=9, label=1)
    message.field.add(name="number", number=2, type=5, label=2 if text == "proto2" else 1)
    pool = descriptor_pool.DescriptorPool()
    return message_factory.GetMessageClass(pool.AddSerializedFile(file.SerializeToString()).message_types_by_name[name])


@pytest.fixture(scope="module")
def handed():
    """A class with a required field, and what encodes and decodes its messages as they are."""
    theirs = made("proto2", "Old")
    return theirs, rj.Encoder.of(theirs, encoding="protobuf"), rj.Decoder.of(theirs, encoding="protobuf")


def test_what_must_be_set_is_asked_for(handed):
    theirs, encode, decode = handed
    for _ in range(3):  # the first call finds the way, the others take it
        with pytest.raises(rj.EncodeError, match=r"number"):
            encode(theirs(text="a"))
        with pytest.raises(rj.DecodeError, match=r"number"):
            decode.to(b"\x0a\x01a", theirs)
        assert encode(theirs(text="a", number=2)) == b"\x0a\x01a\x10\x02"
        assert decode.to(b"\x0a\x01a\x10\x02", theirs) == theirs(text="a", number=2)


def test_a_message_that_passes_is_checked_nevertheless(handed):
    """Nothing is encoded anew, so what decodes must find what is wrong."""
    theirs, _, decode = handed
    good = theirs(text="abc", number=1).SerializeToString()
    for broken, kind in ((good[:-1], "truncated"), (b"\x0a\x01\xff\x10\x02", "text"), (b"\x0a\x7f", "truncated")):
        for _ in range(3):
            with pytest.raises(rj.DecodeError) as caught:
                decode.to(broken, theirs)
            assert caught.value.kind == kind
            assert decode.to(good, theirs).number == 1
            assert decode.to(bytearray(good), theirs).number == 1
            assert decode.to(memoryview(good), theirs).text == "abc"


def test_a_message_that_is_mapped(handed):
    theirs, _, _ = handed
    mapping = 'import "h.proto"\ndata-holder: h.Old\nwire-schema: h.Old\nunpack-rules:\n  .text = .text\n  .number = int32(.number + 1)\n'
    schema = {
        "h.proto": 'syntax = "proto2";\npackage h;\nmessage Old { optional string text = 1; required int32 number = 2; }\n',
        "h.mapping": f"{mapping}pack-rules:\n  .text = .text\n  .number = int32(.number - 1)\n",
    }
    encode, decode = rj.Encoder("h.mapping", schema=schema), rj.Decoder("h.mapping", schema=schema)
    for number in range(3):
        message = theirs(text="abc", number=number)
        assert theirs.FromString(encode(message)).number == number - 1
        assert decode.to(message.SerializeToString(), theirs).number == number + 1


def test_classes_in_turn(handed):
    """What an encoder and a decoder remember is the last class alone; the others are found nevertheless, also a dict."""
    theirs, encode, decode = handed

    class Like:
        def __init__(self, text="", number=0):
            self.text, self.number = text, number

    data = b"\x0a\x01a\x10\x02"
    for _ in range(5):
        for each in (theirs(text="a", number=2), Like("a", 2), {"text": "a", "number": 2}, decode(data)):
            assert encode(each) == data
            assert encode(each, bytearray(8), 1) == 1 + len(data)
        for class_ in (theirs, Like):
            one, other = decode.to(data, class_), decode.to(message=data, object_type=class_)
            assert type(one) is type(other) is class_
            assert (one.text, one.number) == ("a", 2)
        with pytest.raises(TypeError):
            decode.to(data)
        with pytest.raises(TypeError):
            decode.to(1, theirs)


def test_nothing_is_counted_wrong(handed):
    """References of what is handed over, also where it fails."""
    import sys

    theirs, encode, decode = handed
    bad, good, data, broken = theirs(text="a"), theirs(text="a", number=2), b"\x0a\x01a\x10\x02", b"\x0a\x7f"
    counted = (theirs, bad, good, data, broken, None)

    def run():
        for _ in range(100):
            encode(good)
            decode.to(data, theirs)
            for call in (lambda: encode(bad), lambda: decode.to(broken, theirs)):
                with pytest.raises(rj.RosettaError):
                    call()
        gc.collect()  # what errors refer to refers to them

    run()
    before = [sys.getrefcount(each) for each in counted]
    run()
    after = [sys.getrefcount(each) for each in counted]
    assert all(abs(one - other) < 10 for one, other in zip(before, after, strict=True))


@pytest.mark.parametrize("kind", ["numbers", "texts", "messages"])
def test_the_functions_in_c_do_what_the_methods_do(kind, tmp_path):
    """Those of upb's classes are called without the interpreter; nothing is lost by that, also where they refuse."""
    import sys

    theirs = compiled(f'syntax = "proto3"; package h; message M {{ {KINDS[kind]} }}', tmp_path)
    encode, decode = rj.Encoder.of(theirs, encoding="protobuf"), rj.Decoder.of(theirs, encoding="protobuf")
    in_c = decode.holder_type.family_.wholes[theirs].in_c
    assert (in_c is not None) == is_native()
    data = next(each for each in map(bytes.fromhex, FIELDS) if failure(decode, each) is None and theirs.FromString(each).ListFields())
    value = theirs.FromString(data)
    for made in [decode.to(data, theirs) for _ in range(3)]:
        assert made == value
        assert made.IsInitialized()
        made.MergeFromString(data)
        made.Clear()
        assert made == theirs()
    assert sys.getrefcount(decode.to(data, theirs)) == sys.getrefcount(theirs.FromString(data))

    def run():
        for _ in range(100):
            assert encode(value) == data
            assert decode.to(data, theirs) == value
            assert failure(decode.to, b"\xff", theirs) is not None

    counted = (theirs, value, data, (), None)
    run()
    before = [sys.getrefcount(each) for each in counted]
    run()
    after = [sys.getrefcount(each) for each in counted]
    assert all(abs(one - other) < 10 for one, other in zip(before, after, strict=True))


IN_PYTHON = """
from google.protobuf import struct_pb2
from google.protobuf.internal import api_implementation
from rosetta_jit.frameworks.protobuf.objects import in_c
assert api_implementation.Type() == "python"
assert in_c(struct_pb2.Value) is None
import rosetta_jit as rj
value = struct_pb2.ListValue(values=[struct_pb2.Value(bool_value=True)])
encode, decode = rj.Encoder.of(type(value)), rj.Decoder.of(type(value))
for _ in range(3):
    assert encode(value) == value.SerializeToString()
    assert decode.to(value.SerializeToString(), type(value)) == value
"""


def test_messages_of_the_package_in_python():
    """Whose classes have no functions in C, where protobuf runs without its own."""
    import os
    import subprocess
    import sys

    environment = {**os.environ, "PROTOCOL_BUFFERS_PYTHON_IMPLEMENTATION": "python"}
    subprocess.run([sys.executable, "-c", IN_PYTHON], check=True, env=environment, timeout=300)


def test_threads_hand_over_at_the_same_time(handed):
    from concurrent.futures import ThreadPoolExecutor

    theirs, encode, decode = handed

    def run(number):
        message = theirs(text="x" * (number * 50), number=number)
        data = message.SerializeToString()
        return all(encode(message) == data and decode.to(data, theirs) == message for _ in range(300))

    with ThreadPoolExecutor(4) as pool:
        assert all(pool.map(run, range(8)))


KINDS = {
    "numbers": """double a = 1; repeated sint64 b = 2; repeated fixed32 c = 3 [packed = false]; optional bool d = 4;
        oneof o { float e = 5; uint64 f = 6; }""",
    "texts": "string a = 1; repeated string b = 2; map<string, bytes> c = 3;",
    "messages": """message I { uint32 x = 1; repeated string y = 2; } I a = 1; repeated I b = 2; map<int32, I> c = 3; E d = 4;
        enum E { P = 0; Q = 1; }""",
}
FIELDS = (
    *("0a00", "0a026161", "12020101", "1a04aabbccdd", "2001", "2d0000803f", "3005", "0900000000000000f03f", "1206080112026162", "20ff01"),
    *("1a060a01611201ff", "1a080801120408051a00", "4801", "1202c3a9", "0a02c328", "100f", "1d01000000", "f8ff7f05", "0b0c", "1a020803"),
)
"""Bytes of fields of some of these messages: the same number is a text in one and a number in the other."""


@pytest.mark.parametrize("kind", KINDS)
def test_what_their_own_functions_accept_is_what_decodes(kind, tmp_path):
    """Of such types these decide alone: they refuse whatever our programs refuse, and nothing else."""
    theirs = compiled(f'syntax = "proto3"; package h; message M {{ {KINDS[kind]} }}', tmp_path)
    encode, decode = rj.Encoder.of(theirs, encoding="protobuf"), rj.Decoder.of(theirs, encoding="protobuf")
    assert decode.holder_type.family_.wholes[theirs].is_exact
    rng, accepted = random.Random(1), 0
    for _ in range(4000):
        data = b"".join(bytes.fromhex(each) for each in rng.choices(FIELDS, k=rng.randint(1, 6)))
        data = altered(rng, data) if rng.random() < 0.5 else data
        wanted = failure(decode, data)
        assert failure(decode.to, data, theirs) == wanted, data.hex()
        if wanted is not None:
            continue
        found = decode.to(data, theirs)
        assert encode(found) == found.SerializeToString()
        assert decode(encode(found)).to_dict() == decode(data).to_dict(), data.hex()
        accepted += 1
    assert 400 < accepted < 3600


@pytest.mark.parametrize(
    "text",
    [
        'syntax = "proto2"; package h; message M { optional string a = 1; }',
        'syntax = "proto2"; package h; message M { required int32 a = 1; }',
        'syntax = "proto3"; package h; message M { M a = 1; }',
        'syntax = "proto3"; package h; message M { message I { repeated M c = 1; } map<int32, I> b = 1; }',
        'edition = "2023"; package h; message M { string a = 1; }',
    ],
)
def test_other_messages_are_checked(text, tmp_path):
    theirs = compiled(text, tmp_path)
    assert not rj.Decoder.of(theirs, encoding="protobuf").holder_type.family_.wholes[theirs].is_exact


def failure(decode, *arguments):
    """What is wrong with a message, and where; None if nothing is."""
    try:
        decode(*arguments)
    except rj.DecodeError as error:
        return error.kind, error.path, error.offset
    return None


def compiled(text, folder):
    """The class of the message `h.M` of a file, in a pool of its own."""
    from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
    from grpc_tools import protoc

    (folder / "h.proto").write_text(text)
    assert protoc.main(["protoc", f"-I{folder}", f"--descriptor_set_out={folder / 'set'}", "h.proto"]) == 0
    pool = descriptor_pool.DescriptorPool()
    for file in descriptor_pb2.FileDescriptorSet.FromString((folder / "set").read_bytes()).file:
        pool.AddSerializedFile(file.SerializeToString())
    return message_factory.GetMessageClass(pool.FindMessageTypeByName("h.M"))
