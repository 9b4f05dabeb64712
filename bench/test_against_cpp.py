"""Messages of many small parts, integers and texts, beside what frameworks generate for C++.

Both fill what is used again, and write into a buffer that is given. Where lengths vary, both have the same messages in turn.
"""

from __future__ import annotations

import pytest

from bench import varied
from bench.contest import Contender
from bench.loops import loop
from bench.peers.native import native_peers, rounds_of
from bench.report import words
from bench.subjects import MIXED_VARINTS, VARINTS

CHAPTER = "Small parts, against C++"
OURS = "rosetta_jit"
SUBJECTS = {
    **{name: lambda each=each: (each, (each.message,)) for name, each in VARINTS.items()},
    **{name: lambda every=every: (every[0], tuple(each.message for each in every)) for name, every in MIXED_VARINTS.items()},
    "TFMessage 50": lambda: _of(varied.transforms()),
    "DiagnosticArray, 20 statuses": lambda: _of(varied.diagnostics()),
}
"""A type, and its messages."""
AT_MOST = {"decode": 1.2, "encode": 1.5}


def _of(made):
    return made.subject, made.messages


@pytest.mark.parametrize("job", AT_MOST)
@pytest.mark.parametrize("name", SUBJECTS)
def test_against_what_is_generated_for_cpp(name, job, effort, compare, record):
    subject, messages = SUBJECTS[name]()
    peers = native_peers(subject, messages)
    if not peers:
        pytest.skip("the C++ peer of this framework was not built")
    (peer,) = peers
    try:
        theirs = rounds_of(peer.decode if job == "decode" else peer.encode, effort.round_s)
    except ValueError as error:
        pytest.skip(str(error))
    made = "a holder, used again" if job == "decode" else "a buffer that is given"
    contenders = [
        Contender(OURS, "ours", made, ours(subject, messages, job, effort)),
        Contender(peer.who, "peer", peer.makes if job == "decode" else made, theirs),
    ]
    outcome = compare(CHAPTER, f"{name}, {job}d", contenders)
    took = f"{words.time(outcome.took(OURS).median)} against {words.time(outcome.took(peer.who).median)}"
    record(f"{name}, {job}d, against {peer.who}", outcome.ratio(OURS, peer.who), AT_MOST[job], "x", took)


def ours(subject, messages, job, effort):
    """What is timed: a call of one message again and again, or a loop over several."""
    decode, encode, buffer = subject.decoder(), subject.encoder(), bytearray(max(map(len, messages)))
    holders = [decode.into(each, decode.new()) for each in messages]
    for each, message in zip(holders, messages, strict=True):
        assert encode(each, buffer, 0) == len(message)
        assert buffer[: len(message)] == message
    if len(messages) == 1:
        return effort.call(decode, *messages) if job == "decode" else effort.call(encode, *holders, buffer, 0)
    if job == "decode":
        return loop(effort, "decode(m)", messages, decode=decode)
    return loop(effort, "encode(m, buffer, 0)", holders, encode=encode, buffer=buffer)
