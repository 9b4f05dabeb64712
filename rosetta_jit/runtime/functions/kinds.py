"""Objects as plain values that say all that numba can see of them: what `content` goes on with.

    an enumeration      the kinds of its bases, and of each member its name and value
    a named tuple       the names of its fields, their defaults, and its items
    an array, a scalar  its dtype, shape, order and bytes
    options of njit     those that it was given, and the types of locals

Each answer is None where a class has been given other manners than its kind has, as by a property of the user's that is called `value`.
"""

from __future__ import annotations

import enum
import struct
import sys
from types import FunctionType
from typing import Any, cast

import numpy as np

from rosetta_jit.runtime.functions.known import is_known
from rosetta_jit.runtime.limits import MAX_FROZEN_BYTES
from rosetta_jit.startup.sha import sha256

MANNERS = frozenset(("value", "_value_", "name", "_missing_", "__getattribute__", "__getattr__"))
"""What an enumeration of the user's may not define, because it says what members are."""

PLAIN_DTYPES = frozenset("biufcmMSUV")


def plain(value: object) -> str | None:
    """A value without parts, to the last bit; None of any other. Subclasses have manners of their own."""
    kind = type(value)
    if kind is float:
        return struct.pack("<d", value).hex()
    if kind is complex:
        number = cast("complex", value)
        return struct.pack("<dd", number.real, number.imag).hex()
    if kind is int:
        return hex(cast("int", value))
    return repr(value) if kind in (bool, str, bytes, type(None), type(...)) else None


def set_of_plain(values: frozenset[object]) -> tuple[object, ...] | None:
    """A set of values without parts, which are known by their texts."""
    texts = [(type(each).__name__, plain(each)) for each in values]
    return None if any(text is None for _, text in texts) else ("set", *sorted(texts, key=repr))


def enumeration(cls: enum.EnumType) -> tuple[object, ...] | None:
    """An enumeration class."""
    bases = [base for base in cls.__mro__ if not is_known(base)]
    if type(cls) is not enum.EnumType or any(_has_manners(base) for base in bases):
        return None
    kinds = tuple(f"{base.__module__}.{base.__qualname__}" for base in cls.__mro__ if base not in bases)
    members = cast("dict[str, enum.Enum]", cls.__members__)
    if any(getattr(cls, name, None) is not member for name, member in members.items()):
        return None  # `type.__setattr__` has put something else there, and numba takes the attribute
    return kinds, tuple((name, _member(member)) for name, member in members.items())


def _has_manners(base: type) -> bool:
    """Whether a class of the user's is no enumeration, or says itself what a member's value is."""
    makes = vars(base).get("__new_member__", vars(base).get("_new_member_"))
    made_by_user = isinstance(makes, FunctionType) and not is_known(makes)
    return not issubclass(base, enum.Enum) or made_by_user or bool(MANNERS & vars(base).keys())


def _member(member: enum.Enum) -> tuple[object, ...]:
    """A member's value, and the number or text that the member is itself, if it is one."""
    number = int.__repr__(member) if isinstance(member, int) else None
    return vars(member).get("_value_"), number, str.__str__(member) if isinstance(member, str) else None


def enumeration_member(member: enum.Enum) -> tuple[object, ...]:
    """A member, beside its class: `content` looks into that, too."""
    return (type(member), vars(member).get("_name_"), _member(member))


def named_tuple(cls: type) -> tuple[object, ...] | None:
    """A class that `collections.namedtuple` or `typing.NamedTuple` made."""
    fields: Any = vars(cls).get("_fields")
    if type(cls) is not type or cls.__mro__ != (cls, tuple, object) or type(fields) is not tuple or type(cls.__new__) is not FunctionType:
        return None
    return "named tuple", cast("tuple[object, ...]", fields), cls.__new__.__defaults__


def dtype(number_type: np.dtype[Any]) -> tuple[object, ...] | None:
    """A dtype of numbers, texts, times, or records of these."""
    if number_type.hasobject or number_type.kind not in PLAIN_DTYPES or number_type.type.__module__ not in ("numpy", "numpy.rec"):
        return None
    return "dtype", repr(number_type), number_type.itemsize, number_type.isalignedstruct


def array(numbers: np.ndarray[Any, Any]) -> tuple[object, ...] | None:
    """An array that numba copies into the code."""
    kind = dtype(numbers.dtype)
    if kind is None:
        return None
    flags = numbers.flags
    digest = sha256(numbers.tobytes()).hexdigest()
    return "array", kind, numbers.shape, (flags.c_contiguous, flags.f_contiguous, flags.aligned, flags.writeable), digest


def is_at_its_address(numbers: np.ndarray[Any, Any]) -> bool:
    """Whether numba compiles where the array lies, not what is in it."""
    return numbers.nbytes > MAX_FROZEN_BYTES or not (numbers.flags.c_contiguous or numbers.flags.f_contiguous)


def scalar(value: np.generic[Any]) -> tuple[object, ...] | None:
    """A scalar of numpy's."""
    kind = dtype(value.dtype)
    if kind is None or not (is_known(type(value)) or type(value) is np.record):
        return None
    return "scalar", kind, value.tobytes()


def is_dispatcher(value: object) -> bool:
    """Whether numba's njit made it."""
    registry = sys.modules.get("numba.core.registry")
    return registry is not None and type(value) is registry.CPUDispatcher


def is_ordinary(dispatcher: Any) -> bool:
    """Whether numba's usual compiler compiles what the dispatcher shows, for whatever types, and no code comes from a file."""
    compiler, caching = sys.modules.get("numba.core.compiler"), sys.modules.get("numba.core.caching")
    if compiler is None or caching is None:
        return False
    own = dispatcher._compiler  # noqa: SLF001 - numba has no other name
    shown = own.py_func is dispatcher.py_func and own.targetoptions == dispatcher.targetoptions and own.locals == dispatcher.locals
    usual = shown and own.pipeline_class is compiler.Compiler
    return usual and type(dispatcher._cache) is caching.NullCache and dispatcher._can_compile  # noqa: SLF001 - as above


def options(callee: Any) -> tuple[object, ...]:
    """What `njit` was given beside the function: options, and types of locals. Functions that it was not put on have none."""
    if not is_dispatcher(callee):
        return (), ()
    chosen: dict[str, Any] = callee.targetoptions
    types: dict[str, Any] = callee.locals
    return tuple((name, _ordered(value)) for name, value in sorted(chosen.items())), tuple(sorted(types.items()))


def _ordered(value: Any) -> Any:
    return tuple(sorted(map(str, cast("set[object]", value)))) if type(value) is set else value
