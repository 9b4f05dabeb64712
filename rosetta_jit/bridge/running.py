"""A bridge that runs: opens what its file says, tries again what cannot be opened yet, changes to another file while it runs, and stops."""

from __future__ import annotations

import threading
from collections.abc import Callable, Collection
from concurrent.futures import ThreadPoolExecutor, wait
from typing import TYPE_CHECKING, Any

from rosetta_jit.bridge.announcing import announced, served, wanted
from rosetta_jit.bridge.configuration import Configuration, Route, Rpc
from rosetta_jit.bridge.limits import MAX_CLOSING, MAX_FOUND, MAX_OPENING
from rosetta_jit.bridge.live import LINGER_S, Inlet, LiveRoute
from rosetta_jit.bridge.patterns import is_pattern, matching, place_to_list
from rosetta_jit.bridge.services import LiveService
from rosetta_jit.bridge.translating import translator, translator_of
from rosetta_jit.errors import RosettaError
from rosetta_jit.startup.dataclass import replace
from rosetta_jit.transports.base import Message, Source
from rosetta_jit.transports.end import End
from rosetta_jit.transports.opening import call, names, publish, serve, subscribe

if TYPE_CHECKING:
    from rosetta_jit.transports.base import Bytes

    Live = LiveRoute | LiveService
    Key = tuple[str, tuple[tuple[str, str], ...]]
    """Of a source: its address, and the options that are not in it."""

RETRY_S = 1.0
"""How long after a channel could not be opened it is tried again, and after which channels are listed again."""

FIRST_S = 1.0
"""How long the start waits for what is opened at once; the rest follows."""


class _Shared:
    """One source, for all routes from its address.

    Where all of its peers were gone and one came again, the mappings of its routes begin anew: differences, filters and sequence numbers
    of what was sent before mean nothing for what comes now.
    """

    source: Source | None = None

    def __init__(self, first: LiveRoute | Inlet) -> None:
        self.routes: tuple[LiveRoute | Inlet, ...] = (first,)
        self._sessions = 1

    def opened(self, source: Source) -> None:
        self.source = source
        self.bring_to(*self.routes)

    def bring_to(self, *routes: LiveRoute | Inlet) -> None:
        """Bring messages to these routes from now on; straight to a single one that keeps nothing, as it need not begin anew."""
        self.routes = routes
        if self.source is not None:
            self.source.plain = routes[0].deliver if len(routes) == 1 and not routes[0].keeps else self.deliver

    def take(self, message: Message) -> None:
        """Take one that came before the source was known."""
        self.deliver(message.data, message.sent or message.time)

    def deliver(self, data: Bytes, time: int) -> None:
        if self.source is not None and self.source.sessions > self._sessions:
            self._sessions = self.source.sessions
            for route in self.routes:
                route.begin_anew()
        for route in self.routes:
            route.deliver(data, time)

    def close(self) -> None:
        if self.source is not None:
            self.source.close()

    def lost(self, reason: str, count: int) -> None:
        for route in self.routes:
            route.lost(f"before it came here: {reason}", count)


