"""Integer expressions in a normal form: polynomials over atoms, so that equal ones are equal objects.

    Polynomial = Σ coefficient · Π atom^power          Atom = head (argument polynomials)

An atom is what the arithmetic cannot look into: a loop variable, a field of the message that is read, its length, a
quotient, a call. Its arguments are polynomials again, so that a substitution reaches them.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import assert_never

from rosetta_jit.language import typed
from rosetta_jit.language.conversions import describe
from rosetta_jit.language.counters import counter_of
from rosetta_jit.language.limits import MAX_ATOM_DEPTH, MAX_ATOMS
from rosetta_jit.language.places import shown_shape
from rosetta_jit.model.expr import Literal
from rosetta_jit.model.types import Bool, Int
from rosetta_jit.startup.dataclass import dataclass, field


class TooComplexError(Exception):
    """An expression whose normal form is larger than `MAX_ATOMS` or deeper than `MAX_ATOM_DEPTH`; never leaves the checker."""


@dataclass(frozen=True, slots=True)
class Atom:
    """``head`` says what it is (``i``, ``.a[].b``, ``align``), ``arguments`` what it depends on."""

    head: str
    arguments: tuple[Polynomial, ...] = ()


Monomial = frozenset[tuple[Atom, int]]
ONE: Monomial = frozenset()
BIT = "bit"
"""The head of a bool as a number: 0 or 1."""


@dataclass(frozen=True, slots=True)
class Polynomial:
    """Terms with their coefficients, none of them 0."""

    terms: frozenset[tuple[Monomial, int]]
    size: int = field(compare=False, repr=False)
    depth: int = field(compare=False, repr=False)

    def constant(self) -> int | None:
        """The number that it is, or None."""
        match list(self.terms):
            case []:
                return 0
            case [(monomial, coefficient)] if monomial == ONE:
                return coefficient
            case _:
                return None

    def __str__(self) -> str:
        shown = sorted((_shown(monomial, coefficient) for monomial, coefficient in self.terms), key=lambda term: (-len(term), term))
        return " + ".join(shown) or "0"


def number(value: int) -> Polynomial:
    """A constant."""
    return _of(Counter({ONE: value}))


def atom(head: str, *arguments: Polynomial) -> Polynomial:
    """A polynomial of one atom."""
    return _of(Counter({frozenset({(Atom(head, arguments), 1)}): 1}))


def product(monomial: Monomial, coefficient: int) -> Polynomial:
    """A polynomial of one term."""
    return _of(Counter({monomial: coefficient}))


def add(left: Polynomial, right: Polynomial, factor: int = 1) -> Polynomial:
    """``left + factor · right``"""
    terms = Counter(dict(left.terms))
    for monomial, coefficient in right.terms:
        terms[monomial] += factor * coefficient
    return _of(terms)


def subtract(left: Polynomial, right: Polynomial) -> Polynomial:
    """``left - right``"""
    return add(left, right, -1)


def multiply(left: Polynomial, right: Polynomial) -> Polynomial:
    """``left · right``"""
    if len(left.terms) * len(right.terms) > MAX_ATOMS:
        raise TooComplexError
    terms: Counter[Monomial] = Counter()
    for monomial, coefficient in left.terms:
        for other, factor in right.terms:
            terms[_product(monomial, other)] += coefficient * factor
    return _of(terms)


def substitute(polynomial: Polynomial, name: str, value: Polynomial) -> Polynomial:
    """The polynomial with a variable replaced, within the arguments of atoms too."""
    if not contains(polynomial, name):
        return polynomial
    result = number(0)
    for monomial, coefficient in polynomial.terms:
        term = number(coefficient)
        for factor, power in monomial:
            replaced = value if factor == Atom(name) else atom(factor.head, *(substitute(a, name, value) for a in factor.arguments))
            for _ in range(power):
                term = multiply(term, replaced)
        result = add(result, term)
    return result


def contains(polynomial: Polynomial, name: str) -> bool:
    """Whether a variable occurs, at any depth."""
    return any(_mentions(factor, name) for monomial, _ in polynomial.terms for factor, _ in monomial)


def coefficient_of(polynomial: Polynomial, name: str) -> tuple[Polynomial, Polynomial] | None:
    """``(stride, rest)`` with polynomial = stride · variable + rest and the variable in neither; None if it is not affine."""
    stride: Counter[Monomial] = Counter()
    rest: Counter[Monomial] = Counter()
    for monomial, coefficient in polynomial.terms:
        if (Atom(name), 1) in monomial:
            stride[monomial - {(Atom(name), 1)}] += coefficient
        else:
            rest[monomial] += coefficient
    parts = _of(stride), _of(rest)
    return None if any(contains(part, name) for part in parts) else parts


def polynomial_of(expr: typed.Expr) -> Polynomial:
    """The normal form of an integer expression."""
    match expr:
        case typed.Const(value=int(value)):
            return number(value)
        case typed.Local(name):
            return atom(name)
        case typed.Access(place):
            return _field_value(place)
        case typed.LenOf(place):
            return _length(place)
        case typed.Unary("not", operand):
            return atom("not", polynomial_of(operand))
        case typed.Unary(operand=operand):
            return subtract(number(0), polynomial_of(operand))
        case typed.Binary(operator, left, right):
            return _arithmetic(operator, polynomial_of(left), polynomial_of(right))
        case typed.Convert() | typed.Nearest():
            return _converted(expr)
        case typed.Call(function, arguments):
            return atom(function, *map(polynomial_of, arguments))
        case typed.HostCall(function, arguments):
            return atom(f"{function}()", *map(polynomial_of, arguments))
        case typed.IsText(place, text):
            return atom(f"{shown_shape(place.steps)} == {text!r}", *_indices(place.steps))
        case typed.Has(place):
            return atom(f"has {shown_shape(place.steps)}", *_indices(place.steps))
        case typed.Search() | typed.Reduce():
            return _of_elements(expr)
        case typed.Choice() | typed.Listed() | typed.Given():
            return _chosen(expr)
        case typed.Const() | typed.StateVariable():
            return atom(f"state {expr.name} of {expr.target}" if isinstance(expr, typed.StateVariable) else repr(expr.value))
        case _:
            assert_never(expr)


def _of_elements(expr: typed.Search | typed.Reduce) -> Polynomial:
    """What is found among elements, or made of them."""
    match expr:
        case typed.Search(place, _, condition):
            return atom(f"in {shown_shape(place.steps)}", *_indices(place.steps), polynomial_of(condition))
        case typed.Reduce(function, _, count, value, chosen=chosen):
            of_chosen = () if chosen is None else (polynomial_of(chosen),)
            return atom(f"{function} of each", polynomial_of(count), polynomial_of(value), *of_chosen)
        case _:
            assert_never(expr)


def _converted(value: typed.Convert | typed.Nearest) -> Polynomial:
    rule = value.rule if isinstance(value, typed.Convert) else "solved"
    if isinstance(value.operand.type, Bool) and isinstance(value.type, Int):
        return _bit(value.operand)
    keeps = isinstance(value.operand.type, Int) and rule in {"widen", "exact"}
    return polynomial_of(value.operand) if keeps else atom(f"{describe(value.type)} {rule}", polynomial_of(value.operand))


def _bit(expr: typed.Expr) -> Polynomial:
    """A bool as 0 or 1; one that was made of an integer is that integer."""
    match expr:
        case typed.Unary("not", operand):
            return subtract(number(1), _bit(operand))
        case typed.Convert(operand, Bool()) if isinstance(operand.type, Int):
            return polynomial_of(operand)
        case typed.Const(bool(value)):
            return number(int(value))
        case _:
            return atom(BIT, polynomial_of(expr))


def _chosen(expr: typed.Choice | typed.Listed | typed.Given) -> Polynomial:
    """One of several values; it is the same under the same conditions, and for the same number."""
    match expr:
        case typed.Choice(cases, otherwise):
            parts = [part for case in cases for part in case] + ([] if otherwise is None else [otherwise])
            return atom("choice", *map(polynomial_of, parts))
        case typed.Listed(items, index):
            return atom("item", *map(polynomial_of, (*items, index)))
        case typed.Given(name, arguments):
            return atom(name, *map(polynomial_of, arguments))
        case _:
            assert_never(expr)


def _arithmetic(operator: str, left: Polynomial, right: Polynomial) -> Polynomial:
    match operator:
        case "+":
            return add(left, right)
        case "-":
            return subtract(left, right)
        case "*":
            return multiply(left, right)
        case _:
            return atom(operator, left, right)


def _field_value(place: typed.Place) -> Polynomial:
    """A field's value; the one that the schema fixes, where it does."""
    last = place.steps[-1]
    match last:
        case typed.FieldStep(field) if isinstance(field.constant, Literal) and type(field.constant.value) is int:
            return number(field.constant.value)
        case _:
            return atom(shown_shape(place.steps), *_indices(place.steps))


