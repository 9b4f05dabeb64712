"""Many messages in one call: as a list, and with some that are not what the schema promises."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

import rosetta_jit as rj

SCHEMA = {"p/A.msg": "int32 n\nfloat64[3] fixed\nstring s\nstring[] names\nB[] items\n", "p/B.msg": "int32 k\nstring t\n"}
BROKEN = {1: -2, 4: 3, 5: -1}


def of(program, **options):
    return program.of("p/A", schema=SCHEMA, encoding="ros1", imports=["p/A.msg"], **options)


def plain(number):
    return {
        "n": number,
        "fixed": [float(number), 0.0, 1.0],
        "s": "s" * number,
        "names": [str(number)] * (number % 3),
        "items": [{"k": number, "t": "t" * number}] * (number % 4),
    }


EMPTY = {"n": 0, "fixed": [0.0] * 3, "s": "", "names": [], "items": []}


@pytest.fixture(scope="module")
def encode():
    return of(rj.Encoder)


@pytest.fixture(scope="module", params=["llvm", "python"])
def decode(request):
    return of(rj.Decoder, backend=request.param)


@pytest.fixture(scope="module")
def messages(encode):
    return [encode(encode.holder_type.from_dict(plain(number))) for number in range(8)]


@pytest.fixture(scope="module")
def broken(messages):
    return [message[: BROKEN[number]] if number in BROKEN else message for number, message in enumerate(messages)]


def read(batch):
    return [message.to_dict() for message in batch]


def test_a_list_of_messages(decode, messages):
    batch = decode.many(messages)
    assert read(batch) == [plain(number) for number in range(8)]
    mixed = [bytearray(messages[1]), memoryview(messages[2]), np.frombuffer(messages[3], np.uint8)]
    assert read(decode.many(iter(mixed), into=batch)) == [plain(1), plain(2), plain(3)]
    assert len(decode.many([])) == 0
    assert len(batch.errors) == 0
    assert batch.kept.tolist() == [0, 1, 2]


def test_what_is_no_list_of_messages(decode, messages):
    for wrong in (messages[0], np.frombuffer(messages[0], np.uint8)):
        with pytest.raises(TypeError, match="take offsets"):
            decode.many(wrong)
    for wrong in ([1, 2], ["text"], None, 5):
        with pytest.raises(TypeError):
            decode.many(wrong)
    with pytest.raises(ValueError, match="on_error"):
        decode.many(messages, on_error="ignore")


def test_messages_where_they_lie(decode, messages, broken):
    """With begins and ends, there may be other bytes between messages, and they may lie in any order."""
    data, spans = bytearray(b"head"), []
    for message in broken:
        spans.append((len(data), len(data) + len(message)))
        data += message + b"gap"
    places = np.array(spans, np.int64).T
    assert read(decode.many(data, places, on_error="skip")) == [plain(each) for each in range(8) if each not in BROKEN]
    assert read(decode.many(bytes(data), places[:, [7, 2, 2]])) == [plain(7), plain(2), plain(2)]
    assert len(decode.many(data, places[:, :0])) == 0
    with pytest.raises(rj.DecodeError, match=r"`\[1\]"):
        decode.many(data, places)
    for wrong in ([[0], [len(data) + 1]], [[-1], [4]], [[8], [4]]):
        with pytest.raises(ValueError, match="message 0 fall, or leave the buffer"):
            decode.many(data, np.array(wrong, np.int64))
    for wrong in (np.zeros((3, 2), np.int64), np.zeros((2, 2), np.int32), np.zeros((1, 2, 2), np.int64), np.zeros(0, np.int64)):
        with pytest.raises(ValueError, match="of two rows: begins and ends"):
            decode.many(data, wrong)


def test_errors_are_raised(decode, broken):
    with pytest.raises(rj.DecodeError, match=r"^truncated.*\[1\]"):
        decode.many(broken)


def test_messages_are_left_out(decode, broken):
    batch = decode.many(broken, on_error="skip")
    assert batch.kept.tolist() == [0, 2, 3, 6, 7]
    assert read(batch) == [plain(number) for number in batch.kept]
    assert batch.mask().all()
    assert list(batch.errors) == [1, 4, 5]
    assert {error.kind for error in batch.errors.values()} == {"truncated"}
    assert batch.errors[4].path.startswith("[4].")
    assert read(decode.many(broken[:1], into=batch)) == [plain(0)]
    assert batch.errors == {}
    assert batch.kept.tolist() == [0]


def test_messages_are_left_empty(decode, broken):
    batch = decode.many(broken, on_error="mask")
    assert read(batch) == [EMPTY if number in BROKEN else plain(number) for number in range(8)]
    assert batch.mask().tolist() == [number not in BROKEN for number in range(8)]
    assert read(batch[batch.mask()]) == read(decode.many(broken, on_error="skip"))
    batch[1].fixed[:] = 1, 2, 3
    batch[4].s = "set"
    assert batch.column("fixed").to_numpy()[:3].tolist() == [[0, 0, 1], [1, 2, 3], [2, 0, 1]]


def test_errors_are_a_column(decode, broken):
    pytest.importorskip("pyarrow")
    batch = decode.many(broken, on_error="mask")
    column = batch.to_arrow(["n"], errors="error")["error"].to_pylist()
    assert [text is not None for text in column] == [number in BROKEN for number in range(8)]
    assert column[1] == str(batch.errors[1])
    assert batch.to_pandas(errors="why")["why"].isna().sum() == 5
    assert decode.many(broken, on_error="skip").to_arrow(errors="error")["error"].null_count == 5


def test_errors_survive_pickling(decode, broken):
    batch = decode.many(broken, on_error="skip")
    again = pickle.loads(pickle.dumps(batch))  # noqa: S301 - our own
    assert read(again) == read(batch)
    assert {number: str(each) for number, each in again.errors.items()} == {number: str(each) for number, each in batch.errors.items()}
    assert again.errors[4].offset == batch.errors[4].offset
    assert again.kept.tolist() == batch.kept.tolist()


def test_all_are_broken(decode):
    assert len(decode.many([b"", b"x"], on_error="skip")) == 0
    batch = decode.many([b"", b"x"], on_error="mask")
    assert read(batch) == [EMPTY] * 2
    assert not batch.mask().any()


def test_messages_that_ask_for_too_much_are_left_out_too():
    """The room for it is not made."""
    files = {
        "t/In.msg": "int64 n\n",
        "t/Out.msg": "float64[] a\n",
        "m.mapping": """import "t/In.msg"
