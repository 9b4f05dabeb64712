"""What holders can do as their frameworks' classes do, and as dataclasses do: methods that serialise, plain values, copies, comparison."""

from __future__ import annotations

import copy
import pickle
from dataclasses import asdict, dataclass
from io import BytesIO
from typing import TYPE_CHECKING

import pytest

from bench import plain, varied
from bench.loops import contender, found, same
from bench.peers import peers_of
from bench.report import words

if TYPE_CHECKING:
    from collections.abc import Callable

    from bench.varied import Varied

METHODS, VALUES, CALLS = "Methods that serialise", "Plain values and copies", "Ways to call a decoder"
OBJECTS = "Objects of the peers' own classes"
OURS, PLAIN = "rosetta_jit", "a dataclass with slots"
PACKAGES = ("mcap-ros1-support", "lcm", "protobuf")
KEPT = 32
WRITTEN = "b.seek(0); {}; read(b.getvalue())"


@dataclass(frozen=True, slots=True)
class Method:
    """A method as `body`, and the program that does the same as `direct`.

    `m` is a message or its bytes, ``x`` a message that is used again, ``made`` the class.
    """

    make: Callable[[], Varied]
    body: str
    program: str
    direct: str
    peer: str
    reads: bool = True  # whether `m` is bytes


def _imu():
    return varied.imu(1)


SERIALISING = {
    "`SerializeToString`": Method(varied.joints, "read(m.SerializeToString())", "Encoder", "read(encode(m))", "upb", reads=False),
    "`ParseFromString`": Method(varied.joints, "x.ParseFromString(m)", "Decoder", "decode(m)", "upb"),
    "`FromString`": Method(varied.joints, "made.FromString(m)", "Decoder", "into(m, new())", "upb"),
    "genpy's `serialize`": Method(_imu, "b.seek(0); m.serialize(b)", "Encoder", "b.seek(0); b.write(encode(m))", "genpy", reads=False),
    "genpy's `deserialize`": Method(_imu, "x.deserialize(m)", "Decoder", "decode(m)", "genpy"),
    "LCM's `encode`": Method(varied.lcm_doubles, "read(m.encode())", "Encoder", "read(encode(m))", "lcm", reads=False),
    "LCM's `decode`": Method(varied.lcm_doubles, "made.decode(m)", "Decoder", "into(m, new())", "lcm"),
}
BOTH = {
    "Imu": (lambda: varied.imu(2), plain.imu),
    "JointState, 32 joints": (lambda: varied.joint_state(2), plain.joint_state),
}
DOES = {
    "`to_dict`": ("read(m.to_dict())", "read(asdict(m))"),
    "`from_dict`": ("make(m)", "make(m)"),
    "`==`": ("read(m[0] == m[1])", "read(m[0] == m[1])"),
    "`copy`": ("copy(m)", "deepcopy(m)"),
    "`pickle`, there and back": ("loads(dumps(m, 5))", "loads(dumps(m, 5))"),
}
GIVEN = {"asdict": asdict, "copy": copy.copy, "deepcopy": copy.deepcopy, "loads": pickle.loads, "dumps": pickle.dumps}


@pytest.mark.parametrize("name", SERIALISING)
def test_serialising(name, effort, compare, record):
    job = SERIALISING[name]
    made = job.make()
    decode, encode = made.subject.decoder(), made.subject.encoder()
    given = {"b": BytesIO(), "encode": encode, "decode": decode, "into": decode.into, "new": decode.new, "made": decode.holder_type}
    messages = made.messages if job.reads else made.holders(KEPT)
    direct, makes = f"{job.program}, the same", "a message" if job.reads else "bytes, anew"
    contenders = [
        contender(effort, OURS, "ours", makes, job.body, messages, x=decode.new(), **given),
        contender(effort, direct, "limit", makes, job.direct, messages, **given),
    ]
    for who, class_, its in _peers(made, job):
        assert job.reads or same(found(job.body, its, b=BytesIO()), found(job.body, messages, b=BytesIO()))
        contenders.append(contender(effort, who, "peer", makes, job.body, its, x=class_(), made=class_, b=BytesIO()))
    outcome = compare(METHODS, name, contenders)
    record(name, outcome.ratio(OURS, direct), 2, f"x {job.program}", _detail(outcome, direct))
    for who, _, _ in _peers(made, job):
        record(f"{name}, against {job.peer}", outcome.ratio(OURS, who), 1, f"x {job.peer}", _detail(outcome, who))


