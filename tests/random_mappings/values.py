"""Random well-typed expressions of the mapping language, each with what it is by `meaning`.

    Made = text, type, evaluate(fields) → value or a failed `Refused`

`of(type, depth)` makes one.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from tests.random_mappings.meaning import (
    COMPARED,
    FLOAT_FUNCTIONS,
    FLOAT_OPERATIONS,
    INTEGER_OPERATIONS,
    INTEGERS,
    NARROW,
    NUMBERS,
    REALS,
    SHIFTS,
    TEXTS,
    Fields,
    Refused,
    Value,
    as_float,
    behind,
    clamped,
    cut,
    element,
    fits,
    lowered,
    raised,
    spelled,
    together,
    whole,
    wrapped,
    written,
)

if TYPE_CHECKING:
    import random
    from collections.abc import Callable


CONSTANTS = [0.1, 2.5, -0.5, 3.0, 1234567890.0, 1e-7, 255.0, 2, -3]
"""Constants that stand beside numbers of other types; of some there is a float32."""


@dataclass
class Made:
    text: str
    type: str
    evaluate: Callable[[Fields], Value]
    is_known: bool = False


@dataclass
class Maker:
    """Makes expressions; ``leaves`` are the fields that there are, by name."""

    rng: random.Random
    leaves: dict[str, str]
    variables: tuple[str, ...] = ()
    atoms: tuple[Made, ...] = ()
    """More that stands where a field does: whether something is there, an enum's number."""
    arrays: tuple[tuple[str, str], ...] = (("ks", "int32"), ("q", "int16"))
    """The arrays of integers."""

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
        atoms = [each for each in self.atoms if each.type in kinds]
        if atoms and choice < 0.5:
            return self.rng.choice(atoms)
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
                name, kind = self.rng.choice(self.arrays)
                if index.is_known:
                    index = self.live("int64", 0)
                return Made(
                    f".{name}[{index.text}]",
                    kind,
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
            case 6 | 7:
                return self.mixed(type_, depth)
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

    def mixed(self, type_: str, depth: int) -> Made:
        """Arithmetic of numbers of two types, or of one and a constant of the text."""
        template, function = FLOAT_OPERATIONS[self.rng.choice(list(FLOAT_OPERATIONS))]
        kind = np.float32 if type_ == "float32" else np.float64
        for _ in range(20):
            left, constant = self.operand(depth), self.rng.choice([None, *CONSTANTS])
            right = self.operand(depth) if constant is None else constant_of(constant)
            if self.rng.random() < 0.5 and not (template.endswith(("/ {})", "% {})")) or template.startswith("divide")):
                pair, constants = (right, left), (constant, None)
            else:
                pair, constants = (left, right), (None, constant)
            of_integers = constant is not None and isinstance(constant, int) and left.type in INTEGERS
            if not of_integers and together((pair[0].type, pair[1].type), constants) == type_:
                return Made(
                    template.format(pair[0].text, pair[1].text),
                    type_,
                    lambda fields, pair=pair: both(function, kind(pair[0].evaluate(fields)), kind(pair[1].evaluate(fields))),
                )
        return self.leaf(type_)

    def operand(self, depth: int) -> Made:
        """A float, or a field of an integer that a float64 holds."""
        names = [name for name, kind in self.leaves.items() if kind in NARROW]
        if names and self.rng.random() < 0.5:
            return field(name := self.rng.choice(names), self.leaves[name])
        return self.live(self.rng.choice(["float32", "float64"]), depth - 1)

    def mixed_comparison(self, depth: int) -> Made:
        """Numbers of two types compared exactly, and an integer with a float constant."""
        left, operator = self.operand(depth), self.rng.choice(list(COMPARED))
        right, constant = self.operand(depth), self.rng.choice(CONSTANTS)
        if left.type in INTEGERS and self.rng.random() < 0.5:
            right = constant_of(constant)
        return Made(
            f"({left.text} {operator} {right.text})",
            "bool",
            lambda fields: bool(COMPARED[operator](np.float64(left.evaluate(fields)), np.float64(right.evaluate(fields)))),
        )

    def condition(self, depth: int) -> Made:
        match self.rng.randrange(9):
            case 8:
                return self.mixed_comparison(depth)
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


def constant_of(number: float) -> Made:
    """A number that the text writes down; a negative one in brackets."""
    return Made(f"{number!r}" if number >= 0 else f"({number!r})", "constant", lambda _: number)


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
