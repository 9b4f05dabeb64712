"""Wires whose messages describe themselves: trees of elements, each of which begins with a code that says what it is.

    message = list
    element = code, value
    value   = bytes of a known number | size, bytes | list's count, element* | message

A list may say one code for all its elements, which then have none of their own. Codes, sizes and counts are i32, little-endian. A `Tree`
says which codes there are in one dialect, and which code each has in another one: values are the same in both.
"""

from __future__ import annotations

from collections.abc import Mapping

from rosetta_jit.startup.dataclass import dataclass, field


@dataclass(frozen=True, slots=True)
class Scalar:
    """A code that announces a value: of ``size`` bytes, or, where that is None, of as many as a number before them says.

    ``there`` is its code in the other dialect, None where that has no such type.
    """

    name: str
    code: int
    there: int | None
    size: int | None


@dataclass(frozen=True, slots=True)
class Header:
    """Elements in a row that are known by their bytes, and of which one number differs between the dialects.

    Attributes
    ----------
    size
        How many bytes they are, from the first element's code on.
    words
        What is known of them: i32 by offset. The first is the code of a scalar.
    at
        The offset of the i32 that differs.
    keep, put
        It becomes ``(number & keep) | put``.
    """

    size: int
    words: Mapping[int, int] = field(hash=False)
    at: int
    keep: int
    put: int


@dataclass(frozen=True, slots=True)
class Tree:
    """Messages of one dialect, and what becomes of them in another.

    Attributes
    ----------
    list_code
        That of a list; the code of its elements is added where it says one for all.
    whole_code
        That of an element which is a message.
    """

    scalars: tuple[Scalar, ...]
    list_code: int
    whole_code: int
    headers: tuple[Header, ...] = ()
    there: str = ""
