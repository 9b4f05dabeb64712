"""What can be wrong in a `.lcm` file."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Protocol

from rosetta_jit.catalogue.suggestions import closest
from rosetta_jit.diagnostics import Diagnostic, Mistake, error
from rosetta_jit.frameworks.lcm.limits import MAX_SHOWN

if TYPE_CHECKING:
    from rosetta_jit.source import Span


class Name(Protocol):
    """A word as it was written, and where."""

    @property
    def text(self) -> str: ...
    @property
    def span(self) -> Span: ...


SCALARS = {
    "int": "int32_t",
    "short": "int16_t",
    "long": "int64_t",
    "char": "int8_t",
    "bool": "boolean",
    "int8": "int8_t",
    "int16": "int16_t",
    "int32": "int32_t",
    "int64": "int64_t",
    "uint8_t": "byte",
    "uint8": "byte",
    "float32": "float",
    "float64": "double",
}
"""Words of other languages, and LCM's own for the same."""


def _cut(word: str) -> str:
    return word if len(word) <= MAX_SHOWN else f"{word[:MAX_SHOWN]}..."


def _nearest(word: str, known: Iterable[str]) -> str:
    found = closest(word, known)
    return f"Is `{found}` meant?" if found else ""


# --- the text ---------------------------------------------------------------------------------------------------------------


no_space = Mistake(
    "no-space",
    "a space is missing",
    "not apart from what stands before it",
    help="Put a space or a line break here.",
    notes=("to LCM, braces and slashes are part of the word that they stand in",),
)
unclosed_comment = Mistake("unclosed-comment", "a comment does not end", "it begins here", help="Close it with `*/`.")


def unexpected(span: Span, found: str, wanted: str, help_: str = "") -> Diagnostic:
    return error("syntax", f"`{_cut(found)}` does not fit here", span, f"expected {wanted}", help_)


def unfinished(span: Span, wanted: str) -> Diagnostic:
    return error("unfinished", "the file ends within a declaration", span, f"expected {wanted}")


def nested(span: Span, kind: str) -> Diagnostic:
    help_ = "Declare it outside, and use its name here; or close the struct around it."
    return error("nested", f"LCM has no {kind} within a struct", span, "not here", help_)


# --- types ------------------------------------------------------------------------------------------------------------------


def primitive_declared(name: Name) -> Diagnostic:
    return error("repeated-type", f"`{name.text}` is a type of LCM itself", name.span, "taken")


def repeated_type(name: Name, full: str, first: Span) -> Diagnostic:
    return error("repeated-type", f"`{_cut(full)}` is declared twice", name.span, "again", "", (f"it was declared at {first}",))


def unknown_type(name: Name, full: str, paths: Sequence[str], known: Iterable[str]) -> Diagnostic:
    word = SCALARS.get(name.text)
    help_ = f"LCM's own is `{word}`." if word else _nearest(full, known)
    note = f"it was looked for in {', '.join(f'`{_cut(path)}`' for path in paths)}"
    return error("unknown-type", f"there is no type `{_cut(full)}`", name.span, "unknown", help_, (note,))


def endless(field: str, span: Span | None, struct: str) -> Diagnostic:
    help_ = "Let it contain an array whose size another field tells."
    return error("endless", f"no value of `{_cut(struct)}` would end", span, f"`{_cut(field)}` contains one again", help_)


def too_deep(name: str, span: Span | None, limit: int) -> Diagnostic:
    return error("too-deep", f"`{_cut(name)}` nests structs more than {limit} deep, or too many in each other", span, "met here")


def recursion_in_elements(field: str, span: Span | None) -> Diagnostic:
    help_ = "Make the elements of the array the recursive structs themselves, in one dimension."
    message = f"the elements of `{_cut(field)}` contain recursive structs"
    return error("recursion", message, span, "this cannot be read or written", help_)


# --- members ----------------------------------------------------------------------------------------------------------------


def repeated_name(name: Name, first: Span) -> Diagnostic:
    return error("repeated-name", f"`{_cut(name.text)}` has two meanings", name.span, "again", "", (f"it was declared at {first}",))


def repeated_number(name: Name, first: str, number: int) -> Diagnostic:
    return error("repeated-number", f"two enumerators have the number {number}", name.span, f"taken by `{_cut(first)}`")


def constant_type(type_: Name, known: Sequence[str]) -> Diagnostic:
    return error("constant-type", f"there are no constants of the type `{_cut(type_.text)}`", type_.span, f"expected {', '.join(known)}")


def no_integer(value: Name) -> Diagnostic:
    help_ = "Decimal numbers, hexadecimal ones (0x1f) and octal ones (017) are read."
    return error("number", f"`{_cut(value.text)}` is no integer", value.span, "expected one", help_)


def no_number(value: Name) -> Diagnostic:
    help_ = "LCM reads a `+` as a word of its own: leave it out." if value.text.endswith(("e", "E")) else ""
    return error("number", f"`{_cut(value.text)}` is no finite number", value.span, "expected one", help_)


def constant_range(value: Name, type_: str) -> Diagnostic:
    return error("range", f"{_cut(value.text)} does not fit into {type_}", value.span, "too large or too small")


# --- sizes ------------------------------------------------------------------------------------------------------------------


def size_range(size: Name, value: int, limit: int) -> Diagnostic:
    return error("size", f"no array has the size {_cut(str(value))}", size.span, f"expected 1 to {limit}")


def unknown_size(size: Name, known: Sequence[str], *, later: bool) -> Diagnostic:
    help_ = "Declare it before the array." if later else _nearest(size.text, known)
    return error("size", f"`{_cut(size.text)}` tells no size", size.span, "no number, constant, or integer field before the array", help_)


def size_is_array(size: Name) -> Diagnostic:
    return error("size", f"`{_cut(size.text)}` is an array itself", size.span, "expected one integer")


def size_type(size: Name, type_: str) -> Diagnostic:
    return error("size", f"a {_cut(type_)} cannot be a size", size.span, "expected an int8_t, int16_t, int32_t or int64_t")


def too_many_dimensions(size: Name, limit: int) -> Diagnostic:
    return error("size", f"an array has more than {limit} dimensions", size.span, "one too many")
