"""The paper's experiment: a bottle of 200 bytes, decoded a million times, by us, by YARP or the model of it, and by hand."""

from __future__ import annotations

import json
import shutil
from functools import partial

import numpy as np
import pytest

import rosetta_jit as rj
from bench.contest import Contender
from bench.figures import Spread
from bench.messages import batch, joints_mapping, repeated, specialised, tagged
from bench.peers import bottle_by_hand
from bench.peers.generated import generated_c, generated_cpp
from bench.peers.generated_lisp import generated_lisp
from bench.peers.yarp_native import Peers
from bench.processes import run

CHAPTER = "Native bottle parsing"
CPP, ADDS, RESIZES = "rosetta_jit, generated C++", "C++ by hand, add_angles", "C++ by hand, into resized memory"
INTO_PROTOBUF = {CPP: "codec", ADDS: "add", RESIZES: "resize"}
LISP = "rosetta_jit, generated Lisp"
MESSAGES, SERIES = 1_000_000, 20
HERE = {"loop": "C++ by hand, loop, for this machine", "tagged": "C++ by hand, tagged, for this machine"}
OURS, BUILTIN, MANY, LEN, LOOP, COPY, TAGGED, GENERATED = (
    "rosetta_jit",
    "rosetta_jit, `builtin`",
    "rosetta_jit, `many`",
    "len()",
    "C++ by hand, loop",
    "C++ by hand, memcpy",
    "C++ by hand, tagged",
    "rosetta_jit, generated C",
)
ONE_CALL = (
    ("one call, 24 specialised doubles, `builtin`", "24 specialised doubles", "builtin", 1.3),
    ("one call, 24 specialised doubles", "24 specialised doubles", "decode", 2),
    ("one call, 16 tagged doubles, `builtin`", "16 tagged doubles", "builtin", None),
    ("one call, 16 tagged doubles", "16 tagged doubles", "decode", 3),
    ("`encode`, one call, 24 doubles", "24 specialised doubles", "encode", 3),
)
"""Rows: what, which message, what is called, and the target."""

HOLDER = "JointAngles in float32 radians, used again"


@pytest.fixture(scope="module")
def decoders(tmp_path_factory):
    folder = tmp_path_factory.mktemp("joints")
    return {count: rj.Decoder(joints_mapping(count, folder), encoding="yarp3") for count in (24, 16)}


def series(effort):
    """Messages in one of the series that make up the million; a tenth of it in a quick run."""
    return MESSAGES // SERIES // (10 if effort.quick else 1)


def decodes(effort):
    return f"{SERIES * series(effort):,} decodes"


def degrees_of(message):
    """The numbers of a bottle, as its writer had them."""
    return np.array([10.0 * index - 7.25 for index in range(16 if message == tagged() else 24)])


def same(found, wanted):
    """Before anything is timed: each contender has the numbers."""
    assert np.asarray(found) == pytest.approx(wanted, rel=1e-6)


def bottle_contenders(effort, decoder, message, peers):
    """Who reads either form: ours, YARP, numba, numpy."""
    count, degrees, radians = series(effort), degrees_of(message), np.radians(degrees_of(message))
    rows = repeated(message, 10_000)
    into = decoder.many(*rows)
    array, holder = np.frombuffer(message, np.uint8), decoder.into(message, decoder.new())
    kernel, filled = bottle_by_hand.numba_kernel(decoder, holder)
    view, anew = bottle_by_hand.frombuffer(message), bottle_by_hand.radians(message)
    same(decoder(message).angles, radians)
    same(decoder.builtin(message).angles, radians)
    same(into.angles.to_numpy()[[0, -1]], np.array([radians, radians]))
    same(peers.dynamic_values(message), degrees)
    holder.angles[:] = 0
    kernel(array, filled)
    same(holder.angles, radians)
    same(view(message), degrees)
    same(anew(message), radians)
    return [
        Contender(OURS, "ours", HOLDER, effort.call(decoder, message, count=count)),
        Contender(BUILTIN, "ours", HOLDER, effort.call(decoder.builtin, message, count=count)),
        Contender(MANY, "ours", "10,000 rows of angles, used again", effort.call(many(decoder, rows, into), messages=10_000)),
        Contender(LEN, "limit", "a number", effort.call(len, message, count=count)),
        Contender(peers.dynamic_decoder, "peer", "one heap object an element, in C++", partial(peers.dynamic(message), count)),
        numba_by_hand(effort, message, array, radians),
        Contender("our kernel through numba's dispatcher", "peer", HOLDER, effort.call(kernel, array, filled, count=count)),
        Contender("numpy.frombuffer, unchecked", "peer", "a view of degrees", effort.call(view, message, count=count)),
        Contender("numpy, as radians, unchecked", "peer", "an array, anew", effort.call(anew, message, count=count)),
    ]


