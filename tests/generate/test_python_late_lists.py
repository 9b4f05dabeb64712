"""Messages with many lists and maps, in generated Python: an object of which none has come gets them when somebody asks for one."""

from __future__ import annotations

import copy
import dataclasses
import inspect
import pickle
import random
import threading

import numpy as np
import pytest

import rosetta_jit as rj
from rosetta_jit.api.options import type_request
from rosetta_jit.generate.build import NO_WISHES, Wishes
from tests.generate.driver import harmed
from tests.generate.python import BOTH, answers_as_the_library, module, protobuf, source_of

LISTS = " ".join(
    f"repeated {kind} l{number} = {number};" for number, kind in enumerate(("string", "bytes", "bool", "double", "sint32") * 4, 1)
)
MAPS = " ".join(f"map<int32, {kind}> m{number} = {number};" for number, kind in enumerate(("string", "Inner") * 3, 31))
BODY = f"""
    message Inner {{ repeated string texts = 1; int32 number = 2; }}
    message M {{
        int32 first = 50; {LISTS} string text = 51; {MAPS} Inner inner = 52; repeated Inner inners = 53;
        oneof which {{ Inner case = 54; string word = 55; }} optional bool said = 56;
    }}
"""
GIVEN = protobuf(BODY)
VALUES = {
    "first": 7,
    "l1": ["ä"],
    "l2": [b"x", b""],
    "l3": [True],
    "l20": [-1],
    "text": "ä",
    "m31": {1: "one"},
    "m36": {2: {"texts": ["a"]}},
    "inner": {"texts": ["a", ""]},
    "inners": [{}, {"number": 1}],
    "case": {"texts": ["b"]},
    "said": True,
}
SOME = ("first", "text", "inner", "case", "said")
"""Those that are no lists."""
UNKNOWN = b"\xf8\x06\x05"


@pytest.fixture(scope="module", params=[NO_WISHES, Wishes(numpy=True)], ids=["lists", "arrays"])
def unit(request):
    return module(type_request("decode", "t.M", GIVEN), BOTH, request.param)


@pytest.fixture(scope="module", params=[NO_WISHES, Wishes(numpy=True)], ids=["lists", "arrays"])
def wide(request):
    kinds = ("string", "bytes", "bool", "double", "sint32") * 8
    lists = " ".join(f"repeated {kind} l{number} = {number};" for number, kind in enumerate(kinds, 1))
    given = protobuf(f"message M {{ int32 first = 50; string text = 51; {lists} }}")
    return module(type_request("decode", "t.M", given), BOTH, request.param)


def encoded(values) -> bytes:
    encoder = rj.Encoder.of("t.M", **GIVEN)
    return bytes(encoder(encoder.holder_type.from_dict(values)))


def without_lists(unit):
    return unit.decode(encoded({name: VALUES[name] for name in SOME}))


def has_lists(unit, message) -> bool:
    return type(message) is unit.M


def lacking(unit, message) -> str:
    """Which of its groups of some ten lists an object lacks."""
    return "".join(str(group) for group in range(5) if unit._lacking.get(type(message), 0) >> group & 1)


def test_messages_have_some_of_their_lists(unit):
    """None, each alone, several, in any order; with fields that the schema does not know; and broken."""
    programs = rj.Decoder.of("t.M", **GIVEN), rj.Encoder.of("t.M", **GIVEN)
    parts, chance = {name: encoded({name: value}) for name, value in VALUES.items()}, random.Random("lists")
    messages = [b"", UNKNOWN, *parts.values(), b"".join(parts[name] for name in SOME)]
    for _ in range(16):
        some = chance.sample([*parts.values(), UNKNOWN], 4)
        messages.append(b"".join(some))
    answers_as_the_library(unit, programs, harmed(messages, 8, "lists"))


def test_nothing_is_made_before_somebody_asks(unit):
    message = encoded({name: VALUES[name] for name in SOME})
    found = unit.decode(message)
    assert (found.first, found.text, found.said, found.inner.texts, found.unknown_fields) == (7, "ä", True, ["a", ""], b"")
    assert unit.encode(found) == message
    assert lacking(unit, found) == "012"
    assert (len(found.l20), lacking(unit, found)) == (0, "01")
    assert (len(found.m31), lacking(unit, found)) == (0, "01")
    assert (len(found.l1), len(found.l10), has_lists(unit, found)) == (0, 0, True)
    assert lacking(unit, unit.decode(encoded({"l3": [True]}))) == "12"
    assert has_lists(unit, unit.decode(encoded({"l3": [True], "l12": [b""], "inners": [{}]})))


def test_it_is_what_an_object_with_lists_is(unit):
    other = without_lists(unit)
    made = unit.M(**{each.name: getattr(other, each.name) for each in dataclasses.fields(unit.M)})
    assert without_lists(unit) == made
    assert made == without_lists(unit)
    assert without_lists(unit) == without_lists(unit) != unit.M()
    assert unit.decode(b"") == unit.M() == unit.decode(b"")
    assert repr(without_lists(unit)) == repr(made)
    found = without_lists(unit)
    assert isinstance(found, unit.M)
    assert (type(found).__name__, type(found).__qualname__, type(found).__module__, found.__class__) == ("M", "M", "generated_unit", unit.M)
    assert (type(found).__doc__, found.__slots__) == (unit.M.__doc__, unit.M.__slots__)
    assert not has_lists(unit, found)
    with pytest.raises(TypeError):
        hash(found)


def pickled(message, protocol=pickle.DEFAULT_PROTOCOL):
    return pickle.loads(pickle.dumps(message, protocol))  # noqa: S301 - of ourselves


