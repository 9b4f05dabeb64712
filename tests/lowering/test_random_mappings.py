"""Random mappings: each backend makes of random values what plain Python makes of them, or fails alike at the same place."""

from __future__ import annotations

import random

import numpy as np
import pytest

import rosetta_jit as rj
from tests.lowering.random_values import LEAVES, Maker, Refused, plain, some_fields

RULES = 8
MESSAGES = 25
OUT = ["int64", "float32", "float64", "bool", "string"]
HEAD = 'import "t/In.{}"\nimport "t/Out.msg"\n'
PROTO = {"int32": "int32", "uint32": "uint32", "int64": "sint64", "uint64": "fixed64", "float32": "float", "float64": "double"}


def ros_type(leaves):
    fields = [f"{type_} {name}" for name, type_ in leaves.items()]
    return "\n".join([*fields, "float64[] xs", "int32[] ks", "int16[4] q"]) + "\n"


def random_rules(rng, leaves):
    maker = Maker(rng, leaves)
    return [maker.of(rng.choice(OUT), rng.randrange(1, 5)) for _ in range(RULES)]


def aim(made):
    return made.type if made.type in OUT else "int64"


def texts(rules, direction):
    out = "".join(f"{aim(made)} o{number}\n" for number, made in enumerate(rules))
    sides = ("Out", "In", "unpack") if direction == "decode" else ("In", "Out", "pack")
    mapping = 'import "t/In.msg"\nimport "t/Out.msg"\ndata-holder: t/{}\nwire-schema: t/{}\n{}-rules:\n'.format(*sides)
    body = "".join(f"  .o{number} = {made.text}\n" for number, made in enumerate(rules))
    return {"t/In.msg": ros_type(LEAVES), "t/Out.msg": out, "m.mapping": mapping + body}


def own(kind, files, name, backend="interpreter"):
    return kind.of(f"t/{name}", schema=files, imports=[f"t/{name}.msg"], encoding="ros1", backend=backend)


def runner(files, direction, backend):
    """``run(fields)``: the fields of the other side as a dict."""
    if direction == "decode":
        decode, write = rj.Decoder("m.mapping", schema=files, encoding="ros1", backend=backend), own(rj.Encoder, files, "In")
        return lambda fields: decode(write(write.holder_type.from_dict(fields))).to_dict()
    encode, read = rj.Encoder("m.mapping", schema=files, encoding="ros1", backend=backend), own(rj.Decoder, files, "Out")
    return lambda fields: read(encode(encode.holder_type.from_dict(fields))).to_dict()


def seen(run, fields):
    try:
        return {name: plain(value) for name, value in run(fields).items()}
    except rj.MessageError as error:
        return error.kind, error.path


def expected(rules, fields):
    """The values of all rules, or the kind and place of the first that refuses."""
    found = {}
    for number, made in enumerate(rules):
        try:
            with np.errstate(all="ignore"):
                value = made.evaluate(fields)
        except Refused as refused:
            return refused.kind, refused.place or f".o{number}"
        found[f"o{number}"] = plain(np.float64(value) if made.type == "float64" else value)
    return found


def check(seed, direction, backends):
    rng = random.Random(seed)
    rules = random_rules(rng, LEAVES)
    files = texts(rules, direction)
    runs = {backend: runner(files, direction, backend) for backend in backends}
    for _ in range(MESSAGES):
        fields = some_fields(rng, LEAVES)
        wanted = expected(rules, fields)
        for backend, run in runs.items():
            assert seen(run, fields) == wanted, (seed, backend, files["m.mapping"], fields)


@pytest.mark.parametrize("direction", ["decode", "encode"])
@pytest.mark.parametrize("seed", range(6))
def test_expressions(seed, direction):
    check(seed, direction, ["python", "interpreter", "llvm"])
