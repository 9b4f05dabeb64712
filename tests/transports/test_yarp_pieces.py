"""Messages of YARP in datagrams: those that YARP 3.12 and 4.0 sent, and what becomes of pieces that are lost, doubled, moved or made up."""

from __future__ import annotations

import json
from collections import Counter

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rosetta_jit.transports.feeding import Feed, ProtocolError
from rosetta_jit.transports.yarp.bottles import from_text
from rosetta_jit.transports.yarp.incoming import incoming, messages
from rosetta_jit.transports.yarp.pieces import DAMAGED, HEAD, MISSING, PIECE, STRANGE, TWICE, Pieces, cut
from rosetta_jit.transports.yarp.wire import head_of, hello
from tests.transports.test_yarp_streams import VECTORS, Line, Port

LIVE = {
    (dialect, each["name"]): each
    for dialect in ("yarp3", "yarp4")
    for each in json.loads((VECTORS / f"live-{dialect}.json").read_text())["connectionless"]
}


def reader(carrier="udp", port=None):
    """Pieces of one writer, where the messages go, and what was lost."""
    port, lost = port or Port("yarp3"), Counter()
    return Pieces(lambda: messages(port, None, "/w", carrier), lambda why: lost.update([why])), port.got, lost


def datagrams(data, envelope=None):
    return [b"".join(parts) for parts in cut(head_of(len(data), envelope=envelope), data)]


def take(pieces, *datagrams):
    for each in datagrams:
        pieces.take(memoryview(each))


@pytest.mark.parametrize("live", LIVE.values(), ids=map("-".join, LIVE))
def test_datagrams_of_yarp(live):
    dialect = next(dialect for (dialect, _), each in LIVE.items() if each is live)
    pieces, got, lost = reader()
    take(pieces, *map(bytes.fromhex, live["datagrams"]))
    assert (len(got), lost) == (len(live["datagrams"]) - 1, {})  # the last one wakes a reader, and says nothing
    for (data, sent, told), value in zip(got, live["sent"], strict=False):
        if "text" in value:
            assert data == from_text(value["text"], dialect)
        if value.get("envelope"):
            assert (told["sequence"], sent) == (value["envelope"]["seq"], round(value["envelope"]["time"] * 1e9))
    if live["name"] != "vec_udp":  # vectors of YARP come in three blocks, ours in two
        assert [each.hex() for data, _, _ in got for each in datagrams(data)] == live["datagrams"][:-1]


@pytest.mark.parametrize("live", LIVE.values(), ids=map("-".join, LIVE))
def test_hello_and_goodbye_of_yarp(live):
    port, line = Port("yarp3", number=int.from_bytes(bytes.fromhex(live["hello"]["server"])[2:6], "little")), Line()
    feed = Feed(incoming(port, line))
    feed.feed(bytes.fromhex(live["hello"]["client"]))
    assert feed.done
    assert line.out.hex() == live["hello"]["server"]
    ((sender, group),) = port.groups
    carrier = "mcast" if group else "udp"
    assert group in (None, ("224.1.1.3", 10004))
    assert bytes.fromhex(live["hello"]["client"]).startswith(hello(carrier, sender))
    port, line = Port("yarp3"), Line()
    port.name = "/in" if sender == "/out" else "/r"
    Feed(incoming(port, line)).feed(bytes.fromhex(live["goodbye"]["client"]))
    assert line.out.hex() == live["goodbye"]["server"]


LONG = bytes(range(256)) * 1000


def test_long_messages_are_cut_where_yarp_cuts_them():
    pieces, got, lost = reader()
    cut_up = datagrams(LONG)
    assert [len(each) for each in cut_up[:-1]] == [65_499] * 3
    assert [HEAD.unpack_from(each)[1] for each in cut_up] == [0, 1, 2, 3]
    take(pieces, *cut_up, *datagrams(b"short"))
    assert [data for data, *_ in got] == [LONG, b"short"]
    assert not lost
    assert len(datagrams(bytes(PIECE - len(head_of(1))))) == 1
    assert len(datagrams(bytes(PIECE - len(head_of(1)) + 1))) == 2


