"""Messages of many small parts, integers and texts, beside what frameworks generate for C++.

Both fill what is used again, and write into a buffer that is given.
"""

from __future__ import annotations

import pytest

from bench.contest import Contender
from bench.peers.native import native_peers, rounds_of
from bench.report import words
from bench.subjects import DIAGNOSTICS, TRANSFORMS, VARINTS

CHAPTER = "Small parts, against C++"
OURS = "rosetta_jit"
SUBJECTS = {**VARINTS, "TFMessage 50": TRANSFORMS, "DiagnosticArray, 20 statuses": DIAGNOSTICS}
AT_MOST = {"decode": 1.2, "encode": 1.5}


@pytest.mark.parametrize("job", AT_MOST)
@pytest.mark.parametrize("name", SUBJECTS)
def test_against_what_is_generated_for_cpp(name, job, effort, compare, record):
    subject = SUBJECTS[name]
    peers = native_peers(subject)
    if not peers:
        pytest.skip("the C++ peer of this framework was not built")
    (peer,) = peers
    message, decode, encode, buffer = subject.message, subject.decoder(), subject.encoder(), bytearray(len(subject.message))
    holder = decode.into(message, decode.new())
    assert encode(holder, buffer, 0) == len(message)
    assert buffer == message
    ours = effort.call(decode, message) if job == "decode" else effort.call(encode, holder, buffer, 0)
    try:
        theirs = rounds_of(peer.decode if job == "decode" else peer.encode, effort.round_s)
    except ValueError as error:
        pytest.skip(str(error))
    made = "a holder, used again" if job == "decode" else "a buffer that is given"
    contenders = [
        Contender(OURS, "ours", made, ours),
        Contender(peer.who, "peer", peer.makes if job == "decode" else made, theirs),
    ]
    outcome = compare(CHAPTER, f"{name}, {job}d", contenders)
    took = f"{words.time(outcome.took(OURS).median)} against {words.time(outcome.took(peer.who).median)}"
    record(f"{name}, {job}d, against {peer.who}", outcome.ratio(OURS, peer.who), AT_MOST[job], "x", took)
