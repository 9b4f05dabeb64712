"""Objects that compiled code takes field by field: what comes of them is what Python's own way makes of them, errors included."""

from __future__ import annotations

import array
import threading
from dataclasses import dataclass, field, make_dataclass
from enum import IntEnum
from typing import Any

import numpy as np
import pytest

import rosetta_jit as rj
from rosetta_jit.errors import RosettaError
from rosetta_jit.runtime.attributes.code import library
from rosetta_jit.runtime.holder.objects.taking import Takers

SCHEMA = """
int32 count
string word
bool good
uint8[] octets
float64[] numbers
float32[3] three
int16[] shorts
string[] names
geometry_msgs/Point place
std_msgs/Header header
"""
FIELDS = ("count", "word", "good", "octets", "numbers", "three", "shorts", "names", "place", "header")


class Number(IntEnum):
    ONE = 1


class Odd(list[float]):
    """A list of another class."""


def numbered(class_name, names, *, slots):
    return make_dataclass(class_name, [(name, Any, None) for name in names], slots=slots)


@dataclass(frozen=True)
class Classes:
    whole: Any
    point: Any
    header: Any
    time: Any

    @classmethod
    def made(cls, *, slots):
        names = {"Whole": FIELDS, "Point": "xyz", "Header": ("seq", "stamp", "frame_id"), "Time": ("secs", "nsecs")}
        return cls(*(numbered(name, parts, slots=slots) for name, parts in names.items()))


@dataclass
class Case:
    changes: dict[str, Any] = field(default_factory=dict[str, Any])
    within: dict[str, Any] = field(default_factory=dict[str, Any])


def unaligned(numbers):
    content = b"\0" + np.asarray(numbers, np.float64).tobytes()
    return np.frombuffer(content, np.uint8)[1:].view(np.float64)


CASES = {
    "as it is": Case(),
    "tuples": Case({"numbers": (1.0, 2), "three": (1, 2.5, 3), "names": ("a", "b"), "octets": (1, 2), "shorts": (1, -2)}),
    "arrays": Case({"numbers": np.arange(4.0), "three": np.arange(3, dtype=np.float32), "shorts": np.arange(3, dtype=np.int16)}),
    "arrays of another type": Case({"numbers": np.arange(4, dtype=np.float32), "three": np.arange(3.0), "shorts": np.arange(3)}),
    "an array of the other byte order": Case({"numbers": np.arange(4, dtype=">f8")}),
    "an array with gaps": Case({"numbers": np.arange(8.0)[::2]}),
    "an array that is not aligned": Case({"numbers": unaligned([1.5, 2.5])}),
    "an array of two dimensions": Case({"numbers": np.ones((2, 2))}),
    "Python's own arrays": Case(
        {"numbers": array.array("d", [1.0, 2.0]), "shorts": array.array("h", [1, 2]), "octets": array.array("B", [7])}
    ),
    "numpy's scalars": Case({"count": np.int32(4), "good": np.bool_(True)}, {"x": np.float64(1.5), "y": np.int64(2)}),
    "whole numbers for floats": Case({"numbers": [1, 2.5, True]}, {"x": 3}),
    "an enumerator": Case({"count": Number.ONE}),
    "a list of another class": Case({"numbers": Odd([1.0])}),
    "nothing in arrays": Case({"numbers": [], "names": [], "octets": b"", "shorts": ()}),
    "long texts": Case({"word": "ü" * 500, "names": ["ä" * 300, "", "日本"]}),
    "too large": Case({"count": 1 << 40}),
    "too large in an array": Case({"shorts": [1, 70000]}),
    "too few": Case({"three": [1.0]}),
    "a text for a number": Case({"count": "1"}),
    "a number for a text": Case({"word": 1}),
    "a text that has no bytes": Case({"word": "\ud800"}),
    "a number among texts": Case({"names": ["a", 1]}),
    "a text among numbers": Case({"numbers": [1.0, "a"]}),
    "nothing for a number": Case({"count": None}),
    "nothing for a message": Case({"place": None}),
    "a number for a message": Case({"place": 1}),
    "a text for a number within": Case({}, {"z": "high"}),
    "a dict for a message": Case({"place": {"x": 1.0, "y": 2.0, "z": 3.0}}),
    "a dict of some for a message": Case({"place": {"x": 1.0}}),
}


