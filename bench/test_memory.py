"""What is held: by a decoder, by a holder, by a million rows."""

from __future__ import annotations

import ctypes
import gc
from pathlib import Path

import pytest

import rosetta_jit as rj
from bench import varied
from bench.figures import Spread
from bench.messages import joints_mapping, repeated, specialised
from bench.processes import run

COUNT = 10_000
STATUS = Path("/proc/self/statm")
PAGE_BYTES = 4096

pytestmark = pytest.mark.skipif(not STATUS.exists(), reason="reads the resident set from /proc")


@pytest.fixture
def decoder(tmp_path):
    return rj.Decoder(joints_mapping(24, tmp_path), encoding="yarp3")


def test_decoders(tmp_path, record):
    mapping, message = joints_mapping(24, tmp_path), specialised(24)

    def make():
        decoder = rj.Decoder(mapping, encoding="yarp3")
        decoder(message)
        return decoder

    record("memory of 10,000 decoders of one type, each", held(make, COUNT), None, "KB", "aim 20 KB")


def test_holders(decoder, record):
    message = specialised(24)
    record("memory of 10,000 holders of 24 angles, each", held(lambda: decoder.into(message, decoder.new()), COUNT), None, "KB")


def test_a_holder_built_again(record, effort):
    """Texts that are assigned take the place of others, sooner or later."""
    made, times = varied.joint_state(1), COUNT // 10 if effort.quick else COUNT
    holder, encode = made.subject.decoder().new(), made.subject.encoder()
    for number in range(times):
        holder.name = made.plain[number % len(made.plain)]["name"]
        encode(holder)
    size = sum(buffer.nbytes for buffer in holder.lanes_.buffers) / 1000
    record("memory of a holder of 32 names, assigned again and again", Spread.of([size]), None, "KB", f"{times:,} times, each encoded")


@pytest.mark.parametrize("how", ["compiled", "from the cache"])
def test_programs(how, tmp_path, record, effort):
    """Of different mappings: each has code of its own."""
    count, processes = (20, 1) if effort.quick else (60, 3)
    cached = how == "from the cache"

    def each(number):
        cache = tmp_path / ("cache" if cached else f"cache{number}")
        return float(run("-m", "bench.decoder_memory", str(tmp_path), str(count), ROSETTA_JIT_CACHE_DIR=str(cache)))

    if cached:
        each(0)
    detail = f"30 to {30 + count} doubles; slope of the private memory, in processes of their own"
    record(
        f"memory of decoders of different mappings, {how}, each",
        Spread.of([each(number) for number in range(processes)]),
        None,
        "KB",
        detail,
    )


def test_a_million_rows(decoder, record, effort):
    rows = 100_000 if effort.quick else 1_000_000
    buffer, offsets = repeated(specialised(24), rows)
    size = held(lambda: decoder.many(buffer, offsets), 1, warm=0).times(1000 / rows)
    record("memory of a million rows of 24 angles, each", size, None, "bytes", f"96 bytes of them angles; {rows:,} rows")


def held(make, count, *, warm=20):
    """Kilobytes of the resident set for each of so many things, made and kept."""
    kept = [make() for _ in range(warm)]
    before = resident_bytes()
    kept += [make() for _ in range(count)]
    each = (resident_bytes() - before) / count / 1000
    assert len(kept) == warm + count
    return Spread.of([each])


def resident_bytes() -> int:
    """What this process holds, without what it has given up: a compiler leaves more behind than a decoder takes."""
    gc.collect()
    trim = getattr(ctypes.CDLL(None), "malloc_trim", None)  # glibc's
    if trim is not None:
        trim(0)
    return int(STATUS.read_text("utf-8").split()[1]) * PAGE_BYTES
