"""Compressed images: what they measure, and their bytes, compressed or not, in the hidden lane of what is computed.

decompress (bytes)                                              the pixels, row by row, channels interleaved
decompress (bytes, "png", width, height, channels [, level])    the same of an image of these measures, which `<->` packs as it says
compress (pixels, "png", width, height, channels [, level])     also "png16", and "jpeg" with a quality
image_width image_height image_channels image_depth (bytes)     of a compressed image
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import cast

from rosetta_jit.catalogue import images as words
from rosetta_jit.functions.forms import loses, undone_by
from rosetta_jit.kernel.nodes import Advance, Binary, Compare, Expr, Extent, HostCall, Local, Place, Reserve, Used, Wire
from rosetta_jit.kernel.terms import index
from rosetta_jit.language import typed
from rosetta_jit.language.conversions import as_int64, describe, is_bytes
from rosetta_jit.language.function import NOT_FOLLOWED, SEVERAL, Function, Row
from rosetta_jit.language.image_orders import COLOURS, ORDERED
from rosetta_jit.language.scope import Scope
from rosetta_jit.language.typed import INT64
from rosetta_jit.lowering.evaluation import Evaluation, lowered
from rosetta_jit.lowering.texts.views import View, sound
from rosetta_jit.model import expr as model
from rosetta_jit.model.types import Bytes, String
from rosetta_jit.startup.dataclass import replace

MEASURES = ("image_width", "image_height", "image_channels", "image_depth")
DEFAULTS = {"png": 1, "png16": 1, "jpeg": 90}
"""Formats, and how hard they compress unless the mapping says it: PNG's level (0 to 9), JPEG's quality (1 to 100)."""

MEASURE, DECOMPRESS, COMPRESSED, COMPRESS = "image.measure", "image.decompress", "image.compressed", "image.compress"
"""The host's functions: a number of an image; its pixels; the size of a compressed image, and its bytes."""

SIZE = len(MEASURES)
"""What `MEASURE` is asked for besides `MEASURES`: the bytes of all pixels."""

FORMATS = tuple(DEFAULTS)

PROBLEMS = {
    -1: "no PNG or JPEG image, or a damaged one",
    -2: "an image that is too large",
    -3: "an image with pixels of another kind: of four inks, or with 16 bits a colour",
    -4: "the pixels are not as many as the width, the height and the channels say",
    -5: "an image of no such width, height, channels or quality",
}
"""What the host's functions give where there is nothing to give."""

MAKING = frozenset(("compress", "decompress", ORDERED, *COLOURS))
"""The functions that make such bytes."""

LANE = "texts"
"""The hidden lane of what is computed: one byte a row."""


# --- types ---------------------------------------------------------------------------------------------------------------


def _type_of_image(call: model.Call, arguments: list[typed.Expr], scope: Scope) -> typed.Expr | None:
    """A call of any of these functions: its first argument is bytes that lie in a field, or that another of these functions makes."""
    wanted = {"compress": (5, 6), "decompress": (1, 5, 6)}.get(call.function, (1,))
    if len(arguments) not in wanted:
        scope.problems.append(words.arguments(call.span, call.function, len(arguments)))
        return None
    first = arguments[0]
    if not makes_bytes(first):
        scope.problems.append(words.no_bytes(first.span, call.function, describe(first.type)))
        return None
    if len(arguments) > 1:
        return _type_measured(call, arguments, scope)
    return typed.Call(call.function, (first,), Bytes() if call.function == "decompress" else INT64, call.span)


def makes_bytes(value: typed.Expr) -> bool:
    """Whether a value is bytes that lie in a field, or that one of these functions makes."""
    is_there = isinstance(value, typed.Access) or (isinstance(value, typed.Call) and value.function in MAKING)
    return is_there and is_bytes(value.type)


