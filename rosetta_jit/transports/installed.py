"""Which transports there are: ours, and those of installed packages."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import TYPE_CHECKING, cast

from rosetta_jit.startup.entry_points import loaded
from rosetta_jit.startup.garbage import imported

if TYPE_CHECKING:
    from rosetta_jit.transports.base import Transport

GROUP = "rosetta_jit.transports"
"""The entry-point group in which packages offer transports of their own: a `Transport` each."""

OURS = ("sockets", "yarp", "rsb", "ros1", "lcm", "mqtt", "zenoh", "cyclone", "iceoryx")
"""Folders beside this file with a `transport.TRANSPORTS`."""


@cache
def installed() -> Mapping[str, Transport]:
    """Every transport by its schemes: ours, and those of installed packages."""
    ours = [
        each for name in OURS for each in cast("tuple[Transport, ...]", imported(f"rosetta_jit.transports.{name}.transport").TRANSPORTS)
    ]
    offers = cast("tuple[Transport, ...]", loaded(GROUP))
    return {scheme: transport for transport in (*ours, *offers) for scheme in transport.schemes}
