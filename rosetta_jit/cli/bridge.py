"""`rosetta-jit bridge`: routes between channels of middlewares, as a file describes them."""

from __future__ import annotations

import argparse
import gc
import json
import os
import signal
import sys
import threading
from contextlib import suppress
from typing import TYPE_CHECKING, Any, TextIO

from rosetta_jit.cli.arguments import Commands, add_command
from rosetta_jit.diagnostics import to_json

if TYPE_CHECKING:
    from rosetta_jit.bridge.configuration import Configuration
    from rosetta_jit.bridge.metrics import MetricsServer

CLEAR = "\x1b[H\x1b[J"
SWITCH_S = 0.0005
"""How long the thread that counts and prints holds up those that carry messages; Python's own 5 ms are a hundred times a latency."""

SLOW_S = 10.0
"""How often the table is printed where it cannot be drawn over."""


def add(commands: Commands) -> None:
    """Declare the arguments."""
    command = add_command(commands, "bridge", "Run routes between channels of middlewares: YARP, ROS, RSB, sockets and others.", run)
    command.add_argument("file", metavar="FILE", help="the routes, in TOML: docs/bridges.md")
    command.add_argument("--check", action="store_true", help="say what the file means, or what is wrong with it, and run nothing")
    command.add_argument("--json", action="store_true", help="one JSON object a line: counts of all routes, or what --check finds")
    command.add_argument("--quiet", action="store_true", help="no table; what is lost is still said on stderr")
    command.add_argument("--seconds", type=float, metavar="N", help="stop after so many seconds")


def run(arguments: argparse.Namespace) -> int:
    """Exit code 1 if the file is wrong, or not everything could be printed; else 0 when the bridge has been stopped."""
    from rosetta_jit.bridge.checking import checked
    from rosetta_jit.errors import BridgeError

    try:
        configuration = checked(arguments.file)
    except BridgeError as error:
        if not arguments.json:
            raise
        print(json.dumps({"file": arguments.file, "diagnostics": [to_json(each) for each in error.diagnostics]}))
        return 1
    return _explain(configuration, arguments) if arguments.check else _Session(configuration, arguments).run()


def _explain(configuration: Configuration, arguments: argparse.Namespace) -> int:
    from rosetta_jit.bridge.checking import explained, lines
    from rosetta_jit.terminal import printable

    if arguments.json:
        print(json.dumps({"file": arguments.file, "diagnostics": [], "routes": explained(configuration)}))
    else:
        print("\n".join(map(printable, lines(configuration))))
    return 0


def _call_all_old() -> None:
    """What the bridge consists of is there to stay: no search for garbage looks through it while messages wait."""
    gc.collect()
    gc.freeze()


class _Output:
    """A stream for people. Messages go on where it takes nothing: its disk is full, it is closed, or its reader has ended."""

    def __init__(self, stream: TextIO | None) -> None:
        self.stream = stream
        self.problem = ""

    def print(self, text: str) -> None:
        """Print lines, if they can be printed."""
        if self.stream is None:
            return
        try:
            print(text, file=self.stream, flush=True)
        except (OSError, ValueError) as error:
            self.problem = getattr(error, "strerror", None) or str(error)

    def end(self) -> None:
        """Leave nothing for Python to fail at when it ends."""
        if self.problem and self.stream is not None:
            with suppress(OSError, ValueError):
                os.dup2(os.open(os.devnull, os.O_WRONLY), self.stream.fileno())


class _Terminal:
    """The terminal in which the program was started, if there is one."""

    def __init__(self) -> None:
        streams = (sys.stdin, sys.stdout, sys.stderr)
        self._numbers = [each.fileno() for each in streams if each is not None and each.isatty() and _controls(each.fileno())]

    @property
    def is_gone(self) -> bool:
        """Whether it has been closed since."""
        return bool(self._numbers) and not any(map(_controls, self._numbers))


def _controls(number: int) -> bool:
    """Whether a file is the terminal that sends signals to this process."""
    try:
        os.tcgetpgrp(number)
    except OSError:
        return False
    return True


def _printed_to(configuration: Configuration) -> TextIO | None:
    """Where the table goes: not among the messages of a route whose target is standard output."""
    return sys.stderr if any(each.target.partition("?")[0] == "pipe:-" for each in configuration.routes) else sys.stdout


