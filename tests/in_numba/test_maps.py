"""Maps in users' own compiled functions, which read them as Python does."""

from __future__ import annotations

import random
import sys

import numpy as np
import pytest
from numba import njit
from numba.core.errors import TypingError

import rosetta_jit as rj

SCHEMA = {
    "m.proto": """
    syntax = "proto3"; package m;
    message Inner { double a = 1; string s = 2; }
    message M {
      map<string, int32> table = 1; map<int64, Inner> inners = 2; map<bool, string> words = 3; map<uint64, double> numbers = 4;
    }
    """
}


@pytest.fixture(scope="module")
def decoder():
    made = rj.Decoder.of("m.M", schema=SCHEMA)
    assert made.kernel is not None
    return made


@pytest.fixture
def holder(decoder):
    made = decoder.new()
    made.table.update({"one": 1, "zwölf": 12, "": -1})
    for number in (5, -3):
        made.inners[number].a, made.inners[number].s = number / 2, "x" * abs(number)
    made.words[True] = "yes"
    return made


def test_values_by_keys(holder):
    @njit
    def read(holder, name):
        table = holder.table
        return table["one"], table["zwölf"], table[""], table[name], holder.inners[-3].a, len(holder.words[True])

    assert read(holder, b"one") == read(holder, np.frombuffer(b"one", np.uint8)) == (1, 12, -1, 1, -1.5, 3)


def test_whether_a_key_is_there(holder):
    @njit
    def read(holder, number):
        return "one" in holder.table, "two" in holder.table, number in holder.inners, False in holder.words, "on" not in holder.table

    assert read(holder, 5) == (True, False, True, False, True)
    assert read(holder, 6) == (True, False, False, False, True)


def test_a_key_that_is_not_there(holder):
    with pytest.raises(KeyError, match="no such key"):
        njit(lambda holder: holder.table["two"])(holder)


def test_iteration(holder):
    @njit
    def read(holder):
        keys = [len(key) for key in holder.table]
        again = [len(key) for key in holder.table.keys()]  # noqa: SIM118 - it is what is tested
        values = [value for value in holder.table.values()]  # noqa: C416 - numba makes no list of it otherwise
        pairs = [(number, inner.a, len(inner.s)) for number, inner in holder.inners.items()]
        return keys, again, values, pairs, len(holder.table), len(holder.numbers)

    assert read(holder) == ([3, 6, 0], [3, 6, 0], [1, 12, -1], [(5, 2.5, 5), (-3, -1.5, 3)], 3, 0)


def pair(number, value):
    """A pair of `numbers`, as protobuf writes it."""
    inner = b"\x08" + bytes([number]) + b"\x11" + np.float64(value).tobytes()
    return b"\x22" + bytes([len(inner)]) + inner


def test_keys_that_come_twice(decoder):
    """The last pair of a key counts, and it stands where the first was."""
    kernel = decoder.kernel

    @njit
    def read(message, holder, key):
        kernel(message, holder)
        numbers = holder.numbers
        return [pair for pair in numbers.items()], len(numbers), numbers[key]  # noqa: C416 - as above

    choose = random.Random(3)
    for count in (1, 2, 3, 7, 100):
        keys = [choose.randrange(1, 2 + count // 2) for _ in range(count)]
        message = b"".join(pair(key, at) for at, key in enumerate(keys))
        expected = dict(decoder(message).numbers)
        assert expected == {key: float(at) for at, key in enumerate(keys)}
        pairs, length, value = read(message, decoder.new(), keys[0])
        assert pairs == list(expected.items())
        assert (length, value) == (len(expected), expected[keys[0]])


def test_texts_are_ordered_by_their_bytes(decoder):
    """Many texts, of which some are begins of others: sorting finds those that came twice."""
    choose, made = random.Random(5), decoder.new()
    for number in range(200):
        made.table["ab"[: choose.randrange(3)] * choose.randrange(4) + chr(choose.randrange(97, 100))] = number

    @njit
    def read(holder):
        return [value for value in holder.table.values()], len(holder.table)  # noqa: C416 - as above

    twice = decoder(made.SerializeToString() + made.SerializeToString())
    assert read(twice) == (list(made.table.values()), len(made.table))


def test_a_map_keeps_its_holder_alive(decoder, holder):
    @njit
    def read(holder):
        table = holder.table
        return [key for key in table]  # noqa: C416 - as above

    @njit
    def iterate(holder):
        return [len(key) for key, inner in holder.table.items()]

    count = sys.getrefcount(holder)
    for _ in range(10):
        keys = read(holder)
        assert sum(iterate(holder)) == sum(len(key) for key in keys)
    assert sys.getrefcount(holder) == count + 1  # for the keys that are there
    holder.table.update({str(number): number for number in range(1000)})
    del holder
    assert [bytes(key).decode() for key in keys] == ["one", "zwölf", ""]


@pytest.mark.parametrize(
    ("read", "said"),
    [
        (lambda holder: holder.table[1], "a key of this map is a text"),
        (lambda holder: "one" in holder.inners, "a key of this map is int64"),
        (lambda holder: holder.words[1], "a key of this map is bool"),
    ],
)
def test_keys_of_another_type(holder, read, said):
    with pytest.raises(TypingError, match=said):
        njit(read)(holder)