import "t/Out.msg"
data-holder: t/Out
wire-schema: t/In
unpack-rules:
  len(.a) = .n
  for i from 0 to .n
    .a[i] = 1.0
  end
""",
    }
    decode = rj.Decoder("m.mapping", schema=files, encoding="ros1")
    batch = decode.many([number.to_bytes(8, "little") for number in (2, 1 << 40, 3)], on_error="skip")
    assert [len(each) for each in batch.a.to_list()] == [2, 3]
    assert (batch.errors[1].kind, batch.errors[1].path) == ("count", "[1].a")


def test_wrong_offsets_are_no_error_of_a_message(decode, messages):
    with pytest.raises(ValueError, match="offsets"):
        decode.many(messages[1], np.array([0, 1000]), on_error="skip")


def test_borrowed_messages_are_left_out():
    decode = rj.Decoder.of("rst.vision.Image", encoding="protobuf", borrow=True)
    message = b"\x0a\x06\x01\x02\x03\x04\x05\x06\x10\x02\x18\x01"
    batch = decode.many([message, message[:5], message], on_error="skip")
    assert [bytes(each.data) for each in batch] == [bytes(range(1, 7))] * 2


def test_many_rows_have_memory_of_their_own(decode, broken):
    """So that numpy asks for large pages; whatever is done with a batch does not depend on it."""
    from rosetta_jit.kernel.state import ADDRESS, lane_word
    from rosetta_jit.runtime.memory import LARGE, PAGE

    stride = decode.holder_type.family_.layout.lanes[0].stride
    count = -(-LARGE // stride)
    few, many = [decode.many(broken * (number // len(broken) + 1), on_error="mask") for number in (len(broken), count)]
    assert len(many.lanes.arena) < LARGE
    assert many.lanes.words[lane_word(0, ADDRESS)] % PAGE == 0
    assert len(many) >= count
    for start in (0, len(many) // len(broken) // 2 * len(broken)):
        part = many[start : start + len(broken)]
        assert [each.to_dict() for each in part] == [each.to_dict() for each in few[: len(broken)]]
    assert many.mask().sum() * len(broken) == len(many) * few[: len(broken)].mask().sum()
    again = decode.many(broken[:1], into=many)
    assert len(again) == 1
    assert again[0].to_dict() == few[0].to_dict()


def test_what_is_no_list_of_messages_is_said(decode, messages):
    batch = decode.many(messages[:2])
    for given, words in (
        ((None,), "a list of messages is needed, or a buffer and offsets, not NoneType"),
        (("text",), "a list of messages is needed, or a buffer and offsets, not str"),
        (([messages[0], None],), "message 1 is no bytes-like object, but of the type NoneType"),
        ((messages, batch), "not in a list; the batch that is to be filled is `into=…`"),
        ((np.array(messages, object), [0, 8]), "not in a ndarray"),
        ((messages[0],), "messages in one buffer take offsets"),
    ):
        with pytest.raises(TypeError, match=words):
            decode.many(*given)
    assert read(decode.many(np.array(messages, object))) == read(decode.many(messages))


def test_many_messages_are_not_one(encode, decode, messages):
    pandas = pytest.importorskip("pandas")
    batch = decode.many(messages)
    for source in (batch, batch.to_arrow(), pandas.DataFrame({"n": [1]})):
        with pytest.raises(TypeError, match=f"not {type(source).__name__}: many messages are encoded by `many`"):
            encode(source)
    with pytest.raises(TypeError, match="a batch, a list of messages, or a table or frame"):
        encode.many(5)


def test_columns_and_types_are_named(decode, messages):
    batch = decode.many(messages)
    for ask in (batch.column, batch.mask, batch[0].column):
        with pytest.raises(TypeError, match=r"a field is named by a str, not by \['n'\]"):
            ask(["n"])
    for type_ in (5, dict, decode.holder_type):
        with pytest.raises(TypeError, match="a type is a name, or a message class of protobuf's package"):
            rj.Decoder.of(type_)


def test_lanes_of_many_messages_are_little_larger_than_what_they_hold():
    """A guess that falls short by some messages doubles a lane, and copies it, shortly before the end."""
    of = {"encoding": "ros1", "backend": "llvm"}
    holder = rj.Decoder.of("sensor_msgs/LaserScan", **of).new()
    holder.ranges, holder.header.frame_id = np.arange(9), "laser"
    message = rj.Encoder.of("sensor_msgs/LaserScan", **of)(holder)
    lanes = rj.Decoder.of("sensor_msgs/LaserScan", **of).many([message] * 20_000).lanes
    for lane in range(1, len(lanes.plan.strides)):
        assert lanes.capacity(lane) <= 1.1 * max(lanes.used(lane), 1000)
