"""Holders that behave as the Python classes that lcm-gen writes do, so that code written against those keeps working.

What differs, and why: arrays of numbers are numpy arrays, and those of fixed sizes have all their dimensions; an enum is its number, not an
object with a ``value``; fields that tell a size must agree with their arrays, which lcm-gen cuts; bytes behind a message are refused; what
cannot be decoded raises `rosetta_jit.errors.DecodeError`, a ValueError that says where; and messages are equal if their fields are.
"""

from __future__ import annotations

from functools import cache
from typing import Any, ClassVar, Self

import numpy as np

from rosetta_jit.frameworks.lcm.fingerprint import fingerprint
from rosetta_jit.frameworks.lcm.shape import shape_of
from rosetta_jit.runtime.holder import PLAIN, Family, Holder, Manners
from rosetta_jit.runtime.holder.serialising import Programs, encoded, programs_of


class LcmMessage(Holder):
    """A message of a struct that LCM's IDL declares. Its constants are attributes of the class.

    Attributes
    ----------
    __slots__ : list of str
        The names of its fields.
    __typenames__ : list of str
        Their types, without sizes.
    __dimensions__ : list
        Their sizes: None for one value, else a list of numbers and names of fields.
    """

    __slots__ = ()

    programs_: ClassVar[Programs | None] = None

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        cls.__slots__ = tuple(each.name for each in cls.family_.struct.fields)  # read by people's code only, once a class is made

    def encode(self) -> bytes:
        """The message's bytes.

        Raises
        ------
        EncodeError
            If a size does not agree with its array.
        """
        return encoded(self)

    @classmethod
    def decode(cls, data: Any) -> Self:
        """A new message of bytes, or of what a file has left.

        Raises
        ------
        DecodeError
            If they are no message of the type. It is a ValueError.
        """
        programs = programs_of(cls.family_.holder)
        message: Self = programs.new()
        programs.decode(data.read() if hasattr(data, "read") else data, message)
        return message

    @classmethod
    def get_hash(cls) -> int:
        """The fingerprint of the type."""
        return _hash(cls.family_)

    @classmethod
    def _get_packed_fingerprint(cls) -> bytes:
        """The fingerprint, as messages begin with it."""
        return _hash(cls.family_).to_bytes(8, "big")


@cache
def _hash(family: Family) -> int:
    return fingerprint(family.struct, family.schema)


def members(family: Family) -> dict[str, Any]:
    """What a class has besides its fields: constants, and the words and sizes of the fields."""
    shapes = [shape_of(each) for each in family.struct.fields]
    constants = {each.name: each.value for each in family.struct.constants if not _taken(each.name)}
    typenames = [each.type for each in shapes]
    return {**constants, "__typenames__": typenames, "__dimensions__": [list(each.sizes) or None for each in shapes]}


def _taken(name: str) -> bool:
    """Whether Python or the holder need a name for themselves."""
    return name.startswith("__") or (name.strip("_") != name and hasattr(LcmMessage, name))


LCM_GEN = Manners(
    LcmMessage,
    np.ndarray,
    PLAIN.sequence,
    PLAIN.mapping,
    assigns_whole=True,
    members=members,
    serialising=("lcm", "lcm"),
    foreign="rosetta_jit.frameworks.lcm.objects:OBJECTS",
    place="rosetta_jit.frameworks.lcm.manners:LCM_GEN",
    methods=lambda _: {"encode": "encode", "decode": "make"},
)
"""The manners of lcm-gen's classes."""
