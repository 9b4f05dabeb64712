"""What others than numba itself have taught numba in this process: it may change what any function compiles to.

Numba keeps what it is taught in registries: types of functions and attributes (`overload`, `overload_method`, `infer_global`), their code
(`lower_builtin`, `lower_cast`), types of Python objects (`typeof_impl`), layouts of types, rewrites. Whatever stands there about a thing
that every function can reach - a built-in function, one of numpy's, a method of a number - and is not numba's or ours makes all functions
uncertain. What stands there about a function or a type of the user's own does not: a function that reaches it is uncertain for that reason.

Where numba was not imported, nobody has taught it anything.
"""

from __future__ import annotations

import enum
import os
import sys
from collections.abc import Iterator, Mapping
from contextlib import suppress
from functools import cache
from types import CellType, FunctionType, MethodType
from typing import Any, cast
from weakref import ReferenceType

from rosetta_jit.catalogue import uncertain as words
from rosetta_jit.runtime.functions.known import is_known

MAKERS = frozenset(("numba", "rosetta_jit", "abc", "builtins", "typing"))
"""Packages whose classes numba's are made of; `abc` is the module of classes that numba makes as it goes."""

_EMPTY = CellType()


def doubts() -> Iterator[str]:
    """Each thing of everybody's that somebody taught numba to see in another way; none where numba was not imported."""
    if "numba.core.registry" in sys.modules:
        found = {_name(key): None for key, taught in _registered() if not _is_of_numba(taught) and not _is_own(key)}
        yield from map(words.registered, found)


def _registered() -> Iterator[tuple[object, object]]:
    """What numba was taught about, and the class or function that says how: what waits in registries, and what was taken from them."""
    target: Any = sys.modules["numba.core.registry"].cpu_target
    yield from _types(sys.modules["numba.core.typing.templates"].builtin_registry, target.typing_context)
    yield from _code(sys.modules["numba.core.imputils"].builtin_registry, target.target_context)
    yield from sys.modules["numba.core.typing.typeof"].typeof_impl.registry.copy().items()
    yield from sys.modules["numba.core.datamodel"].default_manager._handlers.copy().items()  # noqa: SLF001 - numba has no other name
    rewrites: dict[str, list[object]] = sys.modules["numba.core.rewrites"].rewrite_registry.rewrites
    yield from (("rewrites", each) for some in rewrites.values() for each in some)


def _types(waiting: Any, context: Any) -> Iterator[tuple[object, object]]:
    """Types of functions, of attributes, and of objects. Tables are copied: objects that are freed meanwhile leave them."""
    yield from ((each.key, each) for each in (*waiting.functions, *waiting.attributes))
    for table in (context._functions, context._attributes):  # noqa: SLF001 - numba has no other name
        yield from ((key, each) for key, some in table.copy().items() for each in some)
    for value, type_ in (*waiting.globals, *context._globals.copy().items()):  # noqa: SLF001 - as above
        yield from _typed(value, type_)


def _code(waiting: Any, context: Any) -> Iterator[tuple[object, object]]:
    """Code of functions, attributes, conversions and constants."""
    yield from ((function, each) for each, function, _ in waiting.functions)
    yield from ((types[0], each) for each, _, types in (*waiting.getattrs, *waiting.setattrs))
    yield from ((types, each) for each, types in (*waiting.casts, *waiting.constants))
    yield from ((key, each) for key, some in context._defns.copy().items() for _, each in some.versions)  # noqa: SLF001 - as above
    attributes = (*context._getattrs.copy().values(), *context._setattrs.copy().values())  # noqa: SLF001 - as above
    yield from ((types[0], each) for some in attributes for types, each in some.versions)
    yield from ((types, each) for some in (context._casts, context._get_constants) for types, each in some.versions)  # noqa: SLF001 - as above


def _typed(value: Any, type_: Any) -> Iterator[tuple[object, object]]:
    """What makes up the type that an object was given: templates, or the function behind a dispatcher that is not the object itself."""
    key: object = value() if type(cast("object", value)) is ReferenceType else value
    if type(type_).__name__ == "Dispatcher":
        with suppress(ReferenceError):  # a dispatcher that is freed already, which nothing can reach
            dispatcher = type_.dispatcher
            yield from [] if dispatcher is key else [(key, dispatcher.py_func)]
    else:
        yield from ((key, each) for each in getattr(type_, "templates", (type_,)))


def _is_own(key: object) -> bool:
    """Whether something is a function or class of the user's own, of which none can be reached without being noticed."""
    if isinstance(key, tuple):
        return any(map(_is_own, cast("tuple[object, ...]", key)))
    if isinstance(key, MethodType):  # as which a template that is an instance gives the function that it is about
        return _is_own(key.__func__)
    if isinstance(key, FunctionType):
        return not is_known(key)
    if isinstance(key, type):
        return not is_known(key) and not issubclass(key, tuple | enum.Enum | BaseException)
    return type(key).__qualname__ == "_Intrinsic" or (_is_type(key) and not is_known(type(key)))


def _is_type(key: object) -> bool:
    """Whether something is one of numba's types, such as that of a class of the user's."""
    return isinstance(key, sys.modules["numba.core.types"].Type)


def _is_of_numba(taught: object) -> bool:
    """Whether all code of a template, a model or an implementation is numba's or ours."""
    if type(taught) is FunctionType:
        return _is_function_of_numba(taught)
    return all(map(_is_class_of_numba, (taught if isinstance(taught, type) else type(taught)).__mro__))


@cache
def _is_class_of_numba(cls: type) -> bool:
    """Whether a class is numba's or ours, apart from what it inherits."""
    return cls.__module__.partition(".")[0] in MAKERS and all(map(_is_function_of_numba, _functions(vars(cls))))


def _functions(attributes: Mapping[str, Any]) -> Iterator[FunctionType]:
    """The functions among a class's attributes. What a template is about is one of them, too, under the name `key`."""
    for name, value in attributes.items():
        function = getattr(value, "__func__", getattr(value, "fget", value))
        if isinstance(function, FunctionType) and name != "key":
            yield function


@cache
def _is_function_of_numba(function: FunctionType) -> bool:
    """Whether a function's code is numba's or ours, and that of functions that it was made around."""
    around = [cell.cell_contents for cell in function.__closure__ or () if cell != _EMPTY]
    inner = [each for each in around if isinstance(each, FunctionType) and each is not function]
    return function.__code__.co_filename.startswith(_folders()) and all(is_known(each) or _is_function_of_numba(each) for each in inner)


@cache
def _folders() -> tuple[str, ...]:
    """Where numba's code lies, and ours."""
    packages = (sys.modules[name].__file__ or "" for name in ("numba", "rosetta_jit", "abc"))
    return (*(f"{os.path.dirname(file)}{os.sep}" for file in packages),)  # noqa: PTH120 - pathlib says no more


def _name(key: object) -> str:
    if isinstance(key, tuple):
        return " to ".join(map(_name, cast("tuple[object, ...]", key)))
    return key if isinstance(key, str) else f"`{getattr(key, '__qualname__', key)}`"
