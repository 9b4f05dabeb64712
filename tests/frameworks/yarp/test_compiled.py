"""Every bottle that the real YARP wrote, through a schema drafted from it and a compiled kernel, to its values and back to its bytes."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import rosetta_jit as rj
from rosetta_jit.frameworks.yarp.bottle import read
from rosetta_jit.frameworks.yarp.drafting.infer import read_any
from rosetta_jit.frameworks.yarp.tags import DIALECTS
from rosetta_jit.frameworks.yarp.tree import Dict, List, Value
from rosetta_jit.runtime.holder import Holder

VECTORS = Path(__file__).resolve().parents[2] / "vectors" / "yarp"
NATIVE = {"mixed_every_tag", "dict_two", "icub_arm_state_16", "img_rgb_4x3_padded", "legacy_mixed", "string_invalid_utf8"}
"""Compiled by LLVM as well; the others run the same kernels in Python, which costs no second each."""


def bottles():
    for dialect in ("yarp3", "yarp4", "yarp2012"):
        for vector in json.loads((VECTORS / f"{dialect}.json").read_text()):
            if vector.get("kind") != "pointcloud":
                yield pytest.param(dialect, vector["name"], bytes.fromhex(vector["hex"]), id=f"{dialect}-{vector['name']}")


def programs(message, dialect, backend):
    schema = {"x.bottle-schema": rj.infer([message], name="x", encoding=dialect)}
    options = {"encoding": dialect, "schema": schema, "backend": backend}
    return rj.Decoder.of("x", **options), rj.Encoder.of("x", **options)


def plain(item):
    """The values of a tree, lists as lists."""
    match item:
        case List(items):
            return [plain(each) for each in items]
        case Dict(content):
            return [plain(each) for each in content.items]
        case Value("string", text):
            return text.decode("utf-8", "surrogateescape")
        case Value(_, value):
            return value


def values(shown):
    """The values of a holder, in the order of the fields; a dict's keys are in the schema."""
    match shown:
        case dict():
            return [values(each) for each in shown.values()]
        case list():
            return [values(each) for each in shown]
        case _:
            return shown


def same(left, right):
    return repr(left) == repr(right)  # tells -0.0 from 0.0, and takes NaN for itself


@pytest.mark.parametrize(("dialect", "name", "message"), list(bottles()))
def test_bottle_of_the_real_yarp(dialect, name, message):
    tree = plain(read(message, DIALECTS[dialect]))
    for backend in ("python", "llvm") if name in NATIVE else ("python",):
        decode, encode = programs(message, dialect, backend)
        holder = decode(message)
        assert encode(holder) == message
        shown = values(Holder.to_dict(holder))
        if "dict" not in name:  # its keys are names of fields
            assert same(shown, tree) or same(shown[0] if shown else shown, tree)


@pytest.mark.parametrize("dialect", ["yarp3", "yarp4"])
def test_malformed_bottles_are_refused_or_right(dialect):
    """Where infer can read a message at all, so must the decoder; its good relative's schema must never read it as something else."""
    good = {case["name"]: case for case in json.loads((VECTORS / f"{dialect}.json").read_text())}
    schemas = [bytes.fromhex(good[name]["hex"]) for name in ("list_int32_5", "mixed_every_tag", "vec_double_3", "string_simple")]
    decoders = [programs(message, dialect, "python")[0] for message in schemas]
    for case in json.loads((VECTORS / f"malformed-{dialect}.json").read_text()):
        message = bytes.fromhex(case["hex"])
        for decode in decoders:
            try:
                shown = values(decode(message).to_dict())
            except rj.DecodeError as error:
                assert 0 <= error.offset <= len(message)  # noqa: PT017 - either outcome is right
            else:
                tree = plain(read(message, DIALECTS[dialect]))
                assert same(shown, tree) or same(shown[0], tree)


@pytest.mark.parametrize("name", ["icub_torso_state_3", "icub_arm_state_16", "mixed_every_tag", "list_string_3"])
@pytest.mark.parametrize("dialect", ["yarp3", "yarp4"])
def test_the_dialect_is_found(dialect, name):
    vectors = {each["name"]: each for each in json.loads((VECTORS / f"{dialect}.json").read_text())}
    message = bytes.fromhex(vectors[name]["hex"])
    schema = {"x.bottle-schema": rj.infer([message], name="x", encoding=dialect)}
    any_dialect = rj.Decoder.of("x", schema=schema, backend="python")
    known = rj.Decoder.of("x", encoding=dialect, schema=schema, backend="python")
    assert same(any_dialect(message).to_dict(), known(message).to_dict())
    assert read_any(message)[0].name in {dialect, "yarp3"}
