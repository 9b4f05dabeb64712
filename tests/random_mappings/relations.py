"""Random relations for both directions, each with what it unpacks, by plain Python.

Part = fields of the wire, fields of the holder, rules, unpack(fields of the wire) → fields of the holder or a failed `Refused`
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from tests.random_mappings.meaning import (
    INTEGERS,
    NARROW,
    TEXTS,
    Refused,
    Value,
    behind,
    clamped,
    exact_quotient,
    fits,
    quotient,
    spelled,
    together,
    wrapped,
    written,
)
from tests.random_mappings.message_types import CONSTANTS, Choice, Enum, Kind, Message, Scalar, some
from tests.random_mappings.values import quoted

if TYPE_CHECKING:
    import random
    from collections.abc import Callable, Iterable, Mapping

    from tests.random_mappings.wires import Wire


Values = dict[str, Value]


@dataclass
class Part:
    wire: Mapping[str, Kind]
    holder: Mapping[str, Kind]
    text: str
    unpack: Callable[[Values], Values]
    wires: Callable[[random.Random], Values] | None = None
    """Values of the wire's fields that are likely to be taken."""
    holders: Callable[[random.Random], Values] | None = None

    mappings: Mapping[str, tuple[Message, Message, str]] = field(default_factory=dict)
    """Other mappings that the rules use: the types of their wire and holder, and what they say of them."""
    parameters: Mapping[str, tuple[str, Any]] = field(default_factory=dict)
    units: tuple[str, ...] = ()
    """Fields with their units, as `Src.a: km`."""
    pack: str = ""
    """Rules to pack."""
    is_same: bool = False
    """Whether `same names` maps its fields."""
    is_sure: bool = False
    """Whether no other values of the wire are asked for: what they are refused as is not said here."""
    is_bounded: bool = False
    """Whether neither side is asked for other values: some are refused for what is beyond 64 bits in between."""

    def own(self, values: Values) -> Values:
        """Those of the wire's values that it reads: the cases of a union without a name stand among the fields."""
        names = set(self.wire)
        for kind in self.wire.values():
            if isinstance(kind, Choice) and not kind.is_named:
                names |= set(kind.cases)
        return {name: value for name, value in values.items() if name in names}

    def some_wire(self, rng: random.Random) -> Values:
        return chosen(rng, self.wire, self.wires, is_sure=self.is_sure or self.is_bounded)

    def some_holder(self, rng: random.Random) -> Values:
        return chosen(rng, self.holder, self.holders, is_sure=self.is_bounded)


def chosen(
    rng: random.Random, kinds: Mapping[str, Kind], likely: Callable[[random.Random], Values] | None, *, is_sure: bool = False
) -> Values:
    """Likely values, or any."""
    if likely is not None and (is_sure or rng.random() < 0.8):
        return likely(rng)
    count = rng.choice([0, 1, 2, 4, 6])
    return {name: value for name, kind in kinds.items() if (value := some(rng, kind, count)) is not None}


FLOAT_STEPS: list[tuple[str, Callable[[Any, Any], Any]]] = [
    ("({} + {})", lambda x, c: x + c),
    ("({1} - {0})", lambda x, c: c - x),
    ("({} * {})", lambda x, c: x * c),
    ("({} / {})", lambda x, c: x / c),
    ("(-{})", lambda x, _: -x),
]


def computed(function: Callable[[Any, Any], Any], value: np.floating, number: float) -> np.floating:
    """A step of a float and a constant, of the type in which it is computed."""
    if function is FLOAT_STEPS[-1][1]:  # which has no constant
        return -value
    kind = np.float32 if together((value.dtype.name, "constant"), (None, number)) == "float32" else np.float64
    return function(kind(value), kind(number))


