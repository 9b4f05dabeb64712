"""What a port does with a connection that somebody makes to it: messages by tcp, fast_tcp or text, questions, and commands for the port."""

from __future__ import annotations

import struct
from collections.abc import Callable, Generator
from contextlib import suppress
from time import time_ns
from typing import TYPE_CHECKING, Any, Protocol

from rosetta_jit.terminal import printable
from rosetta_jit.transports.base import Message
from rosetta_jit.transports.feeding import ProtocolError, Until
from rosetta_jit.transports.limits import MAX_LINE_BYTES
from rosetta_jit.transports.yarp.bottles import from_text, is_open, to_text
from rosetta_jit.transports.yarp.stamps import attributes_of
from rosetta_jit.transports.yarp.wire import ACK, FIRST_CARRIER, MCAST, TCP, UDP, WITH_ACKS, frames, hello_rest, int_of, name_in, yarp_int

if TYPE_CHECKING:
    from rosetta_jit.transports.feeding import Machine

    Reply = Callable[[bytes | None, str | None], object]

_GROUP = struct.Struct(">4BH")

NO_ANSWER = struct.pack("<ii", 256, 0)
"""An empty bottle. Where nothing stands before the acknowledgement, YARP takes that for a bottle, and who asked waits for ever."""

HELLO_S = 10.0
"""How long a connection may say nothing."""

UNKNOWN = b"* Error. Protocol not found.\r\n* This port understands tcp, fast_tcp, udp, mcast, text and text_ack.\r\n"
HELP = b"Port command not understood.\r\nType d to send data to the port's owner.\r\nType ? for help.\r\n"


class Line(Protocol):
    """The connection: where answers are written."""

    def send(self, *parts: bytes) -> bool: ...
    def within(self, seconds: float, why: str) -> None: ...
    def in_time(self) -> None: ...
    def finish(self, linger: float) -> None: ...


class Owner(Protocol):
    """The port, as its connections see it.

    `came` says who sends; `receive` opens a socket for datagrams, those of a group where there is one, and gives its number; `take` gets a
    message; `asked` gets a question, where the port answers; `administer` answers a command by calling back, perhaps later and from another
    thread.
    """

    name: str
    number: int
    most: int
    dialect: str
    answers: bool

    def came(self, line: Line, sender: str, carrier: str) -> None: ...
    def receive(self, line: Line, sender: str, group: tuple[str, int] | None) -> int: ...
    def take(self, message: Message) -> None: ...
    def asked(self, message: Message, reply: Reply) -> None: ...
    def administer(self, command: str, answer: Callable[[str], object]) -> None: ...
    def disconnect(self, other: str) -> str: ...


def incoming(port: Owner, line: Line) -> Machine:
    """Read one connection to a port, whatever its carrier."""
    line.within(HELLO_S, "a connection that said nothing")
    first = yield 8
    word = bytes(first)
    if word in (b"CONNECT ", b"CONNACK "):
        yield from _text(port, line, has_acks=word == b"CONNACK ")
        return
    code = int_of(first) - FIRST_CARRIER if word[:2] == b"YA" and word[6:] == b"RP" else -1
    if code % 16 not in (TCP, UDP, MCAST):
        line.send(UNKNOWN)
        line.in_time()
        return
    sender = yield from hello_rest()
    if code % 16 == MCAST:
        *address, number = _GROUP.unpack((yield _GROUP.size))
        line.in_time()
        port.receive(line, sender, (".".join(map(str, address)), number))
        return
    line.in_time()
    if code % 16 == UDP:
        line.send(yarp_int(port.receive(line, sender, None)))
        return
    carrier = "tcp" if code & WITH_ACKS else "fast_tcp"
    line.send(yarp_int(port.number))
    port.came(line, sender, carrier)
    yield from messages(port, line, sender, carrier)


