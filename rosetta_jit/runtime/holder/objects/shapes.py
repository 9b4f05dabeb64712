"""Which attributes the objects of a class have, and of which classes those are."""

from __future__ import annotations

import re
import sys
import typing
from collections.abc import Mapping
from enum import Enum as Enumeration
from functools import lru_cache
from typing import Any, cast

from rosetta_jit.model.types import same_name

NO_MESSAGES = (str, bytes, bytearray, memoryview, int, float, complex, list, tuple, set, frozenset, type(None))
"""Values that are never messages."""


def is_message_like(value: object) -> bool:
    """Whether a value may be a message of another class: anything but a class and what Python has for single values."""
    return has_messages(type(value))


@lru_cache(maxsize=256)
def has_messages(object_type: type[Any]) -> bool:
    """The same for all objects of a class."""
    kind: Any = object_type
    has_many = hasattr(kind, "__array_interface__") or hasattr(kind, "__arrow_c_stream__")
    return not issubclass(kind, (*NO_MESSAGES, type)) and kind is not object and not has_many


def declared(object_type: type) -> frozenset[str]:
    """The public names that a class declares for its objects: fields of a dataclass, and slots."""
    slots: list[str] = []
    for each in object_type.__mro__:
        own = vars(each).get("__slots__", ())
        slots += [own] if isinstance(own, str) else own
    return frozenset(name for name in (*fields_of(object_type), *slots) if not name.startswith("_"))


def fields_of(object_type: type) -> Mapping[str, Any]:
    """The fields of a dataclass that its constructor takes, by name; nothing of any other class."""
    fields = getattr(object_type, "__dataclass_fields__", {})
    return {name: each for name, each in fields.items() if each.init and not name.startswith("__")}


def field_count(object_type: type) -> int:
    """How many attributes the constructor of a dataclass gives an object, of whatever name."""
    from dataclasses import fields

    return len(fields(object_type))


def has_dict(object_type: type) -> bool:
    """Whether objects of a class can have attributes that the class does not declare."""
    return object_type.__dictoffset__ != 0


def attributes_of(value: object) -> frozenset[str]:
    """The public names that an object has for values of its own: what a class computes is not among them."""
    own = vars(value) if has_dict(type(value)) else {}
    return declared(type(value)) | {name for name in own if not name.startswith("_")}


def annotation(object_type: type, name: str) -> Any:
    """What a class says about the type of an attribute: a type, or text; None where it says nothing."""
    for each in object_type.__mro__:
        if name in (found := vars(each).get("__annotations__", {})):
            return found[name]
    field = fields_of(object_type).get(name)
    return None if field is None else field.type


def made_by_default(object_type: type, name: str) -> type | None:
    """The class that a dataclass makes the value of an attribute with, where nobody gives one."""
    made = getattr(fields_of(object_type).get(name), "default_factory", None)
    return made if isinstance(made, type) and has_messages(made) else None


def class_in(said: Any, owner: type) -> type | None:
    """The class of messages, or the enum, that an annotation names, itself or as what a list or an optional value has."""
    if isinstance(said, str):
        scope = vars(sys.modules[owner.__module__]) if owner.__module__ in sys.modules else {}
        named = (class_in(_at(scope, name), owner) for name in re.findall(r"[A-Za-z_][\w.]*", said))
        return next((each for each in named if each is not None), None)
    if isinstance(said, type) and not typing.get_args(said):
        found = cast("type[Any]", said)
        return found if found.__module__ not in _NO_MODULES and (issubclass(found, Enumeration) or has_messages(found)) else None
    inner = (class_in(each, owner) for each in (*typing.get_args(said), *getattr(said, "__metadata__", ())))
    return next((each for each in inner if each is not None), None)


def kind_in(said: Any) -> str:
    """Of what kind an annotation says that an array is: ``ndarray``, ``list``, or nothing that it says."""
    text = str(said)
    return "ndarray" if "ndarray" in text else "list" if re.search(r"\b(list|List|Sequence|sequence)\b", text) else ""


_NO_MODULES = frozenset(["builtins", "typing", "collections.abc", "numpy", "array"])


def _at(scope: Mapping[str, Any], path: str) -> Any:
    """What a dotted name means in a module; None if nothing."""
    first, *others = path.split(".")
    found = scope.get(first)
    for each in others:
        found = getattr(found, each, None)
    return found


def class_named(types: Mapping[str, type], struct: str) -> type | None:
    """The class that a table has for a struct, however it writes its name."""
    return types.get(struct) or next((each for name, each in types.items() if same_name(name, struct)), None)
