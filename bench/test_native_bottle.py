"""The paper's experiment: a bottle of 200 bytes, decoded a million times, by us, by YARP or the model of it, and by hand."""

from __future__ import annotations

import numpy as np
import pytest

import rosetta_jit as rj
from bench.contest import Contender
from bench.messages import batch, joints_mapping, repeated, specialised, tagged
from bench.peers import bottle_by_hand
from bench.peers.yarp_native import Peers

CHAPTER = "Native bottle parsing"
MESSAGES, SERIES = 1_000_000, 20
OURS, BUILTIN, MANY, LEN, LOOP, COPY, TAGGED = (
    "rosetta_jit",
    "rosetta_jit, `builtin`",
    "rosetta_jit, `many`",
    "len()",
    "C++ by hand, loop",
    "C++ by hand, memcpy",
    "C++ by hand, tagged",
)
HOLDER = "JointAngles in float32 radians, used again"


@pytest.fixture(scope="module")
def decoders(tmp_path_factory):
    folder = tmp_path_factory.mktemp("joints")
    return {count: rj.Decoder(joints_mapping(count, folder), encoding="yarp3") for count in (24, 16)}


def series(effort):
    """Messages in one of the series that make up the million; a tenth of it in a quick run."""
    return MESSAGES // SERIES // (10 if effort.quick else 1)


def bottle_contenders(effort, decoder, message, peers):
    """Who reads either form."""
    count, rows = series(effort), repeated(message, 10_000)
    into = decoder.many(*rows)
    return [
        Contender(OURS, "ours", HOLDER, effort.call(decoder, message, count=count)),
        Contender(BUILTIN, "ours", HOLDER, effort.call(decoder.builtin, message, count=count)),
        Contender(MANY, "ours", "10,000 rows of angles, used again", effort.call(many(decoder, rows, into), messages=10_000)),
        Contender(LEN, "limit", "a number", effort.call(len, message, count=count)),
        Contender(peers.dynamic_decoder, "peer", "one heap object an element, in C++", lambda: peers.dynamic(message)(count)),
    ]


def yarp_vector(peers, message, count):
    """YARP's class for this list alone, where it is installed."""
    read = peers.yarp("vector", message)
    if read is not None:
        yield Contender("YARP's Vector", "peer", "an array of float64 degrees, used again, in C++", lambda: read(count))


def many(decoder, rows, into):
    buffer, offsets = rows
    return lambda: decoder.many(buffer, offsets, into=into)


def test_24_specialised_doubles(decoders, effort, compare, record):
    decoder, message, peers, count = decoders[24], specialised(24), Peers(), series(effort)
    assert decoder(message).angles == pytest.approx(np.radians([10.0 * index - 7.25 for index in range(24)]), rel=1e-6)
    array, by_hand = np.frombuffer(message, np.uint8), bottle_by_hand.numba_by_hand()
    kernel, state = bottle_by_hand.numba_kernel(decoder, message)
    assert by_hand(array, np.empty(24, np.float32)) == len(message)
    assert kernel(array, state) >= 0
    outcome = compare(
        CHAPTER,
        "24 specialised doubles, 200 bytes, 1,000,000 decodes",
        [
            *bottle_contenders(effort, decoder, message, peers),
            *yarp_vector(peers, message, count),
            Contender(LOOP, "peer", "an array of float32 radians, used again", lambda: peers.loop(message, 266)(count)),
            Contender(COPY, "peer", "an array of float64 degrees, used again", lambda: peers.copy(message, 266)(count)),
            Contender("numba by hand", "peer", "an array, used again", effort.call(by_hand, array, np.empty(24, np.float32), count=count)),
            Contender("our kernel through numba's dispatcher", "peer", HOLDER, effort.call(kernel, array, state, count=count)),
            Contender("numpy.frombuffer", "peer", "a view of degrees", effort.call(bottle_by_hand.frombuffer, message, count=count)),
            Contender("numpy, as radians", "peer", "an array, anew", effort.call(bottle_by_hand.frombuffer_radians, message, count=count)),
            Contender("struct", "peer", "a tuple of degrees", effort.call(bottle_by_hand.struct_unpack(24), message, count=count)),
        ],
        rounds=SERIES,
    )
    record(
        "one call, 24 specialised doubles, `builtin`", outcome.ratio(BUILTIN, LEN), 1.3, "x len()", f"{outcome.took(BUILTIN).median:.0f} ns"
    )
    record("one call, 24 specialised doubles", outcome.ratio(OURS, LEN), 2, "x len()", f"{outcome.took(OURS).median:.0f} ns")
    dynamic = outcome.took(peers.dynamic_decoder).median
    record(
        "the same against a dynamic C++ decoder",
        outcome.ratio(OURS, peers.dynamic_decoder),
        1 / 30,
        "of it",
        f"{peers.dynamic_decoder}: {dynamic:.0f} ns",
    )
    loop, copy = (outcome.took(who).median for who in (LOOP, COPY))
    detail = f"loop {loop:.1f} ns, header check and memcpy {copy:.1f} ns"
    record("the same against a C++ loop by hand, inside C++", outcome.ratio(OURS, LOOP), None, "x", detail)


