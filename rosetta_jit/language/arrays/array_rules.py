"""Rules about many elements as loops, and what they need to know of lengths: what `elementwise` does with rules that have such arrays."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Protocol

from rosetta_jit.catalogue import fields
from rosetta_jit.catalogue import layouts as words
from rosetta_jit.catalogue import texts as text_words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.language.arrays.array_functions import ARGUMENTS, NUMBER_BYTES, PADDED
from rosetta_jit.language.arrays.counts import ONE, LayoutError, times
from rosetta_jit.language.arrays.layouts import NumberType, View, number_type, view_of
from rosetta_jit.language.arrays.parts import has_each, is_many, open_parts, sources_in, substituted
from rosetta_jit.language.installed import functions
from rosetta_jit.language.limits import MAX_MADE
from rosetta_jit.language.scope import Scope
from rosetta_jit.model.expr import Binary, Call, Each, Expr, Len, Literal, Name, Path
from rosetta_jit.model.mapping import Assignment, For, Reject, Rule, SetLength, When
from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Float, Int, Map, String, Struct, Type
from rosetta_jit.model.walk import parts
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import replace
from rosetta_jit.startup.late import Late, late

if TYPE_CHECKING:
    from rosetta_jit.language.arrays import element_loops, filters
    from rosetta_jit.language.arrays.element_loops import Padding
    from rosetta_jit.model import printer
else:
    filters, element_loops = late("rosetta_jit.language.arrays", "filters", "element_loops")
    printer = Late("rosetta_jit.model.printer")

Lengths = dict[Path, "Expr"]
"""What is known of the lengths of the target's arrays."""

SINGLE = (Bool, Enum, Float, Int, Struct)
"""Types of one value."""


class Expansion(Protocol):
    """The expansion of the block that a rule stands in (`elementwise`): the scope, and how many rules were made."""

    @property
    def scope(self) -> Scope: ...
    @property
    def made(self) -> Iterator[int]: ...
    def block(self, rules: tuple[Rule, ...], lengths: Lengths, level: int) -> tuple[Rule, ...]:
        """The rules of a block within, expanded."""
        ...

    def type_of(self, path: Path) -> Type | None:
        """The type of a place without slices; None where there is none, which others report."""
        ...

    def variable(self, level: int, word: str = "element") -> str:
        """The name of the loop at a level, or of what it counts."""
        ...


def refused(expansion: Expansion, rule: When[Rule, Expr], refusal: Reject[Expr], level: int) -> tuple[Rule, ...]:
    """A rejection for what some element has, as a loop."""
    try:
        views = {source: view_of(source) for source in dict.fromkeys(sources_in(rule.condition))}
        name = expansion.variable(level)
        elements: dict[Expr, Expr] = {source: element_loops.element_of(view, Name(name)) for source, view in views.items()}
        first, *others = (view.total for view in views.values())
    except LayoutError as error:
        expansion.scope.problems.append(error.problem)
        return ()
    pieces = tuple(substituted(piece, elements, Name(name)) for piece in refusal.pieces)
    refusing = replace(rule, condition=substituted(rule.condition, elements, Name(name)), then=(replace(refusal, pieces=pieces),))
    wrong = [When(condition, (Reject(why, rule.span),), (), rule.span) for view in views.values() for condition, why in view.refused]
    same_lengths = [check for total in others for check in _unless_equal(total, first, rule.span)]
    return (*wrong, *same_lengths, For(name, Literal(0), first, expansion.block((refusing,), {}, level + 1), rule.span))


def loops(expansion: Expansion, rule: Assignment, lengths: Lengths, level: int, *, whole: bool) -> tuple[Rule, ...]:
    """A rule for each element of its arrays, or for ``whole`` arrays, as loops, with what checks or sets their lengths before."""
    if rule.where is not None:
        return _filtered(expansion, rule, lengths, level)
    if not has_each(rule.place) and (texts := _joined_elements(rule.value)) is not None:
        raise LayoutError(text_words.joined_elements(texts.span))
    value, padding = _padded(rule.value)
    value, packed = _packed(value)
    is_whole = isinstance(value, Path) if packed else whole or padding
    sources = [_whole(value)] if is_whole else list(dict.fromkeys(sources_in(value)))
    views = {source: view_of(source) for source in sources}
    place = rule.place if has_each(rule.place) else replace(rule.place, steps=(*rule.place.steps, Each(rule.place.span)))
    target = view_of(place)
    if isinstance(expansion.type_of(target.array), SINGLE):
        raise LayoutError(_many(rule))
    for array in (target.array, *(view.array for view in views.values())):
        if isinstance(expansion.type_of(array), String) and (array != target.array or has_each(rule.place)):
            raise LayoutError(fields.not_indexable(array.span, "text", printer.show_expr(array)))
    width = ONE if packed is None else packed.size
    counts = [times(padding[0], padding[2])] if padding else [times(view.total, width) for view in views.values()]
    refused = [each for view in views.values() for each in view.refused]
    before: list[Rule] = [When(condition, (Reject(reason, rule.span),), (), rule.span) for condition, reason in refused]
    number, counted = _counted(expansion, rule, target, counts, lengths)
    before += counted
    if padding:
        before += _unless_equal(times(next(iter(views.values())).total, width), times(padding[0], padding[1]), rule.span)

    def expanded(element: Assignment, level: int) -> tuple[Rule, ...]:
        if next(expansion.made) > MAX_MADE:
            raise LayoutError(words.too_many_rules(rule.span, MAX_MADE))
        return expansion.block((element,), lengths, level)

    moves = element_loops.Moves(replace(rule, value=value), target, views, number, padding, level, expansion.variable, expanded, packed)
    return (*before, *moves.rules())


