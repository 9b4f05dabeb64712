"""How holders serialise themselves, where their manners have methods that do."""

from __future__ import annotations

from copy import deepcopy
from typing import Any, Protocol

from rosetta_jit.errors import RosettaError
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
    return programs_of(message).encode(deepcopy(message) if isinstance(message, View) else message)
