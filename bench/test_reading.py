"""Messages decoded and read, as a program does it that wants the values: a few, whole arrays, and every element one by one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import pytest

from bench import varied
from bench.loops import contender, found, same
from bench.messages import anew
from bench.peers import peers_of
from bench.report import words

if TYPE_CHECKING:
    from collections.abc import Callable

    from bench.varied import Varied

CHAPTER, OURS, COLUMNS, REPEATED = "Decoding and reading", "rosetta_jit", "rosetta_jit, columns", "one message repeated"
PACKAGES = ("mcap-ros1-support", "rosbags", "lcm", "protobuf")

STAMP = "h = m.header.stamp; read(h.secs); read(h.nsecs)"
VECTOR = "read(v.x); read(v.y); read(v.z)"
TURN = "q = {0}; read(q.x); read(q.y); read(q.z); read(q.w)"
FIVE = f"{STAMP}; v = m.angular_velocity; {VECTOR}"
ELEVEN = f"read(m.header.stamp.secs); {TURN.format('m.orientation')}; v = m.angular_velocity; {VECTOR}; v = m.linear_acceleration; {VECTOR}"
POSES = f"""
for p in m.poses:
    v = p.position; {VECTOR}; {TURN.format("p.orientation")}
"""
TRANSFORMS = f"""
for t in m.transforms:
    h = t.header; read(h.seq); read(h.stamp.secs); read(h.stamp.nsecs); read(h.frame_id); read(t.child_frame_id)
    v = t.transform.translation; {VECTOR}; {TURN.format("t.transform.rotation")}
"""
DIAGNOSTICS = """
for s in m.status:
    read(s.level); read(s.name); read(s.message); read(s.hardware_id)
    for v in s.values:
        read(v.key); read(v.value)
