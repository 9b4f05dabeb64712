"""What can be wrong with images in a mapping."""

from __future__ import annotations

from collections.abc import Sequence

from rosetta_jit.catalogue.mapping import shorten
from rosetta_jit.catalogue.resolve import written_at
from rosetta_jit.diagnostics import Diagnostic, error
from rosetta_jit.source import Span

FORMS = {
    "compress": '`compress(pixels, "png", width, height, channels)`, and behind it a level or quality',
    "decompress": '`decompress(image)`, or `decompress(image, "png", width, height, channels)`',
    "yuv_of": '`yuv_of(pixels, "nv12", width, height)`, and behind it how many bytes apart rows of RGB begin',
    "rgb_of": '`rgb_of(pixels, "bayer_rggb8", width, height)`, and behind it how many bytes apart rows begin',
}


def arguments(span: Span | None, function: str, found: int) -> Diagnostic:
    message = f"`{function}` does not take {found} value{'' if found == 1 else 's'}"
    return error("arguments", message, span, help_=f"write {FORMS.get(function, f'`{function}(image)`')}")


def no_bytes(span: Span | None, function: str, found: str) -> Diagnostic:
    return error("no-bytes", f"`{function}` takes bytes, not {found}", span, "not bytes", help_="name a field of bytes, or of uint8[]")


def unknown_format(span: Span | None, found: str | None, known: Sequence[str]) -> Diagnostic:
    message = "a format is written in quotes" if found is None else f"images cannot be compressed as `{shorten(found)}`"
    return error("image-format", message, span, help_=f"choose one of {', '.join(known)}")


def unknown_encoding(span: Span | None, found: str | None, known: Sequence[str], colours: str) -> Diagnostic:
    message = "an encoding is written in quotes" if found is None else f"pixels in `{shorten(found)}` cannot be made RGB"
    if found is not None and colours == "YUV":
        message = f"RGB cannot be made `{shorten(found)}`"
    return error("image-encoding", message, span, help_=f"choose one of {', '.join(known)}")


def no_integer(span: Span | None, found: str) -> Diagnostic:
    help_ = f"convert it: `int64({written_at(span)})`"
    return error("integer", f"the size of an image is in integers, not {found}", span, f"this is {found}", help_=help_)


def no_library() -> Diagnostic:
    return error("no-images", "images need Pillow, which is not installed", help_="pip install rosetta-jit[images]")
