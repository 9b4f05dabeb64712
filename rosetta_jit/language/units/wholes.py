"""Which numbers change their unit when an array, struct, union or map is assigned as a whole.

Both sides of such a rule have one type, or arrays whose elements widen, so that only what stands around differs: the units that fields on
the way give to what is within them.
"""

from __future__ import annotations

from rosetta_jit.catalogue import units as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.language.conversions import describe
from rosetta_jit.language.limits import MAX_WHOLE_DEPTH, MAX_WHOLE_VALUES
from rosetta_jit.language.scope import Message, Scope
from rosetta_jit.language.typed import Access, Assignment, Binary, Change, Const, Convert, EachElement, EachMember, Expr, Place, Rescale
from rosetta_jit.language.units.conversion import factors_between, shown, unit_of
from rosetta_jit.language.units.dimensions import conversion
from rosetta_jit.language.units.unit_at import contexts_at, unit_at
from rosetta_jit.model.types import Array, Field, Float, Int, Map, Struct, Type, Union
from rosetta_jit.model.units import Context
from rosetta_jit.startup.dataclass import dataclass, field


def change_within(value: Expr, place: Place, scope: Scope) -> Change | None:
    """What changes within a whole value, None if nothing does; what cannot be is reported."""
    if not (isinstance(value, Access) and isinstance(place.type, Array | Struct | Union | Map)):
        return None
    (origin, *more), (target, *others) = contexts_at(value.place), contexts_at(place)
    if more or others:
        scope.problems.append(words.mixed(value.span, shown(unit_at(value.place)), shown(unit_at(place))))
        return None
    finder = _Finder(scope, value, place)
    change = finder.change((value.type, place.type), (origin, target), 0)
    if finder.one_sided and not finder.reported:
        known, wanted = finder.one_sided[0]
        scope.problems.append(words.one_sided(value.span, known or wanted or "", is_source=wanted is None))
    return change


_Types = tuple["Type", "Type"]
_Contexts = tuple["Context", "Context"]


@dataclass(slots=True)
class _Finder:
    """Walks the types of source and target at once, with what is known of their units."""

    scope: Scope
    value: Access
    place: Place
    seen: int = 0
    reported: bool = False
    one_sided: list[tuple[str | None, str | None]] = field(default_factory=list[tuple["str | None", "str | None"]])

    def change(self, types: _Types, contexts: _Contexts, depth: int) -> Change | None:
        self.seen += 1
        source, target = (message.value_type(type_) for message, type_ in zip(self.messages, types, strict=True))
        if self.reported or (contexts[0] == contexts[1] and source == target):
            return None
        if depth > MAX_WHOLE_DEPTH or self.seen > MAX_WHOLE_VALUES:
            return self.report(words.too_much_within(self.value.span, describe(self.value.type)))
        match source, target:
            case ((Int() | Float()), (Int() | Float())):
                return self.number(source, target, contexts)
            case Array(element=one), Array(element=other):
                return self.elements((one, other), contexts, depth)
            case Map(value=one), Map(value=other):
                change = self.change((one, other), (contexts[0].element(None), contexts[1].element(None)), depth + 1)
                return None if change is None else EachElement(EachMember((("value", change),)))
            case Struct(fields=ones), Struct(fields=others):
                return self.members(ones, others, contexts, depth)
            case Union(cases=ones), Union(cases=others):
                return self.members(ones, others, contexts, depth)
            case _:
                return None

    @property
    def messages(self) -> tuple[Message, Message]:
        return self.scope.messages[self.value.place.side], self.scope.messages[self.place.side]

    def number(self, source: Int | Float, target: Int | Float, contexts: _Contexts) -> Change | None:
        known, wanted = contexts[0].unit, contexts[1].unit
        if known is None or wanted is None:
            self.one_sided += [] if known == wanted else [(known, wanted)]
            return None
        before = len(self.scope.problems)
        factors = factors_between(known, wanted, self.value.span, self.scope.problems)
        self.reported = len(self.scope.problems) > before
        if factors is None or factors == (1.0, 0.0):
            return None
        if not isinstance(target, Float):
            return self.report(words.integers_within(self.value.span, describe(source), known, wanted))
        return Rescale(known, wanted, *factors)

    def elements(self, types: _Types, contexts: _Contexts, depth: int) -> Change | None:
        ones, others = contexts[0].elements, contexts[1].elements
        found = {
            number: self.change(types, (ones.get(number, ones[None]), others.get(number, others[None])), depth + 1)
            for number in sorted(number for number in ones | others if number is not None)
        }
        rest = self.change(types, (ones[None], others[None]), depth + 1)
        unlike = tuple(each for each in found.items() if each[1] != rest)
        return EachElement(rest, unlike) if unlike or rest is not None else None

    def members(self, ones: tuple[Field, ...], others: tuple[Field, ...], contexts: _Contexts, depth: int) -> Change | None:
        found: list[tuple[str, Change]] = []
        for one, other in zip(ones, others, strict=True):
            change = self.change((one.type, other.type), (contexts[0].member(one), contexts[1].member(other)), depth + 1)
            found += [] if change is None else [(one.name, change)]
        return EachMember(tuple(found)) if found else None

    def report(self, problem: Diagnostic) -> None:
        self.reported = True
        self.scope.problems.append(problem)


def inserted(rule: Assignment) -> Change | None:
    """The conversion that the compiler has put into a rule, for whoever explains it."""
    value = rule.value.operand if isinstance(rule.value, Convert) and rule.value.rule == "nearest" else rule.value
    offset = 0.0
    match value:
        case Binary("+", Binary("*") as product, Const(float(known))):
            value, offset = product, known
        case _:
            pass
    match value:
        case Binary("*", operand, Const(float(factor))):
            source, target = unit_of(operand), unit_at(rule.place)
            if isinstance(source, str) and isinstance(target, str) and conversion(source, target) == (factor, offset):
                return Rescale(source, target, factor, offset)
            return None
        case _:
            return rule.by
