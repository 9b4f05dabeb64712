"""Messages of several topics of a log in one holder, by a mapping of several wires."""

from __future__ import annotations

import pytest

import rosetta_jit as rj
from tests.logs.made import POINT, TEXT, expected, write_bag, write_mcap

COUNT = 20
TOPICS = {"point": "/a", "text": "/b"}
RULES = """unpack-rules:
  .x = .point.x
  .name = .point.name
  .data = .text.data
"""


def files(point, text):
    """The types of a framework, and a mapping that joins them."""
    mapping = f"""import "{point}.msg"
import "{text}.msg"
import "both.proto"
data-holder: Both
wire-schema point: {point}
wire-schema text: {text}
{RULES}"""
    declared = 'syntax = "proto3"; message Both { double x = 1; string name = 2; string data = 3; }'
    return {f"{point}.msg": POINT, f"{text}.msg": TEXT, "both.proto": declared, "both.mapping": mapping}


LOGS = {"bag": (write_bag, files("t/Point", "t/Text")), "mcap": (write_mcap, files("t/msg/Point", "t/msg/Text"))}


def model(on=None):
    """What is known behind each message, in plain Python."""
    found, known, times = [], {}, {}
    for time, topic, value in expected(COUNT):
        wire = {"/a": "point", "/b": "text"}[topic]
        known |= {"x": value[0], "name": value[1]} if wire == "point" else {"data": value}
        times[wire] = time
        if len(times) == len(TOPICS) and on in (None, wire):
            found.append((time, wire, dict(known), {each: time - last for each, last in times.items()}))
    return found


@pytest.fixture(scope="module", params=LOGS)
def log(request, tmp_path_factory):
    write, schema = LOGS[request.param]
    path = write(tmp_path_factory.mktemp("joined") / f"both.{request.param}", COUNT)
    with rj.open(path) as found:
        yield found, schema


@pytest.mark.parametrize("on", [None, "text"])
def test_the_holder_behind_each_message(log, on):
    opened, schema = log
    joined = opened.joined("both.mapping", TOPICS, on=on, schema=schema, backend="python")
    assert [(time, wire, holder.to_dict(), ages) for time, wire, holder, ages in joined] == model(on)
    assert model(on)


def test_what_cannot_be_joined_is_said(log):
    opened, schema = log
    for topics, on, text in (
        ({"point": "/a"}, None, "which topic has the messages of wire `text`"),
        ({**TOPICS, "text": "/c"}, None, "/c"),
        ({**TOPICS, "more": "/a"}, None, "no wire `more`"),
        (TOPICS, "test", "no wire `test`"),
    ):
        with pytest.raises(rj.ReportError, match=text):
            opened.joined("both.mapping", topics, on=on, schema=schema, backend="python")


def test_messages_that_are_refused(log):
    opened, schema = log
    refusing = {**schema, "both.mapping": schema["both.mapping"] + '  reject "small" when .point.x < 3.0\n'}
    with pytest.raises(rj.DecodeError, match=r"small.*a message of /a, logged"):
        list(opened.joined("both.mapping", TOPICS, schema=refusing, backend="python"))
    found = list(opened.joined("both.mapping", TOPICS, schema=refusing, backend="python", on_error="skip", on="text"))
    assert 0 < len(found) < len(model("text"))
    assert all(holder.x >= 3.0 for _, _, holder, _ in found)
