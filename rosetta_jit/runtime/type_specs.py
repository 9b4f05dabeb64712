"""Types that Python's class statement cannot make, through CPython's stable type specifications (PEP 384) by ctypes."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping, Sequence
from types import MethodDescriptorType
from typing import Any, cast

# Include/object.h, Include/typeslots.h, Include/structmember.h
DEFAULT, METHOD_DESCRIPTOR, VECTORCALL, BASETYPE = 1 << 18, 1 << 17, 1 << 11, 1 << 10
MP_SUBSCRIPT, SQ_LENGTH = 5, 45
TP_CALL, TP_DEALLOC, TP_ITER, TP_ITERNEXT, TP_SETATTRO, TP_MEMBERS = 50, 52, 62, 63, 69, 72
TP_NEW = 65
OBJECT, SSIZE_T, READONLY = 16, 19, 1
VARARGS, KEYWORDS, ONE_ARGUMENT, FASTCALL = 0x01, 0x02, 0x08, 0x80
"""Flags of methods (Include/methodobject.h); the last with that of keywords has the arguments of a vectorcall."""

_CLASS = 8
"""Where an object has its class."""
_KEPT: list[object] = []


class Member(ctypes.Structure):
    """PyMemberDef of Include/structmember.h."""

    _fields_ = (
        ("name", ctypes.c_char_p),
        ("type", ctypes.c_int),
        ("offset", ctypes.c_ssize_t),
        ("flags", ctypes.c_int),
        ("doc", ctypes.c_char_p),
    )


class GetSet(ctypes.Structure):
    """PyGetSetDef of Include/descrobject.h."""

    _fields_ = (
        ("name", ctypes.c_char_p),
        ("get", ctypes.c_void_p),
        ("set", ctypes.c_void_p),
        ("doc", ctypes.c_char_p),
        ("closure", ctypes.c_void_p),
    )


class Method(ctypes.Structure):
    """PyMethodDef of Include/methodobject.h."""

    _fields_ = (("name", ctypes.c_char_p), ("function", ctypes.c_void_p), ("flags", ctypes.c_int), ("doc", ctypes.c_char_p))


class _Slot(ctypes.Structure):
    """PyType_Slot of Include/object.h."""

    _fields_ = (("slot", ctypes.c_int), ("function", ctypes.c_void_p))


class _Spec(ctypes.Structure):
    """PyType_Spec of Include/object.h."""

    _fields_ = (
        ("name", ctypes.c_char_p),
        ("basicsize", ctypes.c_int),
        ("itemsize", ctypes.c_int),
        ("flags", ctypes.c_uint),
        ("slots", ctypes.POINTER(_Slot)),
    )


class Listed(type):
    """The class of the classes that holders and views derive from: what they have for us alone, whose names end with an underscore, is not
    listed. Prompts ask each base of a class for what it lists.
    """

    __slots__ = ()

    def __dir__(cls) -> list[str]:
        return [name for name in super().__dir__() if name.startswith("__") or not name.endswith("_")]


def let_list(created: type) -> type:
    """The type, of which CPython has made its own class `type`, as one of the class `Listed`, which takes as much memory."""
    ctypes.pythonapi.Py_IncRef(ctypes.py_object(Listed))
    write_word(id(created) + _CLASS, id(Listed))
    return created


def from_spec(name: str, base: type, size: int, flags: int, slots: Sequence[tuple[int, int]]) -> type:
    """A type whose instances are of a fixed size; all else, garbage collection included, comes from the base.

    Up to CPython 3.11 its own class does not: then it is the one that has no other memory.
    """
    table = (_Slot * (len(slots) + 1))(*(_Slot(number, function) for number, function in slots))
    spec = _Spec(f"rosetta_jit.{name}".encode(), size, 0, flags, table)
    create = ctypes.pythonapi.PyType_FromSpecWithBases
    create.restype, create.argtypes = ctypes.py_object, [ctypes.c_void_p, ctypes.py_object]
    created = create(ctypes.addressof(spec), (base,))
    return let_list(created) if isinstance(base, Listed) and type(created) is type else created


def with_attributes(created: type, attributes: Mapping[str, object]) -> type:
    """The type, with attributes; what its C structures point to must live as long as the type, and so is one of them."""
    for name, value in attributes.items():
        setattr(created, name, value)
    return created


def address_of(function: str) -> int:
    """The address of a function of Python's C interface."""
    return ctypes.cast(getattr(ctypes.pythonapi, function), ctypes.c_void_p).value or 0