class Running:
    """A bridge while it runs.

    Parameters
    ----------
    say
        Takes lines for people: what was lost, what cannot be opened.
    """

    def __init__(self, configuration: Configuration, say: Callable[[str], object]) -> None:
        self.configuration = configuration
        self.live: dict[str, Live] = {}
        self._say = say
        self._sources: dict[Key, _Shared] = {}
        self._lock = threading.RLock()
        self._stopping = threading.Event()
        self._patterns: set[str] = set()
        self._trying: set[str] = set()
        self._pool = ThreadPoolExecutor(MAX_OPENING, "opens routes")
        self._opener = threading.Thread(target=self._keep_open, name="opens routes", daemon=True)

    def start(self) -> None:
        """Open all that can be opened, and go on with the rest in the background.

        Raises
        ------
        ReportError
            A mapping cannot be compiled.
        """
        self._change(self.configuration)
        self._open_all(FIRST_S)
        self._opener.start()

    def reload(self, configuration: Configuration) -> None:
        """Close routes that are gone or were changed, and open those that are new; the others go on.

        Raises
        ------
        ReportError
            A mapping cannot be compiled; everything goes on as before.
        """
        self._change(configuration)
        self._open_all(FIRST_S)

    def stop(self, linger_s: float = LINGER_S) -> None:
        """Take nothing more, send what was taken, and close."""
        self._stopping.set()
        with self._lock:
            for shared in self._sources.values():
                shared.close()
            self._sources.clear()
            _close(self.live.values(), linger_s)
        self._pool.shutdown(wait=False, cancel_futures=True)
        if self._opener.is_alive():
            self._opener.join(2 * RETRY_S)

    def snapshot(self) -> list[dict[str, Any]]:
        """Each route with its counts."""
        return [self._shown(name, each) for name, each in tuple(self.live.items())]

    def _shown(self, name: str, each: Live) -> dict[str, Any]:
        source, target = self._ends_of(each)
        ends = {end: counts for end, counts in (("source", source), ("target", target)) if counts is not None}
        return {
            "route": name,
            **_ends(each),
            "problem": each.problem,
            "waiting": each.waiting,
            "connections": {end: counts.connections for end, counts in ends.items()},
            "reconnects": {end: counts.reconnects for end, counts in ends.items()},
            **each.counts.snapshot(),
            "state": dict(each.state),
        }

    def _ends_of(self, each: Live) -> tuple[End | None, End | None]:
        if isinstance(each, LiveService):
            return each.server, each.caller
        source = next(
            (shared.source for shared in tuple(self._sources.values()) if any(inlet.live is each for inlet in shared.routes)), None
        )
        return source, each.target

    # --- which routes there are ----------------------------------------------------------------------------------------

    def _change(self, configuration: Configuration) -> None:
        wanted = {each.name: each for each in (*configuration.routes, *configuration.rpcs)}
        folders = configuration.search_path
        with self._lock:
            same_folders = folders == self.configuration.search_path
            kept = {name for name, each in self.live.items() if same_folders and _is_same(each.route, wanted, name)}
            made = {name: self._made(each, folders) for name, each in wanted.items() if name not in kept and not _is_pattern(each)}
            self.configuration = configuration
            gone = [self.live.pop(name) for name in [*self.live] if name not in kept]
            for each in gone:
                self._forget(each)
            _close(gone, LINGER_S)
            self._patterns.clear()
            self.live.update(made)

    def _made(self, route: Route | Rpc, folders: tuple[str, ...]) -> Live:
        if isinstance(route, Route):
            return LiveRoute(route, translator_of(route, folders), self._say)
        return LiveService(route, translator(route.request, folders), translator(route.reply, folders), self._say)

    def _forget(self, gone: Live) -> None:
        """Bring a route no more messages; where it was the last one of its source, close that."""
        with self._lock:
            for key, shared in [*self._sources.items()]:
                left = tuple(each for each in shared.routes if each.live is not gone)
                shared.bring_to(*left)
                if not left:
                    shared.close()
                    del self._sources[key]

    # --- opening -------------------------------------------------------------------------------------------------------

    def _keep_open(self) -> None:
        while not self._stopping.wait(RETRY_S):
            self._open_all()

    def _open_all(self, wait_s: float = 0.0) -> None:
        """Try to open what is not open, side by side: a peer that does not answer holds up its own routes alone."""
        with self._lock:
            if self._stopping.is_set():
                return
            closed: dict[str, list[tuple[str, Live]]] = {}
            for name, each in self.live.items():
                if each.problem and each.problem != "closed":
                    closed.setdefault(each.route.source if isinstance(each, LiveRoute) else name, []).append((name, each))
            begun = [self._pool.submit(self._try_all, key, routes) for key, routes in closed.items() if key not in self._trying]
            patterns = {f"pattern {each.name}": each for each in self.configuration.routes if _is_pattern(each)}
            begun += [self._pool.submit(self._look_for, key, each) for key, each in patterns.items() if key not in self._trying]
            self._trying |= closed.keys() | patterns.keys()
        wait(begun, wait_s)

    def _try_all(self, key: str, routes: list[tuple[str, Live]]) -> None:
        """Try to open the routes of one source, one after the other."""
        try:
            for name, each in routes:
                self._try(name, each)
        finally:
            self._trying.discard(key)

    def _look_for(self, key: str, route: Route) -> None:
        """Make routes of the channels that a pattern finds."""
        try:
            found = [*matching(route, [name for name, _ in names(place_to_list(route.source))])]
            self._patterns.discard(route.name)
            self._add(route, [each for each in found[:MAX_FOUND] if each.name not in self.live])
        except RosettaError as error:
            if route.name not in self._patterns:
                self._say(f"{route.name}: {error}")
                self._patterns.add(route.name)
        finally:
            self._trying.discard(key)

    def _add(self, pattern: Route, found: list[Route]) -> None:
        made = {each.name: self._made(each, self.configuration.search_path) for each in found}
        with self._lock:
            if pattern in self.configuration.routes and not self._stopping.is_set():
                self.live.update(made)
        if made:
            self._open_all()

    def _try(self, name: str, each: Live) -> None:
        try:
            if isinstance(each, LiveRoute):
                self._open_route(each)
            else:
                each.open(call(each.route.call, **announced(each.route.call, each.request)))
                each.server = serve(each.route.serve, each.answer, lost=each.lost, **served(each.route.serve, each.request, each.reply))
        except RosettaError as error:
            if each.problem != str(error):
                self._say(f"{name}: {error}")
            each.problem = str(error)
        with self._lock:
            is_gone = self.live.get(name) is not each or self._stopping.is_set()
        if is_gone:  # while it was being opened
            self._forget(each)
            each.close(0.0)

    def _open_route(self, each: LiveRoute) -> None:
        route = each.route
        if each.target is None:
            if route.calls:
                each.open(None, call(route.target, **announced(route.target, each.translate)))
            else:
                each.open(publish(route.target, lost=each.lost, **announced(route.target, each.translate)), None)
        self._listen(each)
        each.problem = ""

    def _listen(self, each: LiveRoute) -> None:
        """Let its source bring its messages to this route, too; or those of all wires."""
        inlets = [(address, Inlet(each, wire)) for wire, address in each.route.sources]
        for address, inlet in inlets or [(each.route.source, each)]:
            options = wanted(address, each.translate)
            key = address, tuple(sorted(options.items()))
            if not self._joins(key, inlet):
                shared = _Shared(inlet)
                shared.opened(subscribe(address, shared.take, lost=shared.lost, **options))
                with self._lock:
                    first = self._sources.setdefault(key, shared)
                if first is not shared:  # another route was quicker
                    shared.close()
                    self._joins(key, inlet)

    def _joins(self, key: Key, inlet: LiveRoute | Inlet) -> bool:
        """Whether there is such a source already: it then brings its messages to this inlet, too."""
        with self._lock:
            shared = self._sources.get(key)
            if shared is None:
                return False
            if not any(known.live is inlet.live and known.wire == inlet.wire for known in shared.routes):
                shared.bring_to(*shared.routes, inlet)
            return True


def _close(routes: Collection[Live], linger_s: float) -> None:
    """Close routes side by side: a target that takes nothing holds up its own route alone."""
    if routes:
        with ThreadPoolExecutor(min(len(routes), MAX_CLOSING), "closes routes") as pool:
            for done in [pool.submit(each.close, linger_s) for each in routes]:
                done.result()


def _is_pattern(route: Route | Rpc) -> bool:
    return isinstance(route, Route) and is_pattern(route.source)


def _is_same(old: Route | Rpc, wanted: dict[str, Any], name: str) -> bool:
    """Whether a route stands in the file as it was, wherever it stands there."""
    new = wanted.get(name)
    return new is not None and type(new) is type(old) and replace(new, number=old.number) == old


def _ends(each: Live) -> dict[str, str]:
    route = each.route
    return {"from": route.source, "to": route.target} if isinstance(route, Route) else {"from": route.serve, "to": route.call}