def _type_measured(call: model.Call, arguments: list[typed.Expr], scope: Scope) -> typed.Expr | None:
    """A call with the format and the measures of the image."""
    image, format_, *numbers = arguments
    named = format_.value if isinstance(format_, typed.Const) else None
    if not isinstance(named, str) or named not in DEFAULTS:
        scope.problems.append(words.unknown_format(format_.span, named if isinstance(named, str) else None, FORMATS))
        return None
    known = typed_integers(numbers, scope)
    if known is None:
        return None
    measures = known if len(known) == 4 else [*known, typed.Const(DEFAULTS[named], INT64)]
    return typed.Call(call.function, (image, typed.Const(named, String()), *measures), Bytes(), call.span)


def typed_integers(numbers: list[typed.Expr], scope: Scope) -> list[typed.Expr] | None:
    """Sizes of an image, each as an int64; None, and reported, where one is no integer."""
    whole = [as_int64(number) for number in numbers]
    for number, integer in zip(numbers, whole, strict=True):
        if integer is None:
            scope.problems.append(words.no_integer(number.span, describe(number.type)))
    known = [number for number in whole if number is not None]
    return known if len(known) == len(whole) else None


# --- kernels -------------------------------------------------------------------------------------------------------------


def _lower_measure(call: typed.Call, values: Evaluation) -> Expr:
    """A number of a compressed image."""
    what = index(MEASURES.index(call.function))
    return _host_answer(MEASURE, (what,), (bytes_of(call.arguments[0], values),), values)


def _lower_image(call: typed.Call, values: Evaluation) -> View:
    """An image, or its pixels, in the hidden lane."""
    made = bytes_of(call, values)
    assert isinstance(made.address, Place)
    after = values.writer.let("after", Binary("add", made.address.row, made.size))
    return sound(values.writer, View(made.address.lane, made.address.row, after))


def bytes_of(value: typed.Expr, values: Evaluation) -> Extent:
    """Bytes that lie in a field, or that are computed."""
    match value:
        case typed.Access(place):
            size = values.writer.let("size", values.source.count(place, values))
            address = values.source.address(place, values)
            if isinstance(address, Wire):
                values.writer.require(size, values.where, at=address.at)  # known to be there: said again where the proof may have lost it
            return Extent(address, size)
        case typed.Call("decompress", (image, *measures)):
            source = bytes_of(image, values)
            _check_measures(source, measures, values)
            size = _host_answer(MEASURE, (index(SIZE),), (source,), values)
            return _filled(DECOMPRESS, (), source, size, values)
        case typed.Call("compress", (pixels, typed.Const(str(format_)), *measures)):
            source = bytes_of(pixels, values)
            numbers = (index(FORMATS.index(format_)), *(values.writer.let("number", values.of(each)) for each in measures))
            size = _host_answer(COMPRESSED, numbers, (source,), values)
            return _filled(COMPRESS, numbers, source, size, values)
        case typed.Call():
            made = cast("View", lowered(value, values))
            return Extent(made.address, values.writer.let("size", made.size))
        case _:
            raise AssertionError(value)


def _check_measures(source: Extent, measures: list[typed.Expr], values: Evaluation) -> None:
    """That an image is as the mapping says, if it says anything: a format, and its width, height and channels."""
    match measures:
        case [typed.Const(str(format_)), width, height, channels, _]:
            wanted = *map(values.of, (width, height, channels)), index(16 if format_ == "png16" else 8)
        case _:
            return
    for number, (name, value) in enumerate(zip(("width", "height", "number of channels", "depth"), wanted, strict=True)):
        found = _host_answer(MEASURE, (index(number),), (source,), values)
        values.writer.expect(Compare("eq", found, value), "image", values.where, f"an image of another {name}", line=values.line)


