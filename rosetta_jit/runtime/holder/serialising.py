"""How holders serialise themselves, where their manners have methods that do."""

from __future__ import annotations

from collections.abc import Mapping
from inspect import getattr_static
from typing import Any, Protocol, cast

from rosetta_jit.errors import RosettaError
from rosetta_jit.runtime.attributes.methods import Kind, method, put
from rosetta_jit.runtime.holder.message import View


class Programs(Protocol):
    """What serialises holders of one class; whoever compiles it sets it as the class's ``programs_``."""

    def encode(self, holder: Any) -> bytes:
        """The bytes of a holder."""
        ...

    def size(self, holder: Any) -> int:
        """How many they are."""
        ...

    def new(self) -> Any:
        """A holder with room for what has been decoded until now, unless that is much."""
        ...

    def decode(self, data: Any, holder: Any, /) -> object:
        """Fill a holder from bytes."""
        ...


def programs_of(message: Any) -> Programs:
    """The programs of a message, or of a class.

    Raises
    ------
    RosettaError
        None have been compiled in this process.
    """
    programs = message.programs_
    if programs is None:
        raise RosettaError(f"no decoder or encoder of {message.family_.struct.name} has been compiled")
    return programs


def encoded(message: Any) -> bytes:
    """The bytes of a message, also of one that is part of another.

    Raises
    ------
    EncodeError
        If it cannot be written.
    """
    return programs_of(message).encode(cast("Any", message).__deepcopy__({}) if isinstance(message, View) else message)


class Serialised(Protocol):
    """What holders of one class are serialised by: a family."""

    programs: Any

    @property
    def takers(self) -> Any: ...

    @property
    def making(self) -> Any: ...


def serialising_methods(base: type, kinds: Mapping[str, Kind], family: Serialised) -> dict[str, Any]:
    """The methods of a holder class, of those of its base, that compiled code does, by name."""
    return {name: _method(base, family, name, kind) for name, kind in kinds.items()}


def building_method(base: type, family: Serialised) -> Any:
    """The method of a holder class that makes a holder of plain values, of which compiled code does those that are a dict of all fields."""
    found = getattr_static(base, "from_dict")

    def bind(made: Any) -> None:
        steps = family.takers.steps_of(dict)
        if steps is not None and steps.covers:
            put(made, needed=steps, program=steps.table)
            family.making.offer_soon()

    return method("build", found.__func__, bind)


def _method(base: type, family: Serialised, name: str, kind: Kind) -> Any:
    found = getattr_static(base, name)
    direction = "encode" if kind in ("encode", "write") else "decode"

    def bind(made: Any) -> None:
        program: Any = getattr(family.programs, "__dict__", {}).get(direction)
        if program is not None:
            put(made, needed="write" if kind == "write" else getattr(program, "new", None), program=program)

    return method(kind, getattr(found, "__func__", found), bind)
