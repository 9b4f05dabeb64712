"""A service of one middleware that is answered by a service of another."""

from __future__ import annotations

from time import perf_counter_ns
from typing import TYPE_CHECKING

from rosetta_jit.bridge.counting import RouteCounts
from rosetta_jit.errors import MessageError, TransportError
from rosetta_jit.transports.base import Message
from rosetta_jit.transports.calls import ANSWER_FAILED, Caller, Server

if TYPE_CHECKING:
    from rosetta_jit.bridge.configuration import Rpc
    from rosetta_jit.bridge.live import Say
    from rosetta_jit.bridge.translating import Translator


class LiveService:
    """One such service while it runs; attributes as of `rosetta_jit.bridge.live.LiveRoute`."""

    waiting = 0

    def __init__(self, rpc: Rpc, request: Translator, reply: Translator, say: Say) -> None:
        self.route = rpc
        self.counts = RouteCounts()
        self.problem = "not open yet"
        self.server: Server | None = None
        self.request, self.reply = request, reply
        self.caller: Caller | None = None
        self._say = say

    def open(self, caller: Caller) -> None:
        """The service that answers is there."""
        self.caller = caller
        self.problem = ""

    @property
    def state(self) -> dict[str, float | str]:
        """What the mappings of requests and of replies keep from one message to the next."""
        sides = (("request", self.request), ("reply", self.reply))
        return {f"{side}.{name}": value for side, translate in sides for name, value in translate.state().items()}

    def answer(self, message: Message) -> bytes:
        """Ask the other service, and return its answer. An error goes back to the caller."""
        begun, counts = perf_counter_ns(), self.counts
        counts.taken += 1
        counts.bytes_in += len(message.data)
        try:
            data = self.request(message.data)
            assert data is not None
            assert self.caller is not None
            reply = self.reply(self.caller(data, timeout=self.route.timeout_s).data)
            assert reply is not None
        except (MessageError, TransportError) as error:
            if counts.fail(f"{error.kind}: {error.detail}"):
                self._say(f"{self.route.name}: {error}")
            raise
        counts.sent += 1
        counts.bytes_out += len(reply)
        counts.latencies.add(perf_counter_ns() - begun)
        return bytes(reply)

    def lost(self, reason: str, count: int) -> None:
        """Count questions that never came to `answer`."""
        if reason != ANSWER_FAILED and (line := self.counts.lose(reason, count)):
            self._say(f"{self.route.name}: {line}")

    def close(self, linger_s: float = 0.0) -> None:
        """Stop answering."""
        del linger_s
        if self.server is not None:
            self.server.close()
        if self.caller is not None:
            self.caller.close()
        self.problem = self.problem or "closed"
