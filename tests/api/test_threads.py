"""Threads that share decoders, encoders, holders, views and batches get what is right, or `InUse`; none ends the process."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING

import pytest

import rosetta_jit as rj
from rosetta_jit.runtime.holder.dictionary import Dictionary
from tests.api.sharing import CHOICES, KINDS

if TYPE_CHECKING:
    from collections.abc import Callable


def share(kind, seconds):
    command = [sys.executable, "-m", "tests.api.sharing", kind, str(seconds)]
    ended = subprocess.run(command, check=False, capture_output=True, text=True, timeout=seconds + 120)
    assert ended.returncode == 0, f"{ended.returncode}: {ended.stdout}\n{ended.stderr[-3000:]}"


@pytest.mark.parametrize("kind", KINDS)
def test_sharing(kind):
    share(kind, 0.15)


@pytest.mark.campaign
@pytest.mark.parametrize("kind", KINDS)
def test_sharing_for_long(kind):
    share(kind, 120)


@pytest.mark.parametrize("view", ["items", "values"])
def test_pairs_of_a_map_that_are_gone_are_not_put_back(view):
    options = {"schema": CHOICES, "imports": ["choices.proto"], "encoding": "protobuf"}
    decode, encode = rj.Decoder.of("p.C", **options), rj.Encoder.of("p.C", **options)
    holder = decode(encode(encode.holder_type.from_dict({"k": {1: "one", 2: "two"}})), decode.new())
    pairs = iter(getattr(holder.k, view)())
    next(pairs)
    decode(b"", holder)
    with pytest.raises(KeyError):
        next(pairs)
    assert holder.to_dict()["k"] == {}


TEXTS = {"texts.proto": 'syntax = "proto3"; package p; message T { repeated string s = 1; repeated T m = 2; map<int32, T> k = 3; }'}


def _texts(*texts):
    options = {"schema": TEXTS, "imports": ["texts.proto"], "encoding": "protobuf"}
    return rj.Encoder.of("p.T", **options).holder_type.from_dict({"s": list(texts), "m": [{"s": [each]} for each in texts]})


def test_a_list_read_backwards_ends_where_another_thread_has_cut_it():
    holder = _texts("a", "b", "c", "d")
    backwards = reversed(holder.s)
    assert next(backwards) == "d"
    del holder.s[1:]
    assert list(backwards) == []
    assert list(reversed(holder.s)) == ["a"]
    assert [each.s[0] for each in reversed(holder.m)] == ["d", "c", "b", "a"]


def test_a_list_that_changes_while_it_is_sorted_loses_nothing():
    holder = _texts("b", "a")

    def key(text):
        if "late" not in holder.s:
            holder.s.append("late")
        return text

    with pytest.raises(rj.InUse):
        holder.s.sort(key=key)
    assert list(holder.s) == ["b", "a", "late"]


class Interrupting:
    """A value that equals "b", and changes the list when it is first compared with that."""

    def __init__(self, change):
        self.changes = [change]

    def __eq__(self, other):
        while other == "b" and self.changes:
            self.changes.pop()()
        return other == "b"

    __hash__ = None


def test_an_element_is_removed_only_where_it_still_stands():
    holder = _texts("a", "b", "c")
    with pytest.raises(rj.InUse):
        holder.s.remove(Interrupting(lambda: holder.s.insert(0, "new")))
    assert sorted(set(holder.s)) == ["a", "b", "c", "new"]
    holder.s.remove("b")
    assert "b" not in holder.s
    with pytest.raises(ValueError):  # noqa: PT011 - Python's own, which has no words
        holder.s.remove("b")


def test_a_slice_is_put_only_where_its_list_is_as_it_was():
    holder = _texts("a", "b", "c")

    def elements():
        holder.s.append("late")
        yield "x"

    with pytest.raises(rj.InUse):
        holder.s[0:1] = elements()
    assert list(holder.s) == ["a", "b", "c", "late"]


def test_a_message_taken_out_of_a_map_stays_what_it_was():
    maps = _texts()
    maps.CopyFrom(type(maps).from_dict({"k": {each: {"s": [str(each)]} for each in (1, 2, 3)}}))
    popped = maps.k.pop(1)
    key, other = maps.k.popitem()
    assert (list(popped.s), other.s, maps.to_dict()["k"].keys()) == (["1"], [str(key)], {2, 3} - {key})
    maps.k.clear()
    assert list(popped.s) == ["1"]
    assert maps.k.pop(1, None) is None
    for missing in (lambda: maps.k.pop(1), maps.k.popitem):
        with pytest.raises(KeyError):
            missing()


class LateKey:
    """The key 1, which changes the map when the map asks what key it is."""

    def __init__(self, change):
        self.change = change

    def __index__(self):
        self.change()
        return 1


def test_a_key_is_taken_out_only_of_the_map_that_was_read():
    holder = _texts()
    holder.k[1].s.append("one")
    with pytest.raises(rj.InUse):
        holder.k.pop(LateKey(lambda: holder.k[1].s.append("late")))
    assert list(holder.k[1].s) == ["one", "late"]


def _numbers(*elements):
    schema = {"n.proto": 'syntax = "proto3"; package p; message N { repeated int32 v = 1; map<int32, string> k = 2; }'}
    return rj.Decoder.of("p.N", schema=schema, imports=["n.proto"], encoding="protobuf").holder_type(v=elements)


@pytest.mark.parametrize(
    "change",
    [
        lambda v, late: v.sort(key=lambda each: late() or each),
        lambda v, late: v.remove(Late(late)),
        lambda v, late: v.insert(LateIndex(late), 9),
        lambda v, late: v.pop(LateIndex(late)),
        lambda v, late: v.__delitem__(LateIndex(late)),
    ],
    ids=["sort", "remove", "insert", "pop", "del"],
)
def test_numbers_are_changed_only_where_their_list_is_as_it_was(change):
    holder = _numbers(3, 1, 2)
    with pytest.raises(rj.InUse):
        change(holder.v, lambda: holder.v.append(7) if 7 not in holder.v.tolist() else None)
    assert holder.v.tolist() == [3, 1, 2, 7]
    change(holder.v, lambda: None)
    assert holder.v.tolist() != [3, 1, 2, 7]


def test_numbers_are_cleared_whatever_was_there(monkeypatch):
    """To clear them nothing is read, so that no change of another thread stands in the way."""
    holder = _numbers(3, 1, 2)
    numbers = holder.v
    monkeypatch.setattr(type(holder.lanes_), "consistent", lambda *_: pytest.fail("the elements were read"))
    numbers.clear()
    monkeypatch.undo()
    assert holder.v.tolist() == []


@dataclass
class LateIndex:
    """An index, the first, at which something else happens before."""

    happens: Callable[[], object]

    def __index__(self):
        self.happens()
        return 0


@dataclass(eq=False)
class Late(LateIndex):
    """A value that equals any, after something else has happened."""

    def __eq__(self, _):
        self.happens()
        return True

    __hash__ = None


def test_a_default_is_put_into_a_map_only_where_no_other_thread_has_put_a_value(monkeypatch):
    holder = _numbers()
    add = Dictionary._add

    def late(self, key, value):
        self[key] = "theirs"
        add(self, key, value)

    monkeypatch.setattr(Dictionary, "_add", late)
    assert (holder.k[1], holder.k.setdefault(2, "mine")) == ("theirs", "theirs")
    assert holder.to_dict()["k"] == {1: "theirs", 2: "theirs"}