@pytest.mark.parametrize(
    ("order", "arrive", "said"),
    [
        ([0, 1, 3, "b"], ["b"], {MISSING: 1}),
        ([1, 2, 3, "b"], ["b"], {MISSING: 1}),
        ([0, 1, 2, "b"], ["b"], {MISSING: 1}),
        ([0, 2, 1, 3, "b"], ["b"], {MISSING: 2}),  # a piece that goes back looks like one of another message
        ([0, 1, 1, 2, 3, "b"], ["a", "b"], {TWICE: 1}),
        ([0, 0, 1, 2, 3, 3, "b"], ["a", "b"], {TWICE: 2}),
        ([0, 1, 0, 1, 2, 3], ["a"], {MISSING: 1}),
        ([3, 3, "b", 1, 2], ["b"], {MISSING: 3}),
        ([0, "damaged", 1, "strange", 2, "nothing", 3], ["a"], {DAMAGED: 1, STRANGE: 1}),
    ],
)
def test_pieces_that_do_not_come_in_their_turn(order, arrive, said):
    """What arrives is what was sent, and each message that is lost is counted."""
    cut_up, others = datagrams(LONG), {"b": datagrams(b"short")[0], "damaged": b"\0" * 20, "strange": b"x", "nothing": HEAD.pack(0, -1)}
    pieces, got, lost = reader()
    take(pieces, *(others[each] if isinstance(each, str) else cut_up[each] for each in order))
    assert [data for data, *_ in got] == [{"a": LONG, "b": b"short"}[each] for each in arrive]
    assert lost == said


def test_hostile_datagrams_cost_themselves_alone():
    port = Port("yarp3", replies=[])
    pieces, got, lost = reader(port=port)
    huge = next(cut(head_of(1 << 30), b""))
    question = next(cut(head_of(4, reply=True), b"what"))
    take(
        pieces,
        b"".join(huge),
        *datagrams(b"1"),
        b"".join(question),
        *datagrams(b"2"),
        *(b"".join(each) for each in cut(b"no frame at all", b"")),
    )
    take(pieces, *datagrams(b"3"))
    assert [data for data, *_ in got] == [b"1", b"2", b"3"]
    assert sorted(lost.values()) == [1, 1, 1]
    assert {why.split(",")[0] for why in lost} == {
        f"a message of {1 << 30} bytes",
        "a question by udp",
        "the stream is out of step: no YARP number where one belongs",
    }
    assert pieces.size == 1 << 16


@given(st.data())
def test_whatever_happens_to_datagrams_a_message_that_arrives_was_sent(data):
    """Datagrams doubled, and one lost, exchanged with the next of its message, or with bytes changed: all that arrives was sent.

    Pieces that are lost or exchanged across the end of a message may fit into the next one: the protocol cannot tell.
    """
    sent = [bytes([number]) * size for number, size in enumerate(data.draw(st.lists(st.sampled_from([5, PIECE, 2 * PIECE]), max_size=3)))]
    messages = [datagrams(message) for message in sent]
    if messages:
        pieces = data.draw(st.sampled_from(messages))
        at = data.draw(st.integers(0, len(pieces) - 1))
        match data.draw(st.sampled_from(["lose", "exchange", "damage"])):
            case "lose":
                del pieces[at]
            case "exchange":
                pieces[at : at + 2] = reversed(pieces[at : at + 2])
            case "damage":
                pieces[at] = pieces[at][:-1] + b"\xff" + (b"" if data.draw(st.booleans()) else b"x")
    stream = [each for pieces in messages for each in pieces]
    for _ in range(data.draw(st.integers(0, 3)) if stream else 0):
        at = data.draw(st.integers(0, len(stream) - 1))
        stream.insert(at, stream[at])
    joined, got, _ = reader()
    take(joined, *stream)
    assert {each for each, *_ in got} <= set(sent)


def test_what_the_system_dropped_costs_the_message_that_it_was_part_of():
    pieces, got, lost = reader()
    one, two = datagrams(bytes(200_000)), datagrams(b"\1" * 200_000)
    take(pieces, *one[:2])
    pieces.gap()
    pieces.gap()
    take(pieces, *two[2:], *two)
    assert ([data for data, *_ in got], lost) == ([b"\1" * 200_000], {MISSING: 1})


def test_a_group_that_is_none_ends_the_connection():
    class Refusing(Port):
        def receive(self, *_):
            raise ProtocolError("that is no group")

    with pytest.raises(ProtocolError, match="is no group"):
        Feed(incoming(Refusing("yarp3"), Line())).feed(hello("mcast", "/w") + bytes([127, 0, 0, 1, 0, 80]))