@dataclass
class Scalars:
    """Makes relations of single fields between the types of two wires; ``constant`` names a constant of the holder's enum."""

    rng: random.Random
    wire: Wire
    holder: Wire
    constant: Callable[[str], str]
    made: int = field(default=0)

    def integer_type(self, wire: Wire) -> str:
        return self.rng.choice([each for each in wire.scalars if each in INTEGERS and each != "uint64"])

    def chain(self, text: str, steps: int) -> tuple[str, Callable[[int], int]]:
        """Operations on an integer."""
        functions: list[Callable[[int], int]] = []
        for _ in range(steps):
            number = self.rng.choice([2, 3, -1, 7, -5, 1000, 2**31])
            shown = str(number) if number > 0 else f"({number})"
            template, function = self.rng.choice(
                [
                    ("({} + {})", lambda x, c: fits(x + c)),
                    ("({} - {})", lambda x, c: fits(x - c)),
                    ("({1} - {0})", lambda x, c: fits(c - x)),
                    ("({} * {})", lambda x, c: fits(x * c)),
                    ("({} ^ {})", lambda x, c: x ^ c),
                    ("(-{})", lambda x, _: fits(-x)),
                    ("({} / {})", quotient),
                    ("divide({}, {})", exact_quotient),
                ]
            )
            text = template.format(text, shown)
            functions.append(lambda x, function=function, number=number: function(x, number))

        def run(value: int) -> int:
            for function in functions:
                value = function(value)
            return value

        return text, run

    def integers(self, name: str) -> Part:
        origin, aim = self.integer_type(self.wire), self.integer_type(self.holder)
        text, run = self.chain(f".{name}", self.rng.randrange(3))
        rule = self.rng.choice(["exact", "exact", "exact", "saturate", "wrap"])
        convert = {"exact": fits, "saturate": clamped, "wrap": wrapped}[rule]
        text = f"{aim}({text})" if rule == "exact" else f"{aim}({text}, {rule})"
        return Part(
            {name: Scalar(origin)}, {name: Scalar(aim)}, f".{name} <-> {text}\n", lambda fields: {name: convert(run(fields[name]), aim)}
        )

    def floats(self, name: str) -> Part:
        origin, aim = self.rng.choice(["float32", "float64"]), self.rng.choice(["float32", "float64"])
        text, functions = f".{name}", []
        for _ in range(self.rng.randrange(3)):
            number = self.rng.choice([0.5, 3.0, 0.1, 273.15, -2.5, 1000.0])
            shown = str(number) if number > 0 else f"({number})"
            template, function = self.rng.choice(FLOAT_STEPS)
            text = template.format(text, shown)
            functions.append((function, number))

        def unpack(fields: Values) -> Values:
            value = np.float32(fields[name]) if origin == "float32" else np.float64(fields[name])
            for function, number in functions:
                value = computed(function, value, number)
            return {name: np.float32(value) if aim == "float32" else np.float64(value)}

        is_narrowed = aim == "float32" and (origin == "float64" or functions)
        return Part({name: Scalar(origin)}, {name: Scalar(aim)}, f".{name} <-> {f'float32({text})' if is_narrowed else text}\n", unpack)

    def measured(self, name: str) -> Part:
        """An integer that is a float on the other side."""
        origin, aim = self.rng.choice([each for each in self.wire.scalars if each in NARROW]), self.rng.choice(["float32", "float64"])
        text, functions = f".{name}", []
        for step in range(self.rng.randrange(1, 4)):
            number = self.rng.choice([0.01, 255.0, 0.1, 1e7, 1000.0, -2.5, 0.5, 273.15, 1234567890.0])
            template, function = self.rng.choice(FLOAT_STEPS if step else FLOAT_STEPS[:-1])  # what is negated first is an int64
            text = template.format(text, f"({number!r})")
            functions.append((function, number))
        if self.rng.random() < 0.2:
            turn, factor = self.rng.choice([("radians", np.pi / 180), ("degrees", 180 / np.pi)])
            text = f"{turn}({text})"
            functions.append((lambda x, c: x * c, factor))
        if aim == "float32":
            text = f"float32({text})"

        def unpack(fields: Values) -> Values:
            value = np.float64(fields[name])
            for function, number in functions:
                value = function(value, np.float64(number))
            return {name: np.float32(value) if aim == "float32" else value}

        def made(rng: random.Random) -> Values:
            return unpack({name: some(rng, Scalar(origin))})

        return Part({name: Scalar(origin)}, {name: Scalar(aim)}, f".{name} <-> {text}\n", unpack, holders=made)

    def flags(self, name: str) -> Part:
        """Bools and integers."""
        kind = self.rng.choice(["not", "int", "bool"])
        if kind == "not":
            return Part(
                {name: Scalar("bool")}, {name: Scalar("bool")}, f".{name} <-> not .{name}\n", lambda fields: {name: not fields[name]}
            )
        if kind == "int":
            text = f".{name} <-> int32(.{name})\n"
            return Part({name: Scalar("bool")}, {name: Scalar("int32")}, text, lambda fields: {name: int(fields[name])}, holders=few(name))

        def unpack(fields: Values) -> Values:
            return {name: fits_bool(fields[name])}

        return Part({name: Scalar("int32")}, {name: Scalar("bool")}, f".{name} <-> bool(.{name})\n", unpack, wires=few(name))

    def texts(self, name: str) -> Part:
        begin = quoted(self.rng.choice(["a", "é/", "x = "]))[1:-1]
        template, function, back = self.rng.choice(
            [
                ('"{c}" + .{n}', lambda s: begin + s, lambda s: begin + s),
                ('.{n} + "{c}"', lambda s: s + begin, lambda s: s + begin),
                ('behind(.{n}, "{c}")', lambda s: behind(s, begin), None),
                ('before(.{n}, "{c}")', lambda s: before(s, begin), None),
                ('"<" + (.{n} + "{c}")', lambda s: "<" + s + begin, lambda s: "<" + s + begin),
                (".{n}", lambda s: s, None),
            ]
        )
        wires = {
            'behind(.{n}, "{c}")': lambda rng: {name: begin + rng.choice(TEXTS)},
            'before(.{n}, "{c}")': lambda rng: {name: rng.choice(TEXTS) + begin},
        }
        return Part(
            {name: Scalar("string")},
            {name: Scalar("string")},
            f".{name} <-> {template.format(n=name, c=begin)}\n",
            lambda fields: {name: function(fields[name])},
            wires=wires.get(template),
            holders=None if back is None else lambda rng: {name: back(rng.choice(TEXTS))},
        )

    def text_numbers(self, name: str) -> Part:
        """Numbers that are texts on the other side."""
        numbers = {name: Scalar(self.rng.choice([each for each in ("int32", "int64", "float64", "float32") if each in self.wire.scalars]))}
        texts = {name: Scalar("string")}
        if self.rng.random() < 0.5:
            number_type = numbers[name].type
            holders = (lambda rng: {name: written(some(rng, Scalar(number_type)))}) if self.rng.random() < 0.9 else None
            return Part(numbers, texts, f".{name} <-> text(.{name})\n", lambda fields: {name: written(fields[name])}, holders=holders)
        if self.rng.random() < 0.5:
            return Part(
                texts,
                {name: Scalar("int64")},
                f".{name} <-> integer(.{name})\n",
                lambda fields: {name: spelled(fields[name])},
                wires=lambda rng: {name: str(rng.randrange(-(2**63), 2**63))},
            )
        return Part(
            texts,
            {name: Scalar("float64")},
            f".{name} <-> number(.{name})\n",
            lambda fields: {name: number(fields[name])},
            wires=lambda rng: {name: written(some(rng, Scalar("float64")))},
        )

    def enums(self, name: str) -> Part:
        """Texts or numbers that are constants on the holder's side."""
        keys: list[Any] = self.rng.choice([["rgb", "", "é"], ["a", "b", "c"], [7, 0, -2]])
        names = [self.constant(each) for each in CONSTANTS]
        count = self.rng.randrange(1, 4)
        order = self.rng.sample(range(3), count)
        entries = [f"{quoted(keys[i]) if isinstance(keys[i], str) else keys[i]} = {names[i]}" for i in order]
        rest = self.rng.random() < 0.3
        if rest:
            entries.append(f"otherwise {names[order[0]]}")

        def unpack(fields: Values) -> Values:
            for i in order:
                if fields[name] == keys[i]:
                    return {name: CONSTANTS[i]}
            if not rest:
                raise Refused("rejected", f".{name}")
            return {name: CONSTANTS[order[0]]}

        type_ = "string" if isinstance(keys[0], str) else "int32"
        return Part(
            {name: Scalar(type_)},
            {name: Enum()},
            f".{name} <-> table(.{name}) {{ {', '.join(entries)} }}\n",
            unpack,
            wires=lambda rng: {name: keys[rng.choice(order)]},
        )

    def enum_names(self, name: str) -> Part:
        """Names of constants that are constants on the holder's side."""
        enum = self.constant(CONSTANTS[0])[: -len(CONSTANTS[0])].rstrip(".:")

        def unpack(fields: Values) -> Values:
            if fields[name] not in CONSTANTS:
                raise Refused("range", f".{name}")
            return {name: fields[name]}

        relation = f".{name} <-> {enum}(.{name})\n"
        return Part({name: Scalar("string")}, {name: Enum()}, relation, unpack, wires=lambda rng: {name: rng.choice(CONSTANTS)})

    def named_enums(self, name: str) -> Part:
        """Constants that are their names on the holder's side."""
        begin = self.rng.choice(["", "is "])
        relation = f'.{name} <-> "{begin}" + text(.{name})\n' if begin else f".{name} <-> text(.{name})\n"
        return Part(
            {name: Enum()},
            {name: Scalar("string")},
            relation,
            lambda fields: {name: begin + fields[name]},
            holders=lambda rng: {name: begin + rng.choice([*CONSTANTS, *TEXTS])},
        )