@pytest.fixture(scope="module")
def encoder():
    return rj.Encoder.of("test_msgs/Steps", encoding="ros1", schema=SCHEMA)


@pytest.fixture(scope="module", params=[False, True], ids=["a dict", "slots"])
def classes(request):
    return Classes.made(slots=request.param)


def values():
    return {
        "count": 3,
        "word": "hello",
        "good": True,
        "octets": b"ab",
        "numbers": [1.0, 2.0],
        "three": [1.0, 2.0, 3.0],
        "shorts": [1, 2],
        "names": ["one", "zwei"],
        "place": {"x": 1.0, "y": 2.0, "z": 3.0},
        "header": {"seq": 1, "stamp": {"secs": 2, "nsecs": 3}, "frame_id": "base"},
    }


def changed(case):
    plain = values()
    plain["place"] |= case.within
    return plain | case.changes


def as_object(classes, plain):
    place, header = plain["place"], plain["header"]
    if isinstance(place, dict) and place.keys() == {"x", "y", "z"}:
        place = classes.point(**place)
    return classes.whole(**plain | {"place": place, "header": classes.header(header["seq"], classes.time(**header["stamp"]), "base")})


def outcome(run):
    try:
        return run()
    except (RosettaError, TypeError, ValueError, OverflowError) as error:
        return type(error), str(error)


@pytest.fixture
def by_python(monkeypatch):
    """What a call gives where compiled code takes nothing."""

    def found(run):
        with monkeypatch.context() as patch:
            patch.setattr(Takers, "steps", lambda *_: None)
            return outcome(run)

    return found


@pytest.mark.parametrize("name", CASES)
def test_objects_are_taken_as_python_takes_them(name, encoder, classes, by_python):
    usual = encoder(as_object(classes, values()))
    assert usual == encoder(values())
    made = as_object(classes, changed(CASES[name]))
    takers = encoder.holder_type.family_.takers
    slow = rj.Encoder.of("test_msgs/Steps", encoding="ros1", schema=SCHEMA)
    wanted = by_python(lambda: slow(made))
    assert [outcome(lambda: encoder(made)) for _ in range(2)] == [wanted] * 2
    assert encoder(as_object(classes, values())) == usual
    assert library() is None or takers.steps_of(classes.whole) is not None


@pytest.mark.parametrize("name", CASES)
def test_dicts_are_taken_as_python_takes_them(name, encoder):
    holder_type, plain = encoder.holder_type, changed(CASES[name])
    usual = holder_type.from_dict(values())
    assert usual == holder_type.from_dict(values())
    slow = type(usual).from_dict
    wanted = outcome(lambda: slow(dict_of_another_class(plain)))
    found = outcome(lambda: holder_type.from_dict(plain))
    assert found == wanted
    assert holder_type.from_dict(values()).to_dict() == usual.to_dict()


def dict_of_another_class(plain):
    """A mapping that compiled code leaves to Python."""

    class Plain(dict[str, Any]):
        pass

    return Plain(plain)


def test_holders_of_dicts_begin_anew(encoder):
    holder_type = encoder.holder_type
    for _ in range(3):
        several = [holder_type.from_dict(values()) for _ in range(20)]
        del several
    assert holder_type.from_dict({"count": 1}).to_dict() == holder_type().to_dict() | {"count": 1}
    with pytest.raises(RosettaError):
        holder_type.from_dict(values() | {"more": 1})


def test_a_class_that_changes_is_looked_at_anew(encoder, classes):
    mine = Classes.made(slots=hasattr(classes.whole, "__slots__"))
    made = as_object(mine, values())
    usual = encoder(made)
    assert encoder(made) == usual
    mine.point.x = property(lambda _: 9.0)
    expected = values() | {"place": {"x": 9.0, "y": 2.0, "z": 3.0}}
    assert [encoder(made) for _ in range(3)] == [encoder(expected)] * 3


