"""Types that compiled entries know: callables whose vectorcall slot is an entry, holders with their state's address in a fixed place.

Such types cannot be written in Python. They are made through CPython's stable type specifications (PEP 384) by ctypes:

    a callable    0 the instance of its Python base class    64 vectorcall    72 context
    a holder      0 object header    16 address of the state

Where Python is not one that we know, `callable_class` gives a Python class that calls the slow path, and `holder_base` a plain one.
"""

from __future__ import annotations

import ctypes
import sys
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from rosetta_jit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    Words = np.ndarray[tuple[int], np.dtype[np.int64]]

VECTORCALL, CONTEXT, CALLABLE_BYTES = 64, 72, 80
MADE, THREAD = 5, 6
"""Words of a program's context: how many messages it has made, if its kernel asks; the thread that its own holder belongs to, or 0."""

STATE, HOLDER_BYTES = 16, 24

# Include/object.h and Include/typeslots.h
_DEFAULT, _VECTORCALL, _BASETYPE = 1 << 18, 1 << 11, 1 << 10
_TP_CALL, _TP_MEMBERS = 50, 72
_SSIZE_T, _READONLY = 19, 1
_FASTCALL, _KEYWORDS = 0x80, 0x02  # Include/methodobject.h; the two together have the arguments of a vectorcall


@dataclass(frozen=True, slots=True)
class Context:
    """What an entry needs, in the order of its words.

    Attributes
    ----------
    state
        State of the program's own holder, int64. Word 0 is its address.
    holder
        The program's own holder, which a decoder returns.
    slow
        Called with the arguments of every call that is not the common case.
    cell
        A list of one item, the source of borrowed values.
    holder_type
        The exact type of holders that the entry takes.
    """

    state: Words
    holder: object
    slow: Callable[..., object]
    cell: list[object]
    holder_type: type

    def words(self) -> Words:
        """The array that the entry reads, and where it counts. It borrows every reference: `self` must live as long."""
        return np.array([self.state.ctypes.data, id(self.holder), id(self.slow), id(self.cell), id(self.holder_type), 0, 0], np.int64)


def is_native() -> bool:
    """Whether objects of this Python lie in memory as the entries expect: CPython 3.11 to 3.14, 64 bits, with the interpreter lock."""
    known = sys.implementation.name == "cpython" and (3, 11) <= sys.version_info < (3, 15)
    return known and sys.maxsize == 2**63 - 1 and not _is_free_threaded()


def _is_free_threaded() -> bool:
    if sys.version_info < (3, 13):
        return False
    import sysconfig  # slow

    return bool(sysconfig.get_config_var("Py_GIL_DISABLED"))


def callable_class(base: type, *, native: bool | None = None) -> type:
    """A subclass of ``base`` whose instances are called through an entry; see `bind_call`.

    Parameters
    ----------
    base
        An ordinary class with methods and attributes. Its instances may take up to 64 bytes beside their ``__dict__``.
    native
        False forces the class that always takes the slow path; by default that is what `is_native` says.
    """
    if not _chosen(native) or base.__basicsize__ > VECTORCALL:
        return type(base.__name__, (base,), {"__call__": _call_slow, "_is_native": False, **_names(base)})
    members = (_Member * 2)(_Member(b"__vectorcalloffset__", _SSIZE_T, VECTORCALL, _READONLY, None))
    slots = ((_TP_MEMBERS, ctypes.addressof(members)), (_TP_CALL, _address("PyVectorcall_Call")))
    created = _from_spec(base, CALLABLE_BYTES, _DEFAULT | _VECTORCALL | _BASETYPE, slots)
    return _with_attributes(created, {"_is_native": True, "_members": members, **_names(base)})


def holder_base(*, native: bool | None = None) -> type:
    """A class to derive holders from, with room for the address of their state; see `bind_state`."""
    if not _chosen(native):
        return type("HolderBase", (), {"_is_native": False, "__module__": __name__})
    created = _from_spec(object, HOLDER_BYTES, _DEFAULT | _BASETYPE, ())
    return _with_attributes(created, {"_is_native": True, "__module__": __name__, "__qualname__": "HolderBase"})


