"""Each framework's messages into a holder that is used again, one Python call a message, and back into a buffer that is given."""

from __future__ import annotations

import numpy as np
import pytest

from bench.contest import Contender
from bench.messages import anew
from bench.peers import generated_python, python_peers
from bench.peers.native import native_peers, rounds_of
from bench.peers.yarp_native import Peers
from bench.report import words
from bench.subjects import ROS_2, SUBJECTS

OURS, FRESH, INTO, BORROWED, LEN, COPY, MOVE = (
    "rosetta_jit",
    "rosetta_jit, a holder anew",
    "rosetta_jit, into a buffer",
    "rosetta_jit, borrowed",
    "len()",
    "numpy's copy",
    "memmove in C++",
)
ALL = {**SUBJECTS, **ROS_2}
BLOBS = ("Image 640x480", "PointCloud2, 100,000 points", "RST Image 320x240")
SMALL = {"Imu": 3, "RST JointAngles, packed": 3, "RST JointAngles, unpacked": 5}
ARRAYS = {
    "LaserScan 1080": 2,
    "PoseArray 1000": 1.5,
    "LCM, 1,000 big-endian doubles": 2,
    "CORBA TimedDoubleSeq 1000": 1.5,
    "OROCOS vector<double> 1000": 1.5,
}
PYTHON_SHARES = {"Imu": 50, "JointState, 32 joints": 30, "PoseArray 1000": None, "LaserScan 1080": None}


@pytest.mark.parametrize("name", ALL)
def test_decode(name, effort, compare, record):
    subject = ALL[name]
    message, decode = subject.message, subject.decoder()
    assert subject.encoder()(decode(message)) == message
    contenders = [
        Contender(OURS, "ours", "a holder of lanes, used again", effort.placed(lambda: effort.call(subject.decoder(), anew(message)))),
        Contender(FRESH, "ours", "a holder of lanes, anew", effort.call(lambda: decode.into(message, decode.new()))),
        *borrowed(effort, name, subject),
        *limits(effort, message),
        *(Contender(peer.who, "peer", peer.makes, effort.call(peer.decode, message)) for peer in python_peers(subject)),
        *(Contender(peer.who, "ours", peer.makes, effort.call(peer.decode, message)) for peer in generated_python.peers(subject)),
        *(Contender(peer.who, "peer", peer.makes, rounds_of(peer.decode, effort.round_s)) for peer in native_peers(subject)),
    ]
    outcome = compare("Decoding", name, contenders)
    for row in decode_rows(name, outcome, [peer.who for peer in python_peers(subject)]):
        record(*row)


@pytest.mark.parametrize("name", ALL)
def test_encode(name, effort, compare, record):
    subject = ALL[name]
    message, encode = subject.message, subject.encoder()
    holder, buffer = subject.decoder()(message), bytearray(len(message))
    assert encode(holder) == message
    encode(holder, buffer, 0)
    assert buffer == message
    peers = [(peer, peer.decode(message)) for peer in python_peers(subject) if peer.encode is not None]
    generated = [(peer, peer.decode(message)) for peer in generated_python.peers(subject)]
    for peer, value in (*peers, *generated):
        assert bytes(peer.encode(value)) == message, peer.who
    contenders = [
        Contender(INTO, "ours", "a buffer that is given", effort.placed(lambda: into_a_buffer(effort, subject))),
        Contender(OURS, "ours", "bytes, anew", effort.placed(lambda: effort.call(encode, subject.decoder()(message)))),
        Contender("its decode", "limit", "a holder, used again", effort.placed(lambda: effort.call(subject.decoder(), anew(message)))),
        *limits(effort, message),
        *(Contender(peer.who, "peer", "bytes, anew", effort.call(peer.encode, value)) for peer, value in peers),
        *(Contender(peer.who, "ours", "bytes, anew", effort.call(peer.encode, value)) for peer, value in generated),
        *(Contender(peer.who, "peer", "a buffer that is given", rounds_of(peer.encode, effort.round_s)) for peer in native_peers(subject)),
    ]
    outcome = compare("Encoding", name, contenders)
    if name in SUBJECTS:
        took = words.time(outcome.took(INTO).median)
        record(f"{name}, encode", outcome.ratio(INTO, "its decode"), 1.5, "x its decode", took)


def into_a_buffer(effort, subject):
    return effort.call(subject.encoder(), subject.decoder()(subject.message), bytearray(len(subject.message)), 0)


def borrowed(effort, name, subject):
    """Ours once more, for what can stay where it is."""
    if name not in BLOBS:
        return []
    decode = subject.decoder(borrow=True)
    assert subject.encoder()(decode(subject.message)) == subject.message
    return [Contender(BORROWED, "ours", "a holder, used again; bytes are a view of the message", effort.call(decode, subject.message))]


def limits(effort, message):
    """What no decoder in Python can do without: a call, and the bytes moved."""

    def copied():
        return effort.call(np.copyto, np.empty(len(message), np.uint8), np.frombuffer(anew(message), np.uint8))

    def moved():
        return rounds_of(Peers().memmove(len(message)), effort.round_s)

    return [
        Contender(LEN, "limit", "a number", effort.call(len, message)),
        Contender(COPY, "limit", "the message's bytes, elsewhere", effort.placed(copied)),
        Contender(MOVE, "limit", "the same, without a call from Python", effort.placed(moved)),
    ]


def decode_rows(name, outcome, peers):
    """The rows of the table that this message has."""
    took, len_, moved = words.time(outcome.took(OURS).median), outcome.took(LEN).median, outcome.took(MOVE).median
    if name in SMALL:
        allowed = SMALL[name] + (moved / len_ if name == "Imu" else 0)
        yield f"{name}, decode", outcome.ratio(OURS, LEN), allowed, "x len()", took
    if name in ARRAYS:
        allowed, detail = ARRAYS[name] + len_ / moved, f"{took}, the call in the limit"
        yield f"{name}, decode", outcome.ratio(OURS, MOVE), allowed, "x memmove", detail
    if name in BLOBS:
        yield f"{name}, copied", outcome.ratio(OURS, COPY), 1.15, "x memmove", took
        yield f"{name}, borrowed", outcome.ratio(BORROWED, LEN), 4, "x len()", words.time(outcome.took(BORROWED).median)
    if name in PYTHON_SHARES and peers:
        yield against_python(name, outcome, peers)
    if name == "JointState, 32 joints" and "roscpp in C++" in outcome.rounds_ns:
        roscpp = outcome.took("roscpp in C++").median
        yield f"{name}, against roscpp in C++", outcome.ratio(OURS, "roscpp in C++"), 1.2, "x", f"{words.time(roscpp)}, object used again"


def against_python(name, outcome, peers):
    peer, part = outcome.fastest(peers), PYTHON_SHARES[name]
    share = None if part is None else 1 / part
    detail = f"{peer}: {words.time(outcome.took(peer).median)}"
    return f"{name}, against the fastest Python peer", outcome.ratio(OURS, peer), share, "of it", detail
