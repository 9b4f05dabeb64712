"""What the mapping language means, by plain Python and numpy.

Written down here once more, from the manual and not from the compiler: integers are exact and must fit int64, floats are numpy's
scalars, texts are str.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

Fields = dict[str, Any]
Value = Any

INTEGERS = {
    f"{sign}int{bits}": (0 if sign else -(1 << bits - 1), (1 << bits - (not sign)) - 1) for sign in ("", "u") for bits in (8, 16, 32, 64)
}
LEAVES = {
    "i8": "int8",
    "u8": "uint8",
    "i16": "int16",
    "u16": "uint16",
    "i32": "int32",
    "u32": "uint32",
    "i64": "int64",
    "u64": "uint64",
    "f32": "float32",
    "f64": "float64",
    "b": "bool",
    "s": "string",
    "t": "string",
}
"""The fields that expressions read; and `xs`, float64[], `ks`, int32[], `q`, int16[4]."""

NARROW = {"int8", "uint8", "int16", "uint16", "int32", "uint32"}
"""Integers that meet floats without a word: a float64 holds them."""


class Refused(Exception):  # noqa: N818  not an error of ours
    """The message is refused, with this kind; at the place of the rule, if no other is said."""

    def __init__(self, kind: str, place: str = "") -> None:
        super().__init__(kind)
        self.kind, self.place = kind, place


def fits(value: int, type_: str = "int64") -> int:
    low, high = INTEGERS[type_]
    if not low <= value <= high:
        raise Refused("range")
    return value


def quotient(left: int, right: int) -> int:
    if right == 0:
        raise Refused("range")
    return fits(abs(left) // abs(right) * (1 if (left < 0) == (right < 0) else -1))


def remainder(left: int, right: int) -> int:
    if right == 0:
        raise Refused("range")
    fits(abs(left)) if right == -1 else None  # the least int64 has no quotient by -1
    return abs(left) % abs(right) * (-1 if left < 0 else 1)


def floored(left: int, right: int) -> int:
    if right == 0:
        raise Refused("range")
    return fits(left // right)


def remainder_below(left: int, right: int) -> int:
    floored(left, right)
    return left % right


def exact_quotient(left: int, right: int) -> int:
    if quotient(left, right) * right != left:
        raise Refused("range")
    return quotient(left, right)


def shifted(left: int, bits: int, *, up: bool) -> int:
    if not 0 <= bits <= 63:
        raise Refused("range")
    return wrapped(left << bits, "int64") if up else left >> bits


def wrapped(value: int, type_: str) -> int:
    low, high = INTEGERS[type_]
    return (value - low) % (high - low + 1) + low


def clamped(value: int, type_: str) -> int:
    low, high = INTEGERS[type_]
    return min(max(value, low), high)


def aligned(number: int, quantum: int) -> int:
    if number < 0:
        raise Refused("range")
    return fits(-(-number // quantum) * quantum) if quantum > 1 else number


def whole(value: float, type_: str, rule: str) -> int:
    """A float as an integer."""
    number = float(value)
    if rule == "saturate":
        if math.isnan(number):
            raise Refused("range")
        return INTEGERS[type_][number > 0] if math.isinf(number) else clamped(round(number), type_)
    if not math.isfinite(number):
        raise Refused("range")
    if rule == "exact" and not number.is_integer():
        raise Refused("range")
    return fits(round(number) if rule == "round" else math.trunc(number), type_)


def as_float(value: float, type_: str, rule: str = "nearest") -> np.floating:
    """A number as the nearest float."""
    kind = np.float32 if type_ == "float32" else np.float64
    made = kind(value) if not isinstance(value, int) else (np.int64(value) if value < 1 << 63 else np.uint64(value)).astype(kind)
    is_same = math.isnan(value) if isinstance(value, np.floating) and math.isnan(value) else math.isfinite(made) == math.isfinite(value)
    if rule == "exact" and not (is_same and (not math.isfinite(value) or exactly(made) == exactly(value))):
        raise Refused("range")
    return made


def together(types: tuple[str, str], constants: tuple[float | None, float | None] = (None, None)) -> str:
    """The type in which two numbers are computed: float32 of two float32, and of a constant that is equal to one; else float64 or int64."""
    if all(type_ in INTEGERS for type_ in types):
        return "int64"
    singles = [
        type_ == "float32" or (constant is not None and float(np.float32(constant)) == constant)
        for type_, constant in zip(types, constants, strict=True)
    ]
    return "float32" if all(singles) else "float64"


def exactly(value: float) -> int | float:
    return int(value) if float(value).is_integer() else float(value)


def element(values: list[Value], index: int, name: str = "") -> Value:
    if not 0 <= index < len(values):
        raise Refused("index", f".{name}[{index}]" if name else "")
    return values[index]


def minimum(left: Value, right: Value) -> Value:
    return min(right, left)


def maximum(left: Value, right: Value) -> Value:
    return max(right, left)


INTEGER_OPERATIONS: dict[str, tuple[str, Callable[[int, int], int]]] = {
    "+": ("({} + {})", lambda x, y: fits(x + y)),
    "-": ("({} - {})", lambda x, y: fits(x - y)),
    "*": ("({} * {})", lambda x, y: fits(x * y)),
    "/": ("({} / {})", quotient),
    "%": ("({} % {})", remainder),
    "&": ("({} & {})", lambda x, y: x & y),
    "|": ("({} | {})", lambda x, y: x | y),
    "^": ("({} ^ {})", lambda x, y: x ^ y),
    "<<": ("({} << {})", lambda x, y: shifted(x, y, up=True)),
    ">>": ("({} >> {})", lambda x, y: shifted(x, y, up=False)),
    "min": ("min({}, {})", min),
    "max": ("max({}, {})", max),
    "floor_divide": ("floor_divide({}, {})", floored),
    "modulo": ("modulo({}, {})", remainder_below),
    "divide": ("divide({}, {})", exact_quotient),
    "align": ("align({}, {})", aligned),
}
SHIFTS = {"({} << {})", "({} >> {})"}
FLOAT_OPERATIONS: dict[str, tuple[str, Callable[[Any, Any], Any]]] = {
    "+": ("({} + {})", lambda x, y: x + y),
    "-": ("({} - {})", lambda x, y: x - y),
    "*": ("({} * {})", lambda x, y: x * y),
    "/": ("({} / {})", lambda x, y: x / y),
    "%": ("({} % {})", np.fmod),
    "min": ("min({}, {})", minimum),
    "max": ("max({}, {})", maximum),
    "divide": ("divide({}, {})", lambda x, y: x / y),
}
FLOAT_FUNCTIONS: dict[str, Callable[[Any], Any]] = {
    "floor": np.floor,
    "ceil": np.ceil,
    "round": np.rint,
    "abs": abs,
    "-": lambda x: -x,
}
WIDE_FUNCTIONS: dict[str, Callable[[Any], Any]] = {"sqrt": np.sqrt}
COMPARED: dict[str, Callable[[Any, Any], bool]] = {
    "==": lambda x, y: x == y,
    "!=": lambda x, y: x != y,
    "<": lambda x, y: x < y,
    "<=": lambda x, y: x <= y,
    ">": lambda x, y: x > y,
    ">=": lambda x, y: x >= y,
}
TEXTS = ["", "a", "B", " x ", "a/b", "/", "12", "-7", "1e3", "0.5", "é", "naïve", "日本", "a/é/b", "  42", "nan"]
NUMBERS = [0, 1, -1, 2, 3, 7, 10, 63, 64, 255, -128, 1000, 2**31, -(2**31), 2**53 + 1, 2**63 - 1, -(2**63)]
REALS = [0.0, 0.5, 1.0, 1.5, 2.5, -2.5, 3.25, 100.0, 1e10, 1e300, 0.1]


def written(value: Value) -> str:
    """A number as a text, as Python writes it; of a float32 in as few digits as read back."""
    if isinstance(value, bool | int | np.bool_):
        return str(int(value))
    if isinstance(value, np.float32):
        return single(value)
    return repr(float(value))


def single(value: np.float32) -> str:
    number = float(value)
    if not math.isfinite(number):
        return repr(number)
    digits = next(text for places in range(1, 18) if np.float32(text := f"{number:.{places - 1}e}") == value)
    return repr(float(digits))


def lowered(text: str) -> str:
    return "".join(c.lower() if c.isascii() else c for c in text)


def raised(text: str) -> str:
    return "".join(c.upper() if c.isascii() else c for c in text)


def cut(text: str, start: int, stop: int) -> str:
    data = text.encode()
    if not 0 <= start <= stop <= len(data):
        raise Refused("index")
    try:
        data[:start].decode()  # between characters, also where nothing is taken
        return data[start:stop].decode()
    except UnicodeDecodeError:
        raise Refused("text") from None


def spelled(text: str) -> int:
    body = text[1:] if text[:1] in ("+", "-") else text
    if not (body.isascii() and body.isdigit()):
        raise Refused("text")
    return fits(int(text))


def behind(text: str, begin: str) -> str:
    if not text.startswith(begin):
        raise Refused("text")
    return text[len(begin) :]
