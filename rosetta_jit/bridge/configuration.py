"""The file of a bridge: what may stand in it, and what is wrong with it.

    [bridge]      metrics search_path interval
    [[route]]     name source | sources, on; target | call, reply, mapping…, rate, queue, full
    [[rpc]]       name serve call, request, reply

A mapping is what `rosetta_jit.Bridge` takes: `decode_mapping`, `encode_mapping` or types in place of them, `decode` and `encode` with their
options, or `between` for messages that describe themselves. Without one, bytes pass as they are. With `sources` it has several wires.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal, cast

from rosetta_jit.bridge.limits import MAX_QUEUE
from rosetta_jit.bridge.toml_spans import TomlSpans, place_of_syntax
from rosetta_jit.catalogue import bridge as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.errors import BridgeError
from rosetta_jit.source import Source
from rosetta_jit.startup.dataclass import dataclass

LEAST, MOST = 1e-6, 1e9

Full = Literal["oldest", "newest", "block"]
FULL: tuple[Full, ...] = ("oldest", "newest", "block")
QUEUE = 100

TRANSLATION = ("mapping", "decode_mapping", "encode_mapping", "decode_type", "encode_type", "decode", "encode", "between")
KINDS: dict[str, tuple[type | tuple[type, ...], str]] = {
    "name": (str, "a text"),
    "source": (str, "the address of a channel"),
    "sources": (dict, 'addresses by the names of wires: { pose = "ros1:/pose", velocity = "ros1:/twist" }'),
    "on": (str, "the name of a wire"),
    "target": (str, "the address of a channel"),
    "call": (str, "the address of a service"),
    "serve": (str, "the address of a service"),
    "rate": ((int, float), f"a number of messages a second, from {LEAST:g} to {MOST:g}"),
    "queue": (int, f"a number of messages, from 1 to {MAX_QUEUE}"),
    "timeout": ((int, float), f"a number of seconds, from {LEAST:g} to {MOST:g}"),
    "full": (str, '"oldest", "newest" or "block"'),
    "mapping": (str, "the name of a mapping"),
    "decode_mapping": (str, "the name of a mapping"),
    "encode_mapping": (str, "the name of a mapping"),
    "decode_type": (str, "the name of a type"),
    "encode_type": (str, "the name of a type"),
    "decode": (dict, 'options: { encoding = "yarp3" }'),
    "encode": (dict, 'options: { encoding = "cdr" }'),
    "between": (list, 'two encodings: ["yarp3", "yarp4"]'),
    "request": (dict, "the mapping of requests"),
    "reply": ((dict, str), "the mapping of replies"),
    "metrics": (str, 'a place such as "127.0.0.1:9464"'),
    "interval": ((int, float), f"a number of seconds, from {LEAST:g} to {MOST:g}"),
    "search_path": (list, "a list of folders"),
}
"""What values may be, by key."""

RANGES = {"rate": (LEAST, MOST), "timeout": (LEAST, MOST), "interval": (LEAST, MOST), "queue": (1, MAX_QUEUE)}
"""The least and the most that numbers may be; infinity and what is no number are not between."""

PLACE = re.compile(r"(?:[^\s:/]*:|\[[0-9A-Fa-f:.]+\]:)?(\d{1,5})")
ROUTE = ("name", "source", "sources", "on", "target", "call", "timeout", "rate", "queue", "full", *TRANSLATION)
RPC = ("name", "serve", "call", "timeout", "request", "reply")


@dataclass(frozen=True, slots=True)
class Translation:
    """How messages become others: the arguments of `rosetta_jit.Bridge`, as JSON so that two can be compared. Empty: as they are."""

    text: str = ""


@dataclass(frozen=True, slots=True)
class Route:
    """Messages from one channel to another, or to a service.

    ``number`` is its place among the routes of the file. Where ``calls``, the target is a service, which each message asks. A route that
    joins messages of several wires has ``sources``, the address of each, and goes on behind messages of the wire ``on``, or of all.
    """

    name: str
    source: str
    target: str
    translation: Translation
    number: int
    calls: bool = False
    timeout_s: float = 5.0
    rate: float | None = None
    queue: int = QUEUE
    full: Full = "oldest"
    sources: tuple[tuple[str, str], ...] = ()
    on: str = ""


@dataclass(frozen=True, slots=True)
class Rpc:
    """A service of one middleware that answers by a service of another."""

    name: str
    serve: str
    call: str
    request: Translation
    reply: Translation
    number: int
    timeout_s: float = 5.0


@dataclass(frozen=True, slots=True)
class Configuration:
    """A file of a bridge."""

    path: str
    routes: tuple[Route, ...]
    rpcs: tuple[Rpc, ...]
    metrics: str | None
    interval_s: float
    search_path: tuple[str, ...]
    spans: TomlSpans


def read(path: str) -> Configuration:
    """Read a file.

    Raises
    ------
    BridgeError
        With all that is wrong in it, but for addresses and mappings: see `rosetta_jit.bridge.checking`.
    OSError
        It cannot be read.
    """
    source = Source(path, Path(path).read_text("utf-8", "replace"))
    try:
        plain = tomllib.loads(source.text)
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise BridgeError((words.no_toml(place_of_syntax(source, str(error)), str(error)),)) from None
    reading = _Reading(TomlSpans(source), [])
    configuration = reading.configuration(path, plain)
    if reading.problems:
        raise BridgeError(tuple(reading.problems))
    return configuration


@dataclass(slots=True)
class _Reading:
    spans: TomlSpans
    problems: list[Diagnostic]

    def configuration(self, path: str, plain: Mapping[str, Any]) -> Configuration:
        self.known(plain, ("bridge", "route", "rpc"), "the file", ())
        settings = self.table(plain.get("bridge", {}), ("bridge",))
        self.known(settings, ("metrics", "interval", "search_path"), "[bridge]", ("bridge",))
        routes = [self.route(each, number) for number, each in enumerate(self.tables(plain, "route"))]
        rpcs = [self.rpc(each, number) for number, each in enumerate(self.tables(plain, "rpc"))]
        if not routes and not rpcs and not self.problems:
            self.problems.append(words.no_routes(self.spans.of()))
        seen: set[str] = set()
        for kind, each in (*(("route", each) for each in routes), *(("rpc", each) for each in rpcs)):
            if each.name in seen:
                self.problems.append(words.name_twice(self.spans.of(kind, each.number, "name"), each.name))
            seen.add(each.name)
        folders, interval = self.sound(settings, "search_path", ()), self.sound(settings, "interval", 1.0)
        search_path = (str(Path(path).resolve().parent), *folders)
        return Configuration(path, tuple(routes), tuple(rpcs), settings.get("metrics"), float(interval), search_path, self.spans)

    def sound(self, table: Mapping[str, Any], key: str, default: Any) -> Any:
        """The value of a key; its default where it is wrong, which has been noted."""
        return table[key] if key in table and _takes(key, table[key]) else default

    def tables(self, plain: Mapping[str, Any], key: str) -> list[dict[str, Any]]:
        value = plain.get(key, [])
        if not isinstance(value, list) or not all(isinstance(each, dict) for each in cast("list[Any]", value)):
            self.problems.append(words.bad_value(self.spans.of(key), key, f"written as [[{key}]]"))
            return []
        return cast("list[dict[str, Any]]", value)

    def table(self, value: object, place: tuple[str | int, ...]) -> dict[str, Any]:
        if not isinstance(value, dict):
            self.problems.append(words.bad_value(self.spans.of(*place), str(place[-1]), f"written as [{place[-1]}]"))
            return {}
        return cast("dict[str, Any]", value)

    def known(self, table: Mapping[str, Any], keys: tuple[str, ...], where: str, place: tuple[str | int, ...]) -> None:
        """Note keys that mean nothing, and values of another kind."""
        for key, value in table.items():
            if key not in keys:
                self.problems.append(words.unknown_key(self.spans.of(*place, key), key, where, keys))
            elif key in KINDS and not _takes(key, value):
                self.problems.append(words.bad_value(self.spans.of(*place, key), key, KINDS[key][1]))

    def route(self, table: dict[str, Any], number: int) -> Route:
        place = ("route", number)
        before = len(self.problems)
        self.known(table, ROUTE, "a route", place)
        if ("source" in table) == ("sources" in table) or ("target" in table) == ("call" in table):
            needed = "one of `source` and `sources`, or one of `target` and `call`"
            self.problems.append(words.missing_key(self.spans.of(*place), "this route", needed))
        sources = self.sources(table, place) if len(self.problems) == before else ()
        if len(self.problems) > before:
            return Route(str(table.get("name", number)), "", "", Translation(), number)
        source = " + ".join(address for _, address in sources) or str(table["source"])
        target = str(table.get("target") or table.get("call"))
        if source == target:
            self.problems.append(words.same_address(self.spans.of(*place, "target"), source))
        return Route(
            name=str(table.get("name") or f"{source} > {target}"),
            source=source,
            target=target,
            translation=self.translation(table, place),
            number=number,
            calls="call" in table,
            timeout_s=float(table.get("timeout", 5.0)),
            rate=float(table["rate"]) if "rate" in table else None,
            queue=int(table.get("queue", QUEUE)),
            full=cast("Full", table.get("full", "oldest")),
            sources=sources,
            on=str(table.get("on", "")),
        )

    def sources(self, table: dict[str, Any], place: tuple[str | int, ...]) -> tuple[tuple[str, str], ...]:
        """The address of each wire of a route that joins several."""
        addresses = cast("dict[str, object]", table.get("sources", {}))
        if "sources" in table and (not addresses or not all(isinstance(each, str) and "*" not in each for each in addresses.values())):
            self.problems.append(words.bad_value(self.spans.of(*place, "sources"), "sources", KINDS["sources"][1]))
        if addresses and not ("mapping" in table or "decode_mapping" in table):
            self.problems.append(words.missing_key(self.spans.of(*place, "sources"), "this route", "a `mapping` of several wires"))
        if "on" in table and table["on"] not in addresses:
            self.problems.append(words.bad_value(self.spans.of(*place, "on"), "on", "one of the names in `sources`"))
        return tuple((wire, str(address)) for wire, address in addresses.items())

    def rpc(self, table: dict[str, Any], number: int) -> Rpc:
        place = ("rpc", number)
        before = len(self.problems)
        self.known(table, RPC, "an rpc", place)
        if "serve" not in table or "call" not in table:
            self.problems.append(words.missing_key(self.spans.of(*place), "this rpc", "`serve` or `call`"))
        if len(self.problems) > before:
            return Rpc(str(table.get("name", number)), "", "", Translation(), Translation(), number)
        serve, call = str(table["serve"]), str(table["call"])
        request, reply = (self.table(table.get(key, {}), (*place, key)) for key in ("request", "reply"))
        self.known(request, TRANSLATION, "a request", (*place, "request"))
        self.known(reply, TRANSLATION, "a reply", (*place, "reply"))
        translations = self.translation(request, place), self.translation(reply, place)
        return Rpc(str(table.get("name") or f"{serve} > {call}"), serve, call, *translations, number, float(table.get("timeout", 5.0)))

    def translation(self, table: Mapping[str, Any], place: tuple[str | int, ...]) -> Translation:
        import json

        arguments = {key: table[key] for key in TRANSLATION if key in table}
        ways = (
            ("mapping", "decode_mapping", "decode_type"),
            ("decode_mapping", "decode_type"),
            ("encode_mapping", "encode_type"),
            ("between", *(key for key in TRANSLATION if key != "between")),
        )
        for one, other in [(one, other) for one, *others in ways for other in others if {one, other} <= arguments.keys()]:
            self.problems.append(words.two_ways(self.spans.of(*place, other), one, other))
        if "mapping" in arguments:
            arguments["decode_mapping"] = arguments.pop("mapping")
        return Translation(json.dumps(arguments, sort_keys=True, default=str) if arguments else "")


def _takes(key: str, value: Any) -> bool:
    """Whether a key may have a value."""
    if not isinstance(value, KINDS[key][0]) or isinstance(value, bool):
        return False
    match key:
        case "full":
            return value in FULL
        case "between":
            return len(value) == 2 and all(isinstance(each, str) for each in value)
        case "search_path":
            return all(isinstance(each, str) for each in value)
        case "metrics":
            found = PLACE.fullmatch(value)
            return found is not None and int(found[1]) < 65536
        case _:
            least, most = RANGES.get(key, (None, None))
            return least is None or most is None or least <= value <= most