@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy, dataclasses.replace, pickled, lambda message: pickled(message, 2)])
def test_copies(unit, copied):
    found = without_lists(unit)
    other = copied(found)
    assert has_lists(unit, other)
    assert other == found == without_lists(unit)
    if copied is copy.copy:
        assert other.l1 is found.l1


def test_dataclasses_know_it(unit):
    found, made = without_lists(unit), unit.M()
    assert dataclasses.is_dataclass(found)
    assert [each.name for each in dataclasses.fields(found)] == [each.name for each in dataclasses.fields(made)]
    assert {name: value for name, value in dataclasses.asdict(found).items() if name[0] == "m"} == {
        f"m{number}": {} for number in range(31, 37)
    }
    assert dataclasses.replace(without_lists(unit), l1=["a"]).l1 == ["a"]


def test_patterns_match_it(unit):
    match without_lists(unit):
        case unit.M(first=7, l1=[], m31={}):
            pass
        case other:
            pytest.fail(repr(other))


def test_whatever_is_set_is_encoded(unit):
    for name, value, lacks in (("l1", ["a"], "12"), ("first", 8, "012"), ("m31", {1: "b"}, "01"), ("text", "", "012")):
        found = without_lists(unit)
        setattr(found, name, value)
        assert lacking(unit, found) == lacks
        assert getattr(unit.decode(unit.encode(found)), name) == value
    found = without_lists(unit)
    found.l1.append("a")
    found.m36[3] = unit.Inner(number=3)
    assert (without_lists(unit).l1, without_lists(unit).m36) == ([], {})
    assert unit.decode(unit.encode(found)) == found


def test_no_attribute_is_new(unit):
    found = without_lists(unit)
    with pytest.raises(AttributeError, match="'M' object has no attribute 'l0'"):
        _ = found.l0
    for act in (lambda message: setattr(message, "l0", 1), lambda message: delattr(message, "l0")):
        with pytest.raises(AttributeError):
            act(without_lists(unit))
    found = without_lists(unit)
    del found.l1
    assert not hasattr(found, "l1")
    with pytest.raises(unit.EncodeError):
        unit.encode(found)
    assert found.l2 == []


def test_its_class_can_be_changed(unit):
    other = type("Other", (unit.M,), {"__slots__": ()})
    found = without_lists(unit)
    found.__class__ = other
    assert type(found) is other
    assert found.l1 == []


def test_an_object_that_is_made_without_lists_lacks_them(wide):
    made = wide.M(first=7, text="ä")
    assert (made.first, made.text, made.unknown_fields, lacking(wide, made)) == (7, "ä", b"", "01234")
    made.text, made.first = "a", 8
    assert lacking(wide, made) == "01234"
    assert wide.encode(wide.M(first=7)) == wide.encode(wide.M(7))
    made.l1.append("a")
    assert (made.l1, wide.M().l1, lacking(wide, made)) == (["a"], [], "1234")


def test_an_object_that_is_made_with_a_few_lists_lacks_the_others(wide):
    made = wide.M(l1=["a"], text="ä", l40=[1])
    assert (made.l1, made.text, [*made.l40], lacking(wide, made)) == (["a"], "ä", [1], "123")
    assert wide.encode(made) == wide.encode(wide.M(0, "ä", l1=["a"], l40=[1]))
    assert has_lists(wide, wide.M(l1=[], l11=[], l21=[], l31=[]))
    assert has_lists(wide, wide.M(7))


def test_an_object_of_less_than_36_lists_is_made_with_them(unit):
    assert has_lists(unit, unit.M(first=7))
    assert unit.encode(unit.M(first=7)) == encoded({"first": 7})


def test_a_class_is_called_as_one_of_few_lists(wide):
    assert [*inspect.signature(wide.M).parameters] == [each.name for each in dataclasses.fields(wide.M)]
    for given in ({"l0": 1}, {"first": 1, "l41": []}):
        with pytest.raises(TypeError, match="unexpected keyword argument 'l"):
            wide.M(**given)
    with pytest.raises(TypeError, match="multiple values for argument 'first'"):
        wide.M(1, first=7)
    other = type("Other", (wide.M,), {"__slots__": ()})
    assert type(other(first=7)) is other
    assert wide.encode(other(first=7)) == wide.encode(wide.M(first=7))


def test_few_lists_are_made_at_once():
    text = source_of(type_request("decode", "t.M", protobuf(f"message M {{ {LISTS} }}")))
    assert "_without_lists" not in text


def test_arrays_are_new_ones():
    unit = module(
        type_request("decode", "t.M", protobuf("message M { repeated double a = 1; repeated bool b = 2; }")), BOTH, Wishes(numpy=True)
    )
    first, second = unit.decode(b""), unit.decode(b"")
    assert first.a is not second.a
    assert (first.a.dtype, first.b.dtype, first.a.shape, first.a.flags.writeable) == (np.float64, np.bool_, (0,), True)


def test_threads_get_the_same_lists():
    """All of them ask at once for lists of objects that have none yet, and append to them."""
    unit = module(type_request("decode", "t.M", GIVEN))
    messages, threads = [unit.decode(b"") for _ in range(300)], 4
    start = threading.Barrier(threads)

    def append(number: int) -> None:
        start.wait()
        for message in messages:
            getattr(message, f"l{1 + number}").append(number)
            message.l1.append(number)

    workers = [threading.Thread(target=append, args=(number,)) for number in range(threads)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert all(len(message.l1) == threads + 1 and len(message.l4) == 1 for message in messages)