class _Session:
    """A bridge that runs until it is told to stop."""

    def __init__(self, configuration: Configuration, arguments: argparse.Namespace) -> None:
        from rosetta_jit.bridge.running import Running

        self._configuration, self._arguments = configuration, arguments
        self._over = self._changed = False
        self._signalled = threading.Event()
        self._bridge = Running(configuration, self._say)
        self._out, self._errors = _Output(_printed_to(configuration)), _Output(sys.stderr)
        self._terminal = _Terminal()
        self._draws = self._out.stream is not None and self._out.stream.isatty() and not arguments.json and not arguments.quiet
        self._said: list[str] = []
        self._line = threading.Lock()
        self._metrics: MetricsServer | None = None

    def run(self) -> int:
        self._listen_to_signals()
        self._serve_metrics(None)
        before = sys.getswitchinterval()
        sys.setswitchinterval(SWITCH_S)
        try:
            self._bridge.start()
            _call_all_old()
            self._watch()
        finally:
            self._bridge.stop()
            if self._metrics is not None:
                self._metrics.close()
            sys.setswitchinterval(before)
            self._show(self._bridge.snapshot())
        return self._ended()

    def _ended(self) -> int:
        """The exit code: 1 where what was asked for could not be printed."""
        problem = self._out.problem
        if problem:
            self._errors.print(f"error: not everything could be printed: {problem}")
        for each in (self._out, self._errors):
            each.end()
        return 1 if problem and not self._terminal.is_gone else 0

    def _serve_metrics(self, before: str | None) -> None:
        """Serve metrics where the file says, if that is another place than before."""
        from rosetta_jit.bridge.metrics import MetricsServer

        place = self._configuration.metrics
        if place == before:
            return
        old, self._metrics = self._metrics, None if place is None else MetricsServer(place, self._bridge.snapshot)
        if old is not None:
            old.close()

    def _listen_to_signals(self) -> None:
        if threading.current_thread() is not threading.main_thread():
            return
        for each in (signal.SIGINT, signal.SIGTERM):
            signal.signal(each, self._stop)
        if hasattr(signal, "SIGHUP"):
            signal.signal(signal.SIGHUP, self._read_again)

    def _stop(self, *_: object) -> None:
        self._over = True
        self._signalled.set()

    def _read_again(self, *_: object) -> None:
        if self._terminal.is_gone:  # its end is told by the same signal
            self._over = True
        self._changed = True
        self._signalled.set()

    def _watch(self) -> None:
        from time import monotonic

        end = float("inf") if self._arguments.seconds is None else monotonic() + self._arguments.seconds
        due = monotonic() + self._interval_s
        while not self._over and monotonic() < end:
            self._signalled.wait(max(0.0, min(due, end) - monotonic()))  # seldom: this thread holds up those that carry messages
            self._signalled.clear()
            if self._changed and not self._over:
                self._changed = False
                self._reload()
            if monotonic() >= due:
                due = monotonic() + self._interval_s
                self._show(self._bridge.snapshot())

    @property
    def _interval_s(self) -> float:
        return self._configuration.interval_s if self._draws or self._arguments.json else SLOW_S

    def _reload(self) -> None:
        from rosetta_jit.bridge.checking import checked
        from rosetta_jit.errors import RosettaError

        before = self._configuration.metrics
        try:
            configuration = checked(self._configuration.path)
            self._bridge.reload(configuration)
        except (RosettaError, OSError) as error:
            self._say(f"the file cannot be used, and all goes on as before:\n{error}")
            return
        self._configuration, self._out.stream = configuration, _printed_to(configuration)
        _call_all_old()
        self._say("the file was read again")
        try:
            self._serve_metrics(before)
        except RosettaError as error:
            self._say(str(error))

    def _show(self, snapshot: list[dict[str, Any]]) -> None:
        if self._arguments.json:
            self._out.print(json.dumps({"routes": snapshot}))
        elif not self._arguments.quiet:
            from rosetta_jit.bridge.table import rows

            with self._line:
                above = [*self._said[-8:], ""] if self._draws and self._said else []
                self._out.print((CLEAR if self._draws else "") + "\n".join([*rows(snapshot), *above]))

    def _say(self, text: str) -> None:
        from rosetta_jit.terminal import printable

        with self._line:
            lines = [printable(each) for each in text.splitlines()]
            self._said = [*self._said, *lines][-100:]
            if not self._draws:
                self._errors.print("\n".join(lines))
