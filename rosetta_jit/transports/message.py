"""One raw message, as sources and callers give it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


class Message:
    """One message as it came.

    Attributes
    ----------
    data : bytes or memoryview
        Its bytes. A memoryview is valid until the callback that got the message returns: see `keep`.
    channel : str
        Which channel it came over: a subscription may be for several.
    type : str or None
        The type's name, where the middleware tells it.
    time : int
        When it was received, in nanoseconds since 1970.
    sent : int or None
        When it was sent, where the middleware tells it, in nanoseconds since 1970.
    attributes : mapping
        What else the middleware tells: the envelope of YARP, event ids and causes of RSB, the attachment of zenoh.
    """

    __slots__ = ("attributes", "channel", "data", "sent", "time", "type")

    def __init__(
        self,
        data: bytes | memoryview,
        channel: str,
        type: str | None = None,  # noqa: A002 - it is what everybody calls it
        time: int = 0,
        sent: int | None = None,
        attributes: Mapping[str, Any] | None = None,
    ) -> None:
        self.data = data
        self.channel = channel
        self.type = type
        self.time = time
        self.sent = sent
        self.attributes = NOTHING if attributes is None else attributes

    def keep(self) -> Message:
        """Copy the bytes of the message, so that they stay valid; gives the message itself."""
        if not isinstance(self.data, bytes):
            self.data = bytes(self.data)
        return self

    def __repr__(self) -> str:
        return (
            f"Message({len(self.data)} bytes, {self.channel!r}, type={self.type!r}, time={self.time}, attributes={dict(self.attributes)!r})"
        )


NOTHING: Mapping[str, Any] = {}
"""The attributes of messages without any."""
