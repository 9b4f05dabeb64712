"""Values in the type of the place that a rule sets: converted implicitly where nothing can be lost, else reported."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.catalogue import resolve as words
from rosetta_jit.catalogue import texts
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.language.conversions import convert, describe, is_bytes, is_textual, other_way, same, widens, word_for
from rosetta_jit.language.installed import functions
from rosetta_jit.language.limits import MAX_TEXT_CASES
from rosetta_jit.language.scope import Scope
from rosetta_jit.language.typed import Access, Binary, Call, Choice, Const, Convert, Expr, Listed, Place
from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Float, Int, Map, String, Struct, Type, Union
from rosetta_jit.startup.dataclass import replace
from rosetta_jit.startup.late import Late

if TYPE_CHECKING:
    from rosetta_jit.language.resolve import list_items
else:
    list_items = Late("rosetta_jit.language.resolve.list_items")


def fit(value: Expr, place: Place, scope: Scope) -> Expr | None:
    """The value as the type of the place, reported where that takes a word or cannot be."""
    target = place.type
    if isinstance(value, Choice) and isinstance(target, String | Bytes):
        return _fit_choice(value, place, scope)
    if isinstance(value, Choice):
        value = _adapted(value, target)
    if isinstance(value, Listed):
        value = list_items.adapted(value, target)
    if isinstance(value, Access) and _whole(value.type, target, scope):
        return value
    is_image = isinstance(value, Call) and functions()[value.function].operation == "image compression"
    if is_image and isinstance(value.type, Bytes) and is_bytes(target):
        return value
    if isinstance(value, Call) and value.function == "split" and _holds_texts(target, scope):
        return value
    if isinstance(value, Call) and isinstance(value.type, Array) and _holds(value.type.element, target, scope):
        return value
    if isinstance(value, Call) and is_textual(value.type) and not is_image:
        if is_textual(target):
            return value
        if isinstance(target, String):
            scope.problems.append(texts.text_length(value.span))
            return None
    scalar = not isinstance(target, Array | Struct | Union | Map)
    fitting = convert(value, target) if scalar else None
    if fitting is None:
        scope.problems.append(_mismatch(value, target))
    return fitting


def _holds(element: Type, target: Type, scope: Scope) -> bool:
    """Whether a type is an array that takes the elements that a function makes: integers are checked one by one."""
    message = scope.messages[scope.target]
    wanted = (
        Int(8, signed=False) if isinstance(target, Bytes) else message.value_type(target.element) if isinstance(target, Array) else None
    )
    return wanted is not None and (
        same(element, wanted) or widens(element, wanted) or (isinstance(element, Int) and isinstance(wanted, Int))
    )


def _holds_texts(target: Type, scope: Scope) -> bool:
    """Whether a type is an array of texts."""
    if not isinstance(target, Array):
        return False
    element = scope.messages[scope.target].value_type(target.element)
    return isinstance(element, String | Bytes) and is_textual(element)


def _adapted(value: Choice, target: Type) -> Choice:
    """A choice whose values all fit without a word, as that type."""
    cases = [(condition, _adapted_to(chosen, target)) for condition, chosen in value.cases]
    otherwise = None if value.otherwise is None else _adapted_to(value.otherwise, target)
    known = tuple((condition, chosen) for condition, chosen in cases if chosen is not None)
    if len(known) < len(cases) or (otherwise is None) != (value.otherwise is None):
        return value
    return replace(value, cases=known, otherwise=otherwise, type=target)


def _adapted_to(value: Expr, target: Type) -> Expr | None:
    if isinstance(value, Convert) and value.rule == "widen":  # as its choice needed it, not as the place does
        value = value.operand
    return convert(_adapted(value, target) if isinstance(value, Choice) else value, target)


def _fit_choice(value: Choice, place: Place, scope: Scope) -> Choice | None:
    """Each text of a choice as the type of the place."""
    if len(value.cases) > MAX_TEXT_CASES:
        scope.problems.append(words.many_cases(value.span, MAX_TEXT_CASES))
        return None
    cases = [(condition, fit(chosen, place, scope)) for condition, chosen in value.cases]
    otherwise = None if value.otherwise is None else fit(value.otherwise, place, scope)
    known = tuple((condition, chosen) for condition, chosen in cases if chosen is not None)
    if len(known) < len(cases) or (otherwise is None) != (value.otherwise is None):
        return None
    return replace(value, cases=known, otherwise=otherwise, type=place.type)


def _whole(source: Type, target: Type, scope: Scope) -> bool:
    """Whether an array, struct, text or blob can be assigned as a whole."""
    origin, aim = (scope.messages[side] for side in (scope.origin, scope.target))
    source, target = origin.value_type(source), aim.value_type(target)
    match source, target:
        case ((String() | Bytes()), (String() | Bytes())):
            return is_textual(source) == is_textual(target)
        case Array(length=int(length)), Array(length=int(other)) if length != other:
            return False
        case Array(element=element), Array(element=wanted):
            return _whole(element, wanted, scope) or same(element, wanted) or widens(element, wanted)
        case (Struct(), Struct()) | (Union(), Union()) | (Map(), Map()):
            return source == target
        case _:
            return False


def _mismatch(value: Expr, target: Type) -> Diagnostic:
    source, aim = describe(value.type), describe(target)
    match value, target:
        case Const(value=int(number), type=Int()), Int() | Float():
            return words.constant_range(value.span, str(number), aim)
        case Const(value=float(number), type=Float()), Float():
            return words.constant_range(value.span, repr(number), aim)
        case Const(value=str(text), type=String()), Enum(name=name, values=known) if text in dict(known):
            return words.type_clash(value.span, source, aim, f"`{name}.{text}` is the constant of this name")
        case Binary("/", type=Int()), Float() if how := word_for(value.type, target):
            return words.quotient(value.span, source, aim, how)
        case _ if isinstance(value.type, Bool | Enum) and isinstance(target, Int):
            return words.no_number(value.span, source, aim, word_for(value.type, target))
        case _:
            how = word_for(value.type, target)
            spelt = isinstance(value, Const) and isinstance(value.type, String)
            return (
                words.needs_word(value.span, source, aim, how)
                if how
                else words.type_clash(value.span, source, aim, "" if spelt else other_way(value.type, target))
            )
