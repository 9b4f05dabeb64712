"""The values of a message that a mapping packs: the walk over its codec asks for them, and the rules answer."""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator

from rosetta_jit.kernel.nodes import Compare, Const, Expr, If, Local, Place
from rosetta_jit.kernel.terms import index
from rosetta_jit.language import typed
from rosetta_jit.language.conversions import is_textual
from rosetta_jit.language.walk import expressions_of, operands
from rosetta_jit.lowering.rules.holder_side import HolderSide
from rosetta_jit.lowering.rules.scalars import constant, scalar_type
from rosetta_jit.lowering.rules.values import Values
from rosetta_jit.lowering.rules.wire_side import wire_key
from rosetta_jit.lowering.writer import Where, block
from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Float, Int, String, Type, Union
from rosetta_jit.model.walk import every_rule
from rosetta_jit.startup.dataclass import dataclass, replace
from rosetta_jit.wire.codec import Path


@dataclass(frozen=True, slots=True)
class AssignedByRules:
    """What an encoding walk asks for while it lays out a message: numbers, sizes, and bytes that are copied as they are."""

    rules: tuple[typed.Rule, ...]
    source: HolderSide
    values: Values

    def number(self, path: Path) -> Expr:
        return self.decided(path, _zero(path, self.rules), _number_of)

    def size(self, path: Path) -> Expr:
        return self.decided(path, index(0), self.sized)

    def decided(self, path: Path, zero: Const, value: Callable[[typed.Rule, Values], Expr]) -> Expr:
        """What the rule for a field gives; one in a `when` sets a variable."""
        writer, rule = self.values.writer, rule_for(path, self.rules)
        match rule:
            case None:
                raise AssertionError(path)
            case typed.When():
                found = writer.var("_".join(path), zero)
                self.decide(found, path, self.rules, value)
                return found
            case _:
                found = value(rule, self.here(rule))
                return found if isinstance(found, Const) else writer.let("_".join(path), found)

    def decide(self, found: Local, path: Path, rules: tuple[typed.Rule, ...], value: Callable[[typed.Rule, Values], Expr]) -> None:
        """Set a variable where the rules set the field; where they do not, they are going to reject the message."""
        writer, rule = self.values.writer, rule_for(path, rules)
        match rule:
            case None:
                pass
            case typed.When(condition, then, otherwise):
                holds = self.here(rule).of(condition)
                known = dict(self.source.arrays)
                with writer.nested() as yes:
                    self.decide(found, path, then, value)
                self.source.arrays = dict(known)
                with writer.nested() as no:
                    self.decide(found, path, otherwise, value)
                self.source.arrays = known
                writer.emit(If(holds, block(yes), block(no)))
            case typed.Default():  # also of a struct that the field is in
                writer.assign(found, constant(0, found.type))
            case _:
                writer.assign(found, value(rule, self.here(rule)))

    def sized(self, rule: typed.Rule, here: Values) -> Expr:
        """The count that a rule gives its array or text."""
        match rule:
            case typed.SetLength(_, value):
                size = here.writer.let("length", here.of(value))
                here.writer.expect(Compare("ge", size, index(0)), "count", here.where, "a length must not be negative", line=here.line)
                return size
            case typed.Assign(place, typed.Const(str(text))):
                return index(len(units_of(text, place.type)))
            case typed.Assign(_, typed.Access(origin)):
                return self.source.count(origin, here)
            case typed.Assign(place, typed.Listed(items) as listed):
                return here.of(replace(listed, items=tuple(_size(item, place.type) for item in items), type=typed.INT64))
            case typed.Default():
                return index(0)
            case _:
                raise AssertionError(rule)

    def bytes_at(self, path: Path) -> Place | None:
        rule = rule_for(path, self.rules)
        match rule:
            case typed.Assign(_, typed.Access(origin)):
                address = self.source.address(origin, self.here(rule))
                return address if isinstance(address, Place) else None
            case _:
                return None

    def here(self, rule: typed.Rule) -> Values:
        return replace(self.values, where=place_of(rule, self.values)).at_rule(rule.span)


def rule_for(path: Path, rules: tuple[typed.Rule, ...]) -> typed.Rule | None:
    """The rule that sets a field of the wire, or its length, or a `when` that has it in one of its blocks."""
    for rule in rules:
        match rule:
            case typed.Assign(place) | typed.SetLength(place) if wire_key(place) == (path, []):
                return rule
            case typed.Default(place) if wire_key(place) == (path[: len(place.steps)], []):
                return rule
            case typed.When(_, then, otherwise) if rule_for(path, (*then, *otherwise)) is not None:
                return rule
            case _:
                pass
    return None


