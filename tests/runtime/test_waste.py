"""Room of what a list held before is used again when the list is filled anew."""

from __future__ import annotations

import random

import pytest

import rosetta_jit as rj
from rosetta_jit.kernel.state import WASTED

SCHEMA = 'syntax = "proto3"; message T { repeated string a = 1; string s = 2; repeated string b = 3; }'


@pytest.fixture(scope="module")
def holder_type():
    return rj.Decoder.of("T", schema=SCHEMA, encoding="protobuf", backend="llvm").holder_type


def test_a_list_of_texts_that_is_filled_again_takes_no_more_room(holder_type):
    holder, texts = holder_type(), [f"text {number}" for number in range(500)]
    for _ in range(3):
        holder.ClearField("a")
        holder.a.extend(texts)
    size = sum(buffer.size for buffer in holder.lanes_.buffers)
    for _ in range(50):
        holder.ClearField("a")
        holder.a.extend(texts)
    assert list(holder.a) == texts
    assert holder.lanes_.words[WASTED] == 0
    assert sum(buffer.size for buffer in holder.lanes_.buffers) == size


@pytest.mark.parametrize("seed", range(3))
def test_texts_of_others_are_not_given_back(holder_type, seed):
    """Two lists and a text in any order, beside lists of Python's: what one gives back is never another's."""
    random_ = random.Random(seed)
    holder, lists, single = holder_type(), {"a": [], "b": []}, ""
    for step in range(2_000):
        name = random_.choice("ab")
        field, mine = getattr(holder, name), lists[name]
        text = "x" * random_.randrange(4) + str(step)
        match random_.choice(("append", "append", "extend", "delete", "clear", "set", "sort", "single")):
            case "append":
                field.append(text)
                mine.append(text)
            case "extend":
                field.extend([text, "", text])
                mine.extend([text, "", text])
            case "delete" if mine:
                at = random_.randrange(len(mine))
                del field[at], mine[at]
            case "clear":
                holder.ClearField(name)
                mine.clear()
            case "set" if mine:
                at = random_.randrange(len(mine))
                field[at] = mine[at] = text
            case "sort":
                field.sort()
                mine.sort()
            case _:
                holder.s = single = text
    assert ({name: list(getattr(holder, name)) for name in lists}, holder.s) == (lists, single)
