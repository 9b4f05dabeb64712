"""Tables of steps: how compiled code takes the objects of one class, or dicts, into messages (`attributes/objects/taking.ll`).

A table is made after one object, whose attributes tell the classes of the messages in it. It is for objects whose every attribute is a
value that lies in the message's own row, or in a lane of its own: there is none where there are arrays of messages, maps or unions.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, cast

import numpy as np

from rosetta_jit.errors import RosettaError
from rosetta_jit.model.types import Enum
from rosetta_jit.runtime.attributes.code import functions, library
from rosetta_jit.runtime.attributes.descriptors import accessors
from rosetta_jit.runtime.attributes.field_table import PLACE_BYTES
from rosetta_jit.runtime.holder.classes import HolderFamily
from rosetta_jit.runtime.holder.objects import shapes, unions
from rosetta_jit.runtime.holder.record import Bit, Blob, Entry, Items, Numbers, Record, Scalar, Text
from rosetta_jit.runtime.type_specs import read_word, slot_offset
from rosetta_jit.startup.dataclass import dataclass

LEFT = (AttributeError, LookupError, TypeError, ValueError, OverflowError, RosettaError)
"""What makes a quick way leave an object to the slow one. Errors of another kind are those of the object's own code."""

SETTER, MESSAGE, OPTIONAL = 0, 1, 8
BY_NAME, IS_DICT, HAS_DICT = 0, 1, 2
VERSION = 384
"""Where a class has its version: of PyTypeObject, Include/cpython/object.h."""

ACCEPTED: Mapping[type, tuple[type, ...]] = {
    Scalar: (int,),
    Blob: (bytes,),
    Numbers: (list, tuple, np.ndarray),
    Items: (list,),
}
"""Of which classes the value of a field is as it is, where others are converted."""


@dataclass(frozen=True, slots=True)
class Ways:
    """How Python takes objects, as far as steps need it.

    Attributes
    ----------
    names : callable
        What the attribute of a field may be called, given its record and its name.
    without_meaning : callable
        Attributes that an object may have though they are no fields of a record.
    is_whole : callable
        Whether objects of a class are handed over at once, given the record.
    converts : mapping of type to callable
        What makes a value for fields whose nodes are of a class.
    """

    names: Callable[[Record, str], tuple[str, ...]]
    without_meaning: Callable[[Record], frozenset[str]]
    is_whole: Callable[[Record, type], bool]
    converts: Mapping[type, Callable[[Any], Any]]


class Steps:
    """The table of a record for objects like one.

    Attributes
    ----------
    table : int
        Its address.
    covers : bool
        Whether it sets all that a message has, so that the message need not have been empty.

    Raises
    ------
    TypeError
        If there can be no such table.
    """

    def __init__(self, family: HolderFamily, ways: Ways, record: Record, like: Any) -> None:
        if library() is None:
            raise TypeError("there is no compiled code")
        self.covers = True
        self._family, self._ways = family, ways
        self._alive: list[Any] = []
        self._classes: list[tuple[type, int]] = []
        self.table = self._table(record, like)
        self._take = functions()["take"]

    def take(self, message: Any, value: object) -> bool:
        """Whether an object was taken; False where it is another one than these steps are for, and some of it may have been taken then."""
        return self._take(self.table, message, value)

    def is_stale(self) -> bool:
        """Whether one of the classes has changed since."""
        return any(known and known != _version_now(each) for each, known in self._classes)

    def _table(self, record: Record, like: Any) -> int:
        object_type = cast("type[object]", type(like))
        mode = IS_DICT if object_type is dict else HAS_DICT if _keeps_all_in_a_dict(object_type) else BY_NAME
        names = _names(self._ways, record, like, mode)
        words = np.zeros((len(names), 10), np.int64)
        for step, entry in zip(words, record.entries.values(), strict=True):
            self._fill(step, record, entry, like, names[entry.name], mode)
        count = len(names) if mode == IS_DICT else len(cast("dict[str, Any]", vars(like))) if mode == HAS_DICT else 0
        head = np.array([len(names), id(object_type), 0 if mode == IS_DICT else _version(object_type), mode, count], np.int64)
        table = np.concatenate([head, words.ravel()])
        self._alive += [object_type, table]
        self._classes.append((object_type, int(head[2])))
        return table.ctypes.data

    def _fill(self, step: Any, record: Record, entry: Entry, like: Any, name: str, mode: int) -> None:
        node, is_dict = entry.node, mode == IS_DICT
        value = like[name] if is_dict else getattr(like, name)
        step[1], step[2] = self._borrow(name), _slot(cast("type[object]", type(like)), name) if mode == BY_NAME else -1
        if isinstance(node, Record):
            step[0], step[3], step[4] = MESSAGE, *self._message(record, entry, node, value)
            return
        if entry.presence is not None:
            if not isinstance(entry.presence, Bit):
                raise TypeError("cases of unions are set in Python")
            self.covers = False
            step[0] = SETTER if is_dict else OPTIONAL
        step[3], step[4] = self._setter(record, entry)
        if _is_converted(entry):
            accepted = ACCEPTED[type(entry.node)]
            step[5] = self._borrow(self._ways.converts[type(entry.node)])
            step[6 : 6 + len(accepted)] = [id(each) for each in accepted]

    def _message(self, record: Record, entry: Entry, node: Record, value: Any) -> tuple[int, int]:
        """The table of a message within, and where its message is kept."""
        kept = self._family.kept_of(record.struct)
        if entry.presence is not None or kept is None or entry.name not in kept.members or unions.discriminator_of(node) is not None:
            raise TypeError("such messages are set in Python")
        return self._table(node, value), kept.offsets[entry.name]

    def _setter(self, record: Record, entry: Entry) -> tuple[int, int]:
        """The address of what sets a field, and what it is given."""
        code, family = library(), self._family
        assert code is not None, "there are setters"
        if not (family.assigns_whole or isinstance(entry.node, Scalar | Text | Blob)) or entry.name not in family.shown(record):
            raise TypeError("such fields are set in Python")
        _, setter = accessors(entry, plain_arrays=family.array_type is np.ndarray)
        return code[setter], PLACE_BYTES * list(record.entries).index(entry.name)

    def _borrow(self, held: object) -> int:
        """The address of an object that lives as long as the table."""
        self._alive.append(held)
        return id(held)


