"""Structs that contain themselves, whose sizes stand before them in XCDR2: as Cyclone DDS writes them, and damaged."""

from __future__ import annotations

from random import Random

import pytest

pytest.importorskip("cyclonedds")

from cyclonedds.idl import Endianness

import rosetta_jit as rj
from tests.frameworks.omg.cyclone_trees import AppendableNode, AppendableRoot, FinalNode, FinalRoot
from tests.frameworks.omg.test_cdr_cyclone import padded

IDL = """
@{} struct Node {{ octet tag; double weight; sequence<Node> kids; string name; }};
@appendable struct Root {{ octet first; Node tree; sequence<Node> more; octet last; }};
"""


THEIRS = {"final": (FinalNode, FinalRoot), "appendable": (AppendableNode, AppendableRoot)}
ORDERS = {"little": Endianness.Little, "big": Endianness.Big}


def tree(random, depth=0):
    return {
        "tag": random.randrange(256),
        "weight": random.choice([0.0, 1.5, -2.0]),
        "kids": [tree(random, depth + 1) for _ in range(random.randint(0, 3 - depth))],
        "name": "x" * random.randint(0, 9),
    }


def root(random):
    return {"first": 1, "tree": tree(random), "more": [tree(random) for _ in range(random.randint(0, 2))], "last": 2}


def theirs(kind, value):
    node, whole = THEIRS[kind]
    if "tree" not in value:
        return node(**{**value, "kids": [theirs(kind, each) for each in value["kids"]]})
    return whole(value["first"], theirs(kind, value["tree"]), [theirs(kind, each) for each in value["more"]], value["last"])


def given(kind, encoding="cdr2", backend="interpreter"):
    return {"encoding": encoding, "framework": "ros2", "schema": {"probe.idl": IDL.format(kind)}, "backend": backend}


@pytest.mark.parametrize(("backend", "order"), [("interpreter", "little"), ("python", "big"), ("llvm", "little")])
@pytest.mark.parametrize("encoding", ["cdr", "cdr2"])
@pytest.mark.parametrize("kind", THEIRS)
@pytest.mark.parametrize("name", ["Node", "Root"])
def test_cyclone_dds(name, kind, encoding, order, backend):
    options = given(kind, encoding, backend)
    decode, encode = rj.Decoder.of(name, **options), rj.Encoder.of(name, byte_order=order, **options)
    random = Random(7)
    for _ in range(8):
        value = tree(random) if name == "Node" else root(random)
        data = theirs(kind, value).serialize(use_version_2=encoding == "cdr2", endianness=ORDERS[order])
        expected = padded(data) if encoding == "cdr2" else data
        assert decode(data).to_dict() == value
        assert bytes(encode(encode.holder_type.from_dict(value))) == expected


@pytest.mark.parametrize("kind", THEIRS)
def test_every_cut_and_every_byte(kind):
    """Whatever is damaged is refused, or is another message: nothing else happens."""
    decode = rj.Decoder.of("Root", **given(kind))
    data = bytes(theirs(kind, root(Random(3))).serialize(use_version_2=True, endianness=Endianness.Little))
    for size in range(0, len(data), 2):
        with pytest.raises(rj.DecodeError):
            decode(data[:size])
    for at in range(4, len(data), 3):
        for byte in (0, 0x7F, 0xFF):
            try:
                decode(data[:at] + bytes([byte]) + data[at + 1 :])
            except rj.DecodeError as error:
                assert error.kind in ("truncated", "length", "count", "text", "constant", "trailing", "nesting")  # noqa: PT017 - any of these


def chain(depth):
    value = {"tag": 0, "weight": 0.0, "kids": [], "name": ""}
    for _ in range(depth):
        value = {**value, "kids": [value]}
    return value


@pytest.mark.parametrize("encoding", ["cdr", "cdr2"])
@pytest.mark.parametrize("kind", THEIRS)
def test_nesting(kind, encoding):
    decode = rj.Decoder.of("Node", **given(kind, encoding))
    for depth, nests in ((64, True), (65, False)):
        data = theirs(kind, chain(depth)).serialize(use_version_2=encoding == "cdr2")
        if nests:
            assert decode(data).kids[0].kids[0].tag == 0
        else:
            with pytest.raises(rj.DecodeError, match="within each other"):
                decode(data)


REFUSED = [
    "@mutable struct Node { sequence<Node> kids; };",
    "struct Node { map<long, Node> kids; };",
    "struct Node { sequence<sequence<Node> > kids; };",
]


@pytest.mark.parametrize("encoding", ["cdr", "cdr2"])
@pytest.mark.parametrize("text", REFUSED)
def test_refused(text, encoding):
    with pytest.raises(rj.SchemaError, match="recursive"):
        rj.Decoder.of("Node", encoding=encoding, framework="ros2", schema={"probe.idl": text})


def test_too_many_sizes():
    text = """
    @appendable struct Tree {{ sequence<Tree> trees; }};
    @appendable struct Inner {{ sequence<Tree> trees; }};
    @appendable struct Middle {{ Inner inside; }};
    @appendable struct Node {{ {} within; sequence<Node> nodes; octet last; }};
    """
    within = {"trees": [{"trees": [{"trees": []}]}, {"trees": []}]}
    value = {"within": within, "nodes": [{"within": within, "nodes": [], "last": 1}], "last": 2}
    few, many = ({**given("final"), "schema": {"probe.idl": text.format(name)}} for name in ("Inner", "Middle"))
    encode = rj.Encoder.of("Node", **few)
    assert rj.Decoder.of("Node", **few)(encode(encode.holder_type.from_dict(value))).to_dict() == value
    with pytest.raises(rj.SchemaError, match="more than 3 sizes"):
        rj.Decoder.of("Node", **many)
