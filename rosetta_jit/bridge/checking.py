"""Checks a bridge's file without running it: whether its addresses and mappings are right, and what each route does."""

from __future__ import annotations

import json
from collections.abc import Iterator
from importlib.util import find_spec
from typing import Any

from rosetta_jit.bridge.announcing import announced
from rosetta_jit.bridge.configuration import Configuration, Route, Rpc, Translation, read
from rosetta_jit.bridge.patterns import is_pattern
from rosetta_jit.bridge.translating import Translator, Unchanged, differences, translator, translator_of
from rosetta_jit.catalogue import bridge as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.errors import AddressError, BridgeError, RosettaError
from rosetta_jit.source import Span
from rosetta_jit.transports.address import Address, parse, settle
from rosetta_jit.transports.base import Transport
from rosetta_jit.transports.installed import installed
from rosetta_jit.transports.opening import COMMON


def checked(path: str) -> Configuration:
    """A file in which nothing is wrong.

    Raises
    ------
    BridgeError
        With all that is wrong in it.
    """
    configuration = read(path)
    found = mistakes(configuration)
    if found:
        raise BridgeError(tuple(found))
    return configuration


def mistakes(configuration: Configuration) -> list[Diagnostic]:
    """What is wrong with addresses and mappings. Nothing is opened; mappings are compiled, or found in the cache."""
    found: list[Diagnostic] = []
    spans = configuration.spans
    for route in configuration.routes:
        here = ("route", route.number)
        source = spans.of(*here, "sources" if route.sources else "source")
        addresses = [address for _, address in route.sources] or [route.source]
        for transport in [_checked(each, "subscribe", source, found, is_open=is_pattern(each)) for each in addresses]:
            if transport is not None and is_pattern(route.source) and not transport.names:
                found.append(words.cannot_list(source, transport.name))
            if transport is not None and route.full == "block" and "pipe" not in transport.schemes:
                found.append(words.cannot_wait(spans.of(*here, "full"), transport.name))
        key = "call" if route.calls else "target"
        direction = "call" if route.calls else "publish"
        target = _checked(route.target, direction, spans.of(*here, key), found, is_open=is_pattern(route.source))
        translate = _compiled(route, route.translation, configuration, here, found)
        if target is not None and not route.calls and _lacks_type(route.target, target) and not announced(route.target, translate):
            found.append(words.no_type(spans.of(*here, key), target.name, target.options["type"].meaning))
    for rpc in configuration.rpcs:
        here = ("rpc", rpc.number)
        _checked(rpc.serve, "serve", spans.of(*here, "serve"), found)
        _checked(rpc.call, "call", spans.of(*here, "call"), found)
        _compiled(None, rpc.request, configuration, (*here, "request"), found)
        _compiled(None, rpc.reply, configuration, (*here, "reply"), found)
    return found


def _checked(text: str, direction: str, span: Span, found: list[Diagnostic], *, is_open: bool = False) -> Transport | None:
    """The transport of an address, which ``is_open`` where a pattern completes it; None and a report where it has none that can do that."""
    known = installed()
    try:
        address = parse(text, known)
        transport = known[address.scheme]
        settle(address, {**COMMON, **transport.options}, {})
    except AddressError as error:
        found += (words.bad_address(span, text, each.message, each.help) for each in error.diagnostics)
        return None
    extra, module = transport.extra
    if not getattr(transport, direction):
        found.append(
            words.bad_address(span, text, f"{transport.name} cannot {direction}", f"another transport, such as {_example(direction)}")
        )
    elif module and find_spec(module) is None:
        found.append(words.bad_address(span, text, f"{transport.name} takes a package", f"pip install 'rosetta-jit[{extra}]'"))
    elif transport.check and not is_open:
        found += _misplaced(address, transport, span)
    return transport


def _misplaced(address: Address, transport: Transport, span: Span) -> Iterator[Diagnostic]:
    """The mistake in the channel that an address names; None where there is none."""
    try:
        transport.function("check")(address)
    except AddressError as error:
        for each in error.diagnostics:
            yield words.bad_address(span, address.text, each.message, each.help)