def below_all(parts: Iterable[Mapping[str, Any]]) -> dict[str, Any]:
    """All entries of some dicts."""
    return {name: value for part in parts for name, value in part.items()}


def body(parts: list[Part]) -> str:
    """What a mapping says beside its types."""
    declared = "".join(f"parameter {name}: {type_}\n" for part in parts for name, (type_, _) in part.parameters.items())
    rules, pack = ("".join(getattr(part, which) for part in parts) for which in ("text", "pack"))
    if any(part.is_same for part in parts):
        rules += "same names\n"
    return f"{declared}rules:\n{rules}" + (f"pack-rules:\n{pack}" if pack else "")


def few(name: str) -> Callable[[random.Random], Values]:
    return lambda rng: {name: rng.choice([0, 1])}


def fits_bool(value: int) -> bool:
    if value not in (0, 1):
        raise Refused("range")
    return bool(value)


NUMBER = re.compile(r"[+-]?(\d+(\.\d+)?(e[+-]?\d+)?|inf|nan)")


def number(text: str) -> np.float64:
    if not NUMBER.fullmatch(text):
        raise Refused("text")
    return np.float64(text)


def before(text: str, end: str) -> str:
    if not text.endswith(end):
        raise Refused("text")
    return text[: len(text) - len(end)]
