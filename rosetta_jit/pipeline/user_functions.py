"""The functions that a user gives, against those that the mapping declares: each has its other half, and compiles to what is declared."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from importlib.util import find_spec
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import functions as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.errors import MappingError
from rosetta_jit.kernel.host import UserFunction
from rosetta_jit.kernel.nodes import HostCall, Scalar
from rosetta_jit.runtime.code.allowed import ALLOWED
from rosetta_jit.runtime.code.object_file import undefined_symbols
from rosetta_jit.startup.late import Late

if TYPE_CHECKING:
    from rosetta_jit.language.uses import Signature
    from rosetta_jit.lowering.rules import scalars
    from rosetta_jit.pipeline.request import Request
else:
    scalars = Late("rosetta_jit.lowering.rules.scalars")


def check_given(request: Request, declared: Mapping[str, Signature]) -> None:
    """Refuse functions that no mapping declares."""
    problems = tuple(words.not_declared(each.name, declared.keys()) for each in request.functions if each.name not in declared)
    if problems:
        raise MappingError(problems)


def called_functions(request: Request, declared: Mapping[str, Signature], calls: Iterable[HostCall]) -> tuple[UserFunction, ...]:
    """The functions that kernels call, as given. A name with a dot is one of ours."""
    called = sorted({call.function for call in calls if "." not in call.function})
    functions = {each.name: each.function for each in request.functions}
    missing = tuple(words.not_given(declared[name].span, name) for name in called if name not in functions)
    if missing:
        raise MappingError(missing)
    return tuple(_user_function(declared[name], functions[name]) for name in called)


def _user_function(signature: Signature, function: object) -> UserFunction:
    assert callable(function)
    parameters: tuple[Scalar, ...] = tuple(scalars.scalar_type(each) for each in signature.parameters)
    return UserFunction(signature.name, function, parameters, scalars.scalar_type(signature.result))


def check_compiled(functions: Iterable[UserFunction], declared: Mapping[str, Signature]) -> tuple[str, ...]:
    """Refuse functions that do not compile to what is declared of them, or that need more of the process than kernels may have.

    The answer names those that do and whose code has addresses of this process: no other process may run it.
    """
    found = [_compiled(function, declared[function.name]) for function in functions]
    problems = tuple(each for each in found if not isinstance(each, str))
    if problems:
        raise MappingError(problems)
    return tuple(str(each) for each in found if each)


def _compiled(function: UserFunction, declared: Signature) -> Diagnostic | str:
    """What is wrong with a function, or its name if its code has addresses of this process, or nothing."""
    if find_spec("numba") is None:
        return words.no_compiler(declared.span)
    from rosetta_jit.backends.numba.user_functions import FunctionTypeError, compile_function, has_addresses
    from rosetta_jit.runtime.code.assembler import target_machine

    try:
        module = compile_function(function)
    except FunctionTypeError as error:
        return words.does_not_compile(declared.span, function.name, str(error))
    foreign = sorted(undefined_symbols(target_machine().emit_object(module)) - ALLOWED)
    if foreign:
        why = f"it needs {', '.join(foreign[:3])}, which kernels cannot call"
        return words.does_not_compile(declared.span, function.name, why)
    return function.name if has_addresses(module) else ""
