"""Random well-typed expressions of the mapping language, each with what it is by plain Python and numpy.

    Made = text, type, evaluate(fields) → value or a failed `Refused`

`of(type, depth)` makes one. The meaning is written down here once more, from the manual and not from the compiler: integers are
exact and must fit int64, floats are numpy's scalars, texts are str.
"""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import random
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

NARROW = {"int8", "uint8", "int16", "uint16"}
"""Integers that a float32 holds."""


class Refused(Exception):  # noqa: N818  not an error of ours
    """The message is refused, with this kind; at the place of the rule, if no other is said."""

    def __init__(self, kind: str, place: str = "") -> None:
        super().__init__(kind)
        self.kind, self.place = kind, place


@dataclass
class Made:
    text: str
    type: str
    evaluate: Callable[[Fields], Value]
    is_known: bool = False


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


def exactly(value: float) -> int | float:
    return int(value) if float(value).is_integer() else float(value)


def same_number(text: str) -> float:
    return float(text)


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


@dataclass
class Maker:
    """Makes expressions; ``leaves`` are the fields that there are, by name."""

    rng: random.Random
    leaves: dict[str, str]
    variables: tuple[str, ...] = ()

    def of(self, type_: str, depth: int) -> Made:
        """An expression of a type: "int64" (any integer that is computed with), "float32", "float64", "bool" or "string"."""
        if depth <= 0 or self.rng.random() < 0.1:
            return self.leaf(type_)
        match type_:
            case "int64":
                return self.integer(depth)
            case "float32" | "float64":
                return self.float(type_, depth)
            case "bool":
                return self.condition(depth)
            case _:
                return self.string(depth)

    def leaf(self, type_: str) -> Made:
        kinds = {"int64": [each for each in INTEGERS if each != "uint64"]}.get(type_, [type_])
        names = [name for name, kind in self.leaves.items() if kind in kinds]
        choice = self.rng.random()
        if type_ == "int64" and self.variables and choice < 0.4:
            name = self.rng.choice(self.variables)
            return Made(name, "int64", lambda fields: fields[name])
        if names and choice < 0.75:
            name = self.rng.choice(names)
            return Made(f".{name}", self.leaves[name], lambda fields: fields[name])
        match type_:
            case "int64":
                number = self.rng.choice(NUMBERS)
                return Made(str(number) if number >= 0 else f"({number})", "int64", lambda _: number, is_known=True)
            case "float32" | "float64":
                return self.real(type_)
            case "bool":
                is_true = self.rng.random() < 0.5
                return Made(str(is_true).lower(), "bool", lambda _: is_true, is_known=True)
            case _:
                text = self.rng.choice(TEXTS)
                return Made(quoted(text), "string", lambda _: text, is_known=True)

    def real(self, type_: str) -> Made:
        """A number that is not written out where it would stand for another type."""
        number = self.rng.choice(REALS)
        kind = np.float32 if type_ == "float32" else np.float64
        with np.errstate(all="ignore"):
            value = kind(number)
        return Made(
            f"{type_}({number!r})" if type_ == "float64" or number < 1e30 else "float32(1.5)",
            type_,
            lambda _: value if number < 1e30 or type_ == "float64" else np.float32(1.5),
            is_known=True,
        )

    def pair(self, type_: str, depth: int) -> tuple[Made, Made]:
        """Two expressions of which one is no constant."""
        left, right = self.of(type_, depth), self.of(type_, depth)
        return (self.field(type_), right) if left.is_known and right.is_known else (left, right)

    def field(self, type_: str) -> Made:
        """A field of a type."""
        name = self.rng.choice([name for name, kind in self.leaves.items() if kind == type_])
        return Made(f".{name}", type_, lambda fields: fields[name])

    def live(self, type_: str, depth: int) -> Made:
        """An expression that is no constant."""
        made = self.of(type_, depth)
        return self.field(type_) if made.is_known else made

    def chosen(self, type_: str, depth: int) -> Made:
        condition = self.of("bool", depth - 1)
        then, other = self.pair(type_, depth - 1)
        return Made(
            f"({then.text} if {condition.text} else {other.text})",
            type_,
            lambda fields: then.evaluate(fields) if condition.evaluate(fields) else other.evaluate(fields),
        )

    def table(self, type_: str, depth: int) -> Made:
        subject = self.live("int64", depth - 1) if self.rng.random() < 0.5 else self.leaf("string")
        if subject.is_known:
            subject = Made(".s", "string", lambda fields: fields["s"])
        keys = self.rng.sample([each for each in (NUMBERS if subject.type in INTEGERS else TEXTS) if each != ""], 3)
        if subject.type in INTEGERS and subject.type != "int64":
            low, high = INTEGERS[subject.type]
            keys = [key for key in keys if low <= key <= high] or [1]
        values = [self.of(type_, depth - 2) for _ in keys]
        if all(value.is_known for value in values):
            values[0] = self.live(type_, 0)
        rest = self.live(type_, depth - 2) if self.rng.random() < 0.7 else None
        texts = [f"{quoted(key) if isinstance(key, str) else key} = {value.text}" for key, value in zip(keys, values, strict=True)]
        texts.append(f"otherwise {rest.text}" if rest is not None else 'otherwise reject "no"')

        def evaluate(fields: Fields) -> Value:
            found = subject.evaluate(fields)
            for key, value in zip(keys, values, strict=True):
                if found == key:
                    return value.evaluate(fields)
            if rest is None:
                raise Refused("rejected")
            return rest.evaluate(fields)

        return Made(f"table({subject.text}) {{ {', '.join(texts)} }}", type_, evaluate)

    def integer(self, depth: int) -> Made:
        match self.rng.randrange(11):
            case 0:
                return self.chosen("int64", depth)
            case 1 if depth > 1:
                return self.table("int64", depth)
            case 2:
                return self.converted(depth)
            case 3:
                operand = self.live("int64", depth - 1)
                return self.applied(operand, self.rng.choice(["(-{})", "abs({})"]))
            case 4:
                return self.counted(depth)
            case 5:
                index = self.of("int64", depth - 1)
                name = self.rng.choice(["ks", "q"])
                if index.is_known:
                    index = self.live("int64", 0)
                return Made(
                    f".{name}[{index.text}]",
                    "int32" if name == "ks" else "int16",
                    lambda fields: element(fields[name], index.evaluate(fields), name),
                )
            case 6:
                text = self.of("string", depth - 1)
                return Made(f"integer({text.text})", "int64", lambda fields: spelled(text.evaluate(fields)))
            case _:
                template, function = INTEGER_OPERATIONS[self.rng.choice(list(INTEGER_OPERATIONS))]
                left, right = self.pair("int64", depth - 1)
                if right.is_known and (right.text == "0" or template in SHIFTS):
                    right = self.live("int64", 0)
                return Made(
                    template.format(left.text, right.text),
                    "int64",
                    lambda fields: both(function, left.evaluate(fields), right.evaluate(fields)),
                )

    @staticmethod
    def applied(operand: Made, template: str) -> Made:
        def evaluate(fields: Fields) -> Value:
            value = operand.evaluate(fields)
            return fits(-value if template.startswith("(-") or value < 0 else value)

        return Made(template.format(operand.text), "int64", evaluate)

    def converted(self, depth: int) -> Made:
        """An integer by one of the rules."""
        aim = self.rng.choice([each for each in INTEGERS if each != "uint64"])
        if self.rng.random() < 0.5:
            rule = self.rng.choice(["exact", "saturate", "wrap"])
            operand = self.live("int64", depth - 1) if self.rng.random() < 0.7 or "u64" not in self.leaves else field("u64", "uint64")
            if operand.is_known:
                operand = self.live("int64", 0)
            function = {"exact": fits, "saturate": clamped, "wrap": wrapped}[rule]
            return Made(conversion(aim, operand, rule), aim, lambda fields: function(operand.evaluate(fields), aim))
        if self.rng.random() < 0.2:
            condition = self.live("bool", depth - 1)
            return Made(f"{aim}({condition.text})", aim, lambda fields: int(condition.evaluate(fields)))
        rule = self.rng.choice(["exact", "round", "truncate", "saturate"])
        value = self.live(self.rng.choice(["float32", "float64"]), depth - 1)
        return Made(conversion(aim, value, rule), aim, lambda fields: whole(value.evaluate(fields), aim, rule))

    def counted(self, depth: int) -> Made:
        match self.rng.randrange(4):
            case 0:
                return Made("len(.xs)", "int64", lambda fields: len(fields["xs"]))
            case 1:
                return Made("len(.ks)", "int64", lambda fields: len(fields["ks"]))
            case 2:
                text = self.of("string", depth - 1)
                return Made(f'parts({text.text}, "/")', "int64", lambda fields: len(text.evaluate(fields).split("/")))
            case _:
                return Made("len(.s)", "int64", lambda fields: len(fields["s"].encode()))

    def float(self, type_: str, depth: int) -> Made:
        match self.rng.randrange(10):
            case 0:
                return self.chosen(type_, depth)
            case 1 if depth > 1:
                return self.table(type_, depth)
            case 2:
                kind = self.rng.choice(["int64", "float32", "float64"])
                operand, rule = self.live(kind, depth - 1), self.rng.choice(["nearest", "exact"])
                if type_ == "float32" and operand.is_known:
                    operand = self.live(kind, 0)
                return Made(conversion(type_, operand, rule), type_, lambda fields: as_float(operand.evaluate(fields), type_, rule))
            case 3:
                name = self.rng.choice(list(FLOAT_FUNCTIONS))
                operand = self.live(type_, depth - 1)
                function = FLOAT_FUNCTIONS[name]
                text = f"(-{operand.text})" if name == "-" else f"{name}({operand.text})"
                return Made(text, type_, lambda fields: function(operand.evaluate(fields)))
            case 4 if type_ == "float64":
                index = self.live("int64", depth - 1)
                return Made(f".xs[{index.text}]", "float64", lambda fields: np.float64(element(fields["xs"], index.evaluate(fields), "xs")))
            case 5 if type_ == "float64":
                operand = self.live("float64", depth - 1)
                return Made(f"sqrt({operand.text})", type_, lambda fields: np.sqrt(operand.evaluate(fields)))
            case 6:
                narrow = self.narrow()
                if narrow is not None:
                    left, operator = self.live(type_, depth - 1), self.rng.choice("+-*/")
                    kind = np.float32 if type_ == "float32" else np.float64
                    _, function = FLOAT_OPERATIONS[operator]
                    if left.is_known:
                        left = field("f32" if type_ == "float32" else "f64", type_)
                    return Made(
                        f"({left.text} {operator} {narrow.text})",
                        type_,
                        lambda fields: function(left.evaluate(fields), kind(narrow.evaluate(fields))),
                    )
                return self.leaf(type_)
            case _:
                template, function = FLOAT_OPERATIONS[self.rng.choice(list(FLOAT_OPERATIONS))]
                left, right = self.pair(type_, depth - 1)
                if right.is_known:
                    left, right = right, left
                return Made(
                    template.format(left.text, right.text),
                    type_,
                    lambda fields: both(function, left.evaluate(fields), right.evaluate(fields)),
                )

    def narrow(self) -> Made | None:
        names = [name for name, kind in self.leaves.items() if kind in NARROW]
        return field(name := self.rng.choice(names), self.leaves[name]) if names else None

    def condition(self, depth: int) -> Made:
        match self.rng.randrange(8):
            case 0:
                operand = self.live("bool", depth - 1)
                return Made(f"(not {operand.text})", "bool", lambda fields: not operand.evaluate(fields))
            case 1:
                left, right = self.pair("bool", depth - 1)
                return Made(f"({left.text} and {right.text})", "bool", lambda fields: left.evaluate(fields) and right.evaluate(fields))
            case 2:
                left, right = self.pair("bool", depth - 1)
                return Made(f"({left.text} or {right.text})", "bool", lambda fields: left.evaluate(fields) or right.evaluate(fields))
            case 3:
                left, right = self.pair("string", depth - 1)
                operator = self.rng.choice(list(COMPARED))
                compare = COMPARED[operator]
                return Made(
                    f"({left.text} {operator} {right.text})",
                    "bool",
                    lambda fields: both(compare, left.evaluate(fields).encode(), right.evaluate(fields).encode()),
                )
            case 4:
                text, pattern = self.live("string", depth - 1), self.rng.choice(["a", "/", "é", "B"])
                name, asked = self.rng.choice(
                    [("starts_with", str.startswith), ("ends_with", str.endswith), ("contains", str.__contains__)]
                )
                return Made(f"{name}({text.text}, {quoted(pattern)})", "bool", lambda fields: asked(text.evaluate(fields), pattern))
            case _:
                left, right = self.pair(self.rng.choice(["int64", "float32", "float64"]), depth - 1)
                operator = self.rng.choice(list(COMPARED))
                compare = COMPARED[operator]
                return Made(
                    f"({left.text} {operator} {right.text})",
                    "bool",
                    lambda fields: bool(both(compare, left.evaluate(fields), right.evaluate(fields))),
                )

    def string(self, depth: int) -> Made:
        match self.rng.randrange(9):
            case 0:
                left, right = self.pair("string", depth - 1)
                return Made(f"({left.text} + {right.text})", "string", lambda fields: left.evaluate(fields) + right.evaluate(fields))
            case 1:
                name, function = self.rng.choice([("lower", lowered), ("upper", raised), ("strip", lambda text: text.strip(" \t\n\r\v\f"))])
                text = self.live("string", depth - 1)
                return Made(f"{name}({text.text})", "string", lambda fields: function(text.evaluate(fields)))
            case 2:
                text, old, new = self.live("string", depth - 1), self.rng.choice(["a", "/", "é"]), self.rng.choice(["", "xy", "é"])
                return Made(
                    f"replace({text.text}, {quoted(old)}, {quoted(new)})", "string", lambda fields: text.evaluate(fields).replace(old, new)
                )
            case 3:
                text, number = self.live("string", depth - 1), self.of("int64", 0)
                return Made(
                    f'part({text.text}, "/", {number.text})',
                    "string",
                    lambda fields: both(
                        lambda text, index: element(text.split("/"), index), text.evaluate(fields), number.evaluate(fields)
                    ),
                )
            case 4:
                text, start = self.live("string", depth - 1), self.rng.randrange(3)
                stop = start + self.rng.randrange(3)
                return Made(f"slice({text.text}, {start}, {stop})", "string", lambda fields: cut(text.evaluate(fields), start, stop))
            case 5:
                number = self.live(self.rng.choice(["int64", "float32", "float64", "bool"]), depth - 1)
                return Made(f"text({number.text})", "string", lambda fields: written(number.evaluate(fields)))
            case 6:
                text, begin = self.live("string", depth - 1), self.rng.choice(["a", "/", ""])
                if not begin:
                    return text
                return Made(f"behind({text.text}, {quoted(begin)})", "string", lambda fields: behind(text.evaluate(fields), begin))
            case _:
                return self.leaf("string")


