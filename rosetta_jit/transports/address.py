"""Addresses of channels: `scheme:rest?option=value&option=value`.

    yarp:/icub/torso/state:o
    rsb:/arm/left?host=localhost&port=55555
    tcp:127.0.0.1:9000?frame=u32be

The scheme names a transport, which says what the rest means and which options there are. In the rest and in values, `%3f` stands for `?`,
as in URLs.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from rosetta_jit.catalogue import transports as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.errors import AddressError
from rosetta_jit.source import Source as Text
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import dataclass

_UNITS = {"": 1, "k": 1 << 10, "m": 1 << 20, "g": 1 << 30}


@dataclass(frozen=True, slots=True)
class Option:
    """One option of a transport.

    Attributes
    ----------
    kind
        `text`, `number` (an integer of at least 0), `size` (bytes: `64M`), `seconds`, `flag` (`yes` or `no`), the words that it may be, or
        `object`, which only a call can give.
    default
        Where nobody says it.
    meaning
        For a person, one line.
    """

    kind: str | tuple[str, ...]
    default: Any
    meaning: str

    @property
    def wanted(self) -> str:
        """The values that the option takes, in words."""
        match self.kind:
            case "text":
                return "a text"
            case "number":
                return "an integer of at least 0"
            case "size":
                return "a number of bytes, such as 65536, 64k or 16M"
            case "seconds":
                return "a number of seconds of at least 0"
            case "flag":
                return "`yes` or `no`"
            case str():
                return "an object of Python, given by name in the call"
            case choices:
                return "one of " + ", ".join(f"`{each}`" for each in choices)

    def read(self, text: str) -> Any:
        """The value of a text.

        Raises
        ------
        ValueError
            It is not what the option takes.
        """
        match self.kind:
            case "text":
                return text
            case "number":
                return _at_least_0(int(text))
            case "size":
                unit = text[-1:].lower() if text[-1:].isalpha() else ""
                return _at_least_0(int(text.removesuffix(text[-1:]) if unit else text)) * _UNITS.get(unit, -1)
            case "seconds":
                return _at_least_0(float(text))
            case "flag":
                return {"yes": True, "true": True, "1": True, "no": False, "false": False, "0": False}.get(text.lower(), text)
            case _:
                return text

    def takes(self, value: object) -> bool:
        """Whether a value is one of those that it may have."""
        match self.kind:
            case "text":
                return isinstance(value, str)
            case "number" | "size":
                return isinstance(value, int) and not isinstance(value, bool) and value >= 0
            case "seconds":
                return isinstance(value, int | float) and not isinstance(value, bool) and 0 <= value < float("inf")
            case "flag":
                return isinstance(value, bool)
            case "object":
                return not isinstance(value, str)
            case _:
                return isinstance(value, str) and value in self.kind


@dataclass(frozen=True, slots=True)
class Address:
    """An address, taken apart.

    Attributes
    ----------
    text
        As it was written.
    scheme
        The transport's word, in lower case.
    rest
        Between the scheme and the options, with `%` sequences replaced.
    options
        As written, each value with its place in the text.
    """

    text: str
    scheme: str
    rest: str
    options: Mapping[str, tuple[str, Span]]

    def __str__(self) -> str:
        return self.text

    @property
    def place(self) -> Span:
        """The span of the rest, for errors."""
        start = len(self.scheme) + 1
        end = self.text.find("?")
        return Span(Text("address", self.text), start, len(self.text) if end < 0 else end)

    def wrong(self, wanted: str, example: str) -> AddressError:
        """The error that says that the rest is not what the transport needs."""
        return AddressError((words.bad_place(self.place, wanted, example),))


def parse(text: str, known: Iterable[str]) -> Address:
    """Take an address apart.

    Raises
    ------
    AddressError
        It names no transport that is ``known``, or an option stands there twice.
    """
    from urllib.parse import unquote

    source = Text("address", text)
    scheme, colon, behind = text.partition(":")
    if not colon or not scheme.replace("-", "").replace("_", "").isalnum():
        raise AddressError((words.no_scheme(Span(source, 0, max(len(text), 1)), known),))
    if scheme.lower() not in known:
        raise AddressError((words.unknown_scheme(Span(source, 0, len(scheme)), scheme, known),))
    rest, _, behind = behind.partition("?")
    options: dict[str, tuple[str, Span]] = {}
    start = len(scheme) + len(rest) + 2
    for each in behind.split("&") if behind else ():
        name, _, value = each.partition("=")
        span = Span(source, start, start + max(len(each), 1))
        if name in options:
            raise AddressError((words.option_twice(span, name),))
        options[name] = unquote(value), span
        start += len(each) + 1
    return Address(text, scheme.lower(), unquote(rest), options)


def settle(address: Address, known: Mapping[str, Option], called_with: Mapping[str, object]) -> dict[str, Any]:
    """The value of every option: as given in the call, else in the address, else its default.

    Raises
    ------
    AddressError
        All that is wrong with them at once.
    """
    wrong: list[Diagnostic] = []
    values: dict[str, Any] = {name: option.default for name, option in known.items()}
    said: dict[str, tuple[object, Span | None]] = {**address.options, **{name: (value, None) for name, value in called_with.items()}}
    for name, (value, span) in said.items():
        option = known.get(name)
        if option is None:
            wrong.append(words.unknown_option(span, name, known))
            continue
        try:
            found = option.read(value) if isinstance(value, str) else value
        except ValueError:
            found = None
        if option.takes(found):
            values[name] = found
        else:
            wrong.append(words.bad_option(span, name, option.wanted))
    if wrong:
        raise AddressError(tuple(wrong))
    return values


def _at_least_0(number: Any) -> Any:
    if number < 0:
        raise ValueError(number)
    return number
