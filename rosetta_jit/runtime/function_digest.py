"""What a user's function computes, as a digest: a program that calls it is compiled again when that changes, and not before.

The digest covers bytecode, constants, defaults, closure, and the globals that the code names, other functions among them. Whatever
cannot be looked into (an object of some class) makes the digest a new one each time, so that its program is never found in the cache.
"""

from __future__ import annotations

import os
from dataclasses import field
from types import BuiltinFunctionType, CodeType, FunctionType, ModuleType
from typing import Any, cast

import numpy as np

from rosetta_jit.dataclass import dataclass
from rosetta_jit.sha import sha256

PLAIN = (type(None), bool, int, float, complex, str, bytes, type(...))
MAX_FUNCTIONS = 1000
"""Functions that are followed from one."""


def python_function(given: object) -> FunctionType:
    """The function that Python runs: itself, or what numba's `njit` was put on.

    Raises
    ------
    TypeError
        It is neither.
    """
    found = getattr(given, "py_func", given)
    if not isinstance(found, FunctionType):
        raise TypeError(f"a mapping calls Python functions, and those of numba's njit; {type(given).__name__} is neither")
    return found


def digest_of(given: object) -> str:
    """The digest of a function."""
    walk = _Walk()
    walk.add(given)
    while walk.pending:
        walk.function(walk.pending.pop())
    return sha256("\n".join(walk.parts).encode("utf-8", "surrogatepass")).hexdigest()


@dataclass(slots=True)
class _Walk:
    """What was found so far, and the functions that are still to be looked into."""

    parts: list[str] = field(default_factory=list[str])
    pending: list[FunctionType] = field(default_factory=list[FunctionType])
    seen: dict[int, int] = field(default_factory=dict[int, int])

    def add(self, given: object) -> None:
        function = python_function(given)
        self.parts.append(repr(sorted(getattr(given, "targetoptions", {}).items(), key=str)))
        if id(function) not in self.seen and len(self.seen) < MAX_FUNCTIONS:
            self.seen[id(function)] = len(self.seen)
            self.pending.append(function)
        self.parts.append(f"function {self.seen.get(id(function), os.urandom(16).hex())}")

    def function(self, function: FunctionType) -> None:
        names = self.code(function.__code__)
        cells = [cell.cell_contents for cell in function.__closure__ or ()]
        for value in (function.__defaults__, tuple((function.__kwdefaults__ or {}).items()), *cells):
            self.value(value, names)
        for name in sorted(names & function.__globals__.keys()):
            self.parts.append(name)
            self.value(function.__globals__[name], names)

    def code(self, code: CodeType) -> set[str]:
        """The code, and the names that it mentions."""
        self.parts.append(f"{code.co_code.hex()} {code.co_varnames} {code.co_freevars} {code.co_names} {code.co_argcount} {code.co_flags}")
        self.parts.append(code.co_exceptiontable.hex())
        names = set(code.co_names)
        for constant in code.co_consts:
            if isinstance(constant, CodeType):
                names |= self.code(constant)
            else:
                self.value(constant, names)
        return names

    def value(self, value: Any, names: set[str]) -> None:
        """A value that the code can see; of a module, what the code names."""
        if isinstance(value, PLAIN):
            self.parts.append(f"{type(value).__name__} {value!r}")
        elif type(value) in {tuple, frozenset}:
            given = cast("tuple[Any, ...] | frozenset[Any]", value)
            items = sorted(given, key=repr) if isinstance(given, frozenset) else list(given)
            self.parts.append(f"{type(value).__name__} {len(items)}")
            for each in items:
                self.value(each, names)
        elif type(value) is np.ndarray or np.isscalar(value):
            array = cast("np.ndarray[Any, Any]", np.asarray(value))
            self.parts.append(f"{array.dtype.str} {array.shape} {sha256(array.tobytes()).hexdigest()}")
        elif isinstance(value, ModuleType):
            self.parts.append(value.__name__)
            for name in sorted(names & vars(value).keys()):
                self.member(vars(value)[name])
        else:
            self.called(value)

    def member(self, value: Any) -> None:
        """What a module has: of a module in it the name says enough."""
        if isinstance(value, ModuleType):
            self.parts.append(value.__name__)
        else:
            self.value(value, set())

    def called(self, value: Any) -> None:
        """Functions and classes; nothing is known of anything else."""
        if isinstance(value, BuiltinFunctionType | type) or (isinstance(value, FunctionType) and value.__module__.startswith("numpy.")):
            self.parts.append(f"{value.__module__}.{value.__qualname__}")
        elif isinstance(value, np.ufunc):
            self.parts.append(f"ufunc {value.__name__}")
        elif isinstance(getattr(value, "py_func", value), FunctionType):
            self.add(value)
        else:
            self.parts.append(os.urandom(16).hex())