def _filled(function: str, numbers: tuple[Expr, ...], source: Extent, size: Local, values: Evaluation) -> Extent:
    """New bytes behind those of the hidden lane, filled by the host."""
    writer = values.writer
    lane = writer.lane(LANE, 1)
    writer.emit(Reserve(lane, size))
    start = writer.let("computed", Used(lane))
    writer.emit(Advance(lane, size))
    target = Extent(Place(lane, start), size)
    _host_answer(function, numbers, (source,), values, target)
    return target


def _host_answer(
    function: str, numbers: tuple[Expr, ...], inputs: tuple[Extent, ...], values: Evaluation, target: Extent | None = None
) -> Local:
    """What the host answers, which is no problem."""
    writer = values.writer
    found = Local("i64", writer.fresh(function.rpartition(".")[2]))
    failure = writer.failure("image", values.where, "the image could not be looked at", line=values.line)
    writer.emit(HostCall(function, numbers, found, failure, inputs, target))
    for code, problem in PROBLEMS.items():
        writer.expect(Compare("ne", found, index(code)), "image", values.where, problem, line=values.line)
    writer.expect(Compare("ge", found, index(0)), "image", values.where, "an image that cannot be used", line=values.line)
    return found


def _undone(other: str) -> Callable[[model.Call, model.Expr], tuple[model.Expr, model.Expr] | None]:
    """What is compressed or decompressed is what the other function makes of the value, with the same format and measures."""

    def solved(call: model.Call, value: model.Expr) -> tuple[model.Expr, model.Expr] | None:
        first, *measures = call.arguments
        return (first, model.Call(other, (value, *measures), call.span)) if measures else None

    return solved


def _pixels_again(call: typed.Call) -> typed.Expr | None:
    """The pixels that were compressed with the same format and measures, but by JPEG."""
    match call.arguments:
        case typed.Call("compress", (pixels, *options)), *wanted if options == wanted and options[0] != typed.Const("jpeg", String()):
            return pixels
        case _:
            return None


def _measure_again(call: typed.Call) -> typed.Expr | None:
    """What an image was said to measure that was compressed."""
    match call.arguments:
        case (typed.Call("compress", (_, _, *measures)),):
            return measures[MEASURES.index(call.function)]
        case _:
            return None


PIXELS = Row("images", "`decompress(b)`", ("bytes of a PNG or JPEG image", "its pixels, as bytes"))
MEASURED = Row(
    "images",
    '`decompress(b, "png", w, h, c)`',
    (
        "the same, and what `compress` takes behind the pixels",
        "the pixels of an image that is so wide, high and deep; else an error of kind `image`",
    ),
)
IMAGE = Row(
    "images",
    '`compress(p, "png", w, h, c)`, `"png16"`, `"jpeg"`',
    ("pixels, and behind them as integers their width, height and channels; then, if one likes, level or quality", "the image, as bytes"),
)
SIZES = Row("images", "`image_width(b)`, `image_height(b)`, `image_channels(b)`", ("bytes of an image", "int64"))
DEPTH = Row("images", "`image_depth(b)`", ("bytes of an image", "int64: bits of a channel, 8 or 16"))

JPEG, ANEW = "JPEG changes pixels a little", "what is compressed anew has other bytes"
OF_PIXELS = replace(undone_by(compress=loses(ANEW)), of_several=JPEG)
OF_IMAGES = replace(undone_by(decompress=loses(JPEG)), of_several=ANEW)
of_images = partial(Function, operation="image compression", kept=False)
FUNCTIONS = (
    of_images("decompress", _type_of_image, _lower_image, _undone("compress"), OF_PIXELS, (PIXELS, MEASURED), undoes=_pixels_again),
    of_images("compress", _type_of_image, _lower_image, _undone("decompress"), OF_IMAGES, (IMAGE,)),
    *(of_images(name, _type_of_image, _lower_measure, SEVERAL, NOT_FOLLOWED, (SIZES,), undoes=_measure_again) for name in MEASURES[:3]),
    of_images("image_depth", _type_of_image, _lower_measure, SEVERAL, NOT_FOLLOWED, (DEPTH,)),
)
