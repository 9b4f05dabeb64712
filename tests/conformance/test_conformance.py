"""protobuf's own conformance suite, binary to binary: none of its 1,302 cases may fail, nor of the 1,414 that protobuf 36 has.

The runner is built from protobuf's sources; CONFORMANCE_TEST_RUNNER names it and CONFORMANCE_PROTOS the sources' `src`. What it has asked,
and what it has accepted, is kept in the vectors, so that every machine can ask again.
"""

from __future__ import annotations

import json
import lzma
import os
import re
import shutil
import stat
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

import rosetta_jit as rj

VECTORS = Path(__file__).resolve().parents[1] / "vectors" / "proto" / "conformance.json.xz"
RUNNER = os.environ.get("CONFORMANCE_TEST_RUNNER") or shutil.which("conformance_test_runner")
CASES = 1302
TREE = """syntax = 'proto2'; package p; enum E { ONE = 1; }
message A { optional int32 x = 1; optional A a = 2; map<string, A> m = 3; repeated E e = 4 [packed = true]; }"""


@cache
def vectors():
    return json.loads(lzma.decompress(VECTORS.read_bytes()))


@pytest.mark.campaign
@pytest.mark.parametrize("backend", ["numba", "python", "interpreter"])
@pytest.mark.parametrize("version", [2, 3])
def test_all_that_the_runner_asked(version, backend):
    ask(version, backend, step=1)


@pytest.mark.parametrize("version", [pytest.param(2, marks=pytest.mark.campaign), 3])
def test_some_of_what_the_runner_asked(version):
    ask(version, "interpreter", step=30)


def ask(version, backend, step):
    cases = [case for case in vectors()["cases"] if case[0] == version][::step]
    options = {"schema": bytes.fromhex(vectors()["descriptors"][str(version)]), "backend": backend}
    name = f"protobuf_test_messages.proto{version}.TestAllTypesProto{version}"
    decode, encode = rj.Decoder.of(name, **options), rj.Encoder.of(name, **options)
    for _, request, accepted in cases:
        if accepted is None:
            with pytest.raises(rj.DecodeError):
                decode(bytes.fromhex(request))
        else:
            assert encode(decode(bytes.fromhex(request))).hex() == accepted


def test_no_case_is_missing():
    assert len(vectors()["cases"]) == CASES


@pytest.mark.campaign
@pytest.mark.parametrize("backend", ["numba", "interpreter"])
def test_the_runner_itself(tmp_path, backend):
    if RUNNER is None:
        pytest.skip("conformance_test_runner is not installed")
    program = tmp_path / "testee"
    testee = Path(__file__).resolve().parent / "testee.py"
    program.write_text(f'#!/bin/sh\nexec "{sys.executable}" "{testee}"\n')
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
    environment = {**os.environ, "CONFORMANCE_BACKEND": backend}
    done = subprocess.run([RUNNER, program], env=environment, cwd=tmp_path, capture_output=True, text=True, check=False)
    summaries = re.findall(r"CONFORMANCE SUITE \w+: (\d+) successes, \d+ skipped, \d+ expected failures, (\d+) unexpected", done.stderr)
    successes, unexpected = summaries[0]
    assert (int(successes) >= CASES, unexpected) == (True, "0")


@pytest.mark.parametrize("backend", ["llvm", "python", "interpreter"])
@pytest.mark.parametrize(
    ("given", "written"),
    [
        ("a81f01", "a81f01"),  # an unknown number
        ("1203a81f01 08051203b01f07", "08051206a81f01b01f07"),  # unknown fields of a message that comes in two pieces
        ("1a00", "1a040a001200"),  # an entry of a map without key and value
        ("22020102", "2201012002"),  # a number that a closed enum does not name
        ("a31f0801a41f", "a31f0801a41f"),  # an unknown group
    ],
)
def test_what_a_schema_does_not_know_is_kept(given, written, backend):
    options = {"schema": {"tree.proto": TREE}, "backend": backend}
    decode, encode = rj.Decoder.of("p.A", **options), rj.Encoder.of("p.A", **options)
    holder = decode(bytes.fromhex(given))
    assert encode(holder).hex() == written
    copied = holder.new()
    copied.CopyFrom(holder)
    assert encode(copied).hex() == written
