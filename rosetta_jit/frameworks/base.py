"""What a framework is: IDLs, encodings, and the manners of its holders, each named by where it is found and imported when it is used."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING, Protocol, cast

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rosetta_jit.frontend.idl import FrontEnd
    from rosetta_jit.model.types import Schema, Struct
    from rosetta_jit.runtime.holder import Manners
    from rosetta_jit.wire.codec import Encoding

GROUP = "rosetta_jit.frameworks"
"""The entry-point group in which packages offer frameworks of their own: a `Framework` each."""


class Encoder(Protocol):
    """A function from a struct to its bytes' description."""

    def __call__(self, struct: Struct, schema: Schema, name: str) -> Encoding:
        """The encoding of that name of a struct."""
        ...


@dataclass(frozen=True, slots=True)
class Framework:
    """One framework; every implementation as ``module:name``.

    Attributes
    ----------
    idl
        Front ends by the suffix of the files that they read.
    encodings
        By name; the first is the one that decoders use where none is named.
    manners
        Of its holders; empty for plain ones.
    """

    name: str
    idl: Mapping[str, str]
    encodings: Mapping[str, str]
    manners: str = ""

    def encoding(self, name: str) -> Encoder:
        """The encoding of a name."""
        return cast("Encoder", _found(self.encodings[name]))


def front_ends(frameworks: Mapping[str, Framework]) -> dict[str, FrontEnd]:
    """All front ends by suffix, each imported when it is first called."""
    return {suffix: _lazy(place) for framework in frameworks.values() for suffix, place in framework.idl.items()}


def manners_of(place: str) -> Manners:
    """The manners at a place, plain ones for none."""
    if not place:
        from rosetta_jit.runtime.holder import PLAIN

        return PLAIN
    return cast("Manners", _found(place))


@cache
def installed() -> Mapping[str, Framework]:
    """Every framework by name: ours, and those of installed packages."""
    from importlib.metadata import entry_points  # slow to import, and a warm start needs none

    from rosetta_jit.frameworks.table import FRAMEWORKS

    offered = [cast("Framework", each.load()) for each in entry_points(group=GROUP)]
    return {framework.name: framework for framework in (*FRAMEWORKS, *offered)}


def _lazy(place: str) -> FrontEnd:
    def parse(*arguments: object) -> Schema:
        return cast("FrontEnd", _found(place))(*arguments)  # pyright: ignore[reportArgumentType] - passed on as they are

    return parse


def _found(place: str) -> object:
    module, _, name = place.partition(":")
    return getattr(import_module(module), name)
