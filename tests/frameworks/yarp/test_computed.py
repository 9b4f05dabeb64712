"""Lengths and values that fields determine: what the decoder would refuse, the encoder does not write."""

from __future__ import annotations

import pytest

import rosetta_jit as rj

BACKENDS = ("llvm", "python", "interpreter")
TOLD = """
"t.T"
( ("n" :int) ("xs" (:list :double) (:length n)) ("text" :string (:length later)) ("data" :blob (:length (* 2 n))) ("later" :int) )
"""
CHAIN = """
"t.T"
( ("n" :int) ("twice" :int (* n 2)) ("inner" "t.Inner") ("xs" (:list :int) (:length (+ twice inner.more))) )
"t.Inner"
( ("a" :int) ("more" :int (+ a 1)) ("name" :string) )
"""


def programs(schema, backend, encoding="yarp4"):
    options = {"schema": {"t.bottle-schema": schema}, "encoding": encoding, "backend": backend}
    return rj.Decoder.of("t.T", **options), rj.Encoder.of("t.T", **options)


def filled(encode, **values):
    holder = encode.new()
    for name, value in values.items():
        setattr(holder, name, value)
    return holder


@pytest.mark.parametrize("backend", BACKENDS)
def test_lengths_must_agree_with_the_fields_that_tell_them(backend):
    decode, encode = programs(TOLD, backend)
    right = {"n": 2, "xs": [1.0, 2.0], "text": "abc", "data": b"1234", "later": 3}
    assert decode(encode(filled(encode, **right))).to_dict() == {**right, "xs": [1.0, 2.0]}
    for name, wrong, kind in [("xs", [1.0], "count"), ("text", "ab", "length"), ("data", b"123", "length")]:
        with pytest.raises(rj.EncodeError, match="must agree") as caught:
            encode(filled(encode, **{**right, name: wrong}))
        assert (caught.value.kind, caught.value.path) == (kind, f".{name}")


@pytest.mark.parametrize("backend", BACKENDS)
def test_what_is_computed_from_computed_fields_needs_none_of_them_set(backend):
    decode, encode = programs(CHAIN, backend, "yarp3")
    holder = filled(encode, n=2, xs=[1, 2, 3, 4, 5, 6])
    holder.inner.a = 1
    shown = decode(encode(holder)).to_dict()
    assert (shown["twice"], shown["inner"]["more"], shown["xs"]) == (4, 2, [1, 2, 3, 4, 5, 6])


def test_lengths_that_lcm_tells():
    text = "package t; struct T { int32_t n; double xs[n]; }"
    encode = rj.Encoder.of("t.T", schema={"t.lcm": text}, encoding="lcm", backend="interpreter")
    with pytest.raises(rj.EncodeError, match="must agree") as caught:
        encode(filled(encode, n=2, xs=[1.0]))
    assert (caught.value.kind, caught.value.path) == ("count", ".xs")