def test_what_an_object_has_besides_is_refused(encoder):
    mine = Classes.made(slots=False)
    made, other = as_object(mine, values()), as_object(mine, values())
    usual = encoder(made)
    other.more = 1
    with pytest.raises(RosettaError, match="more"):
        encoder(other)
    del made.word
    made.other = "x"
    with pytest.raises(RosettaError, match="other"):
        encoder(made)
    assert encoder(as_object(mine, values())) == usual


def test_an_error_of_the_objects_own_code_comes_through(encoder):
    mine = Classes.made(slots=True)
    made = as_object(mine, values())
    encoder(made)

    class Failing(mine.point):
        __slots__ = ()

        def __init__(self):
            pass

        @property
        def x(self):
            raise RuntimeError("the sensor is off")

    made.place = Failing()
    with pytest.raises(RuntimeError, match="the sensor is off"):
        encoder(made)


def test_an_object_may_change_while_it_is_taken(encoder):
    mine = Classes.made(slots=True)
    made = as_object(mine, values())
    usual = encoder(made)

    class Changing:
        def __index__(self):
            made.names.clear()
            made.place = made.header = None
            return 3

        __int__ = __index__

    made.count = Changing()
    outcome(lambda: encoder(made))
    assert encoder(as_object(mine, values())) == usual


def test_threads_encode_objects_of_one_class(encoder, classes):
    objects = [as_object(classes, values() | {"count": number, "word": str(number)}) for number in range(4)]
    wanted = [encoder(each) for each in objects]
    wrong = []

    def run(number):
        wrong.extend(number for _ in range(300) if encoder(objects[number]) != wanted[number])

    threads = [threading.Thread(target=run, args=(number,)) for number in range(4)]
    for each in threads:
        each.start()
    for each in threads:
        each.join()
    assert not wrong


class Kept:
    """Objects that a class makes without arguments: with tuples, lists and arrays, and messages within."""

    def __init__(self):
        self.count, self.word, self.good, self.octets = 0, "", False, b""
        self.numbers, self.three, self.shorts, self.names = (), [0.0] * 3, np.zeros(0, np.int16), []
        self.place, self.header = Point(), None


class Point:
    __slots__ = ("x", "y", "z")


class Header:
    def __init__(self):
        self.seq, self.stamp, self.frame_id = 0, Time(), ""


class Time:
    __slots__ = ("nsecs", "secs")


def shown(made):
    place, header = made.place, made.header
    return (
        *(made.count, made.word, made.good, made.octets, made.numbers, made.three, list(made.shorts), made.names),
        *(place.x, place.y, place.z),
        *(header.seq, header.stamp.secs, header.stamp.nsecs, header.frame_id),
    )


def test_objects_are_made_one_like_another(encoder):
    decode = rj.Decoder.of("test_msgs/Steps", encoding="ros1", schema=SCHEMA)
    types = {"std_msgs/Header": Header}
    messages = [encoder(values() | {"count": number, "numbers": [float(number)] * number}) for number in range(5)]
    made = [decode.to(each, Kept, types=types) for each in messages]
    again = [decode.to(each, Kept, types=types) for each in reversed(messages)]
    for number, each in enumerate(made):
        wanted = (number, "hello", True, b"ab", (float(number),) * number, [1.0, 2.0, 3.0], [1, 2], ["one", "zwei"])
        assert shown(each) == shown(again[-1 - number]) == (*wanted, 1.0, 2.0, 3.0, 1, 2, 3, "base")
    assert isinstance(made[0].shorts, np.ndarray)
    assert len({id(each.place) for each in made}) == len(made)


def test_a_message_that_is_wrong_spoils_no_other_object():
    made = make_dataclass("Made", [(name, Any, None) for name in ("x", "y", "z")])
    decode, encode = (each.of("geometry_msgs/Point", encoding="ros1") for each in (rj.Decoder, rj.Encoder))
    message = encode({"x": 1.0, "y": 2.0, "z": 3.0})
    for object_type in (Point, made):
        for _ in range(3):
            found = decode.to(message, object_type)
            assert (found.x, found.y, found.z) == (1.0, 2.0, 3.0)
            with pytest.raises(RosettaError):
                decode.to(message[:-1], object_type)
            with pytest.raises(TypeError):
                decode.to(1, object_type)
