"""The functions in C behind the methods of a class: compiled code that calls them passes over the interpreter's way to them."""

from __future__ import annotations

from types import MethodDescriptorType, WrapperDescriptorType
from typing import Any

from rosetta_jit.runtime import type_specs
from rosetta_jit.runtime.callable import is_native
from rosetta_jit.startup.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class InC:
    """The functions in C of one class.

    Attributes
    ----------
    object_type
        The class, which has no other functions for its objects.
    write
        The address of a method that makes bytes of an object, and takes a tuple and a dict of arguments (``METH_VARARGS | METH_KEYWORDS``).
    allocate
        The address of what makes an empty object (``tp_new``), which nothing has to initialise.
    merge
        The address of a method that reads bytes into an object, its one argument (``METH_O``).
    """

    object_type: type
    write: int
    allocate: int
    merge: int


def functions_in_c(object_type: Any, module: str, *, write: str, merge: str) -> InC | None:
    """The functions in C of a class, given the names of two methods.

    None where they and the initialiser are not all of one class in a certain module, whose initialisers are known to do nothing if they are
    given nothing; and where Python's own objects lie in memory in an unknown way.
    """
    writer, merger, begin = getattr(object_type, write), getattr(object_type, merge), object_type.__init__
    are_methods = isinstance(writer, MethodDescriptorType) and isinstance(merger, MethodDescriptorType)
    if not (is_native() and are_methods and isinstance(begin, WrapperDescriptorType)):
        return None
    owners = {each.__objclass__ for each in (writer, merger, begin)}
    if len(owners) != 1 or owners.pop().__module__ != module or type(object_type).__call__ is not type.__call__:
        return None
    writes = type_specs.function_behind(writer, type_specs.VARARGS | type_specs.KEYWORDS)
    allocates, merges = type_specs.allocator_of(object_type), type_specs.function_behind(merger, type_specs.ONE_ARGUMENT)
    return InC(object_type, writes, allocates, merges) if writes and allocates and merges else None
