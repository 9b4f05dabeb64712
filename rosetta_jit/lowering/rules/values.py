"""Typed expressions of rules as kernel expressions: arithmetic, conversions with their rule, functions of the language."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import PurePath
from typing import TYPE_CHECKING, assert_never, cast

from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.terms import index, type_of
from rosetta_jit.kernel.walk import statements
from rosetta_jit.language import typed
from rosetta_jit.language.conversions import describe
from rosetta_jit.language.installed import functions
from rosetta_jit.language.walk import parts
from rosetta_jit.lowering.arithmetic import COMPARISONS, binary, differ
from rosetta_jit.lowering.codec.fields import converted
from rosetta_jit.lowering.evaluation import Awaited, Source, lowered
from rosetta_jit.lowering.rules.scalars import NAMES, RANGES, constant, converted_constant, is_named, scalar_type
from rosetta_jit.lowering.rules.state import remembered
from rosetta_jit.lowering.writer import MESSAGE, Where, Writer, block
from rosetta_jit.model.expr import Operator
from rosetta_jit.model.types import Bool, Enum
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import dataclass, field, replace
from rosetta_jit.startup.late import Late, late

if TYPE_CHECKING:
    from rosetta_jit.lowering.rules import host_calls, look_ahead, reductions, rejections
    from rosetta_jit.lowering.rules import nearest as nearest_values
    from rosetta_jit.lowering.texts import search
else:
    host_calls, look_ahead, nearest_values, reductions, rejections = late(
        "rosetta_jit.lowering.rules", "host_calls", "look_ahead", "nearest", "reductions", "rejections"
    )
    search = Late("rosetta_jit.lowering.texts.search")


@dataclass(frozen=True, slots=True)
class Values:
    """Evaluates expressions: what they read, the loop variables around them, the rule that they belong to."""

    writer: Writer
    source: Source
    variables: Mapping[str, nodes.Expr]
    where: Where = MESSAGE
    line: str = ""
    decided: dict[typed.Expr, tuple[list[nodes.Stmt], nodes.Expr]] = field(
        default_factory=dict["typed.Expr", "tuple[list[nodes.Stmt], nodes.Expr]"]
    )
    groups: dict[typed.Expr, tuple[list[nodes.Stmt], Mapping[str, nodes.Expr]]] = field(
        default_factory=dict["typed.Expr", "tuple[list[nodes.Stmt], Mapping[str, nodes.Expr]]"]
    )
    awaited: dict[typed.Expr, Awaited] = field(default_factory=dict["typed.Expr", "Awaited"])

    def of(self, value: typed.Expr) -> nodes.Expr:
        """The kernel expression of a number. Choices and searches are made once where they are known: nothing that rules read changes."""
        if isinstance(value, typed.Reduce) and value in self.awaited and self.writer.is_around(self.awaited[value].block):
            return self.first_time(value, self.awaited[value])
        is_kept = isinstance(value, typed.Search) or (isinstance(value, KEPT) and not calls_out(value))
        if not is_kept:
            return self.computed(value)
        block, found = self.decided.get(value, (None, None))
        if block is None or found is None or not self.writer.is_around(block):
            block, found = self.writer.block, self.computed(value)
            self.decided[value] = block, found
        return found

    def together(self, value: typed.Expr, compute: Callable[[], Mapping[str, nodes.Expr]]) -> Mapping[str, nodes.Expr]:
        """Numbers that are computed together, by name; what was computed for an equal value is found again where it is known."""
        if calls_out(value):
            return compute()
        block, found = self.groups.get(value, (None, None))
        if block is None or found is None or not self.writer.is_around(block):
            block, found = self.writer.block, compute()
            self.groups[value] = block, found
        return found

    def first_time(self, value: typed.Reduce, awaited: Awaited) -> nodes.Expr:
        """A value that is computed here unless it is known."""
        with self.source.forgetting(), self.writer.nested() as body:
            self.writer.assign(awaited.found, self.computed(value))
            self.writer.assign(awaited.is_known, nodes.Const("bool", value=True))
        self.writer.emit(nodes.If(nodes.Unary("not", awaited.is_known), block(body)))
        return awaited.found

    def computed(self, value: typed.Expr) -> nodes.Expr:
        match value:
            case typed.Const(number, type_):
                return constant(number, scalar_type(type_))
            case typed.Local(name):
                return self.variables[name]
            case typed.Access(place, type_):
                number = self.source.number(place, self)
                return converted(number, scalar_type(type_)) if isinstance(type_, Bool | Enum) else number
            case typed.LenOf(place):
                return self.source.count(place, self)
            case typed.Unary("not", operand):
                return nodes.Unary("not", self.of(operand))
            case typed.Unary(_, operand):
                return self.negative(self.of(operand))
            case typed.Binary(operator, left, right):
                return self.operation(operator, left, right)
            case typed.Convert(operand, type_, rule):
                number = self.of(operand)
                return (
                    self.named(number, type_)
                    if rule == "exact" and is_named(type_, number)
                    else self.convert(number, scalar_type(type_), rule)
                )
            case typed.Nearest():
                return nearest_values.nearest(value, self)
            case typed.Call():
                return cast("nodes.Expr", lowered(value, self))
            case typed.HostCall():
                return host_calls.called(value, self)
            case typed.IsText(place, text):
                return search.is_text(self, place, text.encode())
            case typed.Has() | typed.Search() | typed.Reduce():
                return self.answer(value)
            case typed.StateVariable(_, number, _, type_):
                return remembered(number, scalar_type(type_))
            case typed.Choice() | typed.Listed() | typed.Given():
                return self.choice(value) if isinstance(value, typed.Choice) else self.listed(value)
            case _:
                assert_never(value)

    def answer(self, value: typed.Has | typed.Search | typed.Reduce) -> nodes.Expr:
        """The value of a query about a place, or about the elements of arrays."""
        match value:
            case typed.Has(place):
                return self.source.present(place, self)
            case typed.Search():
                return reductions.number_in(value, self)
            case typed.Reduce():
                return reductions.reduced(value, self)
            case _:
                assert_never(value)

    def operation(self, operator: Operator, left: typed.Expr, right: typed.Expr) -> nodes.Expr:
        if operator in ("and", "or"):
            return self.joined(operator, left, right)
        if operator == "differs":
            return differ(self.writer, self.of(left), self.of(right))
        if operator in COMPARISONS:
            return nodes.Compare(COMPARISONS[operator], self.of(left), self.of(right))
        return binary(self.writer, operator, self.of(left), self.of(right), self.where, self.line)

    def joined(self, operator: Operator, left: typed.Expr, right: typed.Expr) -> nodes.Expr:
        """``left and right``, ``left or right``: where the left one decides, the right one may have no value."""
        writer, first = self.writer, self.of(left)
        with self.source.forgetting(), writer.nested() as step:
            second = self.of(right)
        if not any(isinstance(stmt, FAILING) and stmt not in writer.certain for stmt, _ in statements(block(step))):
            writer.emit(*step)
            return binary(writer, operator, first, second, self.where, self.line)
        found = writer.var("joined", first)
        step.append(nodes.Assign(found.name, second))
        writer.emit(nodes.If(found, block(step)) if operator == "and" else nodes.If(found, (), block(step)))
        return found

    def choice(self, choice: typed.Choice) -> nodes.Expr:
        """Only the value that is chosen is computed, and only the conditions before it: others may not have one."""
        writer = self.writer
        found = writer.var("chosen", constant(0, scalar_type(choice.type)))
        undecided = writer.var("undecided", nodes.Const("bool", value=True))
        for condition, chosen in choice.cases:
            with self.source.forgetting(), writer.nested() as step:
                holds = self.of(condition)
                with writer.nested() as then:
                    writer.assign(found, self.of(chosen))
                    writer.assign(undecided, nodes.Const("bool", value=False))
                writer.emit(nodes.If(holds, block(then)))
            writer.emit(nodes.If(undecided, block(step)))
        if choice.otherwise is None:
            self.reject(choice.reason, choice.pieces, when=undecided)
            return found
        with self.source.forgetting(), writer.nested() as other:
            writer.assign(found, self.of(choice.otherwise))
        writer.emit(nodes.If(undecided, block(other)))
        return found

    def listed(self, listed: typed.Listed | typed.Given) -> nodes.Expr:
        """Only the item that is chosen is computed."""
        assert isinstance(listed, typed.Listed), "parameters are given before a mapping is lowered"
        found = self.writer.var("item", constant(0, scalar_type(listed.type)))
        self.switch(listed, lambda item: self.writer.assign(found, self.of(item)))
        return found

    def switch(self, listed: typed.Listed, use: Callable[[typed.Expr], None]) -> None:
        """Do something with the item of a list that an index chooses."""
        writer = self.writer
        number = writer.let("number", self.of(listed.index))
        there = nodes.Binary("and", nodes.Compare("ge", number, index(0)), nodes.Compare("lt", number, index(len(listed.items))))
        writer.expect(there, "index", self.where, f"the list has {len(listed.items)} items", line=self.line)
        cases: list[tuple[int, nodes.Block]] = []
        for case, item in enumerate(listed.items):
            with self.source.forgetting(), writer.nested() as body:
                use(item)
            cases.append((case, block(body)))
        writer.emit(nodes.Switch(number, tuple(cases), ()))

    def reject(self, reason: str, pieces: tuple[typed.Expr, ...] = (), *, when: nodes.Expr | None = None) -> None:
        """Refuse the message, always or where something holds: with a reason, or with what its pieces say."""
        if pieces:
            rejections.reject_with(pieces, reason, when, self)
            return
        good = nodes.Const("bool", value=False) if when is None else nodes.Unary("not", when)
        self.writer.expect(good, "rejected", self.where, reason, line=self.line)

    def look_ahead(self, exprs: tuple[typed.Expr, ...]) -> None:
        """Before a loop that computes some expressions: what is the same in each round, and takes a loop of its own."""
        look_ahead.look_ahead_of(exprs, self)

    def with_local(self, name: str, number: nodes.Expr, *, afresh: bool = False) -> Values:
        """The same where a loop variable has a value; ``afresh`` where what was decided may be something else for it."""
        variables = {**self.variables, name: number}
        return replace(self, variables=variables, decided={}, groups={}, awaited={}) if afresh else replace(self, variables=variables)

    def with_locals(self, numbers: Mapping[str, nodes.Expr]) -> Values:
        """The same where these names alone have values, and nothing is decided yet."""
        return replace(self, variables=numbers, decided={}, groups={}, awaited={})

    def at_rule(self, span: Span | None) -> Values:
        """The same, with the rule's line for errors; without the folder, so that a kernel is the same wherever its mapping lies."""
        if span is None:
            return self
        line, column = span.source.line_column(span.start)
        return replace(self, line=f"{PurePath(span.source.name).name}:{line}:{column}")

    def negative(self, operand: nodes.Expr) -> nodes.Expr:
        if type_of(operand) in ("f32", "f64"):
            return nodes.Unary("neg", operand)
        return binary(self.writer, "-", index(0), operand, self.where, self.line)

    # --- conversions ---------------------------------------------------------------------------------------------------

    def convert(self, value: nodes.Expr, target: nodes.Scalar, rule: typed.ConversionRule) -> nodes.Expr:
        """A number as another type, by the rule that the mapping states."""
        source = type_of(value)
        if isinstance(value, nodes.Const):
            folded = converted_constant(value, target)
            if folded is not None:
                return folded
        match rule:
            case "widen" | "nearest" | "wrap":
                return value if source == target else nodes.Convert(target, value)
            case "saturate":
                return self.saturated(value, target)
            case "exact" | "round" | "truncate":
                return self.exact(value, target, rule)
            case _:
                assert_never(rule)

    def named(self, value: nodes.Expr, type_: Bool | Enum) -> nodes.Expr:
        """A number as one of the few that a type has."""
        known = (0, 1) if isinstance(type_, Bool) else sorted({number for _, number in type_.values})
        number = self.writer.let("number", value)
        self.in_range(number, scalar_type(type_))
        with self.writer.nested() as other:
            self.expect(nodes.Const("bool", value=False), describe(type_))
        self.writer.emit(nodes.Switch(nodes.Convert("i64", number), tuple((each, ()) for each in known), block(other)))
        return self.convert(number, scalar_type(type_), "wrap")

    def exact(self, value: nodes.Expr, target: nodes.Scalar, rule: str) -> nodes.Expr:
        source = type_of(value)
        local = self.writer.let("number", value)
        if target in ("f32", "f64"):
            return self.exact_float(local, target)
        if source in ("f32", "f64"):
            whole = self.writer.let("whole", nodes.Unary("rint" if rule == "round" else "trunc", local))
            if rule == "exact":
                self.expect(nodes.Compare("eq", whole, local), target)
            local = whole
        self.in_range(local, target)
        return nodes.Convert(target, local)

    def exact_float(self, value: nodes.Local, target: nodes.Scalar) -> nodes.Expr:
        """A float that is the same number; NaN stays one."""
        source = type_of(value)
        made = self.writer.let("float", nodes.Convert(target, value))
        same: nodes.Expr = nodes.Compare("eq", nodes.Convert(source, made), value)
        if source in ("f32", "f64"):
            same = nodes.Binary("or", same, nodes.Compare("ne", value, value))
        else:  # what is rounded up beyond the integers comes back as the last of them
            same = nodes.Binary("and", same, nodes.Compare("lt", made, nodes.Const(target, float(RANGES[source][1]))))
        self.expect(same, target)
        return made

    def in_range(self, value: nodes.Local, target: nodes.Scalar) -> None:
        source = type_of(value)
        if target in ("f32", "f64", "bool"):
            return
        low, high = RANGES[target]
        if source in ("f32", "f64"):
            self.expect(nodes.Compare("ge", value, nodes.Const(source, float(low))), target)
            self.expect(nodes.Compare("lt", value, nodes.Const(source, float(high))), target)
            return
        least, most = RANGES.get(source, (0, 2))
        if low > least:
            self.expect(nodes.Compare("ge", value, nodes.Const(source, low)), target)
        if high < most:
            self.expect(nodes.Compare("lt", value, nodes.Const(source, high)), target)

    def saturated(self, value: nodes.Expr, target: nodes.Scalar) -> nodes.Expr:
        source = type_of(value)
        if source in ("f32", "f64"):
            number = self.writer.let("number", value)
            self.expect(nodes.Compare("eq", number, number), target)  # NaN is none
            return nodes.Convert(target, nodes.Unary("rint", number))
        low, high = RANGES[target]
        least, most = RANGES[source]
        if low > least:
            value = nodes.Binary("max", value, nodes.Const(source, low))
        if high < most:
            value = nodes.Binary("min", value, nodes.Const(source, high - 1))
        return nodes.Convert(target, value)

    def expect(self, condition: nodes.Expr, target: str) -> None:
        self.writer.expect(condition, "range", self.where, f"the value does not fit {NAMES.get(target, target)}", line=self.line)


KEPT = (typed.IsText, typed.Choice, typed.Reduce)
"""Values that take a loop, or statements."""

FAILING = (nodes.Require, nodes.Expect, nodes.HostCall, nodes.Call)
"""Statements that may refuse a message."""


def calls_out(value: typed.Expr) -> bool:
    """Whether a value takes a call out of the kernel, or a text that is made: such are computed where they stand."""
    return any(
        isinstance(part, typed.HostCall | typed.Given) or (isinstance(part, typed.Call) and not functions()[part.function].kept)
        for part in parts(value)
    )