def numba_by_hand(effort, message, array, radians):
    write = bottle_by_hand.numba_tagged if message == tagged() else bottle_by_hand.numba_specialised
    decode, angles = write(), np.zeros(len(radians), np.float32)
    assert decode(array, angles) == len(message)
    same(angles, radians)
    return Contender("numba by hand", "peer", "an array, used again", effort.call(decode, array, angles, count=series(effort)))


def in_cpp(who, makes, timed, target, wanted, count):
    """A decoder by hand in C++, which fills a target."""
    timed(1)
    same(target, wanted)
    return Contender(who, "ours" if who in (GENERATED, CPP, LISP) else "peer", makes, partial(timed, count))


def by_struct(effort, message, makes):
    values = bottle_by_hand.unpacked(message)
    same(values(message, 8)[-1], degrees_of(message)[-1])
    return Contender("struct, unchecked", "peer", makes, effort.call(values, message, 8, count=series(effort)))


def yarp_vector(peers, message, count):
    """YARP's class for this list alone, where it is installed."""
    read = peers.yarp("vector", message)
    if read is not None:
        yield Contender("YARP's Vector", "peer", "an array of float64 degrees, used again, in C++", partial(read, count))


def many(decoder, rows, into):
    buffer, offsets = rows
    return lambda: decoder.many(buffer, offsets, into=into)


def test_one_call(tmp_path, effort, record):
    """In processes of their own: each has luck of its own with where code and data lie."""
    run("-m", "bench.one_call", str(tmp_path), ROSETTA_JIT_CACHE_DIR=str(tmp_path))  # compiles
    count = 5 if effort.quick else 15
    found = [json.loads(run("-m", "bench.one_call", str(tmp_path), ROSETTA_JIT_CACHE_DIR=str(tmp_path))) for _ in range(count)]
    for what, message, called, at_most in ONE_CALL:
        record(what, Spread.of([each[message][called] for each in found]), at_most, "x len()", f"of {count} processes", messages=1)


def test_24_specialised_doubles(decoders, effort, compare, record, tmp_path):
    decoder, message, peers, count = decoders[24], specialised(24), Peers(), series(effort)
    angles, degrees, in_c = np.zeros(24, np.float32), np.zeros(24), np.zeros(24, np.float32)
    compiled = generated_c(joints_mapping(24, tmp_path), tmp_path, message, in_c)
    wanted = degrees_of(message)
    outcome = compare(
        CHAPTER,
        f"24 specialised doubles, 200 bytes, {decodes(effort)}",
        [
            *bottle_contenders(effort, decoder, message, peers),
            *yarp_vector(peers, message, count),
            in_cpp(LOOP, "an array of float32 radians, used again", peers.loop(message, 266, angles), angles, np.radians(wanted), count),
            in_cpp(
                HERE["loop"],
                "an array of float32 radians, used again",
                peers.loop(message, 266, angles, here=True),
                angles,
                np.radians(wanted),
                count,
            ),
            in_cpp(COPY, "an array of float64 degrees, used again", peers.copy(message, 266, degrees), degrees, wanted, count),
            in_cpp(GENERATED, HOLDER, compiled, in_c, np.radians(wanted), count),
            by_struct(effort, message, "a tuple of degrees, anew"),
        ],
        rounds=SERIES,
    )
    against_dynamic(record, outcome, peers, "24 specialised doubles, against a dynamic C++ decoder", 1 / 30)
    took = outcome.took(GENERATED).median
    record("generated C against a C++ loop by hand", outcome.ratio(GENERATED, LOOP), 1.15, "x", f"{took:.1f} ns, gcc -O2", against=LOOP)
    loop, copy = (outcome.took(who).median for who in (LOOP, COPY))
    detail = f"loop {loop:.1f} ns, header check and memcpy {copy:.1f} ns"
    record("24 specialised doubles, against a C++ loop by hand, inside C++", outcome.ratio(OURS, LOOP), None, "x", detail)
    here = f"loop {outcome.took(HERE['loop']).median:.1f} ns, g++ -O3 -march=native"
    record("24 specialised doubles, against that loop compiled for this machine", outcome.ratio(OURS, HERE["loop"]), None, "x", here)


