"""A port: it listens, is registered, connects and is connected, and does so again when a peer or the name server comes back."""

from __future__ import annotations

import os
import socket
import threading
from collections import deque
from collections.abc import Callable, Mapping
from contextlib import suppress
from itertools import count
from typing import TYPE_CHECKING, Any

from rosetta_jit.errors import TransportError
from rosetta_jit.transports.base import Message
from rosetta_jit.transports.connecting import Listener, resolve
from rosetta_jit.transports.conversation import Conversation, connected
from rosetta_jit.transports.end import End
from rosetta_jit.transports.feeding import ProtocolError
from rosetta_jit.transports.limits import MAX_CONNECTING, MAX_CONNECTIONS, MAX_DATAGRAM_INPUTS, MAX_OUTPUTS
from rosetta_jit.transports.loop import loop
from rosetta_jit.transports.stream import Stream
from rosetta_jit.transports.yarp.admin import ask_port, leave, quoted, words_of
from rosetta_jit.transports.yarp.incoming import Line, incoming
from rosetta_jit.transports.yarp.incoming_datagrams import DatagramInput, receiving
from rosetta_jit.transports.yarp.names import NAME, Contact, NameServer
from rosetta_jit.transports.yarp.outgoing import Output
from rosetta_jit.transports.yarp.outgoing_datagrams import DatagramOutput, Group, greeted_by_mcast, greeted_by_udp
from rosetta_jit.transports.yarp.wire import CARRIERS, CONNECTIONLESS

if TYPE_CHECKING:
    from rosetta_jit.transports.yarp.incoming import Reply

SOON_S = 0.5
"""Between two attempts to make a connection that is missing."""

HEARTBEAT_S = 3.0
"""How often a port looks whether the name server still knows it."""

CONNECT_S = 2.0
LEAVE_S = 0.5

_NUMBERS = count(1)


def own_name(options: Mapping[str, Any], about: str) -> str:
    """The name of a port that nobody named."""
    return options["name"] or f"/rosetta_jit{about}/{os.getpid()}.{next(_NUMBERS)}"


