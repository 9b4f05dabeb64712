"""What turns the messages of a route into others."""

from __future__ import annotations

import json
import math
import threading
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

    from rosetta_jit.api.bridges import Bridge
    from rosetta_jit.bridge.configuration import Translation

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


def state_of(translate: Translate | None) -> dict[str, float | str]:
    """The state of a translation; empty where it keeps none."""
    return translate.state() if isinstance(translate, Stateful) else {}


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