def messages(port: Owner, line: Line | None, sender: str, carrier: str) -> Machine:
    """Read frames from a stream, or from the pieces of datagrams, which have no line for answers.

    Raises
    ------
    ProtocolError
        What comes is no frame; or a question, by datagrams.
    """
    channel, most, take = port.name, port.most, port.take
    has_acks = carrier == "tcp"
    _, plain = attributes_of("", sender, carrier)
    while True:
        frame = yield from frames(most)
        command = frame.command
        if command in ("D", "d"):
            sent, attributes = attributes_of(frame.envelope, sender, carrier) if frame.envelope else (None, plain)
            message = Message(frame.payload, channel, None, time_ns(), sent, attributes)
            if command == "d" and port.answers:
                if line is None:
                    raise ProtocolError(f"a question by {carrier}, which has no way back for the answer")
                port.asked(message, _reply_to(line, ACK if has_acks else b""))
                continue
            take(message)
        elif command == "a" and line is not None:
            port.administer(to_text(frame.payload, port.dialect), _bottle_to(line, ACK if has_acks else b"", port.dialect))
            continue
        if has_acks and line is not None:
            line.send(ACK)
        if command == "q":
            return


def _reply_to(line: Line, ack: bytes) -> Reply:
    def reply(answer: bytes | None, _: str | None) -> None:
        line.send((answer or NO_ANSWER) + ack)

    return reply


def _bottle_to(line: Line, ack: bytes, dialect: str) -> Callable[[str], object]:
    """A function that answers a command which came as a bottle."""

    def answer(text: str) -> None:
        line.send(from_text(text, dialect) + ack)

    return answer


def _text(port: Owner, line: Line, *, has_acks: bool) -> Machine:
    ack = b"<ACK>\r\n" if has_acks else b""
    sender = name_in(bytes((yield Until(b"\n", 1000))).rstrip(b"\r\n"))
    line.in_time()
    carrier = "text_ack" if has_acks else "text"
    line.send(f"Welcome {printable(sender)}\r\n".encode())
    if sender != "admin":
        port.came(line, sender, carrier)
    while True:
        text = yield from _line(between=True)
        key = text[:1]
        if key in ("D", "d"):
            yield from _data(port, line, text, ack, sender, carrier)
        elif key == "a":
            command = yield from _line()
            port.administer(command, lambda answer: line.send(f"{answer}\r\n".encode() + ack))
        elif key == "q":
            line.send(ack)
            return
        elif key in ("~", "!"):
            line.send(port.disconnect(text[1:].lstrip("~!")).encode() + b"\r\n" + ack)
        elif key == "*":
            line.send(f"This is {port.name}, a port of rosetta_jit.\r\n".encode() + ack)
        else:
            line.send(HELP + ack)


def _data(port: Owner, line: Line, command: str, ack: bytes, sender: str, carrier: str) -> Machine:
    text = yield from _line()
    while is_open(text):
        start = text[:-1] if text.endswith("\\") else f"{text} "
        text = start + (yield from _line())
        if len(text) > min(port.most, MAX_LINE_BYTES):
            raise ProtocolError(f"a message above max_message={port.most}")
    data = from_text(text, port.dialect)
    sent, attributes = attributes_of(command[2:] if command[1:2] == " " else "", sender, carrier)
    message = Message(data, port.name, None, time_ns(), sent, attributes)
    if command[0] == "d" and command[:2] != "do" and ack and port.answers:
        port.asked(message, _text_reply(line, ack, port.dialect))
    else:
        port.take(message)
        line.send(ack)


def _text_reply(line: Line, ack: bytes, dialect: str) -> Reply:
    def reply(answer: bytes | None, _: str | None) -> None:
        text = ""
        if answer:
            with suppress(ProtocolError):
                text = to_text(answer, dialect)
        line.send((f"{text}\r\n" if text else "").encode() + ack)

    return reply


def _line(*, between: bool = False) -> Generator[Any, memoryview, str]:
    raw: memoryview = yield Until(b"\n", MAX_LINE_BYTES, between)
    return bytes(raw).rstrip(b"\r\n").decode("utf-8", "replace")