@pytest.mark.skipif(shutil.which("sbcl") is None, reason="SBCL is not installed")
def test_24_specialised_doubles_in_lisp(decoders, effort, compare, record, tmp_path):
    """Against generated C: what a vectorised loop, and a structure that need not be filled, are worth."""
    message, mapping, count = specialised(24), joints_mapping(24, tmp_path), series(effort)
    wanted, in_c, in_lisp = np.radians(degrees_of(message)), np.zeros(24, np.float32), np.zeros(24, np.float32)
    compiled = generated_c(mapping, tmp_path, message, in_c)
    with generated_lisp(mapping, tmp_path, message, in_lisp) as timed:
        outcome = compare(
            CHAPTER,
            f"24 specialised doubles in Lisp, {decodes(effort)}",
            [
                Contender(OURS, "ours", HOLDER, effort.call(decoders[24], message, count=count)),
                in_cpp(LISP, "a structure, used again", timed, in_lisp, wanted, count),
                in_cpp(GENERATED, HOLDER, compiled, in_c, wanted, count),
            ],
            rounds=SERIES,
        )
    took = outcome.took(LISP).median
    record("generated Lisp against generated C", outcome.ratio(LISP, GENERATED), None, "x", f"{took:.0f} ns, SBCL", against=GENERATED)


def test_24_specialised_doubles_into_protobuf(decoders, effort, compare, record, tmp_path):
    """The experiment of the paper as it was: into the class that protoc generates."""
    message, count, angles = specialised(24), series(effort), np.zeros(24, np.float32)
    timed = generated_cpp(joints_mapping(24, tmp_path), tmp_path, message, angles)
    if not timed:
        pytest.skip("protoc and its library are not installed")
    makes, wanted, peers = "protoc's JointAngles, used again, in C++", np.radians(degrees_of(message)), Peers()
    contenders = [Contender(OURS, "ours", HOLDER, effort.call(decoders[24], message, count=count))]
    contenders += [in_cpp(who, makes, timed[which], angles, wanted, count) for who, which in INTO_PROTOBUF.items()]
    contenders.append(
        Contender(peers.dynamic_decoder, "peer", "one heap object an element, in C++", partial(peers.dynamic(message), count))
    )
    contenders += yarp_vector(peers, message, count)
    outcome = compare(CHAPTER, f"24 specialised doubles into protoc's class, {decodes(effort)}", contenders, rounds=SERIES)
    detail = f"{outcome.took(CPP).median:.1f} ns, g++ -O2"
    record("generated C++ into protoc's class against a loop over add_angles", outcome.ratio(CPP, ADDS), 1.15, "x", detail, against=ADDS)
    record("the same against a loop into resized memory", outcome.ratio(CPP, RESIZES), None, "x", detail, against=RESIZES)
    against_dynamic(record, outcome, peers, "generated C++ into protoc's class, against a dynamic C++ decoder", 1 / 45, ours=CPP)


