"""Random relations for both directions, each with what it unpacks, by plain Python.

Part = fields of the wire, fields of the holder, rules, unpack(fields of the wire) → fields of the holder or a failed `Refused`
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from tests.lowering.meaning import (
    INTEGERS,
    TEXTS,
    Refused,
    Value,
    behind,
    clamped,
    exact_quotient,
    fits,
    quotient,
    spelled,
    wrapped,
    written,
)
from tests.lowering.random_types import CONSTANTS, Array, Enum, Kind, Maybe, Message, Scalar, some
from tests.lowering.random_values import quoted

if TYPE_CHECKING:
    import random
    from collections.abc import Callable, Iterable, Mapping

    from tests.lowering.random_wires import Wire


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
    is_sure: bool = False
    """Whether no other values of the wire are asked for: what they are refused as is not said here."""

    def some_wire(self, rng: random.Random) -> Values:
        return chosen(rng, self.wire, self.wires, is_sure=self.is_sure)

    def some_holder(self, rng: random.Random) -> Values:
        return chosen(rng, self.holder, self.holders)


def chosen(
    rng: random.Random, kinds: Mapping[str, Kind], likely: Callable[[random.Random], Values] | None, *, is_sure: bool = False
) -> Values:
    """Likely values, or any."""
    if likely is not None and (is_sure or rng.random() < 0.8):
        return likely(rng)
    count = rng.choice([0, 1, 2, 4, 6])
    return {name: value for name, kind in kinds.items() if (value := some(rng, kind, count)) is not None}


@dataclass
class Relations:
    """Makes relations between the types of two wires; ``constant`` names a constant of the holder's enum."""

    rng: random.Random
    wire: Wire
    holder: Wire
    constant: Callable[[str], str]
    made: int = field(default=0)

    more: tuple[Callable[[Relations, str], Part], ...] = ()
    """Forms of other modules, for all wires."""
    more_arrays: tuple[Callable[[Relations, str], Part], ...] = ()

    @property
    def is_counted(self) -> bool:
        """Whether arrays need fields for their lengths."""
        return "lcm" in (self.wire.options["encoding"], self.holder.options["encoding"])

    def part(self) -> Part:
        self.made += 1
        name = f"f{self.made}"
        forms = [self.integers, self.integers, self.floats, self.flags, self.texts, self.text_numbers, self.kinds, self.told, self.checked]
        forms += [partial(form, self) for form in self.more]
        if not self.is_counted:
            forms += [self.arrays, self.lists, self.structs, *(partial(form, self) for form in self.more_arrays)]
        if self.holder.constant:
            forms += [self.enums, self.enums]
        if self.wire.has_optional and self.holder.has_optional:
            forms.append(self.optional)
        return self.rng.choice(forms)(name)

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
            template, function = self.rng.choice(
                [
                    ("({} + {})", lambda x, c: x + c),
                    ("({1} - {0})", lambda x, c: c - x),
                    ("({} * {})", lambda x, c: x * c),
                    ("({} / {})", lambda x, c: x / c),
                    ("(-{})", lambda x, _: -x),
                ]
            )
            text = template.format(text, shown)
            functions.append((function, number))

        def unpack(fields: Values) -> Values:
            value = np.float32(fields[name]) if origin == "float32" else np.float64(fields[name])
            for function, number in functions:
                value = function(value, type(value)(number))
            return {name: np.float32(value) if aim == "float32" else np.float64(value)}

        is_narrowed = (origin, aim) == ("float64", "float32")
        return Part({name: Scalar(origin)}, {name: Scalar(aim)}, f".{name} <-> {f'float32({text})' if is_narrowed else text}\n", unpack)

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

    def told(self, name: str) -> Part:
        """A `when` whose condition other relations tell."""
        a, b = f"{name}a", f"{name}b"
        limit = self.rng.choice([0, 3, 100])
        operator, holds = self.rng.choice([(">", lambda x: x > limit), ("==", lambda x: x == limit), ("!=", lambda x: x != limit)])
        then, run = self.chain(f".{b}", 1)
        other, turn = self.chain(f".{b}", 1)
        shift = self.rng.choice([0, 1, -4])
        condition = f".{a} {operator} {limit}"
        relation = f".{a} <-> int64(.{a} + {shift})\n" if shift > 0 else f".{a} <-> .{a}\n" if not shift else f".{a} <-> .{a} - {-shift}\n"
        if self.rng.random() < 0.3:
            rules = f".{b} <-> ({then} if {condition} else {other})\n"
        else:
            rules = f"when {condition}\n.{b} <-> {then}\nelse\n.{b} <-> {other}\nend\n"

        def unpack(fields: Values) -> Values:
            return {a: fits(fields[a] + shift), b: (run if holds(fields[a]) else turn)(fields[b])}

        kinds = {a: Scalar("int64"), b: Scalar("int64")}
        near = lambda rng: {a: rng.choice([limit, limit + 1, limit + shift, rng.randrange(-200, 200)]), b: rng.randrange(-(10**6), 10**6)}  # noqa: E731 - one line
        ordered = [relation, rules] if self.rng.random() < 0.5 else [rules, relation]
        return Part(kinds, kinds, "".join(ordered), unpack, near, near)

    def kinds(self, name: str) -> Part:
        """A `when` whose blocks relate a field to other constants."""
        a, b = f"{name}a", f"{name}b"
        keys = self.rng.sample(["on", "off", "", "é"], 3)
        then, run = self.chain(f".{b}", 1)
        other, turn = self.chain(f".{b}", 1)
        is_closed = self.rng.random() < 0.5
        last = f'else when .{a} == {quoted(keys[1])}\n.{a} <-> 2\n.{b} <-> {other}\nelse\nreject "no"\nend end\n'
        rules = f"when .{a} == {quoted(keys[0])}\n.{a} <-> 1\n.{b} <-> {then}\n{last}"
        if is_closed:
            rules = f"when .{a}\n.{a} <-> 1\n.{b} <-> {then}\nelse\n.{a} <-> 2\n.{b} <-> {other}\nend\n"

        def unpack(fields: Values) -> Values:
            if not is_closed and fields[a] not in keys[:2]:
                raise Refused("rejected", "")
            is_first = fields[a] if is_closed else fields[a] == keys[0]
            return {a: 1 if is_first else 2, b: (run if is_first else turn)(fields[b])}

        wires = (
            (lambda rng: {a: rng.random() < 0.5, b: rng.randrange(-(10**6), 10**6)})
            if is_closed
            else (lambda rng: {a: rng.choice(keys), b: rng.randrange(-(10**6), 10**6)})
        )
        return Part(
            {a: Scalar("bool" if is_closed else "string"), b: Scalar("int64")},
            {a: Scalar("int32"), b: Scalar("int64")},
            rules,
            unpack,
            wires,
            lambda rng: {a: rng.choice([1, 2]), b: rng.randrange(-(10**6), 10**6)},
        )

    def checked(self, name: str) -> Part:
        """A field that several relations tell, and a constant."""
        a, b = f"{name}a", f"{name}b"
        text, run = self.chain(f".{name}", 1)

        def unpack(fields: Values) -> Values:
            return {a: fields[name], b: run(fields[name]), name: 42}

        def holders(rng: random.Random) -> Values:
            value = rng.randrange(-1000, 1000)
            try:
                return unpack({name: value})
            except Refused:
                return {a: value, b: value, name: 42}

        rules = [f".{a} <-> .{name}\n", f".{b} <-> {text}\n", f".{name} <-> 42\n"]
        self.rng.shuffle(rules)
        kinds = {a: Scalar("int64"), b: Scalar("int64"), name: Scalar("int32")}
        return Part({name: Scalar("int64")}, kinds, "".join(rules), unpack, holders=holders)

    def optional(self, name: str) -> Part:
        """What is there on one side is on the other."""
        type_ = self.rng.choice(["int64", "float64", "string", "bool"])
        sign = "-" if type_ in ("int64", "float64") and self.rng.random() < 0.5 else ""
        rules = f"when has(.{name}) .{name} <-> {sign}.{name} else default .{name} end\n"
        if self.rng.random() < 0.3:
            rules = f"when not has(.{name}) default .{name} else .{name} <-> {sign}.{name} end\n"

        def unpack(fields: Values) -> Values:
            if name not in fields:
                return {}
            value = fields[name]
            return {name: value if not sign else fits(-value) if type_ == "int64" else -value}

        kinds = {name: Maybe(Scalar(type_))}
        return Part(kinds, kinds, rules, unpack)

    def arrays(self, name: str) -> Part:
        rng = self.rng
        size = rng.choice([2, 3])
        forms: list[tuple[str, Callable[[list[Any]], list[Any]]]] = [
            (f".{name} <-> .{name}\n", lambda a: a),
            (f".{name} <-> reversed(.{name})\n", lambda a: a[::-1]),
            (f".{name} <-> reversed(.{name}, {size})\n", lambda a: [x for g in grouped(a, size, name) for x in g[::-1]]),
            (f".{name} <-> permuted(.{name}, [2, 0, 1])\n", lambda a: [g[i] for g in grouped(a, 3, name) for i in (2, 0, 1)]),
            (f".{name} <-> planar(.{name}, {size})\n", lambda a: [g[c] for c in range(size) for g in grouped(a, size, name)]),
            (f".{name}[] <-> -.{name}[]\n", lambda a: [-x for x in a]),
            (
                f"len(.{name}) <-> len(.{name})\nfor i from 0 to len(.{name})\n.{name}[i] <-> .{name}[i] * 2.0\nend\n",
                lambda a: [x * 2.0 for x in a],
            ),
            (
                f"len(.{name}) <-> len(.{name})\nfor i from 0 to len(.{name})\n.{name}[len(.{name}) - 1 - i] <-> .{name}[i]\nend\n",
                lambda a: a[::-1],
            ),
        ]
        text, function = rng.choice(forms)
        kinds = {name: Array(Scalar("float64"))}
        six = lambda rng: {name: [some(rng, Scalar("float64")) for _ in range(rng.choice([0, 6, 12]))]}  # noqa: E731 - one line
        return Part(kinds, kinds, text, lambda fields: {name: function(fields[name])}, six, six)

    def lists(self, name: str) -> Part:
        a, b = f"{name}a", f"{name}b"
        return Part(
            {a: Scalar("float64"), b: Scalar("float64")},
            {name: Array(Scalar("float64"))},
            f".{name} <-> [.{b}, 1.5, -.{a}]\n",
            lambda fields: {name: [fields[b], np.float64(1.5), -fields[a]]},
            holders=lambda rng: {name: [some(rng, Scalar("float64")), np.float64(1.5), some(rng, Scalar("float64"))]},
        )

    def structs(self, name: str) -> Part:
        """An array of messages, member by member."""
        members = {"u": Scalar("int32"), "v": Scalar("string")}
        inner = Array(Message(f"Src{name.upper()}", members)), Array(Message(f"Dst{name.upper()}", members))
        text, run = self.chain(f".{name}[i].u", 1)
        rules = (
            f"len(.{name}) <-> len(.{name})\nfor i from 0 to len(.{name})\n"
            f'.{name}[i].u <-> int32({text})\n.{name}[i].v <-> "#" + .{name}[i].v\nend\n'
        )

        def unpack(fields: Values) -> Values:
            return {name: [{"u": fits(run(each["u"]), "int32"), "v": "#" + each["v"]} for each in fields[name]]}

        def holders(rng: random.Random) -> Values:
            return {name: [{"u": rng.randrange(-1000, 1000), "v": "#" + rng.choice(TEXTS)} for _ in range(rng.randrange(4))]}

        return Part({name: inner[0]}, {name: inner[1]}, rules, unpack, holders=holders)


def below_all(parts: Iterable[Mapping[str, Any]]) -> dict[str, Any]:
    """All entries of some dicts."""
    return {name: value for part in parts for name, value in part.items()}


def body(parts: list[Part]) -> str:
    """What a mapping says beside its types."""
    declared = "".join(f"parameter {name}: {type_}\n" for part in parts for name, (type_, _) in part.parameters.items())
    rules, pack = ("".join(getattr(part, which) for part in parts) for which in ("text", "pack"))
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


def grouped(array: list[Any], size: int, name: str) -> list[list[Any]]:
    if len(array) % size:
        raise Refused("range", f".{name}")
    return [array[i : i + size] for i in range(0, len(array), size)]
