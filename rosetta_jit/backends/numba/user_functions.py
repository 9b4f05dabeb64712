"""Users' functions, compiled by numba to LLVM modules that are linked with kernels."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from llvmlite import binding
from numba import njit, types
from numba.core.errors import NumbaError, UnsupportedBytecodeError
from numba.core.registry import CPUDispatcher

from rosetta_jit.backends.llvm.host import symbol
from rosetta_jit.backends.numba.function import library
from rosetta_jit.kernel.nodes import WIDTH

if TYPE_CHECKING:
    from numba.core.dispatcher import Dispatcher

    from rosetta_jit.kernel.host import UserFunction

NUMBA_TYPES: dict[str, Any] = {
    "bool": types.boolean,
    **{f"{kind[0]}{bits}": getattr(types, f"{kind}{bits}") for kind in ("int", "uint") for bits in (8, 16, 32, 64)},
    "f32": types.float32,
    "f64": types.float64,
}
KEPT = ("error_model", "fastmath", "boundscheck")
"""Of the options that `njit` was given, those that change what a function computes."""

RAISED = (
    *(NumbaError, UnsupportedBytecodeError),
    *(ArithmeticError, AssertionError, AttributeError, ImportError, LookupError, RuntimeError, TypeError, ValueError),
)
"""What numba raises on functions that it cannot compile: errors of its own, and whatever its code runs into on the way."""

ADDRESSES = "numba.dynamic.globals."
"""How the names of global variables begin in which numba keeps addresses of the process (`add_dynamic_addr` of numba/core/base.py)."""

MAX_REASON = 400


class FunctionTypeError(ValueError):
    """A function that is not what it is declared as; says why."""


def compile_function(declared: UserFunction) -> binding.ModuleRef:
    """A module that defines the function under its name as one of the host; raises FunctionTypeError."""
    function, options = _taken_apart(declared.function)
    decorate: Any = njit
    arguments = tuple(NUMBA_TYPES[each] for each in declared.parameters)

    def compiled(signature: object) -> Dispatcher:
        return decorate(signature, nogil=True, no_cpython_wrapper=True, no_cfunc_wrapper=True, **options)(function)

    try:
        dispatcher = compiled(arguments)
        found = _returned(dispatcher)
        if found != declared.result:
            if not _widens(found, declared.result):
                raise FunctionTypeError(f"it gives {_shown(dispatcher)}, not {NUMBA_TYPES[declared.result]}")
            dispatcher = compiled(NUMBA_TYPES[declared.result](*arguments))
    except RAISED as error:
        raise FunctionTypeError(_reason(error)) from error
    return _module(declared.name, dispatcher)


def _taken_apart(callee: Any) -> tuple[Any, dict[str, Any]]:
    """The Python function, and what `njit` was told of it: options that change what it computes, and types of locals."""
    if type(callee) is not CPUDispatcher:
        return callee, {}
    options = {key: value for key, value in callee.targetoptions.items() if key in KEPT}
    return callee.py_func, {**options, "locals": callee.locals}


def has_addresses(module: binding.ModuleRef) -> bool:
    """Whether compiled code refers to objects or functions of this process by their addresses."""
    return any(variable.name.startswith(ADDRESSES) for variable in module.global_variables)


def _module(name: str, dispatcher: Dispatcher) -> binding.ModuleRef:
    text, mangled = library(dispatcher)
    module = binding.parse_assembly(text)
    for defined in (*module.functions, *module.global_variables):
        if not defined.is_declaration and defined.name != mangled:
            defined.linkage = "internal"
    module.get_function(mangled).name = symbol(name)
    return module


def _returned(dispatcher: Dispatcher) -> str:
    """The scalar that a function gives; empty for anything else."""
    (compiled,) = dispatcher.overloads.values()
    return next((scalar for scalar, type_ in NUMBA_TYPES.items() if type_ == compiled.signature.return_type), "")


def _shown(dispatcher: Dispatcher) -> str:
    (compiled,) = dispatcher.overloads.values()
    return str(compiled.signature.return_type)[:MAX_REASON]


def _widens(found: str, wanted: str) -> bool:
    """Whether every number of one kind is one of the other."""
    if not found or "bool" in (found, wanted):
        return False
    if found[0] == wanted[0]:
        return WIDTH[found] < WIDTH[wanted]
    to_signed, to_float = found[0] == "u" and wanted[0] == "i", found[0] in "iu" and wanted[0] == "f"
    return (to_signed or to_float) and WIDTH[found] < WIDTH[wanted]


def _reason(error: Exception) -> str:
    """What numba says, on one line."""
    lines = [line.strip() for line in str(error).splitlines()]
    return "numba: " + " ".join(line for line in lines if line)[:MAX_REASON]
