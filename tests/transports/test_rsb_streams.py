"""The bus against captured connections of rsb-python and rsb-cpp: the same events, the same bytes, and what ends them ends nobody here."""

from __future__ import annotations

import json
import struct
from contextlib import suppress
from itertools import chain
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rosetta_jit.transports.feeding import Feed, ProtocolError
from rosetta_jit.transports.rsb.bus import HANDSHAKE, frames
from rosetta_jit.transports.rsb.notification import Event, EventId, NoEventError, decode, encode, scope_in
from rosetta_jit.transports.rsb.scopes import above, normal

LIVE = json.loads((Path(__file__).resolve().parent.parent / "vectors" / "rsb" / "live.json").read_text())
CAPTURES = {each["name"]: each for each in LIVE["captures"]}
PROBES = {each["name"]: each for each in LIVE["probes"]}


def notifications(stream, *, is_client, pieces=None):
    found, ready = [], []
    feed = Feed(frames(lambda data: found.append(bytes(data)), 1 << 20, is_client=is_client, ready=lambda: ready.append(1)))
    for each in pieces or [stream]:
        feed.feed(each)
    assert ready or len(stream) < 4
    return found, feed


def both_ways(capture):
    """The notifications of each direction: those of the server follow its handshake."""
    return {way: notifications(bytes.fromhex(capture[way]), is_client=way == "s2c")[0] for way in ("c2s", "s2c") if capture[way]}


@pytest.mark.parametrize("name", CAPTURES)
def test_events_are_read_as_they_were_sent(name):
    seen = 0
    found = {way: list(map(decode, map(memoryview, each))) for way, each in both_ways(CAPTURES[name]).items()}
    for told in CAPTURES[name]["events"]:
        if "participant_id" not in told:
            continue
        of_all = [each for way in found.values() for each in way]
        event = next((each for each in of_all if str(each.id) == f"{told['participant_id'].lower()}:{told['sequence_number']}"), None)
        if event is None:
            assert "relay" in name  # what only the other connection carried
            continue
        seen += 1
        assert (event.scope, event.schema, event.method) == (told["scope"], told.get("wire_schema", event.schema), told["method"] or "")
        assert event.id.uuid == told["event_uuid"]
        assert (event.create_time, event.send_time) == (told["create_time_us"], told["send_time_us"])
        assert dict(event.user_times) == told["user_times_us"]
        assert {key: text for key, text in event.user_infos.items() if key != "rsb.wire-schema"} == {
            key: text for key, text in told["user_infos"].items() if key != "rsb.wire-schema"
        }
        assert [str(each) for each in event.causes] == [f"{participant}:{number}" for participant, number in told["causes"]]
        if "text" in told:
            assert str(event.data, "utf-8") == told["text"]
    assert seen


@pytest.mark.parametrize("name", CAPTURES)
def test_events_are_written_as_they_were_sent(name):
    """Byte by byte; but for an empty method, which rsb-python writes and rsb-cpp does not."""
    for each in chain.from_iterable(both_ways(CAPTURES[name]).values()):
        again = b"".join(map(bytes, encode(decode(memoryview(each)))))
        assert again == each.replace(b"r\0z", b"z")


@pytest.mark.parametrize(
    ("name", "way"), [("metadata_c2s", "c2s"), ("rpc_cpp_server_as_tcp_server", "s2c"), ("relay_by_cpp_server.conn1", "s2c")]
)
def test_a_stream_may_be_cut_at_every_byte(name, way):
    stream = bytes.fromhex(CAPTURES[name][way])
    whole, _ = notifications(stream, is_client=way == "s2c")
    assert whole
    ends = set()
    for at in range(len(stream) + 1):
        found, feed = notifications(stream, is_client=way == "s2c", pieces=[stream[:at], stream[at:]])
        assert found == whole
        found, feed = notifications(stream[:at], is_client=way == "s2c") if at > 3 else ([], None)
        if feed is not None and feed.is_between:
            ends.add(at)
    assert len(ends) == len(whole) + 1 - (way == "c2s")


def test_another_handshake_is_refused():
    for first in (b"\1\0\0\0", b"HTTP", b"YA\0\0"):
        with pytest.raises(ProtocolError, match="handshake"):
            notifications(first, is_client=True)


@pytest.mark.parametrize("name", PROBES)
def test_what_ends_other_peers_ends_nobody_here(name):
    """Bad events are dropped; the event behind them arrives. Only a frame of length 0 ends its connection: it asks for that."""
    probe = PROBES[name]
    found, feed = notifications(bytes.fromhex("".join(probe["sent_hex"]) + probe["then_sent_hex"]), is_client=False)
    texts = []
    for each in found:
        with suppress(NoEventError):
            event = decode(memoryview(each))
            if normal(event.scope):
                texts.append(bytes(event.data))
    assert feed.done if name == "frame of size 0" else texts[-1] == b"AFTER"


def test_scopes():
    assert [normal(each) for each in ("/", "/a", "/a/", "/a-1/B_c/", "a", "", "//", "/a//", "/ä/", "/a b")] == [
        "/", "/a/", "/a/", "/a-1/B_c/", None, None, None, None, None, None,
    ]  # fmt: skip
    assert above("/a/b/") == ["/a/b/", "/a/", "/"]
    assert above("/") == ["/"]


@given(st.data())
def test_no_bytes_break_a_reader(data):
    """An event of a captured stream, some of its bytes changed or cut off: an event, or one error, and nothing else."""
    name = data.draw(st.sampled_from(["metadata_c2s", "rpc_c2s_calls", "cpp_publish_c2s"]))
    message = bytearray(data.draw(st.sampled_from(both_ways(CAPTURES[name])["c2s"])))
    for _ in range(data.draw(st.integers(0, 3))):
        message[data.draw(st.integers(0, len(message) - 1))] = data.draw(st.integers(0, 255))
    cut = memoryview(bytes(message[: data.draw(st.integers(0, len(message)))]))
    for read in (decode, scope_in):
        with suppress(NoEventError):
            read(cut)


WORDS = st.text(st.characters(codec="ascii", exclude_characters="\0"), max_size=20)
IDS = st.builds(EventId, st.binary(min_size=16, max_size=16), st.integers(0, 2**32 - 1))
TIMES = st.integers(-(2**63), 2**63 - 1) | st.integers(1 << 48, 1 << 57)


@given(
    st.builds(
        Event,
        IDS,
        st.just("/a/b/"),
        WORDS,
        st.binary(max_size=300),
        TIMES,
        TIMES,
        WORDS,
        st.lists(IDS, max_size=3),
        st.dictionaries(WORDS, WORDS, max_size=3),
        st.dictionaries(WORDS, st.integers(0, 2**63 - 1), max_size=3),
    )
)
def test_what_is_written_is_read_again(event):
    assert decode(memoryview(b"".join(map(bytes, encode(event)))))._replace(data=event.data) == event


def test_lengths_are_bounded():
    for size in (1 << 31, (1 << 20) + 1):
        with pytest.raises(ProtocolError, match="more than max_message"):
            notifications(struct.pack("<I", size) + HANDSHAKE, is_client=False)
