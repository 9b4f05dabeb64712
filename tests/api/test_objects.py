"""Encoders take dicts and objects of other classes, decoders fill and make such objects: by the names of attributes."""

from __future__ import annotations

import array
import threading
from dataclasses import dataclass, field, replace
from enum import IntEnum
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest

import rosetta_jit as rj
from rosetta_jit.errors import ValuesError

SCHEMA = {
    "p/Part.msg": "int32 number\nstring label\ntime when\n",
    "p/Whole.msg": "bool flag\nfloat64 x\nint16[] samples\nfloat32[3] axis\nuint8[] raw\nstring[] names\n"
    "p/Part part\np/Part[] parts\ntime[] times\n",
}


@dataclass
class Moment:
    secs: int = 0
    nsecs: int = 0


@dataclass(slots=True)
class Part:
    number: int
    label: str
    when: Moment


@dataclass
class Whole:
    flag: bool
    x: float
    samples: list[int]
    axis: np.ndarray
    raw: bytes
    names: list[str]
    part: Part
    parts: list[Part]
    times: tuple[Moment, ...] = field(default_factory=tuple)


@pytest.fixture(scope="module")
def encode():
    return rj.Encoder.of("p/Whole", schema=SCHEMA, encoding="ros1", imports=["p/Whole.msg"])


@pytest.fixture(scope="module")
def decode():
    return rj.Decoder.of("p/Whole", schema=SCHEMA, encoding="ros1", imports=["p/Whole.msg"])


def plain(number=1):
    def part(each):
        return {"number": each, "label": f"é{each}", "when": {"secs": each, "nsecs": 5}}

    return {
        "flag": True,
        "x": 0.5,
        "samples": [number, -2],
        "axis": [0.5, 1.5, -2.0],
        "raw": b"\0\xff",
        "names": ["a", "bc"],
        "part": part(7),
        "parts": [part(each) for each in range(number)],
        "times": [{"secs": 1, "nsecs": 2}],
    }


def of_part(values):
    return Part(values["number"], values["label"], Moment(**values["when"]))


def whole(number=1):
    values = plain(number)
    values |= {"part": of_part(values["part"]), "parts": [of_part(each) for each in values["parts"]]}
    return Whole(**values | {"times": tuple(Moment(**each) for each in values["times"])})


def spaces(value):
    match value:
        case dict():
            return SimpleNamespace(**{name: spaces(each) for name, each in value.items()})
        case list():
            return [spaces(each) for each in value]
        case _:
            return value


@pytest.mark.parametrize("number", [0, 1, 5])
def test_a_dict_an_object_and_a_holder_give_the_same_bytes(encode, decode, number):
    expected = encode(encode.holder_type.from_dict(plain(number)))
    assert encode(plain(number)) == encode(whole(number)) == encode(spaces(plain(number))) == expected
    assert encode.size(whole(number)) == len(expected)
    buffer = bytearray(len(expected) + 3)
    assert encode.into(plain(number), buffer, 3) == len(buffer)
    assert buffer[3:] == expected
    assert decode(expected).to_dict() == plain(number)


def test_nothing_is_left_of_the_object_before(encode):
    encode(plain(5))
    empty = encode.holder_type()
    assert encode({}) == encode(empty)
    with pytest.raises(ValuesError):
        encode(plain(2) | {"samples": [1 << 20]})
    assert encode({"x": 2.0}) == encode(encode.holder_type.from_dict({"x": 2.0}))


@pytest.mark.parametrize(
    ("change", "path", "says"),
    [
        ({"x": "1"}, ".x", "real number"),
        ({"samples": [1, 1 << 15]}, ".samples", "out of range"),
        ({"axis": [1.0]}, ".axis", "the type has 3"),
        ({"names": ["a", 1]}, ".names[1]", "expected str"),
        ({"names": "ab"}, ".names", "expected a sequence"),
        ({"part": 3}, ".part", "expected a message or a dict, int found"),
        ({"parts": [plain()["part"], plain()["part"] | {"number": 1 << 31}]}, ".parts[1].number", "out of range"),
        ({"parts": [plain()["part"] | {"nubmer": 1}]}, ".parts[0].nubmer", "no such field"),
        ({"part": None}, ".part", "NoneType found"),
        ({"x": None}, ".x", "real number"),
    ],
)
def test_what_is_wrong_and_where(encode, change, path, says):
    for made in (plain() | change, spaces(plain() | change)):
        with pytest.raises(ValuesError, match=says) as caught:
            encode(made)
        assert caught.value.path == path
    assert encode(whole()) == encode(plain())


def test_an_object_has_every_field_and_no_other(encode):
    lacking, further = whole(), whole()
    del lacking.samples
    further.sampels = [1]
    with pytest.raises(ValuesError, match=r"Whole has no attribute 'samples' - at `\.samples`"):
        encode(lacking)
    with pytest.raises(ValuesError, match=r"no such field, and Whole such an attribute - at `\.sampels`"):
        encode(further)
    further.__dict__.pop("sampels")
    further._cache = 1
    assert encode(further) == encode(plain())
    inner = spaces(plain())
    inner.part.when.minutes = 1
    with pytest.raises(ValuesError, match=r"at `\.part\.when\.minutes`"):
        encode(inner)


