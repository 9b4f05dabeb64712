"""Hosts, ports and paths in addresses."""

from __future__ import annotations

import socket
from typing import TYPE_CHECKING

from rosetta_jit.transports.connecting import resolve

if TYPE_CHECKING:
    from rosetta_jit.transports.address import Address
    from rosetta_jit.transports.connecting import Target

LOOPBACK = "127.0.0.1"


def host_port(address: Address) -> tuple[str, int]:
    """`host:port`, `[ipv6]:port`, or a port of the loopback interface.

    Raises
    ------
    AddressError
        It is neither.
    """
    host, _, port = address.rest.rpartition(":")
    if not port.isascii() or not port.isdecimal() or int(port) > 65535:
        raise address.wrong("a host and a port", f"{address.scheme}:127.0.0.1:9000")
    return host.removeprefix("[").removesuffix("]") or LOOPBACK, int(port)


def place(address: Address) -> tuple[str, int] | str:
    """A path for `unix:`, else a host and a port.

    Raises
    ------
    AddressError
        It is no place of that kind.
    """
    if address.scheme != "unix":
        return host_port(address)
    if not address.rest or "\0" in address.rest or len(address.rest.encode()) > 107:
        raise address.wrong("a path of at most 107 bytes", "unix:/run/robot.socket")
    return address.rest


def targets(address: Address, kind: int = socket.SOCK_STREAM) -> list[Target]:
    """Where an address leads: a path for `unix:`, else the addresses of a host.

    Raises
    ------
    AddressError
        It is no place of that kind.
    TransportError
        Nobody knows the host.
    """
    found = place(address)
    return [(int(socket.AF_UNIX), found)] if isinstance(found, str) else resolve(*found, kind)