def _lacks_type(text: str, transport: Transport) -> bool:
    """Whether who is sent to must be told a type, and is not."""
    option = transport.options.get("type")  # `*` is for subscribers, who take any
    return option is not None and option.default in ("", "*") and "type" not in parse(text, installed()).options


def _example(direction: str) -> str:
    return next(each.example for each in installed().values() if getattr(each, direction))


def _compiled(
    route: Route | None, translation: Translation, configuration: Configuration, here: tuple[str | int, ...], found: list[Diagnostic]
) -> Translator:
    """Compile what a route, or one direction of a service, has for messages; where that is wrong, nothing is known of it."""
    try:
        return translator(translation, configuration.search_path) if route is None else translator_of(route, configuration.search_path)
    except (RosettaError, TypeError, ValueError) as error:
        arguments: dict[str, Any] = json.loads(translation.text)
        keys = [key for key in ("decode_mapping", "encode_mapping", "decode_type", "encode_type", "between") if key in arguments]
        path = (*here, "mapping") if keys[:1] == ["decode_mapping"] else (*here, *keys[:1])
        found.append(words.bad_mapping(configuration.spans.of(*path), str(error)))
        return Unchanged()


def explained(configuration: Configuration) -> list[dict[str, Any]]:
    """Each route as plain data: from where to where, by what, and what happens to messages that are too many."""
    routes = [_explained_route(each, configuration.search_path) for each in configuration.routes]
    return [*routes, *(_explained_rpc(each, configuration.search_path) for each in configuration.rpcs)]


def _explained_route(route: Route, search_path: tuple[str, ...]) -> dict[str, Any]:
    return {
        "route": route.name,
        "from": route.source,
        "sources": dict(route.sources),
        "on": route.on,
        "to": route.target,
        "by": _by(route.translation),
        "differences": [] if route.sources else list(differences(route.translation, search_path)),
        "asks": route.calls,
        "rate": route.rate,
        "queue": route.queue,
        "full": route.full,
    }


def _explained_rpc(rpc: Rpc, search_path: tuple[str, ...]) -> dict[str, Any]:
    return {
        "route": rpc.name,
        "from": rpc.serve,
        "to": rpc.call,
        "by": _by(rpc.request),
        "back": _by(rpc.reply),
        "differences": [*differences(rpc.request, search_path), *differences(rpc.reply, search_path)],
        "timeout_s": rpc.timeout_s,
    }


def _by(translation: Translation) -> str:
    if not translation.text:
        return "as they are"
    arguments: dict[str, Any] = json.loads(translation.text)
    if "between" in arguments:
        return " to ".join(map(str, arguments["between"]))
    sides = (("decode", "read"), ("encode", "write"))
    parts: list[str] = []
    for side, verb in sides:
        what = arguments.get(f"{side}_mapping") or arguments.get(f"{side}_type") or "the data-holder as it is"
        encoding = arguments.get(side, {}).get("encoding")
        parts.append(f"{verb} {what}{f' ({encoding})' if encoding else ''}")
    return ", ".join(parts)


def lines(configuration: Configuration) -> list[str]:
    """The same for people."""
    shown: list[str] = []
    for each in explained(configuration):
        shown.append(each["route"])
        shown += [f"  from {address} ({wire})" for wire, address in each.get("sources", {}).items()] or [f"  from {each['from']}"]
        shown.append(f"  to   {each['to']}{' (a service, asked with each message)' if each.get('asks') else ''}")
        shown.append(f"  by   {each['by']}")
        if "back" in each:
            shown.append(f"  back {each['back']}, within {each['timeout_s']:g} s")
        shown += [f"       {line}" for line in each["differences"]]
        if "queue" in each:
            rate = f"at most {each['rate']:g} a second, " if each["rate"] else ""
            if each["sources"]:
                shown.append(f"       behind messages of {each['on'] or 'any of them'}, once all have come")
            full = {"oldest": "the oldest is dropped", "newest": "new ones are dropped", "block": "the source waits"}[each["full"]]
            shown.append(f"       {rate}{each['queue']} wait for the target; when that many do, {full}")
    return shown
