"""What an access costs: fields of messages that were decoded, against the same fields of plain objects with slots; and a new message."""

from __future__ import annotations

import numpy as np
import pytest

import rosetta_jit as rj
from bench import plain, varied
from bench.loops import TIMES, contender, found, same
from bench.report import words

CHAPTER, OURS, PLAIN = "Attributes", "rosetta_jit", "objects with slots"
KEPT = 32
"""Messages in turn: as many as the fastest cache holds, so that what is measured is the access."""

MADE = {
    "Quaternion": (varied.quaternion, lambda fields: plain.Quaternion(**fields)),
    "Imu": (lambda: varied.imu(2), plain.imu),
    "PoseArray": (lambda: varied.pose_array(2), plain.pose_array),
}
SCALARS = {
    ".w": ("Quaternion", "m.w"),
    ".angular_velocity.x": ("Imu", "m.angular_velocity.x"),
    ".header.stamp.sec": ("Imu", "m.header.stamp.sec"),
    ".poses[3].position.x": ("PoseArray", "m.poses[3].position.x"),
}
POSES = {
    "`len(x)`": ("read(len(m))", 1),
    "`x[3]`": ("read(m[3])", 1),
    "`x[-1]`": ("read(m[-1])", 1),
    "iteration, each": ("for p in m:\n    pass", varied.POSES),
    "iteration, a scalar of each": ("for p in m:\n    read(p.position.x)", varied.POSES),
}
EMPTY = {
    "Quaternion": ("geometry_msgs/msg/Quaternion", plain.Quaternion),
    "Imu": ("sensor_msgs/msg/Imu", plain.Imu),
    "JointState": ("sensor_msgs/msg/JointState", plain.JointState),
}


@pytest.fixture
def against_plain(effort, compare, record):
    """Measures one body over our holders and over plain objects, which read the same, and records the row."""

    def measure(what, body, ours, others, at_most, *, times=TIMES, each=1):
        mine, theirs = (found(body, messages[:3]) for messages in (ours, others))
        assert len(mine) == len(theirs)
        assert same(mine, theirs) or not isinstance(mine[0], int | float)
        outcome = compare(
            CHAPTER,
            what,
            [
                contender(effort, OURS, "ours", "values made when they are read; stored in lanes", body, ours, times=times, each=each),
                contender(effort, PLAIN, "limit", "values made before; references stored", body, others, times=times, each=each),
            ],
        )
        record(what, outcome.ratio(OURS, PLAIN), at_most, "x objects with slots", detail(outcome, PLAIN))

    return measure


def detail(outcome, other):
    return f"{words.time(outcome.took(OURS).median)} against {words.time(outcome.took(other).median)}"


def both(type_):
    """Holders of a type, and plain objects of the same values."""
    make, of_plain = MADE[type_]
    made = make()
    return made.holders(KEPT), [of_plain(each) for each in made.plain[:KEPT]]


@pytest.mark.parametrize("path", SCALARS)
def test_read(path, against_plain):
    type_, expression = SCALARS[path]
    against_plain(f"`{path}`, read", f"read({expression})", *both(type_), 3)


@pytest.mark.parametrize("path", SCALARS)
def test_set(path, against_plain):
    type_, expression = SCALARS[path]
    value = 7 if path.endswith("sec") else 7.5
    ours, others = both(type_)
    against_plain(f"`{path}`, set", f"{expression} = {value}", ours, others, 4)
    assert found(f"read({expression})", ours) == [value] * len(ours)


@pytest.mark.parametrize("what", POSES)
def test_nested_messages(what, against_plain):
    body, each = POSES[what]
    ours, others = both("PoseArray")
    times = TIMES if each == 1 else 1
    against_plain(f"1,000 poses, {what}", body, [m.poses for m in ours], [m.poses for m in others], 4, times=times, each=each)


def test_read_beside_a_built_in(effort, compare, record):
    """The same lookup of an attribute, and the same new float, where C has written the class."""
    ours, numbers, whose = both("Quaternion")[0], [complex(each, 1.0) for each in range(KEPT)], "`complex.real`"
    contenders = [
        contender(effort, OURS, "ours", "a float", "m.w", ours, times=TIMES),
        contender(effort, whose, "limit", "a float", "m.real", numbers, times=TIMES),
    ]
    outcome = compare(CHAPTER, "`.w`, read, against a built-in class", contenders)
    record("`.w`, read, against a built-in class", outcome.ratio(OURS, whose), None, f"x {whose}", detail(outcome, whose))


