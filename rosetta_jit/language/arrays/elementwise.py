"""Rules about whole arrays as loops over their elements.

`.b[] = f(.a[])` holds for every element, `.b = reversed(.a)` for the elements in another order. The first such rule for an
array sets its length, unless the mapping or the type does; every other array that it reads must be as long, else the message is
rejected. Rules for fields of the elements of one array share a loop.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import count
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import layouts as words
from rosetta_jit.language.arrays.counts import LayoutError
from rosetta_jit.language.arrays.orders import is_of_image
from rosetta_jit.language.arrays.parts import has_each, is_many, open_parts
from rosetta_jit.language.conversions import is_single, same, widens
from rosetta_jit.language.scope import Scope, element_type, members_of
from rosetta_jit.language.typed import INT64, Const, FieldStep, IndexStep, Local, Place, Step
from rosetta_jit.language.units.unit_at import unit_at
from rosetta_jit.model.expr import Choice, Each, Expr, Index, Literal, Member, Name, Path
from rosetta_jit.model.mapping import Arranged, Assign, Assignment, For, Reject, Rule, SetLength, Via, When
from rosetta_jit.model.types import Array, Bytes, Float, Int, Map, Struct, Type, Union
from rosetta_jit.model.walk import every_rule
from rosetta_jit.startup.dataclass import dataclass, replace
from rosetta_jit.startup.late import late

if TYPE_CHECKING:
    from rosetta_jit.language.arrays import array_rules, filters
    from rosetta_jit.language.arrays.array_rules import Lengths
else:
    array_rules, filters = late("rosetta_jit.language.arrays", "array_rules", "filters")


def elementwise(rules: tuple[Rule, ...], scope: Scope, broken: list[tuple[str, ...]]) -> tuple[Rule, ...]:
    """The rules of a block with loops in place of those about many elements; what fails is reported, and its field is ``broken``."""
    names = frozenset(rule.variable for rule in every_rule(rules) if isinstance(rule, For)) | {*scope.constants.full, *scope.locals}
    return _Expansion(scope, broken, names, count(1)).block(rules, {}, 0)


@dataclass(frozen=True, slots=True)
class _Expansion:
    """Expands one block; `array_rules` has what rules about many elements become. ``names`` are the mapping's own, ``made`` counts rules;
    ``level`` is how many loops of ours are around.
    """

    scope: Scope
    broken: list[tuple[str, ...]]
    names: frozenset[str]
    made: Iterator[int]

    def block(self, rules: tuple[Rule, ...], lengths: Lengths, level: int) -> tuple[Rule, ...]:
        known = {**lengths, **{rule.place: rule.value for rule in rules if isinstance(rule, SetLength)}}
        made: list[Rule] = []
        for rule in rules:
            for each in self.rule(rule, known, level):
                _add(made, each, self.variable(level))
        return tuple(made)

    def rule(self, rule: Rule, lengths: Lengths, level: int) -> tuple[Rule, ...]:
        match rule:
            case Assign():
                return self.assign(rule, lengths, level)
            case Arranged(place, flag, cases, span):
                if len(cases) > 1:  # those for both directions have one left
                    self.scope.problems.append(words.several_layouts(span))
                pairs = [pair for constant, value in cases[:1] for pair in ((flag, constant), (place, value))]
                return tuple(made for target, value in pairs for made in self.assign(Assign(target, value, span), lengths, level))
            case For(body=body):
                return (replace(rule, body=self.block(body, lengths, level)),)
            case When(condition, (Reject() as refusal,), ()) if any(map(has_each, open_parts(condition))):
                return array_rules.refused(self, rule, refusal, level)
            case When(then=then, otherwise=otherwise):
                return (replace(rule, then=self.block(then, lengths, level), otherwise=self.block(otherwise, lengths, level)),)
            case _:
                return (rule,)

    def assign(self, rule: Assignment, lengths: Lengths, level: int) -> tuple[Rule, ...]:
        if not isinstance(rule.by, Via) and isinstance(rule.value, Path) and self.are_unlike_maps(rule.place, rule.value):
            return tuple(made for each in _entries(rule, rule.value) for made in self.assign(each, lengths, level))
        if isinstance(rule.value, Path) and (
            self.are_unlike_numbers(rule.place, rule.value, fits=rule.by == "checked")
            or self.are_integers_in_other_units(rule.place, rule.value)
        ):
            rule = _each(rule, rule.value)
        if rule.where is None and not has_each(rule.place) and is_of_image(rule.value):
            return (rule,)
        if rule.where is None and not any(is_many(part) for side in (rule.place, rule.value) for part in open_parts(side)):
            return (rule,)
        is_each = any(has_each(part) for side in (rule.place, rule.value) for part in open_parts(side))
        try:
            if isinstance(rule.value, Choice) and not is_each:
                return self.chosen(rule, rule.value, lengths, level)
            return array_rules.loops(self, rule, lengths, level, whole=not is_each)
        except LayoutError as error:
            self.scope.problems.append(error.problem)
            around = (step.field.name for step in self.scope.base(rule.place.side).steps if isinstance(step, FieldStep))
            self.broken.append((*around, *(step.name for step in rule.place.steps if isinstance(step, Member))))
            return ()

    def chosen(self, rule: Assignment, choice: Choice, lengths: Lengths, level: int) -> tuple[Rule, ...]:
        """A choice among arrays, as one rule a case."""

        def assigned(value: Expr) -> tuple[Rule, ...]:
            return self.block((replace(rule, value=value),), lengths, level)

        rest = (Reject(choice.reason, rule.span),) if choice.otherwise is None else assigned(choice.otherwise)
        for condition, value in reversed(choice.cases):
            rest = (When(condition, assigned(value), rest, rule.span),)
        return rest

    def are_unlike_maps(self, one: Path, other: Path) -> bool:
        """Whether two places are maps of different types, which are copied entry by entry."""
        types = self.type_of(one), self.type_of(other)
        return isinstance(types[0], Map) and isinstance(types[1], Map) and types[0] != types[1]

    def are_unlike_numbers(self, one: Path, other: Path, *, fits: bool) -> bool:
        """Whether two places are arrays of different numbers, which become each other one by one: freely, or where each ``fits``."""
        match self.type_of(one), self.type_of(other):
            case Array((Int() | Float()) as wanted, length), Array((Int() | Float()) as element, other_length):
                is_rounded = self.scope.rounds and is_single(wanted) and isinstance(element, Float)
                return not same(element, wanted) and (fits or is_rounded or (widens(element, wanted) and length == other_length))
            case _:
                return False

    def are_integers_in_other_units(self, one: Path, other: Path) -> bool:
        """Whether an array of numbers is set to one of integers in another unit, which are converted one by one."""
        target, source = self.place_of(one), self.place_of(other)
        match target, source:
            case Place(type=Array(Int() | Float())), Place(type=Array(Int())):
                element = IndexStep(Local("element"))
                units = [unit_at(replace(each, steps=(*each.steps, element))) for each in (target, source)]
                return isinstance(units[0], str) and isinstance(units[1], str) and units[0] != units[1]
            case _:
                return False

    def type_of(self, path: Path) -> Type | None:
        """The type of a place without slices; None where there is none, which others report."""
        place = self.place_of(path)
        return None if place is None else place.type

    def place_of(self, path: Path) -> Place | None:
        """A place without slices, its indices known where they are literals; None where there is none, which others report."""
        message, base = self.scope.messages[path.side], self.scope.base(path.side)
        type_: Type = message.root
        steps: list[Step] = [*base.steps]
        for step in path.steps:
            match step, type_:
                case Member(name), Struct() | Union():
                    members = members_of(type_, message.schema)
                    if name not in members:
                        return None
                    steps += [FieldStep(field) for field in members[name]]
                    type_ = message.value_type(members[name][-1].type)
                case Index(number), Array() | Bytes():
                    steps.append(IndexStep(Const(number.value, INT64) if isinstance(number, Literal) else Local("element")))
                    type_ = message.value_type(element_type(type_))
                case _:
                    return None
        return Place(path.side, tuple(steps), type_, path.span)

    def variable(self, level: int, word: str = "element") -> str:
        """The name of the loop at a level, or of what it counts, which no rule of the mapping uses."""
        name = word if level == 0 else f"{word}_{level + 1}"
        while name in self.names:
            name += "_"
        return name


def _each(rule: Assignment, value: Path) -> Assignment:
    """A rule for arrays as one for each element."""
    step = Each(rule.span)
    return replace(rule, place=replace(rule.place, steps=(*rule.place.steps, step)), value=replace(value, steps=(*value.steps, step)))


def _entries(rule: Assignment, value: Path) -> list[Assignment]:
    """Rules for the keys and for the values of a map."""
    steps = [(Each(rule.span), Member(name, rule.span)) for name in ("key", "value")]
    return [
        replace(rule, place=replace(rule.place, steps=(*rule.place.steps, *each)), value=replace(value, steps=(*value.steps, *each)))
        for each in steps
    ]


def _add(made: list[Rule], rule: Rule, variable: str) -> None:
    """One more rule; a loop of ours over the elements of an array joins the one that is there, behind the checks between them."""
    if isinstance(rule, For) and rule.kept is not None:
        made.append(filters.joined(made, rule))
        return
    checks = 0
    while checks < len(made) and isinstance(made[-1 - checks], When):
        checks += 1
    last = made[-1 - checks] if checks < len(made) else None
    match last, rule:
        case For(variable=name), For(variable=other) if name == other == variable and _rounds(last) == _rounds(rule):
            del made[-1 - checks]
            made.append(replace(last, body=(*last.body, *rule.body)))
        case _:
            made.append(rule)


def _rounds(loop: For[Rule, Expr]) -> object:
    """The bounds of a loop, and the array that it sets elements of; the loop itself where that is no single one."""
    steps = loop.body[0].place.steps if loop.body and isinstance(loop.body[0], Assign) else ()
    number = next((number for number, step in enumerate(steps) if step == Index(Name(loop.variable))), None)
    return loop if number is None else (loop.start, loop.stop, steps[:number])
