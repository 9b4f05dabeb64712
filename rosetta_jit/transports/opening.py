"""What a user opens at an address: `subscribe`, `publish`, `call` and `serve`."""

from __future__ import annotations

from collections.abc import Mapping
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from rosetta_jit.catalogue import transports as words
from rosetta_jit.errors import AddressError, MissingPackage
from rosetta_jit.transports.address import Address, Option, parse, settle
from rosetta_jit.transports.base import QUEUE, Sink, Source, Transport
from rosetta_jit.transports.calls import Caller, Server
from rosetta_jit.transports.installed import installed
from rosetta_jit.transports.limits import MAX_MESSAGE_BYTES

if TYPE_CHECKING:
    from rosetta_jit.transports.base import Deliver, Lost
    from rosetta_jit.transports.calls import Answer

COMMON = {
    "max_message": Option("size", MAX_MESSAGE_BYTES, "no message is larger than so many bytes"),
    "queue": Option("number", QUEUE, "so many messages or questions wait for who takes them"),
    "timeout": Option("seconds", 5.0, "how long an answer may take"),
    "linger": Option("seconds", 2.0, "how long closing waits for what is not sent yet"),
}
"""Options of every transport."""


def subscribe(address: str, deliver: Deliver | None = None, *, lost: Lost | None = None, **options: object) -> Source:
    """Receive the messages of a channel.

    Parameters
    ----------
    address
        Such as ``yarp:/icub/torso/state:o``; the scheme names the transport.
    deliver
        Is called with each `Message`, in the transport's own thread: it should be quick, and wait for nothing. Without it the source is
        iterated over.
    lost
        Is called with the reason and the number of messages that are lost, in whichever thread notices it.
    **options
        Of the transport; they go before those in the address.

    Raises
    ------
    AddressError
        The address or an option is wrong.
    MissingPackage
        The transport takes an extra.
    TransportError
        The channel cannot be opened.
    """
    place, transport, settled = _settled("subscribe", address, options)
    source = Source(str(place), deliver, lost, queue=settled["queue"])
    transport.function("subscribe")(place, source, settled)
    return source


def publish(address: str, *, lost: Lost | None = None, **options: object) -> Sink:
    """Send messages to a channel; parameters and errors as for `subscribe`."""
    place, transport, settled = _settled("publish", address, options)
    sink: Sink = transport.function("publish")(place, settled, lost)
    return sink


def call(address: str, **options: object) -> Caller:
    """Ask a service: the result is called with the bytes of a request, and gives the `Message` that answers it.

    Errors as for `subscribe`.
    """
    place, transport, settled = _settled("call", address, options)
    caller: Caller = transport.function("call")(place, settled)
    return caller


def serve(address: str, answer: Answer, *, lost: Lost | None = None, **options: object) -> Server:
    """Answer the requests of a service: ``answer`` gets each as a `Message`, in the server's thread, and returns the bytes of the answer.

    What it raises is told to the peer, where the middleware can. Errors as for `subscribe`.
    """
    place, transport, settled = _settled("serve", address, options)
    server = Server(str(place), answer, lost, queue=settled["queue"])
    transport.function("serve")(place, server, settled)
    return server


def names(address: str, **options: object) -> list[tuple[str, str | None]]:
    """The channels that a middleware knows of, each with its type where that is known; errors as for `subscribe`."""
    place, transport, settled = _settled("names", address, options)
    found: list[tuple[str, str | None]] = transport.function("names")(place, settled)
    return found


def _settled(direction: str, text: str, options: Mapping[str, object]) -> tuple[Address, Transport, dict[str, Any]]:
    known = installed()
    address = parse(text, known)
    transport = known[address.scheme]
    if not getattr(transport, direction):
        raise AddressError((words.cannot(address.place, transport.name, direction),))
    settled = settle(address, {**COMMON, **transport.options}, options)
    extra, module = transport.extra
    if module and find_spec(module) is None:
        raise MissingPackage(f"{transport.name} takes a package: pip install 'rosetta-jit[{extra}]'")
    return address, transport, settled
