"""Messages built of a program's values and encoded, against those whose classes the values are set in."""

from __future__ import annotations

from dataclasses import dataclass
from io import BytesIO
from typing import TYPE_CHECKING

import numpy as np
import pytest

from bench import varied
from bench.loops import contender, found, same
from bench.peers import peers_of
from bench.report import words

if TYPE_CHECKING:
    from collections.abc import Callable

    from bench.varied import Varied

CHAPTER, ANEW, AGAIN = "Building and encoding", "rosetta_jit, a holder anew", "rosetta_jit, a holder used again"
PACKAGES = ("mcap-ros1-support", "protobuf")
JOINT_STATE = """
header = x.header; stamp = header.stamp
stamp.secs, stamp.nsecs, header.frame_id, x.name, x.position, x.velocity, x.effort = m
"""
WRITTEN = {
    "genpy": "b = buffer(); x.serialize(b); read(b.getvalue())",
    "upb": "read(x.SerializeToString())",
}


@dataclass(frozen=True, slots=True)
class Job:
    """What is built: the values of each message, what sets them in a message `x`, and what the peer may be taken of."""

    make: Callable[[], Varied]
    values: Callable[[dict], object]
    body: str
    peer: str
    share: float
    written: bool = True
    arrays: bool = False  # whether ours are given numpy's arrays


def _joint_state(plain):
    stamp, arrays = plain["header"]["stamp"], [plain[name] for name in ("position", "velocity", "effort")]
    return stamp["secs"], stamp["nsecs"], plain["header"]["frame_id"], plain["name"], *arrays


def _orientation(plain):
    return tuple(plain["orientation"].values())


def _texts(plain):
    return plain["texts"]


JOBS = {
    "JointState, 32 joints, of lists": Job(lambda: varied.joint_state(1), _joint_state, JOINT_STATE, "genpy", 0.3),
    "JointState, 32 joints, of arrays": Job(lambda: varied.joint_state(1), _joint_state, JOINT_STATE, "genpy", 0.3, arrays=True),
    "Imu, four fields": Job(lambda: varied.imu(1), _orientation, "q = x.orientation; q.x, q.y, q.z, q.w = m", "genpy", 0.3),
    "protobuf, 1,000 strings": Job(varied.many_texts, _texts, "x.texts.extend(m)", "upb", 1),
    "`extend` of 1,000 strings": Job(varied.many_texts, _texts, "x.texts.extend(m)", "upb", 1, written=False),
}


@pytest.mark.parametrize("name", JOBS)
def test_built_and_encoded(name, effort, compare, record):
    job = JOBS[name]
    made = job.make()
    values = [job.values(each) for each in made.plain]
    ours = [[np.array(each) if _is_array(each) else each for each in value] for value in values] if job.arrays else values
    new, encode = made.subject.decoder().new, made.subject.encoder()
    cleared = "" if job.peer == "genpy" else "x.ClearField('texts')\n"
    end = "read(encode(x))" if job.written else ""
    bodies = {ANEW: f"x = new()\n{job.body}\n{end}", AGAIN: f"{cleared}{job.body}\n{end}"}
    contenders = [
        contender(effort, ANEW, "ours", "bytes, anew", bodies[ANEW], ours, new=new, encode=encode),
        contender(effort, AGAIN, "ours", "bytes, anew", bodies[AGAIN], ours, x=new(), encode=encode),
    ]
    for who, peer in _peers(made, job.peer):
        body = f"x = new()\n{job.body}\n{WRITTEN[job.peer] if job.written else ''}"
        wanted = found(body, values[:3], new=peer, buffer=BytesIO)
        assert same(wanted, found(bodies[ANEW], ours[:3], new=new, encode=encode))
        assert same(wanted, found(bodies[AGAIN], ours[:3], x=new(), encode=encode))
        contenders.append(contender(effort, who, "peer", "bytes, anew", body, values, new=peer, buffer=BytesIO))
    outcome = compare(CHAPTER, name, contenders)
    for who, _ in _peers(made, job.peer):
        for mine in (ANEW, AGAIN):
            detail = f"{words.time(outcome.took(mine).median)} against {words.time(outcome.took(who).median)}"
            what = f"{name}, built{' and encoded' if job.written else ''}, {mine.partition(', ')[2]}"
            record(what, outcome.ratio(mine, who), job.share, f"x {job.peer}", detail)


def _peers(made, name):
    """The peer that has a class of the type: who it is, and the class."""
    found = [peer for peer in peers_of(made.subject, PACKAGES) if name in peer.who][:1]
    return [(peer.who, type(peer.decode(made.messages[0]))) for peer in found]


def _is_array(value):
    return isinstance(value, list) and isinstance(value[0], float)
