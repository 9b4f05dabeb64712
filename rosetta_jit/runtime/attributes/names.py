"""Attributes of a class by the addresses of their names, for compiled code (`holders/calling.ll`), which need not ask all classes above."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from typing import Any

import numpy as np

from rosetta_jit.runtime.attributes.code import HEAP_TYPE_BYTES, library
from rosetta_jit.runtime.callable import is_native
from rosetta_jit.runtime.type_specs import address_of, read_word, write_word

GETATTRO = 144
"""Where in a class stands what reads attributes: of PyTypeObject, Include/cpython/object.h."""

NAMES_AT = HEAP_TYPE_BYTES + 8
"""Where behind it stands the address of its names."""


class Names:
    """The attributes of a class: of each the name, the addresses of what reads and what writes it, and what these are given."""

    __slots__ = ("_names", "_table")

    def __init__(self, attributes: Mapping[str, tuple[int, int, int]]) -> None:
        self._names = {sys.intern(name): words for name, words in attributes.items()}
        places = 1 << (2 * len(attributes)).bit_length()
        table = np.zeros(1 + 4 * places, np.int64)
        table[0] = places - 1
        rows = table[1:].reshape(places, 4)
        for name, words in self._names.items():
            number = (id(name) >> 4) % places
            while rows[number, 0]:
                number = (number + 1) % places
            rows[number] = id(name), *words
        self._table = table

    def __contains__(self, name: str) -> bool:
        return name in self._names

    def give(self, holder_type: Any, *, reads: bool) -> None:
        """Let a class, which must not outlive them, write its attributes through them; and read them, if ``reads`` is set.

        Where compiled code reads them, CPython takes a little longer to find methods, and members.
        """
        code = library()
        assert code is not None, "there is code that reads them"
        write_word(id(holder_type) + NAMES_AT, self._table.ctypes.data)
        if reads and read_word(id(holder_type) + GETATTRO) == address_of("PyObject_GenericGetAttr"):
            write_word(id(holder_type) + GETATTRO, code["get_attribute"])


def take_names(holder_type: type, changed: str) -> None:
    """Let CPython look up the attributes of a class, and of those derived from it, if somebody changes one of them."""
    attributes: Any = getattr(holder_type, "_attributes", None)
    if is_native() and attributes is not None and changed in attributes[2]:
        for each in (holder_type, *holder_type.__subclasses__()):
            write_word(id(each) + NAMES_AT, 0)
