"""Random rules that set all fields of a type, each with what it then has: fields within messages, absent ones, cases of unions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, assert_never

import numpy as np

from tests.random_mappings.meaning import INTEGERS, Fields, Refused, Value, fits
from tests.random_mappings.message_types import CONSTANTS, Array, Choice, Enum, Kind, Map, Maybe, Message, Scalar, below, default, joint
from tests.random_mappings.values import Made, Maker, conversion

if TYPE_CHECKING:
    from collections.abc import Callable

    Run = Callable[[Fields], dict[str, Any]]


@dataclass
class Rules:
    """Rules for some fields of one message, and what they give, as `to_dict` has it."""

    text: str
    run: Run


@dataclass
class Filler:
    """Makes rules that set a message; ``constant`` is how a constant of its enum is named."""

    maker: Maker
    constant: Callable[[str], str]
    depth: int = 4

    def message(self, message: Message, path: str = "") -> Rules:
        return joined([self.field(name, kind, path) for name, kind in message.fields.items()])

    def field(self, name: str, kind: Kind, path: str) -> Rules:
        at, rng = below(path, name, kind), self.maker.rng
        match kind:
            case Scalar(type_):
                return self.left_out(name, type_, at) if rng.random() < 0.05 else self.assigned(name, type_, at)
            case Message():
                inner = self.message(kind, at)
                return Rules(inner.text, lambda fields: {name: inner.run(fields)})
            case Enum():
                return self.enum(name, at)
            case Maybe(each):
                return self.maybe(name, each, at)
            case Choice():
                return self.choice(name, kind, at)
            case Array() | Map():
                raise AssertionError(kind)
            case _:
                assert_never(kind)

    def assigned(self, name: str, type_: str, at: str) -> Rules:
        made = exactly(self.maker, type_, self.depth)
        return Rules(f".{at} = {made.text}\n", lambda fields: {name: placed(made, fields, f".{at}")})

    @staticmethod
    def left_out(name: str, type_: str, at: str) -> Rules:
        return Rules(f"default .{at}\n", lambda _: {name: default(type_)})

    def enum(self, name: str, at: str) -> Rules:
        maker, names = self.maker, [self.constant(each) for each in CONSTANTS]
        match maker.rng.randrange(3):
            case 0:
                condition = maker.live("bool", 2)
                made = Made(
                    f"{names[2]} if {condition.text} else {names[1]}",
                    "enum",
                    lambda fields: CONSTANTS[2 if condition.evaluate(fields) else 1],
                )
            case 1:
                number = maker.live("int64", 2)
                made = Made(
                    f"{names[0][: -len(CONSTANTS[0])].rstrip('.:')}({number.text})", "enum", lambda fields: named(number.evaluate(fields))
                )
            case _:
                text = maker.live("string", 2)
                entries = f'"a" = {names[1]}, "" = {names[2]}, otherwise {names[0]}'
                made = Made(
                    f"table({text.text}) {{ {entries} }}", "enum", lambda fields: CONSTANTS[{"a": 1, "": 2}.get(text.evaluate(fields), 0)]
                )
        return Rules(f".{at} = {made.text}\n", lambda fields: {name: placed(made, fields, f".{at}")})

    def maybe(self, name: str, kind: Scalar | Message, at: str) -> Rules:
        set_, absent = self.field(name, kind, at.rpartition(".")[0]), Rules(f"default .{at}\n", lambda _: {})
        match self.maker.rng.randrange(4):
            case 0:
                return absent
            case 1:
                return set_ if not set_.text.startswith("default") else absent
            case _:
                return self.when(set_ if not set_.text.startswith("default") else absent, absent)

    def choice(self, name: str, kind: Choice, at: str) -> Rules:
        """Rules that set one of the cases, or one of two, or none."""
        rng = self.maker.rng
        is_told = rng.random() < 0.6
        cases = [self.case(kind, each, at, is_told=is_told) for each in rng.sample(list(kind.cases), 2)]
        if not kind.is_named:
            cases.append(Rules(f"default .{joint(at, f'{name}_of')}\n", lambda _: {}))
        made = rng.choice(cases) if rng.random() < 0.4 else self.when(*rng.sample(cases, 2))
        return Rules(made.text, lambda fields: {name: made.run(fields)}) if kind.is_named else made

    def case(self, kind: Choice, case: str, at: str, *, is_told: bool) -> Rules:
        """A case, and the discriminator of unions that have one, before or behind it, or left to the case."""
        type_ = kind.cases[case].type
        if not (kind.is_named and is_told):
            return self.assigned(case, type_, joint(at, case))
        made = self.assigned(case, type_, joint(at, case))
        label = f".{at}._d = {list(kind.cases).index(case) + 1}\n"
        return Rules(label + made.text if self.maker.rng.random() < 0.5 else made.text + label, made.run)

    def when(self, then: Rules, other: Rules) -> Rules:
        condition = self.maker.live("bool", 3)
        return Rules(
            f"when {condition.text}\n{then.text}else\n{other.text}end\n",
            lambda fields: (then if placed(condition, fields, "") else other).run(fields),
        )


def joined(rules: list[Rules]) -> Rules:
    """Rules in their order: it is the first that fails whose error is told."""

    def run(fields: Fields) -> dict[str, Any]:
        found: dict[str, Any] = {}
        for each in rules:
            found |= each.run(fields)
        return found

    return Rules("".join(each.text for each in rules), run)


def placed(made: Made, fields: Fields, at: str) -> Value:
    """The value of an expression; what it refuses is refused at this place, if no other is said."""
    try:
        return made.evaluate(fields)
    except Refused as refused:
        raise Refused(refused.kind, refused.place or at) from None


def exactly(maker: Maker, type_: str, depth: int) -> Made:
    """An expression that a field of a type takes."""
    if type_ in INTEGERS and type_ != "int64":
        operand = maker.live("int64", depth)
        return Made(conversion(type_, operand, "exact"), type_, lambda fields: fits(operand.evaluate(fields), type_))
    made = maker.of(type_, depth)
    if type_ == "float64":
        return Made(made.text, type_, lambda fields: np.float64(made.evaluate(fields)))
    return made


def named(number: int) -> str:
    if number not in range(len(CONSTANTS)):
        raise Refused("range")
    return CONSTANTS[number]
