"""Messages as text, as `str` of protobuf's Python messages prints them: fields by number, one a line, messages in braces.

https://protobuf.dev/reference/protobuf/textformat-spec/
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rosetta_jit.model.types import Enum, Float

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from rosetta_jit.model.types import Field, Type
    from rosetta_jit.runtime.holder.record import Entry, ScalarType

_ESCAPES = {"\n": "\\n", "\r": "\\r", "\t": "\\t", '"': '\\"', "'": "\\'", "\\": "\\\\"}


def scalar_text(type_: ScalarType, value: Any) -> str:
    """A number, boolean or enum."""
    match type_:
        case Enum(_, values, _):
            return next((name for name, number in values if number == value), str(value))
        case Float(bits, _):
            return _float_text(float(value), bits)
        case _:
            return str(value).lower()


def _float_text(value: float, bits: int) -> str:
    """As few digits as a C library prints to read the same value again: 6 or 9 of a float, 15 or 17 of a double."""
    few, all_ = (6, 9) if bits == 32 else (15, 17)
    text = f"{value:.{few}g}"
    same = float(text) == value if bits == 64 else _as_float(text) == value
    return text if same or value != value else f"{value:.{all_}g}"  # noqa: PLR0124  NaN


def _as_float(text: str) -> float:
    import numpy as np

    with np.errstate(over="ignore"):
        return float(np.float32(text))


def quoted(value: str | bytes) -> str:
    """A string or bytes in quotes; what is not printable ASCII is written in octal, but for the letters of a string."""
    if isinstance(value, str):
        return '"' + "".join(_ESCAPES.get(char) or _octal(char, printable=ord(char) >= 0x7F + 1) for char in value) + '"'
    return '"' + "".join(_ESCAPES.get(char) or _octal(char, printable=False) for char in value.decode("latin-1")) + '"'


def _octal(char: str, *, printable: bool) -> str:
    return char if printable or " " <= char <= "~" else f"\\{ord(char):03o}"


def indented(lines: Iterable[str]) -> Iterator[str]:
    """The lines of a message inside another."""
    return (f"  {line}" for line in lines)


def label(entry: Entry, struct: str | None, field: Field) -> str:
    """What stands before a field's value: its name; of a group, the name of its message."""
    if struct is not None and field.option("group"):
        return struct.rpartition(".")[2]
    return entry.name


def element_type(type_: Type) -> Type:
    """Only for symmetry of names with the model."""
    return type_
