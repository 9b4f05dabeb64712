"""The administration of ports, in lines of text: `yarp connect` sends one to a writer, and so does a reader that wants to be connected."""

from __future__ import annotations

import re
from contextlib import suppress
from typing import TYPE_CHECKING

from rosetta_jit.errors import TransportError
from rosetta_jit.transports.conversation import conversation
from rosetta_jit.transports.limits import MAX_ADMIN_BYTES, MAX_ADMIN_WORDS

if TYPE_CHECKING:
    from rosetta_jit.transports.yarp.names import Contact

WORD = re.compile(r'"((?:[^"\\]|\\.)*)"|([^\s"]+)')


def quoted(text: str) -> str:
    """A text in quotes, on one line."""
    safe = "".join(char if char.isprintable() else "?" for char in text)
    return '"' + safe.replace("\\", "\\\\").replace('"', '\\"') + '"'


def words_of(command: str) -> list[str]:
    """The words of a command, without quotes."""
    found = [re.sub(r"\\(.)", r"\1", match[1]) if match[1] is not None else match[2] for match in WORD.finditer(command[:2000])]
    return found[:MAX_ADMIN_WORDS]


def leave(contact: Contact, name: str, timeout: float) -> None:
    """Tell a reader that a port sends it no more datagrams; there is nobody to be told that it does not answer."""
    with suppress(OSError), conversation(contact.host, contact.port, timeout) as sock:
        sock.sendall(f"CONNECT admin\r\n~{name}\r\nq\r\n".encode())
        for _ in range(100):
            if not sock.recv(4096):
                return


def ask_port(contact: Contact, command: str, timeout: float) -> str:
    """What a port answers to a command.

    Raises
    ------
    TransportError
        It does not answer in time.
    """
    got = b""
    try:
        with conversation(contact.host, contact.port, timeout) as sock:
            sock.sendall(f"CONNACK admin\r\na\r\n{command}\r\n".encode())
            while b"<ACK>" not in got and len(got) < MAX_ADMIN_BYTES:
                piece = sock.recv(4096)
                if not piece:
                    break
                got += piece
    except OSError as error:
        raise TransportError("unreachable", contact.name, f"the port does not answer: {error.strerror or error}") from None
    _, _, answer = got.decode("utf-8", "replace").partition("\n")
    return answer.split("\r\n<ACK>")[0]
