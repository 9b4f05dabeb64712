"""What turns the messages of a route into others: nothing, one compiled bridge, or what joins the messages of several wires."""

from __future__ import annotations

import json
import math
import threading
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Literal, Protocol

if TYPE_CHECKING:
    from rosetta_jit.api.bridges import Bridge
    from rosetta_jit.api.encoder import Encoder
    from rosetta_jit.api.wires import Decoders
    from rosetta_jit.bridge.configuration import Route, Translation

    Half = Literal["decode", "encode"]


def always() -> bool:
    """The answer where there is no rate."""
    return True


class Translator(Protocol):
    """What turns the messages of a route into others. Threads may share it.

    Attributes
    ----------
    program
        What does the same to a message where the route has no rate, in one call of compiled code; None where more is to be done than that.
    keeps
        Whether anything is kept from one message to the next.
    """

    program: Callable[[Any], bytes] | None
    keeps: bool

    def __call__(self, message: Any, wire: str = "", is_due: Callable[[], bool] = always) -> bytes | memoryview | None:
        """What goes on behind a message of a wire; None where nothing does.

        Parameters
        ----------
        is_due
            Whether the route's rate lets something go on now. It is asked only where there is something.

        Raises
        ------
        MessageError
            The message is wrong, or its values do not fit the other wire.
        """
        ...

    def reset(self) -> bool:
        """Let the next message be the first one; whether anything of the ones before was kept."""
        ...

    def state(self) -> dict[str, float | str]:
        """What is kept from one message to the next, by name; as JSON has numbers, so that infinity and NaN are texts."""
        ...

    def announced(self, framework: str, half: Half) -> dict[str, str]:
        """What a transport's ends are told of the type that is read or written, as of `rosetta_jit.Bridge.announced`."""
        ...


class Unchanged:
    """Bytes pass as they are."""

    program: Callable[[Any], bytes] | None = None
    keeps = False

    def __call__(self, message: Any, wire: str = "", is_due: Callable[[], bool] = always) -> bytes | memoryview | None:
        """The message."""
        del wire
        return message if is_due() else None

    def reset(self) -> bool:
        """Nothing is kept."""
        return False

    def state(self) -> dict[str, float | str]:
        """Nothing is kept."""
        return {}

    def announced(self, framework: str, half: Half) -> dict[str, str]:
        """Nothing is known."""
        del framework, half
        return {}


class Bridged:
    """One compiled bridge. Where its mappings keep state from one message to the next, threads take it in turn."""

    def __init__(self, bridge: Bridge) -> None:
        self._bridge = bridge
        self._turn = threading.Lock() if any(bridge.state.values()) else None
        self.keeps = self._turn is not None
        self.program: Callable[[Any], bytes] | None = None if self.keeps else bridge

    def __call__(self, message: Any, wire: str = "", is_due: Callable[[], bool] = always) -> bytes | memoryview | None:
        """The translated message."""
        del wire
        if not is_due():
            return None
        if self._turn is None:
            return self._bridge(message)
        with self._turn:
            return self._bridge(message)

    def reset(self) -> bool:
        """Let the mappings begin anew."""
        if self._turn is None:
            return False
        with self._turn:
            self._bridge.reset()
        return True

    def state(self) -> dict[str, float | str]:
        """The state variables, `decode.` or `encode.` in front."""
        if self._turn is None:
            return {}
        with self._turn:
            halves = self._bridge.state
        return {name: value for half, variables in halves.items() for name, value in _shown(half, variables).items()}

    def announced(self, framework: str, half: Half) -> dict[str, str]:
        """See `rosetta_jit.Bridge.announced`."""
        return self._bridge.announced(framework, half)


