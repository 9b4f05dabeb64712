"""What the target of a route is told of the type that it gets, where its address does not say so."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.api.bridges import Bridge
from rosetta_jit.bridge.translating import Stateful
from rosetta_jit.transports.address import parse
from rosetta_jit.transports.installed import installed

if TYPE_CHECKING:
    from rosetta_jit.bridge.translating import Translate


def announced(target: str, translate: Translate | None) -> dict[str, str]:
    """Options for the publisher: a type's name, md5 sum, hash, text, whichever it takes.

    Empty where messages are not translated, or become those of a type that is not the middleware's; and where the address says another
    type, as nothing else is known of that.
    """
    known = installed()
    address = parse(target, known)
    transport = known[address.scheme]
    bridge = translate.bridge if isinstance(translate, Stateful) else translate
    framework = transport.types.get(address.scheme)
    if framework is None or not isinstance(bridge, Bridge):
        return {}
    found = bridge.announced(framework)
    if "type" in address.options and address.options["type"][0] != found.get("type"):
        return {}
    return {name: value for name, value in found.items() if name in transport.options and name not in address.options}