def attribute_of(owner: type, definition: GetSet) -> Any:
    """The descriptor that a definition says, which must live as long as the class."""
    return _described(ctypes.pythonapi.PyDescr_NewGetSet, owner, definition)


def member_of(owner: type, definition: Member) -> Any:
    """The descriptor of a member."""
    return _described(ctypes.pythonapi.PyDescr_NewMember, owner, definition)


def _described(create: Any, owner: type, definition: ctypes.Structure) -> Any:
    create.restype, create.argtypes = ctypes.py_object, [ctypes.py_object, ctypes.c_void_p]
    return create(owner, ctypes.addressof(definition))


def slot_offset(descriptor: Any) -> int:
    """Where a slot of a class lies in its objects: PyMemberDescrObject of Include/descrobject.h."""
    return read_word(read_word(id(descriptor) + 40) + 16)


class _WeaklySeen:
    __slots__ = ("__weakref__",)


def weak_list_offset(slots_end: int) -> int:
    """Where objects of a class that declares ``__weakref__`` keep the list of weak references to them: where its other slots end, or, from
    CPython 3.12 on, before the object.
    """
    here: int = cast("Any", _WeaklySeen).__weakrefoffset__
    return here if here < 0 else slots_end


def size_with_weak_list(slots_end: int) -> int:
    """The size of such objects."""
    return max(slots_end, weak_list_offset(slots_end) + 8)


def function_behind(method: MethodDescriptorType, flags: int) -> int | None:
    """The address of the function in C that a method of a built-in class calls, if its flags are these.

    PyMethodDescrObject of Include/cpython/descrobject.h; its third part is a definition as `Method` is one.
    """
    definition = Method.from_address(read_word(id(method) + 40))
    return definition.function if definition.flags == flags and definition.name == method.__name__.encode() else None


def allocator_of(owner: type) -> int | None:
    """The address of the function in C that makes objects of a class (``tp_new``), before they are initialised."""
    find = ctypes.pythonapi.PyType_GetSlot
    find.restype, find.argtypes = ctypes.c_void_p, [ctypes.py_object, ctypes.c_int]
    return find(owner, TP_NEW)


def function_of(name: str, address: int) -> Callable[..., Any]:
    """A built-in function of code that takes an array of arguments. The code, and what this makes, live as long as the process."""
    method = Method(name.encode(), address, FASTCALL, None)
    _KEPT.append(method)
    create = ctypes.pythonapi.PyCFunction_NewEx
    create.restype, create.argtypes = ctypes.py_object, [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p]
    return create(ctypes.addressof(method), None, None)


def read_word(address: int) -> int:
    """Eight bytes of memory."""
    return ctypes.c_uint64.from_address(address).value


def put_reference(owner: object, offset: int, value: object) -> None:
    """Let an object keep another one where it keeps nothing yet."""
    ctypes.pythonapi.Py_IncRef(ctypes.py_object(value))
    write_word(id(owner) + offset, id(value))


def write_word(address: int, value: int) -> None:
    """Change eight bytes of memory."""
    ctypes.c_uint64.from_address(address).value = value


def write_words(address: int, *values: int) -> None:
    """Change memory from an address on, eight bytes a value."""
    for number, value in enumerate(values):
        write_word(address + 8 * number, value)