@pytest.mark.parametrize("wrong", [None, 1, "text", b"bytes", [1], (1,), np.zeros(3), Whole, {1}, object()])
def test_what_is_no_message(encode, decode, wrong):
    with pytest.raises(TypeError, match="a holder of"):
        encode(wrong)
    with pytest.raises(TypeError, match="a holder of"):
        encode.size(wrong)
    with pytest.raises(TypeError):
        decode.into(encode(plain()), wrong)


def test_a_decoder_fills_an_object_in_place(encode, decode):
    value = whole(0)
    part, moment = value.part, value.part.when
    value.samples, value.raw = array.array("h"), bytearray()
    assert decode.into(encode(plain(3)), value) is value
    assert value.part is part
    assert part.when is moment
    assert (type(value.samples), value.samples.tolist(), value.raw) == (array.array, [3, -2], bytearray(b"\0\xff"))
    assert (value.names, value.parts[2].label, value.times) == (["a", "bc"], "é2", (Moment(1, 2),))
    assert encode(value) == encode(plain(3))


def test_what_is_made_shows_no_memory_of_a_holder(encode, decode):
    one = decode.to(encode(plain(2)), Whole)
    other = decode.to(encode(plain(3)), Whole)
    assert type(one.axis) is np.ndarray
    assert one.axis.base is None
    assert (one.samples, other.samples) == ([2, -2], [3, -2])
    assert encode(one) == encode(plain(2))


def test_a_damaged_message_leaves_an_object_as_it_was(encode, decode):
    value = whole(2)
    with pytest.raises(rj.DecodeError):
        decode.into(encode(plain(3))[:-1], value)
    assert value == whole(2) or value.samples == [2, -2]
    assert decode(encode(plain())).x == 0.5


@dataclass
class Bare:
    label: str


def test_classes_that_nobody_knows(encode, decode):
    class Plain:
        pass

    with pytest.raises(ValuesError, match=r"no class is known for p/Part: name it in `types` - at `\.part`"):
        decode.to(encode(plain()), Plain)
    with pytest.raises(ValuesError, match=r"Bare has no attribute 'number' - at `\.number`"):
        rj.Decoder.of("p/Part", schema=SCHEMA, encoding="ros1", imports=["p/Part.msg"]).to(bytes(16), Bare)
    made = decode.to(encode(plain(2)), Plain, types={"p/msg/Part": Part, "time": Moment})
    assert (made.part, made.parts[1].number, made.times) == (of_part(plain()["part"]), 1, [Moment(1, 2)])


class Color(IntEnum):
    RED = 0
    GREEN = 1


PROTO = {
    "c.proto": 'syntax = "proto2";\nmessage C { enum K { RED = 0; GREEN = 1; }\n'
    "optional K k = 1; repeated K ks = 2; map<string, C> m = 3; optional C c = 4; }\n"
}


@dataclass
class C:
    k: Color | None = None
    ks: list[Color] = field(default_factory=list)
    m: dict[str, C] = field(default_factory=dict)
    c: C | None = None


def test_enumerators_maps_and_what_is_absent():
    encode = rj.Encoder.of("C", schema=PROTO, encoding="protobuf", imports=["c.proto"])
    decode = rj.Decoder.of("C", schema=PROTO, encoding="protobuf", imports=["c.proto"])
    value = C(Color.GREEN, [Color.RED, Color.GREEN], {"a": C(), "b": C(Color.RED)}, C(c=C()))
    assert decode(encode(value)).to_dict() == {
        "k": "GREEN",
        "ks": ["RED", "GREEN"],
        "m": {"a": {"ks": [], "m": {}}, "b": {"k": "RED", "ks": [], "m": {}}},
        "c": {"ks": [], "m": {}, "c": {"ks": [], "m": {}}},
    }
    assert decode.to(encode(value), C) == value
    value.c.c = value
    with pytest.raises(ValuesError, match="more than 100 deep"):
        encode(value)


def test_objects_of_many_threads_and_of_themselves(encode):
    class Nosy(SimpleNamespace):
        """Encodes another object while it is read."""

        def __getattr__(self, name):
            if name == "x":
                encode(plain(4))
                return 0.5
            raise AttributeError(name)

    nosy = Nosy(**{name: value for name, value in vars(spaces(plain())).items() if name != "x"})
    assert encode(nosy) == encode(plain())
    wrong = []

    def work(number):
        expected = encode(encode.holder_type.from_dict(plain(number)))
        got = [encode(make(number)) for _ in range(50) for make in (whole, plain)]
        wrong.extend(each for each in got if each != expected)

    threads = [threading.Thread(target=work, args=[number]) for number in range(4)]
    for each in threads:
        each.start()
    for each in threads:
        each.join()
    assert not wrong