def test_text(effort, compare, record):
    made = varied.string()
    ours, raw = made.holders(KEPT), [each["data"].encode() for each in made.plain[:KEPT]]
    assert found("read(m.data)", ours) == [str(each, "utf-8") for each in raw]
    making = "str(raw, 'utf-8')"
    outcome = compare(
        CHAPTER,
        "a text, read",
        [
            contender(effort, OURS, "ours", "a str", "m.data", ours, times=TIMES),
            contender(effort, making, "limit", "a str", "str(m, 'utf-8')", raw, times=TIMES),
        ],
    )
    record("a text, read", outcome.ratio(OURS, making), 3, f"x `{making}`", detail(outcome, making))


def test_text_set(effort, compare, record):
    made = varied.string()
    ours, texts = made.holders(KEPT), [each["data"] for each in made.plain]
    making, other = ".encode()", texts[KEPT]
    contenders = [
        contender(effort, OURS, "ours", "UTF-8 in lanes", "m.data = text", ours, times=TIMES, text=other),
        contender(effort, making, "limit", "bytes", "m.encode()", texts[:KEPT], times=TIMES),
    ]
    outcome = compare(CHAPTER, "a text, set", contenders)
    assert found("read(m.data)", ours) == [other] * KEPT
    record("a text, set", outcome.ratio(OURS, making), None, f"x `{making}`", detail(outcome, making))


@pytest.mark.parametrize("how", ["read", "set"])
def test_array(how, effort, compare, record):
    ours, numbers, slicing = varied.imu(2).holders(KEPT), np.arange(9.0), "ndarray[a:b]" if how == "read" else "ndarray[a:b] ="
    field, part, given = ("m.orientation_covariance", "m[4:13]", {"numbers": numbers})
    arrays = [np.arange(37.0) for _ in ours]
    bodies = (field, part) if how == "read" else (f"{field} = numbers", f"{part} = numbers")
    contenders = [
        contender(effort, OURS, "ours", "an array", bodies[0], ours, times=TIMES, **given),
        contender(effort, slicing, "limit", "an array", bodies[1], arrays, times=TIMES, **given),
    ]
    outcome = compare(CHAPTER, f"an array of nine numbers, {how}", contenders)
    assert how == "read" or same(found(f"read({field})", ours), [numbers] * KEPT)
    at_most = 2 if how == "read" else None
    record(f"an array of nine numbers, {how}", outcome.ratio(OURS, slicing), at_most, f"x `{slicing}`", detail(outcome, slicing))


@pytest.mark.parametrize("kept", [1, 1000])
@pytest.mark.parametrize("name", EMPTY)
def test_made_anew(name, kept, effort, compare, record):
    type_, other = EMPTY[name]
    decoder = rj.Decoder.of(type_, encoding="cdr")
    bodies = ("new()", "new()") if kept == 1 else (f"[new() for _ in range({kept})]",) * 2
    what = f"a new {name}" if kept == 1 else f"{kept:,} new {name}, kept in a list, each"
    messages = range(KEPT if kept == 1 else 1)
    contenders = [
        contender(effort, OURS, "ours", "a holder", bodies[0], messages, each=kept, new=decoder.new),
        contender(effort, "its class", "ours", "a holder", bodies[0], messages, each=kept, new=decoder.holder_type),
        contender(effort, "a dataclass with slots", "limit", "an object", bodies[1], messages, each=kept, new=other),
    ]
    outcome = compare(CHAPTER, what, contenders)
    record(what, outcome.ratio(OURS, "a dataclass with slots"), 3, "x a dataclass", detail(outcome, "a dataclass with slots"))
    took = f"{words.time(outcome.took('its class').median)} against {words.time(outcome.took('a dataclass with slots').median)}"
    record(f"{what}, by its class", outcome.ratio("its class", "a dataclass with slots"), 3, "x a dataclass", took)
