"""Queries of zenoh as remote procedure calls: a question is a query with a payload, and its first reply the answer."""

from __future__ import annotations

from collections.abc import Mapping
from time import monotonic, time_ns
from typing import TYPE_CHECKING, Any

import zenoh

from rosetta_jit.errors import TransportError
from rosetta_jit.transports.base import Message
from rosetta_jit.transports.calls import Caller, Pending, Server
from rosetta_jit.transports.zenoh.client import message_of
from rosetta_jit.transports.zenoh.sessions import key_of, sessions

if TYPE_CHECKING:
    from rosetta_jit.transports.address import Address


class ZenohCaller(Caller):
    """Asks; any number of questions may be on their way."""

    def __init__(self, address: Address, options: Mapping[str, Any]) -> None:
        super().__init__(address, options)
        self._key = key_of(address)
        self._options = options
        self._session = sessions().enter(options, address)
        self._closed = False

    def ask(self, data: bytes | bytearray | memoryview, until: float, attributes: Mapping[str, Any]) -> Message:
        if self._closed:
            raise TransportError("closed", self.address, "this caller is closed")
        seconds = max(until - monotonic(), 0.001)
        pending = Pending()

        def take(reply: zenoh.Reply) -> None:
            if reply.ok is not None:
                pending.answer(message_of(reply.ok, reply.ok.payload.to_bytes()))
            elif reply.err is not None:
                text = reply.err.payload.to_bytes().decode("utf-8", "replace")[:2000]
                pending.fail(TransportError("refused", self.address, f"the server failed: {text}"))

        def ended() -> None:
            pending.fail(TransportError("unknown", self.address, "nobody answers this key"))

        attachment = attributes.get("attachment")
        handler = zenoh.handlers.Callback(take, ended, indirect=False)
        self._session.get(self._key, handler, payload=bytes(data), attachment=attachment, timeout=seconds)
        self.passed(len(data))
        return pending.wait(until + 0.5, self.address)

    def close(self) -> None:
        if not self._closed:
            self._closed = True
            sessions().leave(self._options)


def serve(address: Address, server: Server, options: Mapping[str, Any]) -> None:
    """Answer the queries for a key."""
    key = key_of(address)

    def take(query: zenoh.Query) -> None:
        data = b"" if query.payload is None else query.payload.to_bytes()
        attributes: dict[str, Any] = {"parameters": str(query.parameters)}
        if query.attachment is not None:
            attributes["attachment"] = query.attachment.to_bytes()

        def reply(answer: bytes | None, error: str | None) -> None:
            if error is not None:
                query.reply_err(error.encode())  # pyright: ignore[reportUnknownMemberType]
            else:
                query.reply(query.key_expr if "*" not in str(query.key_expr) else key, answer or b"")  # pyright: ignore[reportUnknownMemberType]
            query.drop()  # pyright: ignore[reportUnknownMemberType]

        server.asked(Message(data, str(query.key_expr), None, time_ns(), None, attributes), reply)

    session = sessions().enter(options, address)
    queryable = session.declare_queryable(key, take)

    def close() -> None:
        queryable.undeclare()  # pyright: ignore[reportUnknownMemberType]
        sessions().leave(options)

    server.opened(close)
