"""A peer: how it decodes a message, how it encodes it again, and what it leaves behind."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable


@dataclass(frozen=True, slots=True)
class Peer:
    """One way of one library.

    Attributes
    ----------
    who
        The library, and the way where it has several.
    makes
        What a decode gives: which object, whether it is made anew, and what its arrays are.
    decode
        From a message to that object.
    encode
        From that object to the same bytes; None where the library does not write.
    """

    who: str
    makes: str
    decode: Callable[[bytes], Any]
    encode: Callable[[Any], Any] | None = None