# Messages of protobuf's package are handed over as bytes, which it alone reads and writes quickly: its own price is a part of ours.
OF_PEERS = {
    "protobuf, 24 doubles": (varied.joints, "upb"),
    "ROS 1, Imu": (_imu, "rosbags"),
    "ROS 2, JointState, 32 joints": (lambda: varied.joint_state(2), "rosbags"),
    "ROS 1, Imu, genpy's": (_imu, "genpy"),
    "LCM, 24 doubles": (varied.lcm_doubles, "lcm"),
}


@pytest.mark.parametrize("what", ["encoded", "decoded"])
@pytest.mark.parametrize("name", OF_PEERS)
def test_objects_of_peers(name, what, effort, compare, record):
    """Their objects to bytes and back, by our programs and by their own functions."""
    make, who = OF_PEERS[name]
    made = make()
    for peer in [each for each in peers_of(made.subject, (*PACKAGES, "rosbags")) if who in each.who][:1]:
        values = [peer.decode(each) for each in made.messages[:KEPT]]
        decode, encode = made.subject.decoder(), made.subject.encoder()
        bytes_of = peer.encode or type(values[0]).SerializeToString
        assert [encode(each) for each in values] == list(made.messages[:KEPT])
        given = {"encode": encode, "to": decode.to, "made": type(values[0]), "theirs": bytes_of, "parse": peer.decode}
        jobs = {"encoded": ("encode(m)", "theirs(m)", values), "decoded": ("to(m, made)", "parse(m)", made.messages)}
        ours, its, messages = jobs[what]
        contenders = [
            contender(effort, OURS, "ours", "the peer's object", ours, messages, **given),
            contender(effort, peer.who, "peer", "the peer's object", its, messages, **given),
        ]
        outcome = compare(OBJECTS, f"{name}, {what}", contenders)
        record(f"{name}, {what}", outcome.ratio(OURS, peer.who), 1, f"x {who}", _detail(outcome, peer.who))


def _peers(made, job):
    """The peer that has a class of the type: who it is, its class, and its messages or their bytes."""
    for peer in [each for each in peers_of(made.subject, PACKAGES) if job.peer in each.who][:1]:
        messages = made.messages if job.reads else [peer.decode(each) for each in made.messages[:KEPT]]
        yield peer.who, type(peer.decode(made.messages[0])), messages


def _detail(outcome, other):
    return f"{words.time(outcome.took(OURS).median)} against {words.time(outcome.took(other).median)}"


@pytest.mark.parametrize("what", DOES)
@pytest.mark.parametrize("name", BOTH)
def test_as_a_dataclass(name, what, effort, compare, record):
    make, of_plain = BOTH[name]
    made = make()
    values, other = _both(made, of_plain, what)
    mine, its = DOES[what]
    from_dict = made.subject.decoder().holder_type.from_dict
    assert found(mine, values, make=from_dict, **GIVEN) == found(its, other, make=of_plain, **GIVEN)
    contenders = [
        contender(effort, OURS, "ours", "of a holder", mine, values, make=from_dict, **GIVEN),
        contender(effort, PLAIN, "limit", "of an object", its, other, make=of_plain, **GIVEN),
    ]
    outcome = compare(VALUES, f"{name}, {what}", contenders)
    record(f"{name}, {what}", outcome.ratio(OURS, PLAIN), 2, "x a dataclass", _detail(outcome, PLAIN))


def _both(made, of_plain, what):
    """What the bodies are given: plain values, messages, or pairs of equal messages that share nothing, numbers included."""
    values, holders, again = made.plain[:KEPT], made.holders(KEPT), made.holders(KEPT)
    if what == "`from_dict`":
        return values, values
    objects = [of_plain(each) for each in values]
    if what == "`==`":
        return list(zip(holders, again, strict=True)), list(zip(objects, (of_plain(each.to_dict()) for each in again), strict=True))
    return holders, objects


def test_ways_to_call(effort, compare, record):
    made = varied.imu(1)
    decode = made.subject.decoder()
    given = {"decode": decode, "call": decode.builtin, "x": decode.new()}
    bodies = {
        "`decode.into(message, holder)`": "decode.into(m, x)",
        "`decode.builtin`, bound before": "call(m)",
        "`decode.builtin`, asked for": "decode.builtin",
    }
    contenders = [
        contender(effort, OURS, "ours", "a holder, used again", "decode(m)", made.messages, **given),
        *(contender(effort, who, "ours", "", body, made.messages, **given) for who, body in bodies.items()),
    ]
    outcome = compare(CALLS, "Imu", contenders)
    for who in bodies:
        record(f"Imu, {who}", outcome.ratio(who, OURS), None, "x `decode(message)`", words.time(outcome.took(who).median))
