"""Rules about whole arrays as loops over their elements.

`.b[] = f(.a[])` holds for every element, `.b = reversed(.a)` for the elements in another order. The first such rule for an
array sets its length, unless the mapping or the type does; every other array that it reads must be as long, else the message is
rejected. Rules for fields of the elements of one array share a loop.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import count
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import fields
from rosetta_jit.catalogue import layouts as words
from rosetta_jit.catalogue import texts as text_words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.language.arrays.counts import ONE, LayoutError, times
from rosetta_jit.language.arrays.layouts import ARGUMENTS, NUMBER_BYTES, PADDED, NumberType, View, number_type, view_of
from rosetta_jit.language.arrays.orders import is_of_image
from rosetta_jit.language.arrays.parts import has_each, is_many, open_parts, sources_in, substituted
from rosetta_jit.language.conversions import is_single, same, widens
from rosetta_jit.language.installed import functions
from rosetta_jit.language.limits import MAX_MADE
from rosetta_jit.language.scope import Scope, element_type, members_of
from rosetta_jit.language.typed import INT64, Const, FieldStep, IndexStep, Local, Place, Step
from rosetta_jit.language.units.unit_at import unit_at
from rosetta_jit.model.expr import Binary, Call, Choice, Each, Expr, Index, Len, Literal, Member, Name, Path
from rosetta_jit.model.mapping import Arranged, Assign, Assignment, For, Reject, Rule, SetLength, Via, When
from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Float, Int, Map, String, Struct, Type, Union
from rosetta_jit.model.walk import every_rule, parts
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import dataclass, replace
from rosetta_jit.startup.late import Late, late

if TYPE_CHECKING:
    from rosetta_jit.language.arrays import element_loops, filters
    from rosetta_jit.language.arrays.element_loops import Padding
    from rosetta_jit.model import printer
else:
    filters, element_loops = late("rosetta_jit.language.arrays", "filters", "element_loops")
    printer = Late("rosetta_jit.model.printer")

SINGLE = (Bool, Enum, Float, Int, Struct)
"""Types of one value."""

Lengths = dict[Path, "Expr"]
"""What is known of the lengths of the target's arrays."""


def elementwise(rules: tuple[Rule, ...], scope: Scope, broken: list[tuple[str, ...]]) -> tuple[Rule, ...]:
    """The rules of a block with loops in place of those about many elements; what fails is reported, and its field is ``broken``."""
    names = frozenset(rule.variable for rule in every_rule(rules) if isinstance(rule, For)) | {*scope.constants.full, *scope.locals}
    return _Expansion(scope, broken, names, count(1)).block(rules, {}, 0)


