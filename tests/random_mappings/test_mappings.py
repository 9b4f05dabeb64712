"""Random mappings: each backend makes of random values what plain Python makes of them, or fails alike at the same place."""

from __future__ import annotations

import random

import numpy as np
import pytest

import rosetta_jit as rj
from tests.random_mappings.arrays import Arrays, some_arrays
from tests.random_mappings.fields import plain, some_fields, written
from tests.random_mappings.meaning import LEAVES, Refused
from tests.random_mappings.values import Maker

RULES = 8
MESSAGES = 25
OUT = ["int64", "float32", "float64", "bool", "string"]
ELEMENTS = ["float64", "int64", "string"]
PROTO = {"float64": "double", "int64": "int64", "string": "string"}
IN = "".join(f"{type_} {name}\n" for name, type_ in LEAVES.items()) + "float64[] xs\nint32[] ks\nint16[4] q\nt/Pt[] ps\n"
FILES = {"t/In.msg": IN, "t/Pt.msg": "float64 x\nint32 n\nstring s\n"}
OPTIONS = {"ros1": {"encoding": "ros1"}, "proto": {"encoding": "protobuf"}}


def runner(files, direction, backend, out="ros1", functions=None):
    """``run(fields)``: what rules make of the fields of `t/In`, as a dict."""
    common = {"schema": files, "imports": list(files)[:-1], "backend": "interpreter"}
    if direction == "decode":
        write = rj.Encoder.of("t/In", encoding="ros1", **common)
        decode = rj.Decoder("m.mapping", schema=files, encoding="ros1", backend=backend, functions=functions or {})
        return lambda fields: decode(write(write.holder_type.from_dict(fields))).to_dict()
    encode = rj.Encoder("m.mapping", schema=files, backend=backend, functions=functions or {}, **OPTIONS[out])
    read = rj.Decoder.of("t/Out", **common, **OPTIONS[out])
    return lambda fields: read(written(encode, fields)).to_dict()


def mapping(files, rules, direction):
    """The files of a mapping between `t/In` and `t/Out`, its rules written for a direction."""
    imports = "".join(f'import "{name}"\n' for name in files)
    holder, wire, block = ("Out", "In", "unpack") if direction == "decode" else ("In", "Out", "pack")
    return {**files, "m.mapping": f"{imports}data-holder: t/{holder}\nwire-schema: t/{wire}\n{block}-rules:\n{rules}\n"}


def seen(run, fields):
    try:
        return {name: plain(value) for name, value in run(fields).items()}
    except rj.MessageError as error:
        return error.kind, error.path


# --- expressions -------------------------------------------------------------------------------------------------------


def random_rules(rng):
    maker = Maker(rng, LEAVES)
    return [maker.of(rng.choice(OUT), rng.randrange(1, 5)) for _ in range(RULES)]


def with_values(rules, direction):
    fields = "".join(f"{made.type if made.type in OUT else 'int64'} o{number}\n" for number, made in enumerate(rules))
    text = "".join(f"  .o{number} = {made.text}\n" for number, made in enumerate(rules))
    return mapping({**FILES, "t/Out.msg": fields}, text, direction)


def expected(rules, fields):
    """The values of all rules, or the kind and place of the first that refuses."""
    found = {}
    for number, made in enumerate(rules):
        try:
            value = made.evaluate(fields)
        except Refused as refused:
            return refused.kind, refused.place or f".o{number}"
        found[f"o{number}"] = plain(np.float64(value) if made.type == "float64" else value)
    return found


def check_values(seed, direction, backends):
    rng = random.Random(seed)
    rules = random_rules(rng)
    files = with_values(rules, direction)
    runs = {backend: runner(files, direction, backend) for backend in backends}
    for _ in range(MESSAGES):
        fields = {**some_arrays(rng), **some_fields(rng, LEAVES)}
        with np.errstate(all="ignore"):
            wanted = expected(rules, fields)
        for backend, run in runs.items():
            assert seen(run, fields) == wanted, (seed, backend, files["m.mapping"], fields)


# --- arrays ------------------------------------------------------------------------------------------------------------


def with_arrays(rules, types, direction, out):
    text = "\n".join(each.text for each in rules)
    if out == "ros1":
        return mapping({**FILES, "t/Out.msg": "".join(f"{type_}[] o{number}\n" for number, type_ in enumerate(types))}, text, direction)
    fields = "".join(f"repeated {PROTO[type_]} o{number} = {number + 1}; " for number, type_ in enumerate(types))
    return mapping({**FILES, "out.proto": f'syntax = "proto3"; package t; message Out {{ {fields}}}'}, text, direction)


