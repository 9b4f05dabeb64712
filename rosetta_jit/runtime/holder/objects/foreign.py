"""What is particular about the objects of a framework's own package. Where nothing is, attributes are called as the fields of the IDL."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from rosetta_jit.runtime.holder.record import Record
from rosetta_jit.runtime.holder.serialising import Programs
from rosetta_jit.runtime.limits import MAX_CLASSES
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.runtime.holder.objects.in_c import InC


@dataclass(frozen=True, slots=True)
class Whole:
    """How objects of a class are handed over at once, instead of attribute by attribute.

    Attributes
    ----------
    take : callable
        Given a holder and an object, gives the holder the object's values, and leaves it nothing that it had before.
    fill : callable
        Given an object and a holder, gives the object the holder's values.
    make : callable
        A new object, given a holder.
    programs : Programs
        Decoder and encoder of the bytes as which the objects are handed over.
    bytes_of : callable
        The bytes of an object.
    of_bytes : callable
        An object of bytes.
    reads, writes : frozenset of str
        Encodings, or None for the framework's usual one: messages of the former are bytes of which objects can be made, those of the latter
        are the bytes of an object.
    is_exact : bool
        Whether the class's own functions refuse whatever the programs would, so that those need not look at what passes.
    in_c : InC, optional
        The functions in C behind ``bytes_of`` and ``of_bytes``, where they are known.
    """

    take: Callable[[Any, Any], None]
    fill: Callable[[Any, Any], None]
    make: Callable[[Any], Any]
    programs: Programs
    bytes_of: Callable[[Any], bytes]
    of_bytes: Callable[[bytes], Any]
    reads: frozenset[str | None]
    writes: frozenset[str | None]
    is_exact: bool = False
    in_c: InC | None = None


def same_name(record: Record, field: str) -> tuple[str, ...]:  # noqa: ARG001  whatever the record
    """The attribute that is called as the field is."""
    return (field,)


def no_class(owner: type, struct: str) -> type | None:  # noqa: ARG001  whatever they are
    """None."""
    return None


def no_whole(family: Any, object_type: type) -> Whole | None:  # noqa: ARG001  whatever they are
    """None."""
    return None


@dataclass(frozen=True, slots=True)
class Foreign:
    """The particulars of one framework.

    Attributes
    ----------
    names : callable
        What the attribute of a field may be called, given its record and its name; nothing where objects have no such attribute.
    class_of : callable
        The class of the objects of another struct, given a class that refers to it and the struct's name; None if it is not known.
    whole : callable
        How objects of a class are handed over at once, given the family of the holders; None if attribute by attribute.
        TypeError if that class is of another type than the holders.
    besides : frozenset of str
        Attributes that say nothing: objects may have them though they are no fields.
    """

    names: Callable[[Record, str], tuple[str, ...]] = same_name
    class_of: Callable[[type, str], type | None] = no_class
    whole: Callable[[Any, type], Whole | None] = no_whole
    besides: frozenset[str] = frozenset()


ORDINARY = Foreign()
"""Nothing is particular."""


class Wholes(dict[type, "Whole | None"]):
    """How objects of each class are handed over at once to the holders of a family; None where they are not."""

    def __init__(self, foreign: Foreign, family: object) -> None:
        self._foreign, self._family = foreign, family

    def __missing__(self, object_type: type) -> Whole | None:
        found = self._foreign.whole(self._family, object_type)
        if len(self) < MAX_CLASSES:
            self[object_type] = found
        return found