def _size(text: typed.Expr, type_: Type) -> typed.Const:
    """How many bytes or units a text of a list has."""
    assert isinstance(text, typed.Const)
    return typed.Const(len(units_of(str(text.value), type_)), typed.INT64)


def units_of(text: str, type_: Type) -> list[int]:
    """A text as a type has it: bytes, or units of 16 bits."""
    if isinstance(type_, String) and type_.encoding == "utf-16":
        return [unit for (unit,) in struct.iter_unpack("<H", text.encode("utf-16-le"))]
    return list(text.encode())


def _zero(path: Path, rules: tuple[typed.Rule, ...]) -> Const:
    """A number of the type of a field that rules set."""
    rule = rule_for(path, rules)
    match rule:
        case typed.Assign(place) | typed.Default(place) if isinstance(place.type, Int | Float | Bool | Enum):
            return constant(0, scalar_type(place.type))
        case typed.When(_, then, otherwise):
            blocks = [block for block in (then, otherwise) if rule_for(path, block) is not None]
            return next((zero for block in blocks if (zero := _zero(path, block)) != index(0)), index(0))
        case _:
            return index(0)


def _number_of(rule: typed.Rule, here: Values) -> Expr:
    """The number that a rule gives a field."""
    match rule:
        case typed.Assign(_, value):
            return here.of(value)
        case typed.Default(place):
            known = isinstance(place.type, Int | Float | Bool | Enum)
            return constant(0, scalar_type(place.type)) if known else index(0)
        case _:
            raise AssertionError(rule)


def look_up_arrays(rules: tuple[typed.Rule, ...], holder: HolderSide, values: Values) -> None:
    """Read start and count of the holder's arrays once, before any loop."""
    for place in _array_places(rules):
        if place.side == "holder" and not any(isinstance(step, typed.IndexStep) for step in place.steps):
            holder.array(place, values)


def _array_places(rules: tuple[typed.Rule, ...]) -> Iterator[typed.Place]:
    """Every place whose length or elements rules read."""
    for rule in every_rule(rules):
        match rule:
            case typed.Assign(_, typed.Access(place)) if isinstance(place.type, Array | String | Bytes):
                yield place
            case typed.Assign(_, value) | typed.SetLength(_, value) | typed.SetState(_, value):
                yield from _read(value)
            case typed.For() | typed.When():
                yield from _read(*expressions_of(rule))
            case _:
                pass


def _read(*exprs: typed.Expr) -> list[typed.Place]:
    """The same of expressions."""
    return [place for expr in exprs for place in _read_by(expr)]


def _read_by(expr: typed.Expr) -> list[typed.Place]:
    match expr:
        case typed.IsText(place):
            return [place, *_indexed(place)]
        case typed.LenOf(place):
            return [place]
        case typed.Access(place) | typed.Has(place):
            return _indexed(place)
        case typed.Search(_, _, condition):
            return _read(condition)
        case typed.Call(_, arguments) | typed.HostCall(_, arguments):
            texts = [each.place for each in arguments if isinstance(each, typed.Access) and is_textual(each.type)]
            return texts + _read(*arguments)
        case _:
            return _read(*operands(expr))


def _indexed(place: typed.Place) -> list[typed.Place]:
    for number, step in enumerate(place.steps):
        if isinstance(step, typed.IndexStep):
            return [typed.Place(place.side, place.steps[:number], place.type), *_read(step.index)]
    return []


def place_of(rule: typed.Rule, values: Values) -> Where:
    """The field that a rule sets, for its errors. Of the indices those are known that are loop variables, or written down."""
    where = Where()
    if isinstance(rule, typed.Assign | typed.SetLength):
        for step in rule.place.steps:
            match step:
                case typed.FieldStep(each) if isinstance(each.type, Union) and step is not rule.place.steps[-1]:
                    pass  # its cases are named as fields of what is around
                case typed.FieldStep(each):
                    where = where.member(each.name)
                case typed.IndexStep(typed.Local(name)) if name in values.variables:
                    where = where.element(values.variables[name])
                case typed.IndexStep(typed.Const(int(number))):
                    where = replace(where, path=f"{where.path}[{number}]")
                case _:
                    where = replace(where, path=f"{where.path}[]")
    return where
