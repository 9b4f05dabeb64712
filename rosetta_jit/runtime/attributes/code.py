"""The accessors as code: the text of LLVM, and the library that it becomes, which the cache keeps."""

from __future__ import annotations

import warnings
from functools import cache
from pathlib import Path
from string import Template
from typing import TYPE_CHECKING, Any, cast

from rosetta_jit.runtime.cache.texts import kept
from rosetta_jit.runtime.callable import is_native
from rosetta_jit.runtime.cells import SCALARS
from rosetta_jit.runtime.code import native
from rosetta_jit.runtime.code.allowed import ForeignCodeError
from rosetta_jit.runtime.specs import function_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from rosetta_jit.runtime.code.native import Library

FILES = (
    *("message.ll", "boxes.ll", "content.ll", "nested.ll", "sequence.ll", "writing.ll"),
    *("making.ll", "ending.ll", "methods.ll", "handing.ll", "sameness.ll", "taking.ll"),
)
READERS = ("get_python", "get_utf8", "get_octets", "get_bytes", "get_numbers", "get_kept")
WRITERS = ("set_python", "set_utf8", "set_bytes", "set_numbers", "set_texts", "set_attribute")
FUNCTIONS = ("begin", "bind", "restart", "spawn", "equip", "same", "extend_texts", "take", "take_anew")
SEQUENCES = ("length", "subscript", "iterate", "itself", "next", "end_iterator")
METHODS = ("method_encode", "method_write", "method_decode", "method_parse", "method_make", "method_build", "method_turn")
HANDING = ("hand_in", "hand_out")
HOLDERS = ("end_holder", "call_class", "call_maker", "get_attribute")
SYMBOLS = (
    *(f"{verb}_{scalar}" for scalar in SCALARS for verb in ("get", "set")),
    *READERS,
    *WRITERS,
    *FUNCTIONS,
    *SEQUENCES,
    *METHODS,
    *HANDING,
    *HOLDERS,
)
"""What the library defines."""

HEAP_TYPE_BYTES: int = cast("Any", type).__basicsize__
"""The size of a class that a class statement makes, in bytes. Behind it lies what a class of its own class has besides."""

CELLS = {"bool": "i8", "f32": "float", "f64": "double"}
"""LLVM's type of a scalar in memory, where it is not an integer of that size."""


@cache
def library() -> Library | None:
    """The accessors, loaded; None where Python is none that they know, or its memory cannot be executed."""
    if not is_native():
        return None
    try:
        return native.load(_image(), SYMBOLS)
    except ForeignCodeError as error:
        warnings.warn(f"attributes of messages are read in Python, which takes ten times as long: {error}", RuntimeWarning, stacklevel=2)
        return None


@cache
def functions() -> Mapping[str, Callable[..., Any]]:
    """Those of the library that Python calls, as built-in functions."""
    code = library()
    assert code is not None, "there are accessors"
    return {name: function_of(name, code[name]) for name in FUNCTIONS}


def _image() -> bytes:
    whole = text()
    return kept("attributes", whole, lambda: _assembled(whole))


def _assembled(whole: str) -> bytes:
    from rosetta_jit.runtime.code.assembler import assembled  # imports LLVM

    return assembled(whole, SYMBOLS)


def text() -> str:
    """The module."""
    calling = Template(_read("calling.ll")).substitute(HEAP_TYPE_BYTES=HEAP_TYPE_BYTES, NAMES_AT=HEAP_TYPE_BYTES + 8)
    return "\n".join([*(_read(file) for file in FILES), calling, *_scalars()])


def _scalars() -> Iterator[str]:
    template = Template(_read("scalar.ll"))
    for name in SCALARS:
        yield template.substitute(_conversions(name), NAME=name)


def _conversions(name: str) -> dict[str, str]:
    """How a scalar becomes one of Python's, and back. An integer that does not come back as it was is out of range; floats are rounded."""
    cell = CELLS.get(name, f"i{name[1:]}")
    match name[0]:
        case "b":
            box, wide = "bool", "i8"
        case "f":
            box, wide = "float", "double"
        case _:
            box, wide = "signed" if name[0] == "i" else "unsigned", "i64"
    if cell == wide:
        widen, narrow = f"bitcast {cell} %cell to {cell}", f"bitcast {cell} %wide to {cell}"
    elif box == "float":
        widen, narrow = "fpext float %cell to double", "fptrunc double %wide to float"
    else:
        widen, narrow = f"{'sext' if box == 'signed' else 'zext'} {cell} %cell to i64", f"trunc i64 %wide to {cell}"
    unbox = "unbox_real" if box == "float" else f"unbox_{box}"
    fits = "icmp eq i64 %back, %wide" if wide == "i64" else "icmp eq i1 true, true"
    return {"CELL": cell, "WIDE": wide, "BOX": box, "WIDEN": widen, "NARROW": narrow, "BACK": widen, "FITS": fits, "UNBOX": unbox}


def _read(file: str) -> str:
    return Path(__file__).with_name(file).read_text("utf-8")