class Joined:
    """Messages of several wires fill one data-holder, which goes on once each of them has come; threads take it in turn.

    Parameters
    ----------
    on
        The wire behind whose messages the data-holder goes on; empty for any of them.
    """

    program: Callable[[Any], bytes] | None = None
    keeps = True

    def __init__(self, decoders: Decoders, encode: Encoder, on: str) -> None:
        self._decoders, self._encode, self._on = decoders, encode, on
        self._holder = decoders.new()
        self._missing = set(decoders)
        self._turn = threading.Lock()

    def __call__(self, message: Any, wire: str = "", is_due: Callable[[], bool] = always) -> bytes | memoryview | None:
        """Fill the part of a wire; the whole as the target has it, where it goes on."""
        with self._turn:
            self._missing.add(wire)  # until it is filled: a message that is refused holds up the whole
            self._decoders[wire](message, self._holder)
            self._missing.discard(wire)
            goes_on = not self._missing and self._on in ("", wire) and is_due()
            return self._encode(self._holder) if goes_on else None

    def reset(self) -> bool:
        """Let all wires come again."""
        with self._turn:
            self._decoders.reset()
            self._holder.clear()
            self._missing = set(self._decoders)
        return True

    def state(self) -> dict[str, float | str]:
        """The state variables, as of `Bridged`; and of each wire how many messages have come since its last one."""
        with self._turn:
            ages = {wire: age for wire, age in self._decoders.ages.items() if age is not None}
            return {
                **_shown("decode", self._decoders.state),
                **_shown("encode", self._encode.state),
                **_shown("age", ages),
            }

    def announced(self, framework: str, half: Half) -> dict[str, str]:
        """The type that is written, alone: each wire that is read has a type of its own."""
        return self._encode.announced(framework) if half == "encode" else {}


def _shown(group: str, variables: Mapping[str, float]) -> dict[str, float | str]:
    return {f"{group}.{name}": value if math.isfinite(value) else str(value) for name, value in variables.items()}


def translator(translation: Translation, search_path: tuple[str, ...]) -> Translator:
    """What a file says of messages of one wire.

    Raises
    ------
    ReportError
        The mapping, a type or an option is wrong.
    TypeError
        An option is of another kind.
    """
    return Bridged(_bridge(json.loads(translation.text), search_path)) if translation.text else Unchanged()


def differences(translation: Translation, search_path: tuple[str, ...]) -> tuple[str, ...]:
    """See `rosetta_jit.Bridge.differences`. Raises what `translator` raises."""
    return _bridge(json.loads(translation.text), search_path).differences if translation.text else ()


def _bridge(arguments: dict[str, Any], search_path: tuple[str, ...]) -> Bridge:
    from rosetta_jit.api.bridges import Bridge

    if "between" in arguments:
        return Bridge.between(*arguments["between"])
    options = _options(arguments, search_path)
    one, other = arguments.get("decode_mapping"), arguments.get("encode_mapping")
    if one is None and other is None and "decode_type" in arguments:
        return Bridge.of(arguments["decode_type"], arguments.get("encode_type"), **options)
    types = {key: arguments[key] for key in ("decode_type", "encode_type") if key in arguments}
    return Bridge(one, other, **options, **types)


def translator_of(route: Route, search_path: tuple[str, ...]) -> Translator:
    """The translator that a file describes for a route. Raises what `translator` raises."""
    if not route.sources:
        return translator(route.translation, search_path)
    from rosetta_jit.api.encoder import Encoder
    from rosetta_jit.api.wires import Decoders

    arguments: dict[str, Any] = json.loads(route.translation.text)
    options = _options(arguments, search_path)
    decoders = Decoders(arguments["decode_mapping"], **options["decode"])
    for wire in decoders:
        if wire not in dict(route.sources):
            raise ValueError(f"`sources` has no address for wire `{wire}`")
    for wire, _ in route.sources:
        if wire not in decoders:
            raise ValueError(f"the mapping has no wire `{wire}`: its wires are {', '.join(decoders)}")
    if "encode_mapping" in arguments:
        return Joined(decoders, Encoder(arguments["encode_mapping"], **options["encode"]), route.on)
    if "encode_type" in arguments:
        return Joined(decoders, Encoder.of(arguments["encode_type"], **options["encode"]), route.on)
    return Joined(decoders, decoders.encoder(**options["encode"]), route.on)


def _options(arguments: dict[str, Any], search_path: tuple[str, ...]) -> dict[str, Any]:
    return {side: {"search_path": search_path, **arguments.get(side, {})} for side in ("decode", "encode")}
