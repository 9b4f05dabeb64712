"""Bottles of one dialect as those of another, whatever is in them.

YARP 4 gave float32 the code that float64 has in YARP 3, and announces nothing: each garbles the numbers of the other. Only codes differ, so
that a bottle takes as many bytes in either. Images are bottles, too, and differ in one more number, the quantum of their rows.
"""

from __future__ import annotations

from rosetta_jit.frameworks.yarp.tags import DIALECTS, DICT, FIXED_FORMATS, LIST, Dialect, vocab
from rosetta_jit.wire.self_describing import Header, Scalar, Tree

SIZES = {"b": 1, "h": 2, "i": 4, "q": 8, "f": 4, "d": 8}
"""Bytes of the letters of the `struct` module."""

FLAG = 1 << 16
"""The high half of an image's quantum as YARP 3.10 to 3.12 write it: the rows are not upside down."""


def tree(source: str, target: str) -> Tree | None:
    """What bottles of a dialect become in another one; None where more than codes differs."""
    here, there = DIALECTS.get(source), DIALECTS.get(target)
    if here is None or there is None or here.nul_terminated != there.nul_terminated:
        return None
    scalars = (Scalar(name, code, there.tags.get(name), _size(name)) for name, code in here.tags.items())
    headers = () if here.flagged_quantum == there.flagged_quantum else (_image(here, there),)
    return Tree(tuple(scalars), LIST, DICT, headers, _spoken(there))


def _size(name: str) -> int | None:
    return SIZES[FIXED_FORMATS[name]] if name in FIXED_FORMATS else None


def _image(here: Dialect, there: Dialect) -> Header:
    """What stands before the pixels of an image (sig/ImageNetworkHeader.h)."""
    tags = here.tags
    words = {0: tags["vocab32"], 4: vocab(b"mat"), 8: tags["vocab32"], 16: LIST | tags["int32"], 20: 5, 44: tags["blob"]}
    return Header(48, words, 32, 0xFFFF, FLAG if there.flagged_quantum else 0)


def _spoken(dialect: Dialect) -> str:
    return f"YARP {dialect.name.removeprefix('yarp')}"
