"""XML-RPC, by which nodes talk to the master and to each other: one request a connection, answers of bounded size."""

from __future__ import annotations

import http.client
import socket
import threading
import xmlrpc.client
from collections.abc import Callable, Mapping
from typing import Any, cast
from urllib.parse import urlsplit
from xml.parsers.expat import ExpatError

from rosetta_jit.errors import TransportError
from rosetta_jit.transports.conversation import conversation
from rosetta_jit.transports.http_server import Handler, QuestionServer
from rosetta_jit.transports.limits import MAX_REQUESTS, MAX_XML_BYTES

TIMEOUT_S = 5.0
"""How long a request may take, from connecting to the end of the answer."""

BAD_XML = (ExpatError, xmlrpc.client.Error, TypeError, LookupError, ArithmeticError, AttributeError, RecursionError)
"""What the standard library's XML-RPC raises where it gets none."""


def ask(uri: str, method: str, *arguments: Any) -> Any:
    """The value that a node or the master answers with.

    Raises
    ------
    TransportError
        Nothing answers there, or with a failure.
    """
    try:
        place = urlsplit(uri)
        host, port = place.hostname or "", place.port or 11311
        connection = http.client.HTTPConnection(host, port)
        connection.sock = conversation(host, port, TIMEOUT_S)
        try:
            body = xmlrpc.client.dumps(arguments, method).encode()
            connection.request("POST", place.path or "/", body, {"Content-Type": "text/xml"})
            answer = connection.getresponse().read(MAX_XML_BYTES)
        finally:
            connection.close()
        values: tuple[Any, ...] = xmlrpc.client.loads(answer)[0]
    except (OSError, http.client.HTTPException, ValueError) as error:
        raise TransportError("unreachable", uri, f"no answer: {getattr(error, 'strerror', None) or error}") from None
    except BAD_XML as error:
        raise TransportError("protocol", uri, f"no answer of a ROS node: {type(error).__name__}") from None
    match values:
        case ([1, _, value],):
            return value
        case ([code, text, _],):
            why = text[:500] if isinstance(text, str) else "without a reason"
            raise TransportError("refused", uri, f"{method} failed ({code if isinstance(code, int) else '?'}): {why}")
        case _:
            raise TransportError("protocol", uri, f"{method} is not answered as ROS does")


class _Server(QuestionServer):
    request_queue_size = 64

    def __init__(self, place: tuple[str, int], methods: Mapping[str, Callable[..., object]]) -> None:
        self.address_family = socket.AF_INET6 if ":" in place[0] else socket.AF_INET
        self.methods = methods
        super().__init__(place, _Handler, MAX_REQUESTS)


class _Handler(Handler):
    def do_POST(self) -> None:  # noqa: N802 - http.server's name
        size = self.headers.get("Content-Length", "")
        if not size.isdecimal() or int(size) > MAX_XML_BYTES:
            self.send_error(413)
            return
        try:
            arguments, method = xmlrpc.client.loads(self.rfile.read(int(size)))
            answer: Any = cast("_Server", self.server).methods[method or ""](*arguments)
        except (*BAD_XML, ValueError, OSError) as error:
            answer = [-1, type(error).__name__, 0]
        self.answer("text/xml", xmlrpc.client.dumps((answer,), methodresponse=True, allow_none=False).encode())


class Answering:
    """A server of methods, in threads of its own."""

    def __init__(self, host: str, methods: Mapping[str, Callable[..., object]]) -> None:
        try:
            self._server = _Server((host, 0), methods)
        except OSError as error:
            raise TransportError("unreachable", host, f"cannot listen there: {error.strerror or error}") from None
        self.port = int(self._server.server_address[1])
        self._thread = threading.Thread(target=self._server.serve_forever, args=(0.05,), name="ros1 xmlrpc", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Answer no more."""
        self._server.shutdown()
        self._server.server_close()
