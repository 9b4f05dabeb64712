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

    def decode_into(self, data: Any, holder: Any, *, merge: bool) -> None:
        """Fill a holder from bytes, or add to what it has."""
        ...


def programs_of(message: Any) -> Programs:
    """The programs of a message's class.

    Raises
    ------
    RosettaError
        None have been compiled in this process.
    """
    if message.programs_ is None:
        raise RosettaError(f"no decoder or encoder of {message.family_.struct.name} has been compiled")
    return message.programs_


def encoded(message: Any) -> bytes:
    """The bytes of a message, also of one that is part of another.

    Raises
    ------
    EncodeError
        If it cannot be written.
    """
    return programs_of(message).encode(deepcopy(message) if isinstance(message, View) else message)
