"""Ports against the captured connections of YARP 3.12 and 4.0: the same bytes answer, the same messages arrive, wherever a read ends."""

from __future__ import annotations

import json
from contextlib import suppress
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from rosetta_jit.transports.feeding import Feed, ProtocolError
from rosetta_jit.transports.yarp.bottles import from_text, length_of, to_text
from rosetta_jit.transports.yarp.calls import is_reply
from rosetta_jit.transports.yarp.incoming import incoming
from rosetta_jit.transports.yarp.outgoing import Output
from rosetta_jit.transports.yarp.wire import ACK, goodbye, head_of

VECTORS = Path(__file__).resolve().parent.parent / "vectors" / "yarp"
LIVE = {
    dialect: {each["name"]: each for each in json.loads((VECTORS / f"live-{dialect}.json").read_text())["connections"]}
    for dialect in ("yarp3", "yarp4")
}
CARRIED = [
    "wr_tcp",
    "wr_fast_tcp",
    "wr_text",
    "wr_text_ack",
    "wr_tcp_disconnect",
    "bot_env_tcp",
    "bot_env_fast_tcp",
    "bot_someenv_tcp",
    "vec_tcp",
    "pair_tcp",
    "img_odd_tcp",
    "frames_own",
]
"""Connections of which every byte of the reader is known beforehand."""


class Line:
    """A connection that keeps what is written."""

    def __init__(self):
        self.out = b""
        self.closed, self.waiting = False, 0

    def send(self, *parts):
        self.out += b"".join(map(bytes, parts))
        return True

    def within(self, seconds, why): ...

    def in_time(self): ...

    def finish(self, _):
        self.closed = True


class Port:
    """A port that keeps what comes."""

    most = 1 << 20

    def __init__(self, dialect, number=1, replies=None):
        self.name, self.number, self.dialect, self.answers = "/r", number, dialect, replies is not None
        self.got, self.senders, self.groups, self.replies = [], [], [], replies
        self.commands, self.answering = [], {}

    def came(self, _, sender, carrier):
        self.senders.append((sender, carrier))

    def receive(self, _, sender, group):
        self.groups.append((sender, group))
        return self.number

    def take(self, message):
        self.got.append((bytes(message.data), message.sent, dict(message.attributes)))

    def asked(self, message, reply):
        self.take(message)
        reply(self.replies.pop(0), None)

    def administer(self, command, answer):
        self.commands.append(command)
        answer(self.answering.get(command, f"obeyed {command}"))

    def disconnect(self, other):
        return f"Removing connection from {other} to {self.name}"


def read(dialect, stream, pieces=None, **how):
    port, line = Port(dialect, **how), Line()
    feed = Feed(incoming(port, line))
    for piece in pieces or [stream]:
        feed.feed(piece)
    return port, line, feed


@pytest.mark.parametrize("dialect", LIVE)
@pytest.mark.parametrize("name", CARRIED)
def test_a_reader_answers_as_yarp_does(dialect, name):
    live = LIVE[dialect][name]
    port, line, feed = read(dialect, bytes.fromhex(live["client"]), number=live["port"])
    assert line.out == bytes.fromhex(live["server"])
    assert feed.is_between or feed.done
    for (data, sent, told), value in zip(port.got, live["sent"], strict=False):
        if "text" in value:
            assert data == from_text(value["text"], dialect)
        if value.get("envelope"):
            assert (told["sequence"], sent) == (value["envelope"]["seq"], round(value["envelope"]["time"] * 1e9))
        assert length_of(data, dialect) == len(data) or name == "pair_tcp"
    ended = name == "wr_tcp_disconnect"
    assert 0 < len(port.got) <= len(live["sent"]) if ended else len(port.got) == (len(live["sent"]) or 7)


@pytest.mark.parametrize("name", ["wr_tcp", "bot_env_fast_tcp", "wr_text_ack", "text_quirks", "frames_own", "rpc_tcp"])
def test_a_stream_may_be_cut_at_every_byte(name):
    stream = bytes.fromhex(LIVE["yarp4"][name]["client"])
    whole, line, _ = read("yarp4", stream)
    for at in range(1, len(stream)):
        port, again, feed = read("yarp4", stream, [stream[:at]])
        assert port.got == whole.got[: len(port.got)]
        feed.feed(stream[at:])
        assert (port.got, again.out) == (whole.got, line.out)
    each, again, _ = read("yarp4", stream, [stream[at : at + 1] for at in range(len(stream))])
    assert (each.got, again.out) == (whole.got, line.out)


def test_a_stream_that_ends_in_the_middle_is_noticed():
    stream = bytes.fromhex(LIVE["yarp3"]["wr_tcp"]["client"])
    first = 8 + 4 + 3
    cuts = {at for at in range(first, len(stream)) if read("yarp3", stream[:at])[2].is_between}
    assert cuts == {first, *(at for at in range(first, len(stream)) if stream[at:].startswith(b"YA\n\0\0\0RP"))}


@pytest.mark.parametrize("dialect", LIVE)
def test_a_server_replies_as_yarp_does(dialect):
    live = LIVE[dialect]["rpc_tcp"]
    *parts, last, none = bytes.fromhex(live["server"])[8:].split(ACK)
    assert (last, none) == (b"", b"")  # the goodbye is acknowledged without a reply
    port, line, _ = read(dialect, bytes.fromhex(live["client"]), number=live["port"], replies=list(parts))
    assert line.out == bytes.fromhex(live["server"])
    assert [to_text(data, dialect) for data, *_ in port.got][:2] == ["[set] [poss] (0.0 10.5 -3.25)", "[get] [enc] 0"]


