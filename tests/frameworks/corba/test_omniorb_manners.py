"""Holders of CORBA types against what omniORBpy promises."""

from __future__ import annotations

import pytest

import rosetta_jit as rj

TEXT = """module M {
  enum Color { RED, GREEN };
  struct Pixel { long x; Color paint; };
  union Value switch (long) { case 1: long i; case 2: case 3: double d; default: string s; };
};"""


def cls(name):
    return rj.Decoder.of(name, encoding="cdr-giop", schema={"m.idl": TEXT}).holder_type


def test_structs_are_built_by_position():
    pixel = cls("M::Pixel")(4, "GREEN")
    assert (pixel.x, pixel.paint) == (4, 1)
    assert pixel.paint == pixel.GREEN
    assert pixel._NP_RepositoryId == "IDL:M/Pixel:1.0"
    with pytest.raises(TypeError, match="takes 2 values"):
        cls("M::Pixel")(4)


def test_unions_have_a_discriminator_and_a_value():
    value = cls("M::Value")(3, 2.5)
    assert (value._d, value._v, value.d) == (3, 2.5, 2.5)
    value.i = 7
    assert (value._d, value._v) == (1, 7)
    value._d = 99
    value._v = "text"
    assert (value.s, value._v) == ("text", "text")


def test_unions_are_built_by_case():
    value = cls("M::Value")(d=1.5)
    assert (value._d, value._v) == (2, 1.5)


def test_what_is_built_can_be_written():
    options = {"encoding": "cdr-giop", "schema": {"m.idl": TEXT}}
    decode, encode = rj.Decoder.of("M::Value", **options), rj.Encoder.of("M::Value", **options)
    assert decode(encode(decode.holder_type(3, 2.5)))._d == 3