def test_parts_of_holders_are_encoded_as_their_type(encode):
    alone = rj.Encoder.of("p/Part", schema=SCHEMA, encoding="ros1", imports=["p/Whole.msg"])
    whole = encode.new()
    whole.part.number, whole.part.label = 7, "seven"
    whole.parts = [{"number": 8, "label": "eight", "when": {"secs": 1, "nsecs": 2}}]
    part = alone.new()
    part.number, part.label = 7, "seven"
    assert alone(whole.part) == alone(part)
    assert alone.size(whole.parts[0]) == len(alone(whole.parts[0])) == 21
    buffer = bytearray(30)
    assert alone(whole.parts[0], buffer, 3) == 24
    assert buffer[3:24] == alone({"number": 8, "label": "eight", "when": {"secs": 1, "nsecs": 2}})
    with pytest.raises(TypeError, match=r"a holder of p\.Part is needed, not Whole"):
        alone(whole)


def test_lists_of_messages_are_encoded_in_one_call(encode):
    alone = rj.Encoder.of("p/Part", schema=SCHEMA, encoding="ros1", imports=["p/Whole.msg"])
    part = alone.new()
    part.label = "a"
    messages = [part, {"number": 2, "label": "bc", "when": {"secs": 3, "nsecs": 4}}, Part(3, "", Moment(5, 6))]
    buffer, offsets = alone.many(messages)
    assert [buffer[begin:end].tobytes() for begin, end in pairwise(offsets)] == [alone(each) for each in messages]
    buffer[0] = 1
    assert [each.tolist() for each in alone.many(())] == [[], [0]]
    with pytest.raises(ValuesError, match=r"at `\[1\]\.number`"):
        alone.many([part, {"number": "two", "label": "", "when": {"secs": 0, "nsecs": 0}}])
    encode_latin = rj.Encoder.of("p/Part", schema=SCHEMA, encoding="ros1", imports=["p/Whole.msg"])
    with pytest.raises(TypeError):
        encode_latin.many([part, 3])


def test_messages_of_batches_are_encoded_where_they_lie(encode, decode):
    values = [
        Whole(True, number / 2, [number] * number, np.zeros(3), b"r" * number, ["n"] * number, Part(number, "p", Moment()), [])
        for number in range(4)
    ]
    messages = [encode(replace(each, parts=[each.part] * 2)) for each in values]
    borrowing = rj.Decoder.of("p/Whole", schema=SCHEMA, encoding="ros1", imports=["p/Whole.msg"], borrow=True)
    for batch in (decode.many(messages), borrowing.many(messages)):
        assert [encode(batch[number]) for number in range(4)] == messages
        buffer = bytearray(5 + len(messages[3]))
        assert encode(batch[3], buffer, 5) == len(buffer)
        assert buffer[5:] == messages[3]
        with pytest.raises(BufferError, match="are left behind offset"):
            encode(batch[3], buffer, 6)
        with pytest.raises(BufferError, match="offset -1 lies before"):
            encode(batch[3], buffer, -1)
    row = batch[0]
    with pytest.raises(rj.DecodeError):
        borrowing.many([messages[0][:-1]], into=batch)
    with pytest.raises(rj.InvalidHolder):
        encode(row)
    assert encode(decode(messages[2])) == messages[2]


def test_each_message_of_a_batch_gets_the_next_number():
    schema = {"n.bottle-schema": '"n" (("value" :int))', "w.bottle-schema": '"w" (("value" :int))'}
    head = 'import "n.bottle-schema"\nimport "w.bottle-schema"\ndata-holder: n\nwire-schema: w\n'
    files = {
        **schema,
        "m.mapping": f"{head}pack-rules:\n  .value = int32(counter())\n",
        "plain.mapping": f"{head}rules:\n  .value <-> .value\n",
    }
    counting = rj.Encoder("m.mapping", schema=files, encoding="yarp3")
    batch = rj.Decoder("plain.mapping", schema=files, encoding="yarp3").many([counting(counting.new()) for _ in range(3)])
    assert batch.value.tolist() == [0, 1, 2]
    assert [counting(batch[2])[-4:] for _ in range(2)] == [bytes([number, 0, 0, 0]) for number in (3, 4)]


def test_holders_of_a_type_of_the_same_name_in_another_framework():
    """Field by field, where no field can be absent; and what one of them cannot hold is said."""
    one = rj.Encoder.of("p/msg/Part", schema={"p/msg/Part.msg": "int32 number\nstring label\n"}, encoding="cdr")
    other = rj.Decoder.of("p/Part", schema={"p/Part.msg": "int64 number\nstring label\n"}, encoding="ros1").new()
    other.number, other.label = 7, "seven"
    assert one(other) == one({"number": 7, "label": "seven"})
    other.number = 1 << 40
    with pytest.raises(ValuesError, match="number"):
        one(other)
    other.number = 8
    assert one(other) == one({"number": 8, "label": "seven"})
