"""Images in rules: what they measure, and their bytes, compressed or not, in the hidden lane of what is computed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.kernel.ir import Advance, Compare, Extent, HostCall, Local, Place, Reserve, Used, Wire
from rosetta_jit.kernel.terms import index
from rosetta_jit.language import typed
from rosetta_jit.language.functions.images import MEASURES

if TYPE_CHECKING:
    from rosetta_jit.kernel.ir import Expr
    from rosetta_jit.lowering.evaluation import Evaluation

MEASURE, DECOMPRESS, COMPRESSED, COMPRESS = "image.measure", "image.decompress", "image.compressed", "image.compress"
"""The host's functions: a number of an image; its pixels; the size of a compressed image, and its bytes."""

SIZE = len(MEASURES)
"""What `MEASURE` is asked for besides `MEASURES`: the bytes of all pixels."""

FORMATS = ("png", "png16", "jpeg")

PROBLEMS = {
    -1: "no PNG or JPEG image, or a damaged one",
    -2: "an image that is too large",
    -3: "an image with pixels of another kind: of four inks, or with 16 bits a colour",
    -4: "the pixels are not as many as the width, the height and the channels say",
    -5: "an image of no such width, height, channels or quality",
}
"""What the host's functions give where there is nothing to give."""

LANE = "texts"
"""The hidden lane of what is computed: one byte a row."""


def measured(call: typed.ImageCall, values: Evaluation) -> Expr:
    """A number of a compressed image."""
    what = index(MEASURES.index(call.function))
    return _asked(MEASURE, (what,), (bytes_of(call.bytes, values),), values)


def bytes_of(value: typed.Expr, values: Evaluation) -> Extent:
    """Bytes that lie in a field, or that are computed."""
    match value:
        case typed.Access(place):
            size = values.writer.let("size", values.source.count(place, values))
            address = values.source.address(place, values)
            if isinstance(address, Wire):
                values.writer.require(size, values.where, at=address.at)  # known to be there: said again where the proof may have lost it
            return Extent(address, size)
        case typed.ImageCall("decompress", image):
            source = bytes_of(image, values)
            size = _asked(MEASURE, (index(SIZE),), (source,), values)
            return _filled(DECOMPRESS, (), source, size, values)
        case typed.ImageCall():
            source = bytes_of(value.bytes, values)
            numbers = (index(FORMATS.index(value.format)), *(values.writer.let("number", values.of(each)) for each in value.numbers))
            size = _asked(COMPRESSED, numbers, (source,), values)
            return _filled(COMPRESS, numbers, source, size, values)
        case _:
            raise AssertionError(value)


def _filled(function: str, numbers: tuple[Expr, ...], source: Extent, size: Local, values: Evaluation) -> Extent:
    """New bytes behind those of the hidden lane, filled by the host."""
    writer = values.writer
    lane = writer.lane(LANE, 1)
    writer.emit(Reserve(lane, size))
    start = writer.let("computed", Used(lane))
    writer.emit(Advance(lane, size))
    target = Extent(Place(lane, start), size)
    _asked(function, numbers, (source,), values, target)
    return target


def _asked(function: str, numbers: tuple[Expr, ...], inputs: tuple[Extent, ...], values: Evaluation, target: Extent | None = None) -> Local:
    """What the host answers, which is no problem."""
    writer = values.writer
    found = Local("i64", writer.fresh(function.rpartition(".")[2]))
    failure = writer.failure("image", values.where, "the image could not be looked at", line=values.line)
    writer.emit(HostCall(function, numbers, found, failure, inputs, target))
    for code, problem in PROBLEMS.items():
        writer.expect(Compare("ne", found, index(code)), "image", values.where, problem, line=values.line)
    writer.expect(Compare("ge", found, index(0)), "image", values.where, "an image that cannot be used", line=values.line)
    return found
