"""Messages are compared in compiled code; the answer is that of their plain values, whatever the lanes look like."""

from __future__ import annotations

import copy
import math
from random import Random

import numpy as np
import pytest

from rosetta_jit.errors import InvalidHolder
from rosetta_jit.model.types import Array, Bool, Field, Float, Int, Map, Optional, Ref, Schema, String, Struct
from rosetta_jit.runtime.attributes.code import functions
from rosetta_jit.runtime.callable import is_native
from rosetta_jit.runtime.holder import holder_class
from rosetta_jit.runtime.holder.access import raw
from rosetta_jit.runtime.holder.classes import equal

pytestmark = pytest.mark.skipif(not is_native(), reason="no compiled comparison")

TREE = Schema(
    {
        "t.Tree": Struct(
            "t.Tree",
            (
                Field("a", Int(32)),
                Field("b", Int(32)),
                Field("flag", Bool()),
                Field("f", Float(32)),
                Field("d", Float(64)),
                Field("maybe", Optional(Int(16))),
                Field("s", String()),
                Field("numbers", Array(Float(64))),
                Field("names", Array(String())),
                Field("grid", Array(Array(Int(8), 2), 2)),
                Field("leaf", Ref("t.Leaf")),
                Field("leaves", Array(Ref("t.Leaf"))),
                Field("child", Optional(Ref("t.Tree"))),
                Field("trees", Array(Ref("t.Tree"))),
                Field("named", Map(String(), Ref("t.Leaf"))),
            ),
        ),
        "t.Leaf": Struct("t.Leaf", (Field("x", Optional(Float(64))), Field("y", Int(64)), Field("z", Int(8)))),
    }
)


@pytest.fixture(scope="module")
def tree():
    return holder_class(Ref("t.Tree"), TREE)


def value(random, depth=2):
    def leaf():
        return {"y": random.randint(0, 1), "z": random.randint(0, 1)} | (
            {"x": random.choice([0.0, -0.0, math.nan])} if random.random() < 0.5 else {}
        )

    found = {
        "a": random.randint(0, 1),
        "b": random.randint(0, 1),
        "flag": random.random() < 0.5,
        "f": random.choice([0.0, -0.0, 1.5]),
        "d": random.choice([0.0, -0.0, math.inf]),
        "s": random.choice(["", "a", "b"]),
        "numbers": [random.choice([0.0, -0.0, math.nan])] * random.randint(0, 2),
        "names": [random.choice(["", "n"])] * random.randint(0, 2),
        "grid": [[random.randint(0, 1), 0], [0, 1]],
        "leaf": leaf(),
        "leaves": [leaf() for _ in range(random.randint(0, 2))],
        "named": {random.choice("kl"): leaf() for _ in range(random.randint(0, 2))},
    }
    if random.random() < 0.5:
        found["maybe"] = random.randint(0, 1)
    if depth and random.random() < 0.5:
        found["child"] = value(random, depth - 1)
    if depth and random.random() < 0.5:
        found["trees"] = [value(random, depth - 1)]
    return {name: found[name] for name in random.sample(list(found), random.randint(0, len(found)))}


def agree(one, other):
    expected = equal(raw(one), raw(other))
    assert (one == other) is expected
    assert (other == one) is expected
    return expected


def test_random_trees(tree):
    same, asked = 0, 0
    for seed in range(400):
        random = Random(seed)
        plain = value(random)
        one, other = tree.from_dict(plain), tree.from_dict(plain)
        for each in (other, tree.from_dict(value(random)), copy.copy(one)):
            each.names, each.s = ["long " * random.randint(0, 9)] * 3, "other"  # rows that nothing refers to any more
            each.names, each.s = list(one.names), one.s
            same += agree(one, each)
            agree(one.leaf, each.leaf)
            asked += functions()["same"](one, each, one.access_.sameness, each.access_.sameness) is None
        setattr(
            other, *random.choice([("a", 7), ("d", math.nan), ("s", "x"), ("maybe", 9), ("grid", np.ones((2, 2), np.int8)), ("flag", 1)])
        )
        agree(one, other)
    assert same > 200
    assert asked < 400  # maps that differ, and rows of trees without anything


@pytest.mark.parametrize("seed", range(10))
def test_random_types(seed):
    random_types = pytest.importorskip("tests.frameworks.omg.cyclone_types").random_types
    schema, name, made = random_types(seed)
    cls = holder_class(Ref(name), schema)
    values = [made.value(Ref(name))[1] for _ in range(4)]
    holders = [cls.from_dict(each) for each in values for _ in range(2)]
    for one in holders:
        for other in holders:
            agree(one, other)


def test_parts_of_other_messages(tree):
    leaf = holder_class(Ref("t.Leaf"), TREE)
    one, other = leaf.from_dict({"x": 1.0, "y": 2}), tree.from_dict({"leaf": {"x": 1.0, "y": 2}, "leaves": [{"y": 2}, {"x": 1.0, "y": 2}]})
    assert one == other.leaf == other.leaves[1] == one
    assert one != other.leaves[0]
    assert other.child == other.child
    assert other.child == tree()
    assert (one == other) is False
    assert one != 3


def test_types_of_one_name_are_not_mixed_up():
    def of(*names):
        return holder_class(Ref("t.P"), Schema({"t.P": Struct("t.P", tuple(Field(each, Int(32)) for each in names))}))

    assert of("a", "b").from_dict({"a": 1}) == of("a", "b").from_dict({"a": 1})
    assert of("a", "b").from_dict({"a": 1}) != of("b", "a").from_dict({"b": 1})
    assert of("a", "b").from_dict({"a": 1}) == of("b", "a").from_dict({"a": 1})


def test_what_cannot_be_read(tree):
    one, other = tree(), tree()
    other.lanes_.words[0] = 0
    for compare in (lambda: one == other, lambda: other == one):
        with pytest.raises(InvalidHolder):
            compare()
    with other.lanes_, pytest.raises(Exception, match="in use"):
        assert one == other
