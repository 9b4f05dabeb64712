"""What turns the messages of a route into others."""

from __future__ import annotations

import json
import math
import threading
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

    from rosetta_jit.api.bridges import Bridge
    from rosetta_jit.api.programs import Encoder
    from rosetta_jit.api.wires import Decoders
    from rosetta_jit.bridge.configuration import Route, Translation

    Translate = Callable[[Any], bytes]


class Stateful:
    """A compiled bridge whose mappings keep state from one message to the next; threads take it in turn."""

    def __init__(self, bridge: Bridge) -> None:
        self.bridge = bridge
        self._turn = threading.Lock()

    def __call__(self, message: Any) -> bytes:
        """What a message becomes."""
        with self._turn:
            return self.bridge(message)

    def reset(self) -> None:
        """Let the next message be the first one."""
        with self._turn:
            self.bridge.reset()

    def state(self) -> dict[str, float | str]:
        """Each state variable by its name, `decode.` or `encode.` in front; as JSON has numbers, so that infinity and NaN are texts."""
        with self._turn:
            halves = self.bridge.state
        return {f"{half}.{name}": _shown(value) for half, variables in halves.items() for name, value in variables.items()}


class Joining:
    """What turns messages of several wires into messages of the holder that they fill; threads take it in turn."""

    def __init__(self, decoders: Decoders, encode: Encoder, on: str) -> None:
        self._decoders, self.encode, self._on = decoders, encode, on
        self._holder = decoders.new()
        self._missing = set(decoders)
        self.turn = threading.Lock()

    def take(self, wire: str, message: Any) -> bool:
        """Fill a wire's part of the holder; whether the holder is to go on. In one's `turn`."""
        self._missing.add(wire)
        self._decoders[wire](message, self._holder)
        self._missing.discard(wire)
        return not self._missing and self._on in ("", wire)

    def message(self) -> bytes:
        """The holder as the target has it. In one's `turn`."""
        return self.encode(self._holder)

    def reset(self) -> None:
        """Let the next message be the first one."""
        with self.turn:
            self._decoders.reset()
            self._holder.clear()
            self._missing = set(self._decoders)

    def state(self) -> dict[str, float | str]:
        """As of `Stateful`; and of each wire how many messages have come since its last one."""
        with self.turn:
            variables = {f"decode.{name}": _shown(value) for name, value in self._decoders.state.items()}
            ages = {f"age.{wire}": age for wire, age in self._decoders.ages.items() if age is not None}
            return {**variables, **{f"encode.{name}": _shown(value) for name, value in self.encode.state.items()}, **ages}


def state_of(translate: Translate | Joining | None) -> dict[str, float | str]:
    """The state of a translation; empty where it keeps none."""
    return translate.state() if isinstance(translate, Stateful | Joining) else {}


def _shown(value: float) -> float | str:
    return value if math.isfinite(value) else str(value)


def translator(translation: Translation, search_path: tuple[str, ...]) -> Translate | None:
    """The compiled bridge of a route, `Stateful` where its mappings keep state; None where bytes pass as they are.

    Raises
    ------
    ReportError
        The mapping, a type or an option is wrong.
    TypeError
        An option is of another kind.
    """
    if not translation.text:
        return None
    from rosetta_jit.api.bridges import Bridge

    given: dict[str, Any] = json.loads(translation.text)
    if "between" in given:
        return Bridge.between(*given["between"])
    options: dict[str, Any] = {side: {"search_path": search_path, **given.get(side, {})} for side in ("decode", "encode")}
    one, other = given.get("decode_mapping"), given.get("encode_mapping")
    if one is None and other is None and "decode_type" in given:
        return Bridge.of(given["decode_type"], given.get("encode_type"), **options)
    types = {key: given[key] for key in ("decode_type", "encode_type") if key in given}
    bridge = Bridge(one, other, **options, **types)
    return Stateful(bridge) if any(bridge.state.values()) else bridge


def translation_of(route: Route, search_path: tuple[str, ...]) -> Translate | Joining | None:
    """What turns the messages of a route into others, `Joining` where they are of several wires. Raises as `translator`."""
    if not route.sources:
        return translator(route.translation, search_path)
    from rosetta_jit.api.programs import Encoder
    from rosetta_jit.api.wires import Decoders

    given: dict[str, Any] = json.loads(route.translation.text)
    options: dict[str, Any] = {side: {"search_path": search_path, **given.get(side, {})} for side in ("decode", "encode")}
    decoders = Decoders(given["decode_mapping"], **options["decode"])
    for wire in decoders:
        if wire not in dict(route.sources):
            raise ValueError(f"`sources` has no address for wire `{wire}`")
    for wire, _ in route.sources:
        if wire not in decoders:
            raise ValueError(f"the mapping has no wire `{wire}`: its wires are {', '.join(decoders)}")
    if "encode_mapping" in given:
        return Joining(decoders, Encoder(given["encode_mapping"], **options["encode"]), route.on)
    if "encode_type" in given:
        return Joining(decoders, Encoder.of(given["encode_type"], **options["encode"]), route.on)
    return Joining(decoders, decoders.encoder(**options["encode"]), route.on)
