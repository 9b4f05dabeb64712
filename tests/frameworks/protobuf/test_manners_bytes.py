"""Serialising, with programs that stand in for compiled ones."""

from __future__ import annotations

import json

import pytest

from rosetta_jit.errors import EncodeError, RosettaError


class JsonPrograms:
    """Writes messages as JSON."""

    def __init__(self, cls):
        self.cls = cls

    def encode(self, holder):
        assert type(holder) is self.cls
        return json.dumps(holder.to_dict()).encode()

    def new(self):
        return self.cls()

    def size(self, holder):
        return len(self.encode(holder))

    def decode(self, data, holder):
        if isinstance(data, str):
            raise TypeError(data)
        holder.Clear()
        holder.MergeFrom(self.cls.from_dict(json.loads(bytes(data))))


@pytest.fixture
def needy(ours, monkeypatch):
    cls = ours("second.Needy")
    monkeypatch.setattr(cls, "programs_", JsonPrograms(cls))
    return cls


def test_there_and_back(needy):
    message = needy(must=1, other={"must": 2}, others=[{"must": 3}])
    data = message.SerializeToString()
    assert message.ByteSize() == len(data)
    assert needy.FromString(data) == message
    other = needy(must=9, others=[{"must": 4}])
    assert other.ParseFromString(data) == len(data)
    assert other == message
    assert other.MergeFromString(bytearray(data)) == len(data)
    assert [each.must for each in other.others] == [3, 3]


def test_nested_messages_serialise_alone(needy):
    message = needy(must=1, other={"must": 2})
    assert json.loads(message.other.SerializeToString()) == {"must": 2, "others": []}
    message.other.MergeFromString(needy(other={"must": 5}).SerializePartialToString())
    assert (message.other.must, message.other.other.must) == (2, 5)
    message.other.ParseFromString(needy(must=7).SerializeToString())
    assert message.other == needy(must=7)
    assert message.other.FromString(b'{"must": 8}').must == 8


def test_what_is_missing_is_named(needy):
    with pytest.raises(EncodeError, match=r"must,other\.must") as error:
        needy(other={}).SerializeToString()
    assert (error.value.kind, error.value.path) == ("missing", ".must")
    assert json.loads(needy().SerializePartialToString()) == {"others": []}


def test_wrong_arguments(needy, ours, monkeypatch):
    with pytest.raises(TypeError):
        needy().ParseFromString("text")
    with pytest.raises(TypeError):
        needy().other.ParseFromString("text")
    monkeypatch.setattr(ours("third.Plain"), "programs_", None)
    with pytest.raises(RosettaError, match="compiled"):
        ours("third.Plain")().SerializeToString()
