"""Objects that versions identify: what Python, numpy and numba brought, as long as nobody has put something else in its place.

An object is known by what cannot be lent to another one: a C function by its module, a Python function by the globals that it runs in and
the file that its code comes from, a class or a dispatcher of numba's by standing in its module under its name. A name alone proves nothing:
`functools.wraps` copies it.
"""

from __future__ import annotations

import os
import sys
from functools import cache
from types import BuiltinFunctionType, FunctionType, ModuleType
from typing import Any, cast

import numpy as np

LANGUAGE = ("builtins", "math", "cmath", "operator", "_operator", "enum")
LIBRARIES = ("numpy", "numba")


def is_known_module(module: ModuleType) -> bool:
    """Whether a module is one of Python's, numpy's or numba's, and not a file of the user's that has the same name."""
    package = module.__name__.partition(".")[0]
    if sys.modules.get(module.__name__) is not module:
        return False
    folder = _folder_of_language() if module.__name__ in LANGUAGE else _folder_of(package) if package in LIBRARIES else None
    if folder is None:
        return False
    file = getattr(module, "__file__", None)
    return os.path.realpath(file).startswith(folder + os.sep) if file else package in sys.builtin_module_names


def is_known(value: Any) -> bool:
    """Whether the versions of Python, numpy and numba say all about an object that is neither a module nor a constant."""
    if type(value) is BuiltinFunctionType:
        return isinstance(value.__self__, ModuleType) and is_known_module(value.__self__)
    if type(value) is FunctionType:
        module = sys.modules.get(str(value.__globals__.get("__name__")))
        is_of_module = module is not None and vars(module) is value.__globals__ and is_known_module(module)
        is_of_file = is_of_module and value.__code__.co_filename == getattr(module, "__file__", None)
        return is_of_file and value.__closure__ is None  # what a function was made around is nobody's version
    if isinstance(value, type):
        return _is_found(value, value.__module__, value.__qualname__)
    if type(value) is np.ufunc:
        return any(_is_found(value, module, value.__name__) for module in ("numpy._core._multiarray_umath", "numpy.core._multiarray_umath"))
    kind: type = type(cast("object", value))
    if kind.__module__ == "numpy" and kind.__name__ == "_ArrayFunctionDispatcher":
        return is_known(value._implementation)  # noqa: SLF001 - numpy has no other name for it
    return kind.__module__.startswith("numba.core.types.") and is_known(kind) and _is_found(value, "numba.core.types", str(value))


def has_known_attributes(module: ModuleType) -> bool:
    """Whether versions also say which attributes a known module makes when they are asked for (PEP 562)."""
    makes = vars(module).get("__getattr__")
    return is_known_module(module) and (makes is None or is_known(makes))


def is_known_dispatcher(dispatcher: Any) -> bool:
    """Whether a dispatcher is numba's own, and not one that a user's `njit` made of a known function, with options of its own."""
    function = dispatcher.py_func
    return is_known(function) and _is_found(dispatcher, function.__module__, function.__qualname__)


def _is_found(value: object, module: str, name: str) -> bool:
    """Whether the object stands in a known module under this name."""
    holder = sys.modules.get(module)
    if holder is None or not is_known_module(holder):
        return False
    found: object = holder
    for part in name.split("."):
        found = vars(found).get(part) if isinstance(found, ModuleType | type) else None
    return found is value


@cache
def _folder_of_language() -> str:
    return os.path.realpath(os.path.dirname(os.__file__))  # noqa: PTH120 - pathlib says no more


def _folder_of(package: str) -> str | None:
    file = getattr(sys.modules.get(package), "__file__", None)
    return os.path.realpath(os.path.dirname(file)) if file else None  # noqa: PTH120 - as above
