"""Pixels as cameras send them, made RGB, and RGB made YUV: `rosetta_jit.lowering.colours`.

rgb_of yuv_of (bytes, encoding, width, height [, step])
"""

from __future__ import annotations

from rosetta_jit.catalogue import images as words
from rosetta_jit.functions.images import bytes_of, makes_bytes, typed_integers
from rosetta_jit.kernel.nodes import Wire
from rosetta_jit.kernel.terms import add
from rosetta_jit.language import typed
from rosetta_jit.language.conversions import describe
from rosetta_jit.language.function import NOT_FOLLOWED, SEVERAL, Function, Row
from rosetta_jit.language.scope import Scope
from rosetta_jit.language.typed import INT64
from rosetta_jit.lowering.colours.conversion import ENCODINGS, HALVED, PACKED, Picture
from rosetta_jit.lowering.colours.to_rgb import to_rgb
from rosetta_jit.lowering.colours.to_yuv import to_yuv
from rosetta_jit.lowering.evaluation import Evaluation
from rosetta_jit.lowering.texts.views import View, sound
from rosetta_jit.model import expr as model
from rosetta_jit.model.types import Bytes, String

YUV = (*PACKED, *HALVED)


def _type_colours(call: model.Call, arguments: list[typed.Expr], scope: Scope) -> typed.Expr | None:
    """A call: bytes that lie in a field or are decompressed, an encoding in quotes, integers."""
    if len(arguments) not in (4, 5):
        scope.problems.append(words.arguments(call.span, call.function, len(arguments)))
        return None
    pixels, encoding, *numbers = arguments
    if not makes_bytes(pixels):
        scope.problems.append(words.no_bytes(pixels.span, call.function, describe(pixels.type)))
        return None
    named = encoding.value if isinstance(encoding, typed.Const) and isinstance(encoding.value, str) else None
    is_rgb = call.function == "rgb_of"
    if named not in (known_ones := ENCODINGS if is_rgb else YUV):
        scope.problems.append(words.unknown_encoding(encoding.span, named, known_ones, "RGB" if is_rgb else "YUV"))
        return None
    known = typed_integers(numbers, scope)
    if known is None:
        return None
    if len(known) == 2:  # rows lie end to end
        width = known[0]
        each = 3 if not is_rgb else 2 if named in PACKED else 1
        known.append(width if each == 1 else typed.Binary("*", width, typed.Const(each, INT64), INT64, width.span))
    return typed.Call(call.function, (pixels, typed.Const(named, String()), *known), Bytes(), call.span)


def _lower_colours(call: typed.Call, values: Evaluation) -> View:
    pixels, encoding, *numbers = call.arguments
    assert isinstance(encoding, typed.Const)
    extent, writer = bytes_of(pixels, values), values.writer
    width, height, step = (writer.let("number", values.of(each)) for each in numbers)
    lane, first = (None, extent.address.at) if isinstance(extent.address, Wire) else (extent.address.lane, extent.address.row)
    first = writer.let("first", first)
    view = sound(writer, View(lane, first, writer.let("after", add(first, extent.size))))
    convert = to_rgb if call.function == "rgb_of" else to_yuv
    return convert(writer, str(encoding.value), Picture(view, width, height, step), values.where, values.line)


ROW = Row(
    "images",
    '`rgb_of(b, "nv12", w, h)`, `rgb_of(b, "nv12", w, h, step)`',
    (
        "pixels, their encoding, and as integers their width, their height, and how many bytes apart rows begin: end to end, unless told",
        "the pixels as RGB, as bytes",
    ),
)

TO_YUV = Row(
    "images",
    '`yuv_of(b, "nv12", w, h)`, `yuv_of(b, "nv12", w, h, step)`',
    ("pixels of RGB, an encoding of YUV, and the same integers", "the pixels in that encoding, as bytes"),
)

FUNCTIONS = (
    Function("rgb_of", _type_colours, _lower_colours, SEVERAL, NOT_FOLLOWED, (ROW,), kept=False),
    Function("yuv_of", _type_colours, _lower_colours, SEVERAL, NOT_FOLLOWED, (TO_YUV,), kept=False),
)