def _filtered(expansion: Expansion, rule: Assignment, lengths: Lengths, level: int) -> tuple[Rule, ...]:
    """A rule with `where`, as a loop of which some rounds are kept."""
    opened = [part for side in (rule.place, rule.value, rule.where) if side is not None for part in open_parts(side)]
    is_one = isinstance(rule.value, Path) and not isinstance(expansion.type_of(rule.value), Array | Bytes | Map | None)
    if not any(map(is_many, opened)) and is_one:
        raise LayoutError(words.filter_without_elements(rule.span))
    found = filters.filter_of(rule, expansion.variable(level), expansion.variable(level, "kept"))
    array = found.target.array
    if isinstance(expansion.type_of(array), SINGLE):
        raise LayoutError(_many(rule))
    known = lengths.get(array)
    if _fixed_length(expansion, array) is not None or not (known is None or filters.is_filtered(known)):
        raise LayoutError(words.filter_length(rule.place.span))
    if known not in (None, found.length):
        raise LayoutError(words.other_filter(rule.place.span))
    lengths[array] = found.length
    refused = [each for view in found.views for each in view.refused]
    before: list[Rule] = [When(condition, (Reject(reason, rule.span),), (), rule.span) for condition, reason in refused]
    before += [check for view in found.views for check in _unless_equal(view.total, found.loop.stop, rule.span)]
    return (*before, replace(found.loop, body=expansion.block((found.element,), lengths, level + 1)))


def _counted(expansion: Expansion, rule: Assignment, target: View, counts: list[Expr], lengths: Lengths) -> tuple[Expr, list[Rule]]:
    """How many elements a rule sets, and what checks or sets that."""
    known = _known_count(expansion, target, lengths)
    if filters.is_filtered(known):
        raise LayoutError(words.other_filter(rule.place.span))
    is_open = _is_open(target)
    if known is not None:
        return known, [check for total in counts for check in _unless_equal(total, known, rule.span)]
    if not counts:
        no_count = words.no_count(rule.place.span, printer.show_expr(target.array), _whole_array(expansion, rule), rule.span)
        raise LayoutError(words.open_end(rule.place.span) if is_open else no_count)
    checks = [check for total in counts[1:] for check in _unless_equal(total, counts[0], rule.span)]
    if is_open:
        return counts[0], checks
    lengths[target.array] = counts[0]
    return counts[0], [SetLength(target.array, counts[0], rule.span), *checks]


def _whole_array(expansion: Expansion, rule: Assignment) -> str:
    """An array that a rule for each element reads as a whole; empty where it reads none."""
    paths = (each for each in parts(rule.value) if isinstance(each, Path))
    return next((printer.show_expr(each) for each in paths if isinstance(expansion.type_of(each), Array)), "")


def _known_count(expansion: Expansion, target: View, lengths: Lengths) -> Expr | None:
    """What a slice, another rule or the type says of the number of elements that are set."""
    (axis,) = target.axes
    if axis.count != Len(target.array):
        return None if _is_open(target) else axis.count
    fixed = _fixed_length(expansion, target.array)
    return lengths.get(target.array) if fixed is None else Literal(fixed)


def _fixed_length(expansion: Expansion, path: Path) -> int | None:
    type_ = expansion.type_of(path)
    return type_.fixed if isinstance(type_, Array) else None


def _unless_equal(total: Expr, count: Expr, span: Span | None) -> list[Rule]:
    if total == count:
        return []
    return [When(Binary("!=", total, count, span), (Reject(words.OTHER_COUNT, span),), (), span)]


def _is_open(target: View) -> bool:
    """Whether a slice goes to the end of the array that is being filled."""
    return target.axes[0].count != Len(target.array) and any(part == Len(target.array) for part in parts(target.axes[0].count))


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
