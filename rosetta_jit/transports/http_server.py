"""An HTTP server for short questions, which peers cannot keep busy: one question a connection, of bounded time and number."""

from __future__ import annotations

import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

from rosetta_jit.transports.conversation import Conversation

ANSWER_S = 5.0
"""How long one question may take, from its first byte to the end of the answer."""


class QuestionServer(ThreadingHTTPServer):
    """Answers each question in a thread of its own."""

    daemon_threads = True

    def __init__(self, place: tuple[str, int], handler: type[Handler], most: int) -> None:
        """Listen; ``most`` is how many questions are answered at the same time."""
        self._room = threading.BoundedSemaphore(most)
        super().__init__(place, handler)

    def get_request(self) -> tuple[Any, Any]:
        """The next connection, for one question."""
        sock, place = super().get_request()
        return Conversation.over(sock, ANSWER_S), place

    def process_request(self, request: Any, client_address: Any) -> None:
        """Answer in a thread of its own, unless too many ask at the same time; then hang up."""
        if self._room.acquire(blocking=False):
            super().process_request(request, client_address)
        else:
            self.shutdown_request(request)

    def process_request_thread(self, request: Any, client_address: Any) -> None:
        """Answer, in that thread."""
        try:
            super().process_request_thread(request, client_address)
        finally:
            self._room.release()

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Nothing is reported: a peer may go away before the answer has come."""


class Handler(BaseHTTPRequestHandler):
    """Reads a question and writes its answer; derived classes do so in `do_GET` or `do_POST`."""

    timeout = ANSWER_S

    def answer(self, content_type: str, body: bytes) -> None:
        """Write an answer that is no error."""
        self.send_response(200)
        self.send_header("Content-Type", content_type)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, format: str, *args: object) -> None:  # noqa: A002 - http.server's name
        """Say nothing: some peers ask every few seconds."""