def _is_converted(entry: Entry) -> bool:
    """Whether a value may have to be made of what is given for a field."""
    match entry.node:
        case Scalar(type=type_):
            return isinstance(type_, Enum)
        case Text():
            return False
        case Blob() | Items(element=Text()):
            return True
        case Numbers(type=type_) if not isinstance(type_, Enum):
            return True
        case _:
            raise TypeError("such fields are set in Python")


def _names(ways: Ways, record: Record, like: Any, mode: int) -> dict[str, str]:
    """What the attributes of all fields are called: the object has these, and no others that would say something."""
    if mode == IS_DICT:
        if like.keys() != record.entries.keys():
            raise TypeError("a dict that does not name all fields is taken in Python")
        return {name: name for name in record.entries}
    object_type = cast("type[object]", type(like))
    if not shapes.has_messages(object_type) or ways.is_whole(record, object_type) or unions.discriminator_of(record) is not None:
        raise TypeError("such objects are taken in Python")
    found = {name: _name(like, ways.names(record, name)) for name in record.entries}
    allowed = ways.without_meaning(record).union(found.values())
    if shapes.attributes_of(like) - allowed or (mode == BY_NAME and shapes.has_dict(object_type)):
        raise TypeError("objects with other attributes are taken in Python")
    return found


def _name(like: Any, names: tuple[str, ...]) -> str:
    found = next((name for name in names if hasattr(cast("object", like), name)), None)
    if found is None:
        raise TypeError("objects without an attribute are taken in Python")
    return found


def _keeps_all_in_a_dict(object_type: type) -> bool:
    """Whether all attributes of a class's objects lie in a dict: of a dataclass without slots, of whose fields the class computes none."""
    fields = shapes.fields_of(object_type)
    own = [vars(each) for each in object_type.__mro__]
    computed = any(hasattr(cast("type[object]", type(each[name])), "__set__") for name in fields for each in own if name in each)
    return shapes.has_dict(object_type) and bool(fields) and not computed


def _slot(object_type: type, name: str) -> int:
    """Where a slot lies in the objects of a class; -1 of an attribute that is none."""
    descriptor: Any = cast("Any", next((vars(each)[name] for each in object_type.__mro__ if name in vars(each)), None))
    is_slot = type(descriptor).__name__ == "member_descriptor" and object_type.__getattribute__ is object.__getattribute__
    return slot_offset(descriptor) if is_slot and name in _slots(descriptor.__objclass__) else -1


def _slots(object_type: type) -> tuple[str, ...]:
    said = vars(object_type).get("__slots__", ())
    return (said,) if isinstance(said, str) else tuple(said)


def _version(object_type: type) -> int:
    """The version of a class: CPython gives it another one whenever it changes; raises TypeError if it has none."""
    hasattr(object_type, "__slots__")  # a lookup is what gives it one
    version = _version_now(object_type)
    if not version:
        raise TypeError("the class has no version")
    return version


def _version_now(object_type: type) -> int:
    return read_word(id(object_type) + VERSION) & 0xFFFFFFFF