@pytest.mark.parametrize("dialect", LIVE)
def test_commands_may_come_as_bottles(dialect):
    """So `yarp admin rpc` sends them; answers are as those of a port of YARP."""
    live = LIVE[dialect]["admin_rpc"]
    port, line = Port(dialect, live["port"]), Line()
    port.answering = {"[ver]": "[ver] 1 2 3", "[list] [in]": "anon_rpc", "[list] [out]": "", '[list] [out] "/nobody"': ""}
    Feed(incoming(port, line)).feed(bytes.fromhex(live["client"]))
    assert port.commands == list(port.answering)
    assert line.out == bytes.fromhex(live["server"])


@pytest.mark.parametrize("dialect", LIVE)
def test_a_caller_finds_the_end_of_each_reply(dialect):
    """Replies have no length: one is whole where it is a bottle, and its acknowledgement follows."""
    rest, found = bytes.fromhex(LIVE[dialect]["rpc_tcp"]["server"])[8:], []
    while rest:
        size = next(at for at in range(len(rest)) if rest[:at].endswith(ACK) and is_reply(rest[: at - 8])) if len(rest) > 8 else 8
        found.append(rest[: size - 8])
        rest = rest[size:]
    assert len(found) == 7
    assert [to_text(each, dialect) for each in found[:2] if each] == ["[ok]", "12.5"]


@pytest.mark.parametrize("dialect", LIVE)
@pytest.mark.parametrize("name", ["wr_tcp", "wr_fast_tcp", "bot_env_tcp", "bot_env_fast_tcp"])
def test_a_writer_writes_as_yarp_does(dialect, name):
    """Bottles; vectors and images of YARP come in three blocks, which readers join."""
    live = LIVE[dialect][name]
    port, _, _ = read(dialect, bytes.fromhex(live["client"]))
    (sender, carrier), line = port.senders[0], Line()
    output = Output(sender, "/r", carrier)
    output.stream = line
    feed = Feed(output.machine(line))
    for data, _, told in port.got:
        assert output.write(head_of(len(data), envelope=told.get("envelope")), data)
    feed.feed(bytes.fromhex(live["server"]))
    assert output.close(0) == 0
    assert line.out == bytes.fromhex(live["client"])
    assert goodbye() in line.out


def test_a_writer_waits_for_each_acknowledgement():
    line = Line()
    output = Output("/w", "/r", "tcp")
    output.stream = line
    feed = Feed(output.machine(line))
    for _ in range(3):
        assert output.write(b"head", b"data")
    said = len(line.out)
    feed.feed(b"YA\1\0\0\0RP")
    assert line.out[said:] == b"headdata"
    feed.feed(ACK)
    assert line.out[said:] == b"headdata" * 2
    feed.feed(b"YA\3\0\0\0RPxyz")  # an acknowledgement may have bytes behind it, to be skipped
    assert line.out[said:] == b"headdata" * 3


def test_text_is_read_as_yarp_reads_it():
    port, line, _ = read("yarp3", bytes.fromhex(LIVE["yarp3"]["text_quirks"]["client"]))
    texts = [to_text(data, "yarp3") for data, *_ in port.got]
    assert texts == ["1 2 3", "4 5", "6", "(7 8 9)", "10 11", '"a\\nb" [set] {1 2}', "", "12", "13"]
    assert [told.get("sequence") for _, _, told in port.got][-2:] == [17, 18]
    assert b"Port command not understood." in line.out
    port, _, _ = read("yarp3", bytes.fromhex(LIVE["yarp3"]["text_ack_quirks"]["client"]))
    assert to_text(port.got[3][0], "yarp3") == "16 8 1000.0 true [null] inf"


@pytest.mark.parametrize("name", ["bad_start", "http_get"])
def test_what_is_no_carrier_is_told_so(name):
    port, line, feed = read("yarp3", bytes.fromhex(LIVE["yarp3"][name]["client"]))
    assert b"Protocol not found" in line.out
    assert feed.done
    assert not port.got


@pytest.mark.parametrize(
    ("stream", "said"),
    [
        (b"YA\xe4\x1e\0\0RP\0\0\0\0", "a name of 0 bytes"),
        (b"YA\xe4\x1e\0\0RP\xff\xff\xff\x7f", "a name of 2147483647 bytes"),
        (b"YA\xe4\x1e\0\0RP\2\0\0\0a\0notayarp", "out of step"),
        (b"YA\xe4\x1e\0\0RP\2\0\0\0a\0YA\xff\xff\xff\x7fRP", "an index of 2147483647 bytes"),
        (b"YA\xe4\x1e\0\0RP\2\0\0\0a\0" + head_of(1 << 30), "more than max_message"),
        (b"YA\xe4\x1e\0\0RP\2\0\0\0a\0" + head_of(-1), "impossible length"),
        (b"CONNECT " + b"x" * 2000, "no end of line"),
        (b"CONNECT /a\r\nd\r\n" + b"(" * 200 + b")" * 200 + b"\r\n", "nested deeper"),
    ],
)
def test_what_no_port_says_ends_the_connection(stream, said):
    with pytest.raises(ProtocolError, match=said):
        read("yarp3", stream)


@settings(suppress_health_check=[HealthCheck.too_slow])
@given(st.data())
def test_no_stream_breaks_a_reader(data):
    """Bytes of a captured stream, some of them changed: messages, or one ProtocolError, and nothing else."""
    name = data.draw(st.sampled_from(["wr_tcp", "wr_text_ack", "frames_own", "rpc_tcp"]))
    stream = bytearray.fromhex(LIVE["yarp3"][name]["client"])
    for _ in range(data.draw(st.integers(1, 4))):
        stream[data.draw(st.integers(0, len(stream) - 1))] = data.draw(st.integers(0, 255))
    with suppress(ProtocolError):
        read("yarp3", bytes(stream), replies=[b""] * 50 if name == "rpc_tcp" else None)