def expected_arrays(rules, types, fields):
    """The arrays of all rules; None where one of them refuses: which one a kernel finds first depends on what it checks before loops."""
    try:
        arrays = [made.evaluate(fields) for made in rules]
    except Refused:
        return None
    aims = [np.float64 if type_ == "float64" else type_ for type_ in types]
    return {
        f"o{number}": [plain(aim(value) if aim is np.float64 else value) for value in array]
        for number, (array, aim) in enumerate(zip(arrays, aims, strict=True))
    }


def check_arrays(seed, direction, out, backends):
    rng = random.Random(seed)
    types = [rng.choice(ELEMENTS) for _ in range(4)]
    maker = Arrays(rng, LEAVES)
    rules = [maker.of(f"o{number}", type_) for number, type_ in enumerate(types)]
    files = with_arrays(rules, types, direction, out)
    runs = {backend: runner(files, direction, backend, out) for backend in backends}
    for _ in range(MESSAGES):
        fields = {**some_fields(rng, LEAVES), **some_arrays(rng)}
        with np.errstate(all="ignore"):
            wanted = expected_arrays(rules, types, fields)
        outcomes = {backend: seen(run, fields) for backend, run in runs.items()}
        about = seed, files["m.mapping"], fields
        for backend, outcome in outcomes.items():
            if wanted is None:
                assert isinstance(outcome, tuple), (backend, about)
                assert outcome == next(iter(outcomes.values())), (backend, about)
            else:
                assert {name: list(value) for name, value in dict(outcome).items()} == wanted, (backend, about)


# --- messages that are cut or altered ----------------------------------------------------------------------------------


def check_bytes(seed, backends):
    """What is refused is refused by all, with the same words, and what is not gives the same."""
    rng = random.Random(seed)
    files = with_values(random_rules(rng), "decode")
    decoders = [rj.Decoder("m.mapping", schema=files, encoding="ros1", backend=backend) for backend in backends]
    write = rj.Encoder.of("t/In", schema=files, imports=list(files)[:-1], encoding="ros1", backend="interpreter")
    message = bytes(write(write.holder_type.from_dict({**some_arrays(rng), **some_fields(rng, LEAVES)})))
    for _ in range(2 * MESSAGES):
        data = bytearray(message[: rng.choice([len(message), rng.randrange(len(message) + 1)])])
        for _ in range(rng.randrange(3) if data else 0):
            data[rng.randrange(len(data))] = rng.choice([0, 1, 127, 128, 255, rng.randrange(256)])
        outcomes = [seen_of_bytes(decode, bytes(data)) for decode in decoders]
        assert outcomes[1:] == outcomes[:-1], (seed, files["m.mapping"], bytes(data))


def seen_of_bytes(decode, data):
    try:
        return {name: plain(value) for name, value in decode(data).to_dict().items()}
    except rj.DecodeError as error:
        return error.kind, error.path, error.offset, error.detail


@pytest.mark.parametrize("direction", ["decode", "encode"])
@pytest.mark.parametrize("seed", range(4))
def test_expressions(seed, direction):
    check_values(seed, direction, ["python", "interpreter", "llvm"])


@pytest.mark.parametrize(("direction", "out"), [("decode", "ros1"), ("decode", "proto"), ("encode", "ros1"), ("encode", "proto")])
@pytest.mark.parametrize("seed", range(3))
def test_arrays(seed, direction, out):
    check_arrays(seed, direction, out, ["python", "interpreter", "llvm"])


@pytest.mark.parametrize("seed", range(3))
def test_altered_messages(seed):
    check_bytes(seed, ["python", "interpreter", "llvm"])


@pytest.mark.campaign
@pytest.mark.parametrize("block", range(40))
def test_campaign(block):
    for seed in range(100 * block + 1000, 100 * block + 1100):
        for direction in ("decode", "encode"):
            check_values(seed, direction, ["python", "llvm"] if seed % 10 else ["python", "interpreter", "llvm", "numba"])
            for out in ("ros1", "proto"):
                check_arrays(seed, direction, out, ["python"] if seed % 10 else ["python", "interpreter", "llvm", "numba"])
        check_bytes(seed, ["python", "llvm"])
