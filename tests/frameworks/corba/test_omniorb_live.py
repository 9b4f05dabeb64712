"""Random values of random types: omniORB reads what we write to the last byte, and writes the same bytes again."""

from __future__ import annotations

import random
import struct

import pytest

import rosetta_jit as rj
from tests.frameworks.corba import omniorb

pytestmark = pytest.mark.skipif(not omniorb.is_installed(), reason="omniORB's headers and omniidl are not installed")

INTEGERS = {"octet": (8, 0), "short": (16, 1), "unsigned short": (16, 0), "long": (32, 1), "unsigned long": (32, 0), "long long": (64, 1)}
SCALARS = (*INTEGERS, "float", "double", "boolean", "char", "string", "string<9>", "Color")


class Types:
    """A module of random structs, the later ones with members of the earlier ones."""

    def __init__(self, seed, count=6):
        self.random = random.Random(seed)
        self.members = {}
        self.text = ["enum Color { RED, GREEN, BLUE };"]
        for number in range(count):
            name = f"S{number}"
            members = {f"m{k}": self.member() for k in range(self.random.randint(1, 6))}
            self.members[name] = members
            body = " ".join(self.declared(kind, member) for member, kind in members.items())
            self.text.append(f"struct {name} {{ {body} }};")

    @property
    def idl(self):
        return "module R { " + "\n".join(self.text) + " };"

    def member(self):
        element = self.random.choice((*SCALARS, *self.members))
        form = self.random.choice(("plain", "plain", "sequence", "bounded", "array"))
        return form, element, self.random.randint(1, 4)

    def declared(self, kind, name):
        form, element, size = kind
        match form:
            case "plain":
                return f"{element} {name};"
            case "sequence":
                return f"sequence<{element}> {name};"
            case "bounded":
                return f"sequence<{element}, {size}> {name};"
            case _:
                return f"{element} {name}[{size}];"

    def value(self, name):
        return {member: self.of(kind) for member, kind in self.members[name].items()}

    def of(self, kind):
        form, element, size = kind
        match form:
            case "plain":
                return self.one(element)
            case "array":
                count = size
            case "bounded":
                count = self.random.randint(0, size)
            case _:
                count = self.random.randint(0, 5)
        values = [self.one(element) for _ in range(count)]
        return bytes(values) if element == "octet" else values

    def one(self, element):
        if element in self.members:
            return self.value(element)
        if element in INTEGERS:
            bits, signed = INTEGERS[element]
            return self.random.getrandbits(bits) - (signed << bits - 1)
        match element:
            case "float":
                return struct.unpack("<f", struct.pack("<f", self.random.uniform(-1e9, 1e9)))[0]
            case "double":
                return self.random.choice((-0.0, float("inf"), self.random.uniform(-1e300, 1e300)))
            case "boolean":
                return self.random.random() < 0.5
            case "char":
                return self.random.randrange(256)
            case "Color":
                return self.random.randrange(3)
            case _:
                return "".join(self.random.choice("abc é") for _ in range(self.random.randint(0, 4)))


@pytest.mark.parametrize("seed", range(2))
def test_random_types(tmp_path, seed):
    types = Types(seed)
    names = [f"R::{name}" for name in types.members]
    program = omniorb.build(tmp_path, types.idl, names)
    messages = []
    for name in names:
        options = {"encoding": "cdr-giop", "schema": {"types.idl": types.idl}, "backend": "interpreter"}
        for order in ("little", "big"):
            decode, encode = (kind.of(name, byte_order=order, **options) for kind in (rj.Decoder, rj.Encoder))
            for _ in range(8):
                value = types.value(name.removeprefix("R::"))
                data = bytes(encode(encode.holder_type.from_dict(value)))
                assert bytes(encode(decode(data))) == data
                messages.append((name, order, data))
    found = omniorb.run(program, messages)
    assert found == [(data.hex(), "0") for _, _, data in messages]
