"""Routes for many channels: `*` in a source stands for one part of a channel's name, `{1}` in the target for what the first one found."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from rosetta_jit.startup.dataclass import replace

if TYPE_CHECKING:
    from rosetta_jit.bridge.configuration import Route


def is_pattern(address: str) -> bool:
    """Whether an address stands for several channels."""
    return "*" in address.partition("?")[0]


def place_to_list(address: str) -> str:
    """The address whose channels are to be listed: up to the first `*`, with the same options."""
    place, mark, options = address.partition("?")
    return place.partition("*")[0] + mark + options


def matching(route: Route, channels: Iterable[str]) -> Iterator[Route]:
    """A route for each channel that the pattern finds."""
    place, mark, options = route.source.partition("?")
    scheme, _, pattern = place.partition(":")
    wanted = re.compile("([^/]+)".join(map(re.escape, pattern.split("*"))))
    for channel in channels:
        found = wanted.fullmatch(channel)
        if found is not None:
            target = _filled(route.target, found.groups())
            yield replace(route, source=f"{scheme}:{_quoted(channel)}{mark}{options}", target=target, name=f"{route.name} {channel}")


def _quoted(channel: str) -> str:
    return channel.replace("%", "%25").replace("?", "%3f")


def _filled(target: str, parts: tuple[str, ...]) -> str:
    for number, part in enumerate(parts, 1):
        safe = re.sub(r"[^\w.:-]|\A\.+\Z", "_", part)  # a name from the network becomes no option of an address, and no folder above
        target = target.replace(f"{{{number}}}", safe)
    return target
