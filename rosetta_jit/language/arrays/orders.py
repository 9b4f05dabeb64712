"""Orders of bytes that a function makes or takes, in one typed call: `rosetta_jit.functions.reorders` says what of."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, TypeGuard

from rosetta_jit.catalogue import layouts as words
from rosetta_jit.language.arrays.array_functions import ARGUMENTS, NUMBER_BYTES, NUMBERS, PADDED
from rosetta_jit.language.arrays.counts import LayoutError
from rosetta_jit.language.conversions import as_int64
from rosetta_jit.language.image_orders import COLOURS, COUNT, ORDERED
from rosetta_jit.language.installed import written
from rosetta_jit.language.scope import Scope
from rosetta_jit.language.typed import INT64, Call, Const, Expr
from rosetta_jit.model import expr as model
from rosetta_jit.model.types import Bool, Bytes, String
from rosetta_jit.model.walk import rebuilt
from rosetta_jit.startup.dataclass import replace
from rosetta_jit.startup.late import Late

if TYPE_CHECKING:
    from rosetta_jit.language.arrays import layouts

    TypeExpr = Callable[[model.Expr, Scope], Expr | None]
else:
    layouts = Late("rosetta_jit.language.arrays.layouts")

BYTES = model.Path("wire", (model.Member(COUNT),))
"""The bytes, where layouts are made of them."""


def core_of(expr: model.Expr) -> model.Expr:
    """What an order is of."""
    while isinstance(expr, model.Call) and expr.function in ARGUMENTS and expr.arguments:
        expr = expr.arguments[0]
    return expr


def is_order(expr: model.Expr) -> TypeGuard[model.Call]:
    """Whether an expression is an array in another order."""
    return isinstance(expr, model.Call) and expr.function in ARGUMENTS


def is_of_image(value: model.Expr) -> bool:
    """Whether a value is an image or its pixels, perhaps in another order: no element of it lies in a message."""
    core = core_of(value)
    return isinstance(core, model.Call) and takes_orders(core.function)


def takes_orders(function: str) -> bool:
    """Whether a function takes and gives the bytes of images, so that these may be in another order."""
    known = written(function)
    return known is not None and (known.operation == "image compression" or function in COLOURS)


def type_order(call: model.Call, scope: Scope, type_expr: TypeExpr) -> Expr | None:
    """The typed call of bytes in another order; None where there is none, and the problem is in the scope."""
    core = type_expr(core_of(call), scope)
    if core is None:
        return None
    padding: tuple[model.Expr, ...] = ()
    inner: model.Expr = call
    if call.function == PADDED and len(call.arguments) == 4:
        inner, *sizes = call.arguments
        padding = tuple(sizes)
    try:
        view = layouts.view_of(_with_bytes(inner))
    except LayoutError as error:
        scope.problems.append(error.problem)
        return None
    if view.number is not None:
        scope.problems.append(words.numbers_of_image(call.span))
        return None
    parts: list[model.Expr] = [view.first]
    for axis in view.axes:
        parts += [axis.count, axis.step]
    conditions = [condition for condition, _ in view.refused]
    numbers = [_integer(each, scope, type_expr) for each in (*parts, *padding)]
    checks = [_typed(each, scope, type_expr) for each in conditions]
    if any(each is None for each in (*numbers, *checks)):
        return None
    known = [each for each in numbers if each is not None]
    arguments: list[Expr] = [core, known[0], Const(len(view.axes), INT64)]
    for number, axis in enumerate(view.axes):
        listed = "" if axis.listed is None else ",".join(map(str, axis.listed))
        arguments += [known[1 + 2 * number], known[2 + 2 * number], Const(listed, String())]
    arguments += [Const(bool(padding), Bool()), *known[1 + 2 * len(view.axes) :]]
    for check, (_, reason) in zip(checks, view.refused, strict=True):
        arguments += [each for each in (check, Const(reason, String())) if each is not None]
    return Call(ORDERED, tuple(arguments), Bytes(), call.span)


def _with_bytes(expr: model.Expr) -> model.Path | model.Call:
    """An order of `BYTES` in place of what it is of."""
    if isinstance(expr, model.Call) and expr.function in ARGUMENTS and expr.arguments:
        if expr.function in (NUMBERS, NUMBER_BYTES):
            raise LayoutError(words.numbers_of_image(expr.span))
        array, *rest = expr.arguments
        return model.Call(expr.function, (_with_bytes(array), *rest), expr.span)
    return BYTES


def _integer(expr: model.Expr, scope: Scope, type_expr: TypeExpr) -> Expr | None:
    typed = _typed(expr, scope, type_expr)
    whole = None if typed is None else as_int64(typed)
    if typed is not None and whole is None:
        scope.problems.append(words.no_size(expr.span))
    return whole


def _typed(expr: model.Expr, scope: Scope, type_expr: TypeExpr) -> Expr | None:
    """An expression of sizes, with the name of how many bytes there are in place of that."""
    named = replace(scope, values={**scope.values, COUNT: INT64})
    return type_expr(_counted(expr), named)


def _counted(expr: model.Expr) -> model.Expr:
    return model.Name(COUNT) if expr == model.Len(BYTES) else rebuilt(expr, _counted)