class Port:
    """One port in the loop, with a thread that talks to the name server and to other ports' administration.

    Parameters
    ----------
    counts
        Of the source, sink or server that it belongs to.
    take
        Gets messages; None where it only writes.
    asked
        Gets questions; None where it does not answer.
    reads, writes
        Ports whose output it asks for, and to which it connects.
    """

    def __init__(
        self,
        name: str,
        names: NameServer,
        options: Mapping[str, Any],
        counts: End,
        *,
        take: Callable[[Message], object] | None = None,
        asked: Callable[[Message, Reply], object] | None = None,
        reads: str = "",
        writes: str = "",
    ) -> None:
        self.name = name
        self.most: int = options["max_message"]
        self.dialect: str = options["dialect"]
        self.answers = asked is not None
        self.outputs: dict[str, Output | DatagramOutput] = {}
        self._names, self._host, self._carrier, self._counts = names, options["host"], options["carrier"], counts
        self._take, self._answer = take, asked
        self._reads, self._writes = reads, writes
        self._inputs: dict[Stream | DatagramInput, tuple[str, str]] = {}
        self._groups: dict[str, Group] = {}
        self._streams: set[Stream] = set()
        self._seen: set[str] = set()
        self._tasks: deque[Callable[[], object]] = deque()
        self._nudge = threading.Event()
        self._stopped = False
        self._listener = Listener(resolve(self._host, 0)[0], self._accepted)
        self.number = self._listener.port
        try:
            self._register()
        except TransportError:
            if not options["patient"]:
                self._listener.close()
                raise
        self._thread = threading.Thread(target=self._control, name=f"yarp {name}", daemon=True)
        self._thread.start()

    def close(self, linger: float) -> None:
        """Say goodbye to readers, ask writers to disconnect, and unregister."""
        self._stopped = True
        self._nudge.set()
        if self._thread is not threading.current_thread():
            self._thread.join(linger + CONNECT_S)
        for each in tuple(self.outputs.values()):
            if not loop().is_current:
                each.wait(linger, empty=True)
            self._counts.lose("closed before it was sent", left) if (left := each.close(linger)) else None
            if isinstance(each, DatagramOutput):
                leave(each.contact, self.name, LEAVE_S)
        for sender in {sender for sender, _ in tuple(self._inputs.values()) if NAME.fullmatch(sender)}:
            with suppress(TransportError):
                if contact := self._names.query(sender):
                    ask_port(contact, f"[del] {quoted(self.name)}", 0.5)
        self._listener.close()
        for line in {*self._streams, *self._inputs}:
            line.finish(min(linger, 0.5))
        for group in self._groups.values():
            group.sender.close()
            with suppress(TransportError):
                self._names.unregister(group.contact.name)
        with suppress(TransportError):
            found = self._names.query(self.name)
            if found is not None and found.port == self.number:
                self._names.unregister(self.name)

    # what connections tell

    def came(self, line: Line | DatagramInput, sender: str, carrier: str) -> None:
        """A writer said hello."""
        assert isinstance(line, Stream | DatagramInput)
        self._inputs[line] = sender, carrier
        if sender in self._seen:
            self._counts.reconnects += 1
        elif len(self._seen) < MAX_CONNECTIONS:
            self._seen.add(sender)
        self._count()

    def receive(self, line: Line, sender: str, group: tuple[str, int] | None) -> int:
        """A writer said hello, and will send datagrams; gives the number of the port at which they are received.

        Raises
        ------
        ProtocolError
            It named a group that is none, or that cannot be joined.
        """
        assert isinstance(line, Stream)
        carrier = "udp" if group is None else "mcast"
        for each in [each for each, who in self._inputs.items() if isinstance(each, DatagramInput) and who == (sender, carrier)]:
            each.end()  # it begins anew without a goodbye
        known = [each for each in self._inputs if isinstance(each, DatagramInput)]
        if len(known) >= MAX_DATAGRAM_INPUTS:
            min(known, key=lambda each: each.heard).end("too many writers by udp, and this one was silent")
        host = line.socket.getpeername()[0]
        made = DatagramInput(self, self._counts, receiving(line.socket, group), (sender, carrier, host), self._input_gone)
        self.came(made, sender, carrier)
        return made.number

    def take(self, message: Message) -> None:
        """A message came."""
        if self._take is not None:
            self._take(message)

    def asked(self, message: Message, reply: Reply) -> None:
        """A question came."""
        if self._answer is not None:
            self._answer(message, reply)

    def administer(self, command: str, answer: Callable[[str], object]) -> None:
        """Obey a command of `yarp connect` and its like; connecting takes a while, and is done by the port's own thread."""
        words = words_of(command)
        match words:
            case ["[ver]"]:
                answer("[ver] 1 2 3")
            case ["[list]", "[in]"]:
                answer(" ".join(quoted(sender) for sender, _ in self._inputs.values()))
            case ["[list]", "[out]"]:
                answer(" ".join(quoted(each) for each in self.outputs))
            case ["[list]", "[in]", other]:
                found = next((carrier for sender, carrier in self._inputs.values() if sender == other), "")
                answer(f"(from {quoted(other)}) (to {quoted(self.name)}) (carrier {found})" if found else "")
            case ["[list]", "[out]", other]:
                output = self.outputs.get(other)
                remark = " (connectionless 1)" if isinstance(output, DatagramOutput) else ""
                answer(f"(from {quoted(self.name)}) (to {quoted(other)}) (carrier {output.carrier}){remark}" if output else "")
            case ["[add]", other, *carrier]:
                if len(self._tasks) < MAX_CONNECTING:
                    self._soon(lambda: answer(self._add(other, *carrier[:1])))
                else:
                    answer(f"-1 {quoted('This port is busy')}")
            case ["[del]", other]:
                answer(f"0 {quoted(self.disconnect(other))}" if self._knows(other) else f"-1 {quoted(self.disconnect(other))}")
            case _:
                answer('[fail] "send [ver], [list], [add] or [del]"')

    def disconnect(self, other: str) -> str:
        """End the connections to and from a port; gives what a person reads."""
        output = self.outputs.pop(other, None)
        inputs = [stream for stream, (sender, _) in self._inputs.items() if sender == other]
        for stream in inputs:
            stream.finish(1.0)
        if output is not None:
            if self._writes == other:
                self._writes = ""
            output.close(1.0)
            if isinstance(output, DatagramOutput):
                contact = output.contact
                self._soon(lambda: leave(contact, self.name, LEAVE_S))
        if inputs:
            return f"Removing connection from {other} to {self.name}"
        return f"Removed connection from {self.name} to {other}" if output else f"Could not find a connection with {other}"

    def connect(self, target: str, carrier: str) -> str:
        """Connect to a reader; empty, or why it failed. Not in the loop's thread."""
        if target in self.outputs:
            return ""
        if len(self.outputs) >= MAX_OUTPUTS:
            return f"more than {MAX_OUTPUTS} connections"
        contact = self._names.query(target)
        if contact is None or contact.type == "mcast":
            return f"Do not know how to connect to {target}"
        try:
            sock = connected(contact.host, contact.port, CONNECT_S)
        except OSError as error:
            return f"Cannot connect to {target}: {error.strerror or error}"
        if carrier in CONNECTIONLESS:
            try:
                self._connected(target, self._by_datagrams(Conversation.over(sock, CONNECT_S), contact, carrier))
            except (OSError, ValueError, ProtocolError) as error:
                return f"Cannot connect to {target} by {carrier}: {error}"
            return ""
        output = Output(self.name, target, carrier)

        def gone(_: Stream, __: str) -> None:
            self._output_gone(output)

        output.stream = Stream(sock, output.machine, gone)
        self._connected(target, output)
        loop().run(output.stream.start)
        return ""

    # within

    def _connected(self, target: str, output: Output | DatagramOutput) -> None:
        self.outputs[target] = output
        if target in self._seen:
            self._counts.reconnects += 1
        self._seen.add(target)
        self._count()

    def _by_datagrams(self, sock: socket.socket, contact: Contact, carrier: str) -> DatagramOutput:
        def gone() -> None:
            output = self.outputs.get(contact.name)
            if isinstance(output, DatagramOutput):
                self._output_gone(output)

        with sock:
            if carrier == "udp":
                return DatagramOutput(contact, greeted_by_udp(sock, self.name, gone))
            here = sock.getsockname()[0]
            if here not in self._groups:
                found = self._names.register_group(self.name)
                if found is None:
                    raise ProtocolError("the name server gives no group")
                self._groups[here] = Group(found, here)
            greeted_by_mcast(sock, self.name, self._groups[here])
            return DatagramOutput(contact, self._groups[here])

    def _knows(self, other: str) -> bool:
        return other in self.outputs or any(sender == other for sender, _ in self._inputs.values())

    def _add(self, other: str, carrier: str = "") -> str:
        way, _, name = other.rpartition(":/") if ":/" in other else (carrier or "tcp", "", other)
        if self._take is not None or self._answer is not None:
            return f"-1 {quoted('This port only receives')}"
        if way not in CARRIERS:
            return f"-1 {quoted(f'This port does not know the carrier {way[:20]}')}"
        if not NAME.fullmatch(name):
            return f"-1 {quoted('That is no name of a port')}"
        try:
            why = self.connect(name, way)
        except TransportError as error:
            why = error.detail
        return f"-1 {quoted(why)}" if why else f"0 {quoted(f'Added connection from {self.name} to {other}')}"

    def _accepted(self, sock: socket.socket) -> None:
        if len(self._streams) >= MAX_CONNECTIONS or self._stopped:
            sock.close()
            return
        stream = Stream(sock, lambda line: incoming(self, line), self._input_gone)
        self._streams.add(stream)
        stream.start()

    def _input_gone(self, stream: Stream | DatagramInput, why: str) -> None:
        if isinstance(stream, Stream):
            self._streams.discard(stream)
        known = self._inputs.pop(stream, None)
        if why or (known is not None and stream.cut):
            self._counts.lose(why or "the connection ended in the middle of a message")
        self._count()
        self._nudge.set()

    def _output_gone(self, output: Output | DatagramOutput) -> None:
        if self.outputs.get(output.target) is output:
            del self.outputs[output.target]
        left = output.gone()
        if left and not self._stopped:
            self._counts.lose("the reader went away", left)
        self._count()
        self._nudge.set()

    def _count(self) -> None:
        self._counts.connections = len(self._inputs) + len(self.outputs)

    def _soon(self, task: Callable[[], object]) -> None:
        self._tasks.append(task)
        self._nudge.set()

    def _register(self) -> None:
        known = self._names.query(self.name)
        if known is not None and known.port != self.number and _listens(known):
            raise TransportError("taken", self.name, f"another port has this name, at {known.host}:{known.port}")
        if known is None or (known.host, known.port) != (self._host, self.number):
            self._names.register(self.name, self._host, self.number)

    def _control(self) -> None:
        pause = 0.0
        while not self._stopped:
            self._nudge.wait(pause)
            self._nudge.clear()
            while self._tasks and not self._stopped:
                self._tasks.popleft()()
            if self._stopped:
                return
            is_whole = False
            with suppress(TransportError):
                self._register()
                is_whole = self._make_connections()
            pause = HEARTBEAT_S if is_whole else SOON_S

    def _make_connections(self) -> bool:
        """Make what is missing; whether nothing is."""
        for output in tuple(self.outputs.values()):
            if isinstance(output, DatagramOutput) and self._names.query(output.target) != output.contact:
                loop().run(self._output_gone, output)  # the reader was started anew, elsewhere
        if self._writes and self._writes not in self.outputs and self.connect(self._writes, self._carrier):
            return False
        reading = [line for line, (sender, _) in tuple(self._inputs.items()) if sender == self._reads]
        if not self._reads or any(isinstance(line, Stream) for line in reading):
            return True
        contact = self._names.query(self._reads)
        if reading and contact is not None and self._is_written_by(contact):
            return True
        for line in reading:  # the writer has died without a goodbye
            loop().run(line.end)
        if contact is not None:
            ask_port(contact, f"[add] {quoted(f'{self._carrier}:/{self.name}')}", CONNECT_S)
        return False

    def _is_written_by(self, contact: Contact) -> bool:
        """Whether a writer by datagrams is still there, and knows of it."""
        try:
            return bool(ask_port(contact, f"[list] [out] {quoted(self.name)}", CONNECT_S).strip())
        except TransportError:
            return False


def _listens(contact: Contact) -> bool:
    """Whether a registered port is alive, or was left behind."""
    try:
        connected(contact.host, contact.port, 0.5).close()
    except OSError:
        return False
    return True
