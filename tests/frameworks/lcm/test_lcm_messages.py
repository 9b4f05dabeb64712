"""Messages of lcm-gen's classes decode to their values and encode to the same bytes."""

from __future__ import annotations

import json
import random
import re

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from rosetta_jit import Decoder, Encoder
from tests.frameworks.lcm import declarations
from tests.frameworks.lcm.lcm_files import VECTORS, Generated
from tests.frameworks.lcm.values import bits, of_generated, of_holder, of_record

RECORDS = json.loads((VECTORS / "records.json").read_text())
TYPES = sorted({record["type"] for record in RECORDS})
BACKENDS = ("llvm", "python", "interpreter")


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("name", TYPES)
def test_records(name, backend):
    decode = Decoder.of(name, encoding="lcm", backend=backend)
    encode = Encoder.of(name, encoding="lcm", backend=backend)
    for record in RECORDS:
        if record["type"] == name:
            data = bytes.fromhex(record["bytes"])
            holder = decode(data)
            assert of_holder(holder) == of_record(record["value"])
            assert encode(holder) == data


@settings(deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=20)
@given(found=declarations.files(3), seed=st.integers(0, 1 << 32))
def test_random_values_of_random_types(found, seed, tmp_path_factory):
    agree(found, seed, tmp_path_factory.mktemp("random"), "python")


@settings(deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=20)
@given(found=declarations.files(3), seed=st.integers(0, 1 << 32))
def test_random_values_of_random_types_in_the_interpreter(found, seed, tmp_path_factory):
    agree(found, seed, tmp_path_factory.mktemp("random"), "interpreter")


@settings(deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=4)
@given(found=declarations.files(2), seed=st.integers(0, 1 << 32))
def test_random_values_of_random_types_compiled(found, seed, tmp_path_factory):
    agree(found, seed, tmp_path_factory.mktemp("random"), "llvm")


def agree(found, seed, folder, backend):
    """Both read what the other wrote, and write the same."""
    rng = random.Random(seed)
    text = declarations.text_of(found)
    path = folder / "a.lcm"
    path.write_text(without_hexadecimal(text))
    types = {each.name: each for each in found}
    name = found[-1].name
    full = f"{declarations.PACKAGE}.{name}"
    options = {"encoding": "lcm", "schema": {"a.lcm": path.read_text()}, "backend": backend}
    decode, encode = Decoder.of(full, **options), Encoder.of(full, **options)
    with Generated(folder / "py", path) as classes:
        for _ in range(3):
            plain = declarations.random_value(name, types, rng)
            theirs = declarations.as_generated(plain, name, types, classes)
            data = theirs.encode()
            holder = decode(data)
            assert of_holder(holder) == of_plain(plain)
            assert encode(holder) == data
            ours = encode(decode.holder_type.from_dict(plain))
            assert ours == data
            assert of_generated(classes[full].decode(ours)) == of_plain(plain)


def without_hexadecimal(text):
    """Sizes as Python's struct can read them too: lcm-gen copies them into its formats."""
    for written, plain in (("0x3]", "3]"), ("03]", "3]"), ("0X3;", "3;"), ("0x1;", "1;"), ("02;", "2;")):
        text = re.sub(rf"\b{re.escape(written)}", plain, text)  # whole words: a name may end so
    return text


def of_plain(value):
    if isinstance(value, dict):
        return {name: of_plain(each) for name, each in value.items()}
    return [of_plain(each) for each in value] if isinstance(value, list) else bits(value)