def _length(place: typed.Place) -> Polynomial:
    """How many elements are at a place; where another field of a message tells that, it is what that field says."""
    counter = counter_of(place.steps)
    if place.side != "wire" or counter is None:
        return atom(f"len({shown_shape(place.steps)})", *_indices(place.steps))
    around, name = counter
    return atom(f"{shown_shape(around)}.{name}", *_indices(around))


def _indices(steps: Sequence[typed.Step]) -> list[Polynomial]:
    return [polynomial_of(step.index) for step in steps if not isinstance(step, typed.FieldStep)]


def _of(terms: Counter[Monomial]) -> Polynomial:
    kept = frozenset((monomial, coefficient) for monomial, coefficient in terms.items() if coefficient)
    arguments = [argument for monomial, _ in kept for factor, _ in monomial for argument in factor.arguments]
    size = sum(1 + len(monomial) for monomial, _ in kept) + sum(argument.size for argument in arguments)
    depth = 1 + max((argument.depth for argument in arguments), default=0)
    if size > MAX_ATOMS or depth > MAX_ATOM_DEPTH:
        raise TooComplexError
    return Polynomial(kept, size, depth)


def _product(left: Monomial, right: Monomial) -> Monomial:
    powers = Counter(dict(left))
    powers.update(dict(right))
    return frozenset(powers.items())


def _mentions(factor: Atom, name: str) -> bool:
    return factor.head == name or any(contains(argument, name) for argument in factor.arguments)


def _shown(monomial: Monomial, coefficient: int) -> str:
    factors = sorted(shown_atom(factor) + (f"^{power}" if power > 1 else "") for factor, power in monomial)
    return "*".join([str(coefficient), *factors] if coefficient != 1 or not factors else factors)


def shown_atom(factor: Atom) -> str:
    """An atom as text."""
    head = factor.head.replace("$", "#")
    head = f"has({head.removeprefix('has ')})" if head.startswith("has ") else head
    if "[]" in head:
        for argument in factor.arguments:
            head = head.replace("[]", f"[{argument}]", 1)
        return head
    if head == "choice" and len(factor.arguments) == 3:
        condition, chosen, other = factor.arguments
        return f"({chosen} if {condition} else {other})"
    shown = ", ".join(str(argument) for argument in factor.arguments)
    return f"({shown.replace(', ', f' {head} ', 1)})" if head in "*/%" else f"{head}({shown})" if shown else head