def both(function: Callable[[Any, Any], Any], left: Value, right: Value) -> Value:
    """A function of two values that were computed before."""
    return function(left, right)


def field(name: str, type_: str) -> Made:
    return Made(f".{name}", type_, lambda fields: fields[name])


def conversion(type_: str, operand: Made, rule: str) -> str:
    first = "nearest" if type_.startswith("float") else "exact"
    return f"{type_}({operand.text})" if rule == first else f"{type_}({operand.text}, {rule})"


def quoted(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


# --- the values of fields ------------------------------------------------------------------------------------------------


def some_value(rng: random.Random, type_: str) -> Value:
    """A value of a leaf, plain or extreme."""
    match type_:
        case "bool":
            return rng.random() < 0.5
        case "string":
            return rng.choice([*TEXTS, "".join(rng.choice("ab/ é1") for _ in range(rng.randrange(6)))])
        case "float32" | "float64":
            return some_float(rng, type_)
        case _:
            low, high = INTEGERS[type_]
            close = [value for value in (*range(-3, 12), 63, 64, 100) if low <= value <= high]
            return rng.choice([low, high, rng.randint(low, high), low + 1, *(rng.choice(close) for _ in range(6))])


def some_float(rng: random.Random, type_: str) -> np.floating:
    kind = np.float32 if type_ == "float32" else np.float64
    edges = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        0.5,
        1.5,
        2.5,
        -2.5,
        1e10,
        127.5,
        255.5,
        math.nan,
        math.inf,
        -math.inf,
        2.0**31,
        -(2.0**63),
        2.0**63,
        2.0**64,
    ]
    with np.errstate(all="ignore"):
        bits = np.frombuffer(rng.randbytes(8), "<f8")[0] if kind is np.float64 else np.frombuffer(rng.randbytes(4), "<f4")[0]
        return kind(rng.choice([*edges, round(rng.uniform(-100, 100), 2), bits]))


def some_fields(rng: random.Random, leaves: dict[str, str]) -> Fields:
    """The values of the fields that expressions read, without the arrays."""
    return {name: some_value(rng, type_) for name, type_ in leaves.items()}


def plain(value: Value) -> Value:
    """A value as `to_dict` has it, floats by their bits: NaN is equal to itself, and -0 not to 0."""
    if isinstance(value, list):
        return [plain(each) for each in value]
    if isinstance(value, np.floating | float):
        return "nan" if math.isnan(value) else struct.pack("<d", float(value))
    return int(value) if isinstance(value, np.integer) else value
