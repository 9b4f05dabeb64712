"""Functions of a mapping's user: what it declares of them, and the types of their calls.

A mapping is checked without the functions themselves: their types stand in it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import functions as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.language.conversions import convert, describe, word_for
from rosetta_jit.language.functions.calls import FLOATS, INTEGERS, named_type
from rosetta_jit.language.groups import group_functions
from rosetta_jit.language.installed import names
from rosetta_jit.language.limits import MAX_PARAMETERS
from rosetta_jit.language.scope import Scope
from rosetta_jit.language.typed import Expr, HostCall
from rosetta_jit.language.uses import Signature
from rosetta_jit.model import expr as model
from rosetta_jit.model.mapping import Function, Mapping, TypeName
from rosetta_jit.model.types import Type

if TYPE_CHECKING:
    TypeExpr = Callable[[model.Expr, Scope], Expr | None]

SCALARS = (*INTEGERS, *FLOATS, "bool")


def signatures(mappings: Iterable[Mapping], problems: list[Diagnostic]) -> dict[str, Signature]:
    """The functions by name that a mapping and those that it uses declare: where several declare one, all mean the same."""
    found: dict[str, Signature] = {}
    for mapping in mappings:
        for name, signature in _declared(mapping.functions, problems).items():
            first = found.setdefault(name, signature)
            if (first.parameters, first.result) != (signature.parameters, signature.result):
                problems.append(words.repeated(signature.span, name, first.span))
    return found


def _declared(functions: Iterable[Function], problems: list[Diagnostic]) -> dict[str, Signature]:
    """The functions of one mapping. One whose types are wrong is reported and left out."""
    found: dict[str, Signature] = {}
    for function in functions:
        types = [_scalar(each, problems) for each in (*function.parameters, function.result)]
        known = [each for each in types if each is not None]
        if function.name in {*names(), *group_functions(), *SCALARS} or "." in function.name:
            problems.append(words.taken(function.span, function.name))
        elif function.name in found:
            problems.append(words.repeated(function.span, function.name, found[function.name].span))
        elif len(function.parameters) > MAX_PARAMETERS:
            problems.append(words.many_parameters(function.span, MAX_PARAMETERS))
        elif len(known) == len(types):
            found[function.name] = Signature(function.name, tuple(known[:-1]), known[-1], function.span)
    return found


def _scalar(name: TypeName, problems: list[Diagnostic]) -> Type | None:
    if name.name not in SCALARS:
        problems.append(words.no_scalar(name.span, name.name, SCALARS))
        return None
    return named_type(name.name)


def type_host_call(expr: model.Call, signature: Signature, scope: Scope, type_expr: TypeExpr) -> Expr | None:
    """A call of a declared function: each argument becomes its parameter's type if that needs no word."""
    if len(expr.arguments) != len(signature.parameters):
        scope.problems.append(words.arguments(expr.span, signature.name, len(signature.parameters), len(expr.arguments), signature.span))
        return None
    typed = [type_expr(argument, scope) for argument in expr.arguments]
    arguments = [
        None if argument is None else _argument(argument, wanted, signature, scope)
        for argument, wanted in zip(typed, signature.parameters, strict=True)
    ]
    known = [argument for argument in arguments if argument is not None]
    return HostCall(signature.name, tuple(known), signature.result, expr.span) if len(known) == len(arguments) else None


def _argument(argument: Expr, wanted: Type, signature: Signature, scope: Scope) -> Expr | None:
    fitting = convert(argument, wanted)
    if fitting is None:
        types = describe(argument.type), describe(wanted)
        scope.problems.append(words.argument(argument.span, signature.name, types, word_for(argument.type, wanted), signature.span))
    return fitting
