"""Sessions of zenoh: those of a process with the same configuration are one."""

from __future__ import annotations

import json
import threading
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import zenoh

from rosetta_jit.errors import TransportError
from rosetta_jit.transports.processes import per_process

if TYPE_CHECKING:
    from rosetta_jit.transports.address import Address

KEYS = ("connect", "listen", "mode", "scout", "config")


class Sessions:
    """The sessions of a process."""

    def __init__(self) -> None:
        self._open: dict[tuple[Any, ...], tuple[zenoh.Session, int]] = {}
        self._lock = threading.Lock()

    def enter(self, options: Mapping[str, Any], address: Address) -> zenoh.Session:
        """The session that options mean; `leave` it as often as it was entered.

        Raises
        ------
        TransportError
            Zenoh cannot open it.
        """
        key = tuple(options[each] for each in KEYS)
        with self._lock:
            session, users = self._open.get(key) or (self._new(options, address), 0)
            self._open[key] = session, users + 1
            return session

    def leave(self, options: Mapping[str, Any]) -> None:
        """Close it when nobody uses it any more."""
        key = tuple(options[each] for each in KEYS)
        with self._lock:
            session, users = self._open.pop(key)
            if users > 1:
                self._open[key] = session, users - 1
            else:
                session.close()  # pyright: ignore[reportUnknownMemberType]

    @staticmethod
    def _new(options: Mapping[str, Any], address: Address) -> zenoh.Session:
        try:
            if options["config"]:
                return zenoh.open(zenoh.Config.from_file(options["config"]))
            config = zenoh.Config()
            for name, value in (
                ("mode", options["mode"]),
                ("connect/endpoints", _endpoints(options["connect"])),
                ("listen/endpoints", _endpoints(options["listen"])),
                ("scouting/multicast/enabled", options["scout"]),
            ):
                config.insert_json5(name, json.dumps(value))  # pyright: ignore[reportUnknownMemberType]
            return zenoh.open(config)
        except zenoh.ZError as error:
            raise TransportError("unreachable", str(address), f"zenoh cannot open a session: {error}") from None


def _endpoints(text: str) -> list[str]:
    return [each.strip() for each in text.split(",") if each.strip()]


sessions = per_process(Sessions)
"""Those of this process."""


def key_of(address: Address) -> zenoh.KeyExpr:
    """The key expression that an address names.

    Raises
    ------
    AddressError
        It is none.
    """
    try:
        return zenoh.KeyExpr.autocanonize(address.rest)
    except zenoh.ZError:
        raise address.wrong("a key expression of zenoh", "zenoh:robot/arm/**") from None
