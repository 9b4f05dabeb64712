"""The options by which a route tells the ends of its channels the types of its messages, where the addresses do not say them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rosetta_jit.transports.address import parse
from rosetta_jit.transports.installed import installed

if TYPE_CHECKING:
    from rosetta_jit.bridge.translating import Half, Translator


def announced(target: str, translate: Translator) -> dict[str, Any]:
    """Options for a publisher: the name, md5 sum, hash and text of the type that is written, whichever it takes."""
    return _known(target, translate, "encode")


def wanted(source: str, translate: Translator) -> dict[str, Any]:
    """Options for a subscriber: what the type that is read must be, so that messages of another one are refused and not misread."""
    return _known(source, translate, "decode")


def served(place: str, request: Translator, reply: Translator) -> dict[str, Any]:
    """Options for a server: for ROS 1 the service whose requests are read, for RSB the type of the answers."""
    return wanted(place, request) or announced(place, reply)


def _known(place: str, translate: Translator, half: Half) -> dict[str, str]:
    """Nothing where messages are not translated, or where their type is none of the middleware's; nor of a type that the address says."""
    known = installed()
    address = parse(place, known)
    transport = known[address.scheme]
    framework = transport.types.get(address.scheme)
    names = transport.asks if half == "decode" else tuple(transport.options)
    if framework is None or not names:
        return {}
    found = translate.announced(framework, half)
    if "type" in address.options and address.options["type"][0] != found.get("type"):
        return {}
    return {name: value for name, value in found.items() if name in names and name not in address.options}