def test_16_tagged_doubles(decoders, effort, compare, record):
    decoder, message, peers = decoders[16], tagged(16), Peers()
    angles = np.zeros(16, np.float32)
    outcome = compare(
        CHAPTER,
        f"16 tagged doubles, 200 bytes, {decodes(effort)}",
        [
            *bottle_contenders(effort, decoder, message, peers),
            in_cpp(
                TAGGED,
                "an array of float32 radians, used again",
                peers.tagged_loop(message, 10, angles),
                angles,
                np.radians(degrees_of(message)),
                series(effort),
            ),
            in_cpp(
                HERE["tagged"],
                "an array of float32 radians, used again",
                peers.tagged_loop(message, 10, angles, here=True),
                angles,
                np.radians(degrees_of(message)),
                series(effort),
            ),
            by_struct(effort, message, "a tuple of tags and degrees, anew"),
        ],
        rounds=SERIES,
    )
    against_dynamic(record, outcome, peers, "16 tagged doubles, against a dynamic C++ decoder", None)
    loop = outcome.took(TAGGED).median
    record("16 tagged doubles, against a C++ loop by hand", outcome.ratio(OURS, TAGGED), None, "x", f"loop {loop:.1f} ns")
    here = f"loop {outcome.took(HERE['tagged']).median:.1f} ns, g++ -O3 -march=native"
    record("16 tagged doubles, against that loop compiled for this machine", outcome.ratio(OURS, HERE["tagged"]), None, "x", here)


def against_dynamic(record, outcome, peers, what, at_most, *, ours=OURS):
    who = peers.dynamic_decoder
    record(what, outcome.ratio(ours, who), at_most, "of it", f"{who}: {outcome.took(who).median:.0f} ns", against=who)


def test_encode(decoders, effort, compare):
    message, holder = specialised(24), decoders[24](specialised(24))
    encode, buffer = rj.Encoder(decoders[24]._request.mapping, encoding="yarp3"), bytearray(len(message))
    pack, values = bottle_by_hand.packed(message)
    assert encode.into(holder, buffer, 0) == len(message)
    for written in (encode(holder), buffer):
        same(np.frombuffer(written, np.float64, offset=8), degrees_of(message))
    assert pack(*values) == message
    compare(
        CHAPTER,
        "24 specialised doubles, encoded",
        [
            Contender(OURS, "ours", "bytes, anew", effort.call(encode, holder)),
            Contender("rosetta_jit, into", "ours", "a buffer that is given", effort.call(encode, holder, buffer, 0)),
            Contender(LEN, "limit", "a number", effort.call(len, message)),
            Contender("struct", "peer", "bytes, anew; nothing is converted", effort.call(pack, *values)),
        ],
    )


def test_a_million_in_one_call(decoders, effort, compare, record):
    count = MESSAGES // 10 if effort.quick else MESSAGES
    buffer, offsets = batch(count)
    rows = decoders[24].many(buffer, offsets)
    written = sum(rows.lanes.used(lane) * stride for lane, stride in enumerate(rows.lanes.plan.strides))
    moved = np.zeros((buffer.nbytes + written) // 2, np.uint8)  # each byte is read and written
    target = np.empty_like(moved)
    same(rows.angles.to_numpy()[[0, -1]], np.radians([degrees_of(specialised())] * 2))
    by_hand, angles = bottle_by_hand.numba_many(24), np.empty((count, 24), np.float32)
    assert by_hand(buffer, offsets, angles) == count
    same(angles[[0, -1]], rows.angles.to_numpy()[[0, -1]])
    outcome = compare(
        CHAPTER,
        f"{count:,} messages in one call",
        [
            Contender(MANY, "ours", "rows of angles, used again", effort.call(many(decoders[24], (buffer, offsets), rows), messages=count)),
            Contender("memmove", "limit", "as many bytes, elsewhere", effort.call(np.copyto, target, moved, messages=count)),
            Contender("numba, by hand", "peer", "angles, used again", effort.call(by_hand, buffer, offsets, angles, messages=count)),
        ],
        rounds=7,
    )
    took = outcome.took(MANY).median
    what, words = "`many`, 10⁶ such messages", f"{took:.1f} ns a message, of {count:,}"
    record(f"{what}, read and written", outcome.ratio(MANY, "memmove"), 1.2, "x memmove", words)
    record(f"{what}, against a loop by hand", outcome.ratio(MANY, "numba, by hand"), 1.2, "x numba", "which writes the angles alone")
