"""The name server: where ports are registered and looked up. A connection a request, in text, as YARP's own programs do it."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rosetta_jit.errors import TransportError
from rosetta_jit.startup.dataclass import dataclass
from rosetta_jit.transports.conversation import conversation
from rosetta_jit.transports.limits import MAX_NAMES_BYTES

if TYPE_CHECKING:
    from rosetta_jit.transports.address import Address

DEFAULT = ("127.0.0.1", 10000)
END = b"*** end of message"
REGISTRATION = re.compile(r"registration name (.*) ip (\S+) port (\d{1,5}|none) type (\S+)")
NAME = re.compile(r"/[!#-'*-~]{0,250}")
"""Names that can be said in a line of text: no blanks, quotes or parentheses."""


@dataclass(frozen=True, slots=True)
class Contact:
    """The place at which a port listens."""

    name: str
    host: str
    port: int
    type: str


def contact_in(line: str) -> Contact | None:
    """The contact in a line of the name server's answer; None where the line has none."""
    match = REGISTRATION.fullmatch(line)
    if match is None or not match[3].isdecimal() or not 0 < int(match[3]) < 65536:
        return None
    return Contact(match[1], match[2], int(match[3]), match[4])


class NameServer:
    """A client of the name server. Each request takes a connection of its own, and at most ``timeout`` seconds."""

    def __init__(self, host: str, port: int, timeout: float = 2.0) -> None:
        self.host = host
        self.port = port
        self._timeout = timeout

    def ask(self, command: str, *, end: bytes = END) -> list[str]:
        """The lines that answer a command.

        Raises
        ------
        TransportError
            Nothing answers there, or something else than a name server.
        """
        where = f"{self.host}:{self.port}"
        got = b""
        try:
            with conversation(self.host, self.port, self._timeout) as sock:
                sock.sendall(f"NAME_SERVER {command}\n".encode())
                while end not in got and len(got) < MAX_NAMES_BYTES:
                    piece = sock.recv(65536)
                    if not piece:
                        break
                    got += piece
        except OSError as error:
            raise TransportError("unreachable", where, f"YARP's name server does not answer: {_why(error)}") from None
        if end not in got:
            raise TransportError("protocol", where, "what answers there is no name server of YARP")
        return [each.rstrip("\r") for each in got.decode("utf-8", "replace").split("\n") if each.rstrip("\r") and END.decode() not in each]

    def register(self, name: str, host: str, port: int) -> Contact | None:
        """Register a port that listens already, and say what it understands."""
        lines = self.ask(f"register {name} tcp {host} {port}")
        for kind in ("offers", "accepts"):
            self.ask(f"set {name} {kind} tcp fast_tcp udp mcast text text_ack")
        with suppress(TransportError):
            self.ask(f"announce {name}", end=b"\n")  # the only command whose answer has no end line
        return next(filter(None, map(contact_in, lines)), None)

    def register_group(self, owner: str) -> Contact | None:
        """Register a multicast group for the messages that a port sends by mcast, under a name of its own."""
        found = next(filter(None, map(contact_in, self.ask("register ... mcast ... ..."))), None)
        if found is not None:
            with suppress(TransportError):  # as a bottle, whose answer has no end line
                self.ask(f"bot set {owner} owns {found.name}", end=b"\n")
        return found

    def query(self, name: str) -> Contact | None:
        """The contact of the port of that name; None where none is registered."""
        return next((each for each in map(contact_in, self.ask(f"query {name}")) if each), None)

    def unregister(self, name: str) -> None:
        """Forget a port."""
        self.ask(f"unregister {name}")

    def list(self) -> list[Contact]:
        """All ports."""
        return [each for each in map(contact_in, self.ask("list")) if each]


def name_server(options: Mapping[str, Any], address: Address) -> NameServer:
    """The name server that options mean, or YARP's configuration.

    Raises
    ------
    AddressError
        The option is no host and port.
    """
    text: str = options["server"]
    if not text:
        return NameServer(*configured())
    host, _, port = text.rpartition(":")
    if not host or not port.isdecimal() or int(port) > 65535:
        raise address.wrong("a host and a port in `server`", "yarp:/a?server=127.0.0.1:10000")
    return NameServer(host.removeprefix("[").removesuffix("]"), int(port))


def configured() -> tuple[str, int]:
    """The name server of the user's YARP configuration, which `yarp conf` writes; the default where there is none."""
    folder = os.environ.get("YARP_CONFIG_HOME") or Path(os.environ.get("XDG_CONFIG_HOME") or Path.home() / ".config", "yarp")
    try:
        space = [each.split() for each in Path(folder, "yarp_namespace.conf").read_text("utf-8").splitlines()]
        file = next((each[1] for each in space if len(each) > 1 and each[0] == "name"), "/yarp").strip("/").replace("/", "_")
    except (OSError, UnicodeError):
        file = "yarp"
    try:
        words = Path(folder, f"{file}.conf").read_text("utf-8").split()
    except (OSError, UnicodeError):
        return DEFAULT
    return (words[0], int(words[1])) if len(words) > 1 and words[1].isdecimal() and int(words[1]) < 65536 else DEFAULT


def port_name(address: Address) -> str:
    """The port that an address names.

    Raises
    ------
    AddressError
        It is no name that ports have.
    """
    if not NAME.fullmatch(address.rest):
        raise address.wrong("a port's name: `/` and letters, digits and signs without blanks", "yarp:/icub/torso/state:o")
    return address.rest


def ports(address: Address, options: Mapping[str, Any]) -> list[tuple[str, str | None]]:
    """The names of all registered ports; YARP does not say their types."""
    return [(each.name, None) for each in name_server(options, address).list() if each.name.startswith(address.rest)]


def _why(error: Exception) -> str:
    return "no answer in time" if isinstance(error, TimeoutError) else getattr(error, "strerror", None) or str(error)