@dataclass(frozen=True, slots=True)
class _Expansion:
    """Expands one block. ``names`` are the mapping's own, ``made`` counts rules; ``level`` is how many loops of ours are around."""

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
                return self.refused(rule, refusal, level)
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
            return self.loops(rule, lengths, level, whole=not is_each)
        except LayoutError as error:
            self.scope.problems.append(error.problem)
            around = (step.field.name for step in self.scope.base(rule.place.side).steps if isinstance(step, FieldStep))
            self.broken.append((*around, *(step.name for step in rule.place.steps if isinstance(step, Member))))
            return ()

    def refused(self, rule: When[Rule, Expr], refusal: Reject[Expr], level: int) -> tuple[Rule, ...]:
        """A rejection for what some element has, as a loop."""
        try:
            views = {source: view_of(source) for source in dict.fromkeys(sources_in(rule.condition))}
            name = self.variable(level)
            elements: dict[Expr, Expr] = {source: element_loops.element_of(view, Name(name)) for source, view in views.items()}
            first, *others = (view.total for view in views.values())
        except LayoutError as error:
            self.scope.problems.append(error.problem)
            return ()
        pieces = tuple(substituted(piece, elements, Name(name)) for piece in refusal.pieces)
        refusing = replace(rule, condition=substituted(rule.condition, elements, Name(name)), then=(replace(refusal, pieces=pieces),))
        wrong = [When(condition, (Reject(why, rule.span),), (), rule.span) for view in views.values() for condition, why in view.refused]
        same_lengths = [check for total in others for check in _unless_equal(total, first, rule.span)]
        return (*wrong, *same_lengths, For(name, Literal(0), first, self.block((refusing,), {}, level + 1), rule.span))

    def chosen(self, rule: Assignment, choice: Choice, lengths: Lengths, level: int) -> tuple[Rule, ...]:
        """A choice among arrays, as one rule a case."""

        def assigned(value: Expr) -> tuple[Rule, ...]:
            return self.block((replace(rule, value=value),), lengths, level)

        rest = (Reject(choice.reason, rule.span),) if choice.otherwise is None else assigned(choice.otherwise)
        for condition, value in reversed(choice.cases):
            rest = (When(condition, assigned(value), rest, rule.span),)
        return rest

    def loops(self, rule: Assignment, lengths: Lengths, level: int, *, whole: bool) -> tuple[Rule, ...]:
        if rule.where is not None:
            return self.filtered(rule, lengths, level)
        if not has_each(rule.place) and (texts := _joined_elements(rule.value)) is not None:
            raise LayoutError(text_words.joined_elements(texts.span))
        value, padding = _padded(rule.value)
        value, packed = _packed(value)
        is_whole = isinstance(value, Path) if packed else whole or padding
        sources = [_whole(value)] if is_whole else list(dict.fromkeys(sources_in(value)))
        views = {source: view_of(source) for source in sources}
        place = rule.place if has_each(rule.place) else replace(rule.place, steps=(*rule.place.steps, Each(rule.place.span)))
        target = view_of(place)
        if isinstance(self.type_of(target.array), SINGLE):
            raise LayoutError(_many(rule))
        for array in (target.array, *(view.array for view in views.values())):
            if isinstance(self.type_of(array), String) and (array != target.array or has_each(rule.place)):
                raise LayoutError(fields.not_indexable(array.span, "text", printer.show_expr(array)))
        width = ONE if packed is None else packed.size
        counts = [times(padding[0], padding[2])] if padding else [times(view.total, width) for view in views.values()]
        refused = [each for view in views.values() for each in view.refused]
        before: list[Rule] = [When(condition, (Reject(reason, rule.span),), (), rule.span) for condition, reason in refused]
        number, counted = self.counted(rule, target, counts, lengths)
        before += counted
        if padding:
            before += _unless_equal(times(next(iter(views.values())).total, width), times(padding[0], padding[1]), rule.span)

        def expanded(element: Assignment, level: int) -> tuple[Rule, ...]:
            if next(self.made) > MAX_MADE:
                raise LayoutError(words.too_many_rules(rule.span, MAX_MADE))
            return self.block((element,), lengths, level)

        moves = element_loops.Moves(replace(rule, value=value), target, views, number, padding, level, self.variable, expanded, packed)
        return (*before, *moves.rules())

    def filtered(self, rule: Assignment, lengths: Lengths, level: int) -> tuple[Rule, ...]:
        """A rule with `where`, as a loop of which some rounds are kept."""
        opened = [part for side in (rule.place, rule.value, rule.where) if side is not None for part in open_parts(side)]
        is_one = isinstance(rule.value, Path) and not isinstance(self.type_of(rule.value), Array | Bytes | Map | None)
        if not any(map(is_many, opened)) and is_one:
            raise LayoutError(words.filter_without_elements(rule.span))
        found = filters.filter_of(rule, self.variable(level), self.variable(level, "kept"))
        array = found.target.array
        if isinstance(self.type_of(array), SINGLE):
            raise LayoutError(_many(rule))
        known = lengths.get(array)
        if self.fixed_length(array) is not None or not (known is None or filters.is_filtered(known)):
            raise LayoutError(words.filter_length(rule.place.span))
        if known not in (None, found.length):
            raise LayoutError(words.other_filter(rule.place.span))
        lengths[array] = found.length
        refused = [each for view in found.views for each in view.refused]
        before: list[Rule] = [When(condition, (Reject(reason, rule.span),), (), rule.span) for condition, reason in refused]
        before += [check for view in found.views for check in _unless_equal(view.total, found.loop.stop, rule.span)]
        return (*before, replace(found.loop, body=self.block((found.element,), lengths, level + 1)))

    def counted(self, rule: Assignment, target: View, counts: list[Expr], lengths: Lengths) -> tuple[Expr, list[Rule]]:
        """How many elements a rule sets, and what checks or sets that."""
        known = self.known_count(target, lengths)
        if filters.is_filtered(known):
            raise LayoutError(words.other_filter(rule.place.span))
        is_open = _is_open(target)
        if known is not None:
            return known, [check for total in counts for check in _unless_equal(total, known, rule.span)]
        if not counts:
            no_count = words.no_count(rule.place.span, printer.show_expr(target.array), self.whole_array(rule), rule.span)
            raise LayoutError(words.open_end(rule.place.span) if is_open else no_count)
        checks = [check for total in counts[1:] for check in _unless_equal(total, counts[0], rule.span)]
        if is_open:
            return counts[0], checks
        lengths[target.array] = counts[0]
        return counts[0], [SetLength(target.array, counts[0], rule.span), *checks]

    def whole_array(self, rule: Assignment) -> str:
        """An array that a rule for each element reads as a whole; empty where it reads none."""
        paths = (each for each in parts(rule.value) if isinstance(each, Path))
        return next((printer.show_expr(each) for each in paths if isinstance(self.type_of(each), Array)), "")

    def known_count(self, target: View, lengths: Lengths) -> Expr | None:
        """What a slice, another rule or the type says of the number of elements that are set."""
        (axis,) = target.axes
        if axis.count != Len(target.array):
            return None if _is_open(target) else axis.count
        fixed = self.fixed_length(target.array)
        return lengths.get(target.array) if fixed is None else Literal(fixed)

    def fixed_length(self, path: Path) -> int | None:
        type_ = self.type_of(path)
        return type_.fixed if isinstance(type_, Array) else None

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


