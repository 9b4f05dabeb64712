"""Times and durations of ROS 1 behave as genpy's do: the same expressions give the same values, or the same errors."""

from __future__ import annotations

import operator
from copy import copy, deepcopy

import pytest

import rosetta_jit as rj
from tests.frameworks.ros.ros_files import debian

SCHEMA = {"probe/Both.msg": "time moment\nduration span\nduration[] spans\n"}
BOTH = rj.Decoder.of("probe/Both", schema=SCHEMA, framework="ros1", backend="interpreter").holder_type
VALUES = [(0, 0), (1, 500_000_000), (7, 999_999_999), (3, 1_250_000_000), (2.5, 0), (300_000_000, 5)]
NEGATIVE = [(-1, 0), (-2, 250_000_000), (5, -1), (-0.75, 0)]
OPERATORS = [
    *(getattr(operator, name) for name in ("add", "sub", "mul", "truediv", "floordiv", "mod", "lt", "le", "gt", "ge", "eq", "ne")),
    divmod,
]
ALONE = [operator.neg, abs, bool, str, repr, hash, *(operator.methodcaller(each) for each in ("to_sec", "to_nsec", "is_zero"))]


@pytest.fixture(scope="module")
def theirs():
    debian("genmsg", "names")  # genpy's package needs it
    return debian("genpy", "rostime")


def classes(message):
    return {"time": type(message.moment).__mro__[2], "duration": type(message.span).__mro__[2]}


OURS = classes(BOTH())


def plain(value):
    """What can be compared of a result: its kind and value, or of an error its type."""
    if isinstance(value, tuple):
        return tuple(map(plain, value))
    if hasattr(value, "nsecs"):
        return hasattr(value, "to_time"), value.secs, value.nsecs
    return value


def result(function, *values):
    try:
        return plain(function(*values))
    except (TypeError, ValueError, ZeroDivisionError, AttributeError) as error:
        return type(error)


def pairs(theirs):
    """The same values of ours and of theirs."""
    kinds = {"time": theirs.Time, "duration": theirs.Duration}
    for kind, values in (("time", VALUES), ("duration", VALUES + NEGATIVE)):
        for value in values:
            yield OURS[kind](*value), kinds[kind](*value)


NUMBERS = [2, 0, -3, 0.5, "one"]


def test_two_of_them(theirs):
    every = list(pairs(theirs))
    for function in OPERATORS:
        for ours, its in every:
            for other, its_other in [*every, *((number, number) for number in NUMBERS)]:
                assert result(function, ours, other) == result(function, its, its_other), (function, its, its_other)


def test_numbers_before_durations(theirs):
    for ours, its in pairs(theirs):
        for number in NUMBERS:
            assert result(operator.mul, number, ours) == result(operator.mul, number, its)


def test_with_theirs(theirs):
    moment, span = OURS["time"](5, 1), OURS["duration"](2, 3)
    assert plain(moment + theirs.Duration(1, 2)) == (True, 6, 3)
    assert plain(moment - theirs.Time(1, 2)) == (False, 3, 999_999_999)
    assert span > theirs.Duration(1, 0)


def test_one_of_them(theirs):
    for ours, its in pairs(theirs):
        for function in ALONE:
            assert result(function, ours) == result(function, its)


@pytest.mark.parametrize("kind", ["time", "duration"])
@pytest.mark.parametrize("seconds", [0, 1.25, 1e9, -0.5, 3])
def test_from_sec(kind, seconds, theirs):
    its = {"time": theirs.Time, "duration": theirs.Duration}[kind]
    assert result(OURS[kind].from_sec, seconds) == result(its.from_sec, seconds)


def test_beyond_32_bits():
    """Where genpy refuses to serialise, ours is not even made."""
    with pytest.raises(ValueError, match="4000000000"):
        OURS["duration"](2_000_000_000) * 2


def test_a_float_has_no_nanoseconds():
    with pytest.raises(ValueError, match="float"):
        OURS["time"](1.5, 2)


def test_in_messages():
    message = BOTH()
    message.moment = OURS["time"](10, 0)
    message.span = OURS["duration"].from_sec(1.5)
    message.moment += message.span
    message.spans = [message.moment - OURS["time"](1), message.span * 2]
    again = BOTH().deserialize(rj.Encoder.of("probe/Both", schema=SCHEMA, framework="ros1", backend="interpreter")(message))
    assert plain(again.moment) == (True, 11, 500_000_000)
    assert [each.to_sec() for each in again.spans] == [10.5, 3.0]
    assert min(list(again.spans)).to_sec() == 3.0


def test_setting():
    span = OURS["duration"]()
    span.set(3, 0)
    span.secs, span.nsecs = 3, 2_000_000_001
    span.canon()
    assert plain(span) == (False, 5, 1)
    assert plain(span.set_nsec(1_500_000_000)) == (False, 1, 500_000_000)
    assert (copy(span), deepcopy(span)) == (span, span)
    assert {span: 1}[OURS["duration"](1, 500_000_000)] == 1
