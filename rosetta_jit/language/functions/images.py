"""Types of what is done with images.

decompress (bytes)                                              the pixels, row by row, channels interleaved
compress (pixels, "png", width, height, channels [, level])     also "png16", and "jpeg" with a quality
image_width image_height image_channels image_depth (bytes)     of a compressed image
"""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from rosetta_jit.catalogue import images as words
from rosetta_jit.language.conversions import as_int64, describe
from rosetta_jit.language.typed import INT64, Access, Const, ImageCall
from rosetta_jit.model.types import Array, Bytes, Int

if TYPE_CHECKING:
    from collections.abc import Callable

    from rosetta_jit.language.scope import Scope
    from rosetta_jit.language.typed import Expr, ImageFunction
    from rosetta_jit.model import expr as model
    from rosetta_jit.model.types import Type

    TypeExpr = Callable[[model.Expr, Scope], Expr | None]

MEASURES = ("image_width", "image_height", "image_channels", "image_depth")
IMAGE_FUNCTIONS = ("decompress", "compress", *MEASURES)
DEFAULTS = {"png": 1, "png16": 1, "jpeg": 90}
"""Formats, and how hard they compress unless the mapping says it: PNG's level (0 to 9), JPEG's quality (1 to 100)."""


def is_bytes(type_: Type) -> bool:
    """Whether a value is bytes, or an array of them."""
    match type_:
        case Bytes():
            return True
        case Array(element):
            return isinstance(element, Int) and element.bits == 8
        case _:
            return False


def type_image_call(expr: model.Call, scope: Scope, type_expr: TypeExpr) -> Expr | None:
    """A call of one of the functions above."""
    typed = [type_expr(argument, scope) for argument in expr.arguments]
    known = [argument for argument in typed if argument is not None]
    if len(known) < len(typed):
        return None
    function = cast("ImageFunction", expr.function)
    wanted = (5, 6) if function == "compress" else (1,)
    if len(known) not in wanted:
        scope.problems.append(words.arguments(expr.span, function, len(known)))
        return None
    if not (isinstance(known[0], Access | ImageCall) and is_bytes(known[0].type)):
        scope.problems.append(words.no_bytes(known[0].span, function, describe(known[0].type)))
        return None
    if function == "compress":
        return _compressed(expr, known, scope)
    return ImageCall(function, known[0], Bytes() if function == "decompress" else INT64, span=expr.span)


def _compressed(expr: model.Call, arguments: list[Expr], scope: Scope) -> Expr | None:
    pixels, format_, *numbers = arguments
    named = format_.value if isinstance(format_, Const) else None
    if not isinstance(named, str) or named not in DEFAULTS:
        scope.problems.append(words.unknown_format(format_.span, named if isinstance(named, str) else None, tuple(DEFAULTS)))
        return None
    whole = [as_int64(number) for number in numbers]
    for number, integer in zip(numbers, whole, strict=True):
        if integer is None:
            scope.problems.append(words.no_integer(number.span, describe(number.type)))
    known = [number for number in whole if number is not None]
    if len(known) < len(whole):
        return None
    given = known if len(known) == 4 else [*known, Const(DEFAULTS[named], INT64)]
    return ImageCall("compress", pixels, Bytes(), named, tuple(given), expr.span)