def _unless_equal(total: Expr, count: Expr, span: Span | None) -> list[Rule]:
    if total == count:
        return []
    return [When(Binary("!=", total, count, span), (Reject(words.OTHER_COUNT, span),), (), span)]


def _is_open(target: View) -> bool:
    """Whether a slice goes to the end of the array that is being filled."""
    return target.axes[0].count != Len(target.array) and any(part == Len(target.array) for part in parts(target.axes[0].count))


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


def _packed(value: Expr) -> tuple[Expr, NumberType | None]:
    """The numbers of which a value is the bytes, and their type."""
    if not isinstance(value, Call) or value.function != NUMBER_BYTES:
        return value, None
    if not 2 <= len(value.arguments) <= 3:
        raise LayoutError(words.arguments(value.span, NUMBER_BYTES, *ARGUMENTS[NUMBER_BYTES], len(value.arguments)))
    return value.arguments[0], number_type(value)


def _padded(value: Expr) -> tuple[Expr, Padding | None]:
    match value:
        case Call(function, (array, count, size, stride)) if function == PADDED:
            return array, (count, size, stride)
        case Call(function) if function == PADDED:
            raise LayoutError(words.arguments(value.span, PADDED, *ARGUMENTS[PADDED], len(value.arguments)))
        case _:
            return value, None


def _whole(value: Expr) -> Path | Call:
    if isinstance(value, Path | Call):
        return value
    raise LayoutError(words.scalar_needs_each(value.span) if isinstance(value, Literal) else words.not_an_array(value.span))


def _joined_elements(value: Expr) -> Expr | None:
    """The texts of elements that an expression joins."""
    calls = (part for part in parts(value) if isinstance(part, Call) and part.function == "join")
    return next((call.arguments[0] for call in calls if call.arguments and has_each(call.arguments[0])), None)


def _many(rule: Assignment) -> Diagnostic:
    """Why the elements that a rule names cannot be assigned to one value: perhaps what makes one of them is misspelt."""
    called = rule.value.function if isinstance(rule.value, Call) and rule.value.function not in functions() else ""
    reductions = [name for name, each in functions().items() if each.reduction is not None]
    arrays = [printer.show_expr(part).partition("[]")[0] for part in parts(rule.value) if isinstance(part, Path) and has_each(part)]
    return words.one_value(rule.place.span, called, reductions, arrays[0] if arrays else "")
