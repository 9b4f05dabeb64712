"""Sequences that compiled code reads: their classes, and the class of their iterators.

An object of such a class has the address of its place at 16. What is not common is left to the methods of the Python class.
"""

from __future__ import annotations

from functools import cache
from typing import Any

from rosetta_jit.runtime.attributes.code import functions, library
from rosetta_jit.runtime.callable import is_native
from rosetta_jit.runtime.type_specs import (
    BASETYPE,
    DEFAULT,
    MP_SUBSCRIPT,
    SQ_LENGTH,
    TP_DEALLOC,
    TP_ITER,
    TP_ITERNEXT,
    from_spec,
    write_word,
)

PLACE, SEQUENCE_BYTES, ITERATOR_BYTES = 16, 24, 32


def sequence_base() -> type:
    """A class to derive sequences from, with room for the address of their place."""
    if not is_native():
        return type("SequenceBase", (), {"__module__": __name__, "__slots__": ()})
    return from_spec("SequenceBase", object, SEQUENCE_BYTES, DEFAULT | BASETYPE, ())


def bind_place(sequence: Any, address: int) -> None:
    """Tell the compiled code of a sequence, an object of a class that `compiled` gave, where its place is, if it has one."""
    if address:
        write_word(id(sequence) + PLACE, address)


@cache
def compiled(sequence_class: type) -> type:
    """A subclass whose length, elements and iterators are those of compiled code; the class itself where there is none."""
    code = library()
    if code is None:
        return sequence_class
    slots = ((SQ_LENGTH, code["length"]), (MP_SUBSCRIPT, code["subscript"]), (TP_ITER, code["iterate"]))
    reading = from_spec("Sequence", _word_class(sequence_class), SEQUENCE_BYTES, DEFAULT | BASETYPE, slots)
    names = {"__slots__": (), "__module__": sequence_class.__module__, "__qualname__": sequence_class.__qualname__, "_code": code}
    return type(sequence_class)(sequence_class.__name__, (reading, sequence_class), names)


@cache
def iterator_class() -> type:
    """The class of the iterators of such sequences."""
    code = library()
    assert code is not None, "there are sequences for it"
    slots = ((TP_ITER, code["itself"]), (TP_ITERNEXT, code["next"]), (TP_DEALLOC, code["end_iterator"]))
    return from_spec("Iterator", object, ITERATOR_BYTES, DEFAULT, slots)


def _word_class(sequence_class: type) -> type:
    """The class above it that has the room."""
    return next(each for each in sequence_class.__mro__ if each.__basicsize__ == SEQUENCE_BYTES and each.__mro__[1] is object)


def extend_texts(sequence: object, values: object) -> bool:
    """Append the texts of a list to a sequence; False if that is left to Python, because values or sequence are others."""
    return functions()["extend_texts"](sequence, values)