def bind_call(target: Any, entry: int | None, context: Context) -> None:
    """Let calls of ``target``, an instance of a `callable_class`, go to the entry at an address; without one, to the slow path.

    The code there must live as long as the object. The context is kept by the object.
    """
    words = context.words()
    target._context = (context, words)  # noqa: SLF001 - the class is ours
    if not target._is_native:  # noqa: SLF001 - as above
        return
    if entry is None:
        target.__class__ = _without_entry(target.__class__)
    else:
        _write(id(target) + CONTEXT, words.ctypes.data)
        _write(id(target) + VECTORCALL, entry)


def builtin_of(target: Any, name: str, doc: str) -> Callable[..., Any]:
    """The call of a bound ``target`` as a built-in function. CPython calls those with less ado than an object of any other type.

    Its ``__self__`` is the target, which it keeps alive; not the other way round.
    """
    entry = _read(id(target) + VECTORCALL) if target._is_native else 0  # noqa: SLF001 - the class is ours
    if not entry:
        return target._context[0].slow  # noqa: SLF001 - as above
    if "_method" not in vars(target):
        target._method = _Method(name.encode(), entry, _FASTCALL | _KEYWORDS, doc.encode())  # noqa: SLF001 - as above
    create = ctypes.pythonapi.PyCFunction_NewEx
    create.restype, create.argtypes = ctypes.py_object, [ctypes.c_void_p, ctypes.py_object, ctypes.c_void_p]
    return create(ctypes.addressof(target._method), target, None)  # noqa: SLF001 - as above


def bind_state(holder: Any, address: int) -> None:
    """Tell the entries where the state of a holder, an instance of a subclass of a `holder_base`, lies. The holder must keep its memory."""
    if holder._is_native:  # noqa: SLF001 - the class is ours
        _write(id(holder) + STATE, address)


@cache
def _without_entry(native: type) -> type:
    """A subclass with an ordinary ``__call__``: CPython takes that before the vectorcall slot."""
    return type(native.__name__, (native,), {"__call__": _call_slow, "__slots__": (), "_with_entry": native, **_names(native)})


def public_class(target: object) -> type:
    """The class that a program was made as, which its module knows by its name."""
    return getattr(type(target), "_with_entry", type(target))


def _call_slow(self: Any, *arguments: object, **named: object) -> object:
    return self._context[0].slow(*arguments, **named)


def _chosen(native: bool | None) -> bool:
    return is_native() if native is None else native


def _names(base: type) -> dict[str, str]:
    return {"__module__": base.__module__, "__qualname__": base.__qualname__}


def _with_attributes(created: type, attributes: Mapping[str, object]) -> type:
    """What the type's C structures point to lives as long as the type."""
    for name, value in attributes.items():
        setattr(created, name, value)
    return created


class _Member(ctypes.Structure):
    """PyMemberDef of Include/structmember.h."""

    _fields_ = (
        ("name", ctypes.c_char_p),
        ("type", ctypes.c_int),
        ("offset", ctypes.c_ssize_t),
        ("flags", ctypes.c_int),
        ("doc", ctypes.c_char_p),
    )


class _Method(ctypes.Structure):
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


def _from_spec(base: type, size: int, flags: int, slots: Sequence[tuple[int, int]]) -> type:
    """A type whose instances are of a fixed size; all else, garbage collection included, comes from the base."""
    table = (_Slot * (len(slots) + 1))(*(_Slot(number, function) for number, function in slots))
    spec = _Spec(f"rosetta_jit.{base.__name__}".encode(), size, 0, flags, table)
    create = ctypes.pythonapi.PyType_FromSpecWithBases
    create.restype, create.argtypes = ctypes.py_object, [ctypes.c_void_p, ctypes.py_object]
    return create(ctypes.addressof(spec), (base,))


def _address(function: str) -> int:
    return ctypes.cast(getattr(ctypes.pythonapi, function), ctypes.c_void_p).value or 0


def _read(address: int) -> int:
    return ctypes.c_uint64.from_address(address).value


def _write(address: int, value: int) -> None:
    ctypes.c_uint64.from_address(address).value = value