def test_16_tagged_doubles(decoders, effort, compare, record):
    decoder, message, peers = decoders[16], tagged(16), Peers()
    outcome = compare(
        CHAPTER,
        "16 tagged doubles, 200 bytes, 1,000,000 decodes",
        [
            *bottle_contenders(effort, decoder, message, peers),
            Contender(TAGGED, "peer", "an array of float32 radians, used again", lambda: peers.tagged_loop(message, 10)(series(effort))),
            Contender("struct", "peer", "a tuple of tags and degrees", effort.call(bottle_by_hand.struct_tagged(16), message)),
        ],
        rounds=SERIES,
    )
    record("one call, 16 tagged doubles, `builtin`", outcome.ratio(BUILTIN, LEN), None, "x len()", f"{outcome.took(BUILTIN).median:.0f} ns")
    record("one call, 16 tagged doubles", outcome.ratio(OURS, LEN), 3, "x len()", f"{outcome.took(OURS).median:.0f} ns")
    loop = outcome.took(TAGGED).median
    record("the same against a C++ loop by hand, tagged", outcome.ratio(OURS, TAGGED), None, "x", f"loop {loop:.1f} ns")


def test_encode(decoders, effort, compare, record):
    message, holder = specialised(24), decoders[24](specialised(24))
    encode = rj.Encoder(decoders[24]._request.mapping, encoding="yarp3")
    assert len(encode(holder)) == len(message)
    outcome = compare(
        CHAPTER,
        "24 specialised doubles, encoded",
        [
            Contender(OURS, "ours", "bytes, anew", effort.call(encode, holder)),
            Contender("rosetta_jit, into", "ours", "a buffer that is given", effort.call(encode, holder, bytearray(len(message)), 0)),
            Contender(LEN, "limit", "a number", effort.call(len, message)),
        ],
    )
    record("`encode`, one call, 24 doubles", outcome.ratio(OURS, LEN), 3, "x len()", f"{outcome.took(OURS).median:.0f} ns")


def test_a_million_in_one_call(decoders, effort, compare, record):
    count = MESSAGES // 10 if effort.quick else MESSAGES
    buffer, offsets = batch(count)
    rows, target = decoders[24].many(buffer, offsets), np.empty_like(buffer)
    assert len(rows) == count
    outcome = compare(
        CHAPTER,
        "1,000,000 messages in one call",
        [
            Contender(MANY, "ours", "rows of angles, used again", effort.call(many(decoders[24], (buffer, offsets), rows), messages=count)),
            Contender("memmove", "limit", "their bytes, elsewhere", effort.call(np.copyto, target, buffer, messages=count)),
        ],
        rounds=7,
    )
    took = outcome.took(MANY).median
    record("`many`, 10⁶ such messages", outcome.ratio(MANY, "memmove"), 1.2, "x memmove", f"{took:.1f} ns a message")
