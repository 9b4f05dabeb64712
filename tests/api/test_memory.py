"""What programs take is given back when they are dropped."""

from __future__ import annotations

import gc
import subprocess
import sys
import weakref
from pathlib import Path

import pytest

import rosetta_jit as rj


def decoder(number):
    fields = "".join(f"float64 a{number}_{field}\n" for field in range(10))
    return rj.Decoder.of("p/A", schema={"p/A.msg": fields + "string s\n"}, encoding="ros1", imports=["p/A.msg"])


def test_types_end_with_their_programs_and_holders(monkeypatch):
    monkeypatch.setenv("ROSETTA_JIT_CACHE", "off")
    decode = decoder(1)
    holder = decode.new()
    assert holder.serialize.__self__ is holder
    seen = [weakref.ref(decode), weakref.ref(decode._loaded.library), weakref.ref(type(holder)), weakref.ref(type(holder).family_)]
    del decode
    gc.collect()
    assert [each() is None for each in seen] == [True, True, False, False]
    assert rj.Encoder.of("p/A", schema={"p/A.msg": "string s\n"}, encoding="ros1", imports=["p/A.msg"]).holder_type is not type(holder)
    del holder
    gc.collect()
    assert all(each() is None for each in seen)


def test_a_type_that_lives_stays_the_same():
    holder = decoder(2).new()
    gc.collect()
    assert decoder(2).holder_type is type(holder)


def test_who_serialised_ends_with_the_type(monkeypatch):
    monkeypatch.setenv("ROSETTA_JIT_CACHE", "off")
    holder = rj.Decoder.of("t.M", schema={"a.proto": 'syntax = "proto3"; package t; message M { int32 a = 1; }'}).new()
    holder.a = 3
    assert holder.SerializeToString() == b"\x08\x03"
    seen = weakref.ref(type(holder))
    del holder
    gc.collect()
    assert seen() is None


DROPPED = """
import gc, os, sys
os.environ["ROSETTA_JIT_CACHE"] = "off"
from tests.api.test_memory import decoder

def private_kb():
    lines = open("/proc/self/smaps_rollup").read().splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith("Private_Dirty"))

for number in range(20):
    decoder(number)
gc.collect()
before = private_kb()
for number in range(100, 160):
    decoder(number)
gc.collect()
print((private_kb() - before) / 60)
"""


@pytest.mark.skipif(not Path("/proc/self/smaps_rollup").exists(), reason="the system does not say what memory is a process's own")
def test_decoders_of_different_types_leave_nothing_behind():
    ended = subprocess.run([sys.executable, "-c", DROPPED], check=True, capture_output=True, text=True, timeout=300)
    assert float(ended.stdout) < 40, "KB each; where LLVM's passes or the classes of holders stay it is over 100"


@pytest.mark.parametrize("size", [(4 << 20) - 1, 4 << 20, (4 << 20) + 70_000, 9 << 20])
def test_large_messages_are_the_same_in_new_bytes_and_in_a_buffer(size):
    """Around the size from which on memory is asked for in large pages."""
    schema = {"p/B.msg": "uint8[] data\n"}
    encode = rj.Encoder.of("p/B", schema=schema, encoding="ros1")
    holder = encode.new()
    holder.data = (bytes(range(256)) * (size // 256 + 1))[: size - 4]
    buffer = bytearray(encode.size(holder))
    assert encode.into(holder, buffer) == len(buffer)
    assert encode(holder) == buffer
    between = rj.Bridge.of("p/B", decode={"schema": schema, "encoding": "ros1"}, encode={"schema": schema, "encoding": "ros1"})
    assert between(buffer) == buffer
