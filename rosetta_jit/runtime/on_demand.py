"""Programs that are compiled on demand: messages of CDR's other byte order are rare, and the first one that arrives has its program made.

The compiled kernel of a program that leaves such messages to another one looks for that one's kernel where it has failed itself
(`backends/entry/on_demand.ll`). Until it is there, the message comes to the slow path, which makes it.
"""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Literal

from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from rosetta_jit.runtime.code.native import Library
    from rosetta_jit.runtime.run import Sites


class Place:
    """Where the code of a program looks for the other one's kernel. It lives as long as that code, and so does what it refers to.

    That is the other program's code, and whatever else the program was ``prepared`` with.

    Attributes
    ----------
    sites
        Where the other one's kernel can fail; None until it is made.
    """

    def __init__(self, address: int, prepared: object) -> None:
        self._kernel, self._prepared = ctypes.c_int64.from_address(address), prepared
        self._libraries: list[Library] = []
        self.sites: Sites | None = None

    def take(self, library: Library, sites: Sites) -> None:
        """Let the other program go on from now on. Threads may come here at once: what they have made is the same, and all of it stays."""
        self._libraries.append(library)
        self.sites = sites
        self._kernel.value = library["kernel"]


@dataclass(frozen=True, slots=True)
class OnDemand:
    """A program's knowledge of the one that is made on demand.

    Attributes
    ----------
    opening
        The bytes with which those messages begin that are left to it, and no others.
    byte_order
        What it is asked for with.
    name
        The name of the program that leaves them, which says what it was made from.
    """

    opening: bytes
    byte_order: Literal["little", "big"]
    name: str
    library: Library

    @classmethod
    def of(cls, header: Mapping[str, Any], library: Library) -> OnDemand:
        """From the header of a program that leaves messages to another one. It has the program's name, too."""
        opening, byte_order = header["rare"]
        return cls(bytes.fromhex(opening), byte_order, header["name"], library)

    @property
    def place(self) -> Place:
        """The place at which the code finds the other program's kernel."""
        place = self.library.prepared
        assert isinstance(place, Place)
        return place

    def is_for_other(self, data: NDArray[np.uint8], begin: int, end: int) -> bool:
        """Whether a message is one of those that are left to the other program."""
        opening = self.opening
        return data[begin : min(end, begin + len(opening))].tobytes() == opening