"""


@dataclass(frozen=True, slots=True)
class Job:
    """What is read of which messages, and what the fastest of some peers may take of it."""

    make: Callable[[], Varied]
    body: str
    share: float
    against: str = ""  # what the peers' names contain; all of them if empty
    columns: tuple[str, ...] = ()


def _each(field):
    return f"for t in m.{field}:\n    read(t)"


def _columns(prefix, **parts):
    return tuple(f"{prefix}.{part}.{name}" for part, names in parts.items() for name in names)


JOBS = {
    "Imu, five values": Job(lambda: varied.imu(1), FIVE, 0.1),
    "Imu, eleven values": Job(lambda: varied.imu(1), ELEVEN, 0.1),
    "Imu of ROS 2, five values": Job(lambda: varied.imu(2), FIVE.replace("secs", "sec").replace("nsec)", "nanosec)"), 0.1),
    "JointState, 32 joints, its arrays": Job(lambda: varied.joint_state(1), "read(m.position); read(m.velocity); read(m.effort)", 0.1),
    "LCM, 24 doubles, its array": Job(varied.lcm_doubles, "read(m.timestamp); read(m.values)", 0.1),
    "PoseArray 1000, every element": Job(
        lambda: varied.pose_array(1), POSES, 0.4, "genpy", _columns("poses", position="xyz", orientation="xyzw")
    ),
    "TFMessage 50, every element": Job(
        varied.transforms,
        TRANSFORMS,
        0.4,
        "genpy",
        (
            *_columns("transforms", header=("seq", "stamp.secs", "stamp.nsecs", "frame_id")),
            "transforms.child_frame_id",
            *_columns("transforms.transform", translation="xyz", rotation="xyzw"),
        ),
    ),
    "DiagnosticArray, 20 statuses, every element": Job(
        varied.diagnostics,
        DIAGNOSTICS,
        0.4,
        "genpy",
        tuple(f"status.{name}" for name in ("level", "name", "message", "hardware_id", "values.key", "values.value")),
    ),
    "JointState, 1,000 names, each": Job(varied.many_names, _each("name"), 0.4, "genpy", ("name",)),
    "protobuf, 200 fields, each": Job(varied.many_fields, "; ".join(f"read(m.f{each})" for each in range(varied.FIELDS)), 1, "upb"),
    "protobuf, 1,000 texts, each": Job(varied.many_texts, _each("texts"), 1, "upb"),
}
DIFFERENT = {
    "Imu": lambda: varied.imu(1),
    "JointState, 32 joints": lambda: varied.joint_state(1),
    "protobuf, 200 fields": varied.many_fields,
    "protobuf, 1,000 optional fields": varied.very_many_fields,
}


@pytest.mark.parametrize("name", JOBS)
def test_decoded_and_read(name, effort, compare, record):
    job = JOBS[name]
    made = job.make()
    body, peers = f"m = decode(m)\n{job.body}", {peer.who: peer for peer in peers_of(made.subject, PACKAGES) if _gives_a_message(peer)}
    decode, wanted = made.subject.decoder(), found(body, made.messages[:3], decode=made.subject.decoder())
    contenders = [contender(effort, OURS, "ours", "a holder, used again", body, made.messages, decode=decode)]
    if job.columns:
        contenders.append(by_columns(effort, made, job.columns, found(body, made.messages[:1], decode=decode)[-1]))
    for who, peer in peers.items():
        its = _in_its_words(who, made, body)
        assert same(wanted, found(its, made.messages[:3], decode=peer.decode)), who
        contenders.append(contender(effort, who, "peer", peer.makes, its, made.messages, decode=peer.decode))
    outcome = compare(CHAPTER, name, contenders)
    rivals = [who for who in peers if job.against in who]
    if rivals:
        fastest = outcome.fastest(rivals)
        unit, against = ("x upb", "") if job.against == "upb" else ("x genpy", "") if job.against else ("of the fastest peer", fastest)
        detail = f"{words.time(outcome.took(OURS).median)}; {fastest}: {words.time(outcome.took(fastest).median)}"
        record(f"{name}, decoded and read", outcome.ratio(OURS, fastest), job.share, unit, detail, against)
        if job.columns:
            took = words.time(outcome.took(COLUMNS).median)
            record(
                f"{name}, as columns",
                outcome.ratio(COLUMNS, fastest),
                0.05,
                unit,
                f"{took}; `many` of {len(made.messages)}, its rows again",
            )


def by_columns(effort, made, names, last_read):
    """The same values as columns of a batch: all messages in one call, then each column asked for."""
    decode, data = made.subject.decoder(), np.frombuffer(b"".join(made.messages), np.uint8)
    offsets = np.cumsum([0, *map(len, made.messages)])
    batch = decode.many(data, offsets)
    body = "b = many(*m, into=batch)\n" + "\n".join(f"b.column('{name}')" for name in names)
    each = len(made.messages)
    assert last(batch.column(names[-1]).to_list()[0]) == last_read
    return contender(
        effort, COLUMNS, "ours", "arrays of all messages, used again", body, [(data, offsets)], each=each, many=decode.many, batch=batch
    )


def last(value):
    """The last element of the last list in lists."""
    return last(value[-1]) if isinstance(value, list) else value


def _gives_a_message(peer):
    return "ParseFromString" not in peer.who


def _in_its_words(who, made, body):
    """The body as a peer names its fields: rosbags calls times as ROS 2 does."""
    return body.replace(".secs", ".sec").replace(".nsecs", ".nanosec") if who == "rosbags" and made.subject.encoding == "ros1" else body


@pytest.mark.parametrize("name", DIFFERENT)
def test_different_messages(name, effort, compare, record):
    """What a decode takes when each message is another one, against one message over and over, each time in another place."""
    made = DIFFERENT[name]()
    decode, copies = made.subject.decoder(), [anew(made.messages[0]) for _ in made.messages]
    peers = peers_of(made.subject, PACKAGES)
    contenders = [
        contender(effort, OURS, "ours", "a holder, used again", "decode(m)", made.messages, decode=decode),
        contender(effort, REPEATED, "limit", "a holder, used again", "decode(m)", copies, decode=decode),
        *(contender(effort, peer.who, "peer", peer.makes, "decode(m)", made.messages, decode=peer.decode) for peer in peers),
    ]
    outcome = compare(CHAPTER, f"{name}, each message another one", contenders)
    took = words.time(outcome.took(OURS).median)
    record(f"{name}, decode, each message another one", outcome.ratio(OURS, REPEATED), None, "x one message repeated", took)
    if peers:
        fastest = outcome.fastest([peer.who for peer in peers])
        detail = f"{fastest}: {words.time(outcome.took(fastest).median)}"
        record(f"{name}, decode, against the fastest Python peer", outcome.ratio(OURS, fastest), None, "of it", detail)
