"""Integers that are the same where nothing is refused: quotients and remainders are undone.

divide(x · c, c) = x                divide(x, c) · c = x                  what leaves a remainder, and a divisor of 0, is refused
floor_divide(x · c + y, c) = x      where 0 ≤ y < c is known              modulo(x, c) = x - c · floor_divide(x, c)
floor_divide(floor_divide(x, b), c) = floor_divide(x, b · c)
nanoseconds(x, y) = x · 10⁹ + y     of which 0 ≤ y < 10⁹ is checked
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rosetta_jit.language.algebra.polynomial import (
    BIT,
    ONE,
    Atom,
    Monomial,
    Polynomial,
    add,
    multiply,
    number,
    product,
    shown_atom,
    subtract,
)
from rosetta_jit.language.limits import MAX_SUBSTITUTED
from rosetta_jit.startup.dataclass import dataclass, replace

SECOND = 10**9

Fact = tuple[Atom, Polynomial]
"""What an atom is equal to."""

Digit = tuple[Polynomial, int]
"""A number that is from 0 to below another."""


@dataclass(frozen=True, slots=True)
class Facts:
    """What lengths and fields are known to be, and which numbers are digits."""

    equal: tuple[Fact, ...] = ()
    digits: tuple[Digit, ...] = ()


NOTHING = Facts()


def are_same(left: Polynomial, right: Polynomial, facts: Facts = NOTHING) -> bool:
    """Whether two numbers are the same; raises TooComplexError."""
    if left == right:
        return True
    rest = reduced(subtract(left, right), facts)
    return _put(rest, list(_products(rest))[:MAX_SUBSTITUTED]) == number(0) or _without_divisors(rest) == number(0)


def reduced(polynomial: Polynomial, facts: Facts) -> Polynomial:
    """A number without quotients and remainders of what is known; raises TooComplexError."""
    return _reduced(_reduced(_put(polynomial, facts.equal), facts), facts)


def mentions(polynomial: Polynomial, atom: Atom) -> bool:
    """Whether an atom occurs, at any depth."""
    found = _atoms(polynomial)
    return atom in found or any(mentions(argument, atom) for each in found for argument in each.arguments)


def _put(polynomial: Polynomial, known: Sequence[Fact]) -> Polynomial:
    """A number with what atoms are equal to in their places, one fact after the other."""
    for each, value in known[:MAX_SUBSTITUTED]:
        polynomial = _replaced(polynomial, each, value)
    return polynomial


def _replaced(polynomial: Polynomial, atom: Atom, value: Polynomial) -> Polynomial:
    """A number with another in place of an atom; within quotients only what is divided."""
    result = number(0)
    for monomial, coefficient in polynomial.terms:
        term = number(coefficient)
        for factor, power in monomial:
            for _ in range(power):
                term = multiply(term, value if factor == atom else _of(factor))
        result = add(result, term)
    return result


def _reduced(polynomial: Polynomial, facts: Facts) -> Polynomial:
    """A number with quotients of what is known, and without remainders."""
    for atom in _atoms(polynomial):
        found = _known(atom, facts)
        if found is not None:
            polynomial = _replaced(polynomial, atom, found)
    return polynomial


def _known(atom: Atom, facts: Facts) -> Polynomial | None:
    """What a quotient, remainder or moment comes to."""
    match atom:
        case Atom("divide", (total, divisor)):
            return _quotient(_reduced(total, facts), divisor)
        case Atom("floor_divide", (total, divisor)) if (by := divisor.constant() or 0) > 0:
            return _floored(_reduced(total, facts), by, _with_checked(total, facts))
        case Atom("modulo", (total, divisor)) if (by := divisor.constant() or 0) > 0:
            reduced = _reduced(total, facts)
            return add(reduced, _floored(reduced, by, _with_checked(total, facts)), -by)
        case Atom("nanoseconds", (whole, behind)):
            return _reduced(add(behind, whole, SECOND), facts)
        case _:
            return None


def _with_checked(total: Polynomial, facts: Facts) -> Facts:
    """What is known besides where a number is computed: `nanoseconds(x, y)` has checked that y is less than a second."""
    pairs = (atom.arguments for atom in _atoms(total) if atom.head == "nanoseconds" and len(atom.arguments) == 2)
    return replace(facts, digits=(*facts.digits, *((behind, SECOND) for _, behind in pairs)))


def _floored(total: Polynomial, by: int, facts: Facts) -> Polynomial:
    """A number divided by another and rounded down: what is a multiple by itself, and what is less than that not at all."""
    whole, rest = number(0), number(0)
    for monomial, coefficient in total.terms:
        if coefficient % by:
            rest = add(rest, product(monomial, coefficient))
        else:
            whole = add(whole, product(monomial, coefficient // by))
    known = rest.constant()
    if known is not None:
        return add(whole, number(known // by))
    if _is_below(rest, by, facts):
        return whole
    match only_atom(rest):
        case Atom("floor_divide", (inner, divisor)) if (before := divisor.constant() or 0) > 0:
            return add(whole, _floored(inner, before * by, facts))
        case _:
            return add(whole, _of(Atom("floor_divide", (rest, number(by)))))


def _is_below(total: Polynomial, by: int, facts: Facts) -> bool:
    """Whether a number is known to be from 0 to below another: it is a digit, or a sum of multiples of digits."""
    if any(digit == total and below <= by for digit, below in facts.digits):
        return True
    least = most = 0
    for monomial, coefficient in total.terms:
        if monomial == ONE:
            least, most = least + coefficient, most + coefficient
            continue
        below = _below(product(monomial, 1), facts)
        if below is None:
            return False
        furthest = coefficient * (below - 1)
        least, most = least + min(0, furthest), most + max(0, furthest)
    return least >= 0 and most < by


def _below(value: Polynomial, facts: Facts) -> int | None:
    """What a digit is below; of several such numbers the least."""
    found = [below for digit, below in facts.digits if digit == value]
    atom = only_atom(value)
    return min([*found, *([2] if atom is not None and atom.head == BIT else [])], default=None)


def _quotient(total: Polynomial, divisor: Polynomial) -> Polynomial | None:
    """A number divided by a product of constants and atoms, each of its terms; None where one is no multiple."""
    match list(divisor.terms):
        case [(by, coefficient)]:
            parts = [_part(monomial, factor, by, coefficient) for monomial, factor in total.terms]
            result = number(0)
            for part in parts:
                if part is None:
                    return None
                result = add(result, part)
            return result
        case _:
            return None


def _part(monomial: Monomial, factor: int, by: Monomial, coefficient: int) -> Polynomial | None:
    powers = dict(monomial)
    for atom, power in by:
        powers[atom] = powers.get(atom, 0) - power
    if factor % coefficient or min(powers.values(), default=0) < 0:
        return None
    return product(frozenset((atom, power) for atom, power in powers.items() if power), factor // coefficient)


def _products(polynomial: Polynomial) -> Iterator[Fact]:
    """What was divided, as its quotient times the divisor; what was divided first comes first."""
    for atom in _atoms(polynomial):
        yield from _undone(atom)


def _without_divisors(polynomial: Polynomial) -> Polynomial:
    """A number times the constants that its quotients are divided by: each quotient times its divisor is what was divided."""
    for _ in range(MAX_SUBSTITUTED):
        divided = (atom for atom in _atoms(polynomial) if atom.head == "divide" and len(atom.arguments) == 2)
        found = next(((atom, by) for atom in divided if (by := atom.arguments[1].constant()) and _is_single(atom, polynomial)), None)
        if found is None:
            break
        polynomial = _multiplied(polynomial, *found)
    return polynomial


def _is_single(atom: Atom, polynomial: Polynomial) -> bool:
    """Whether no term has an atom more than once."""
    return all(dict(monomial).get(atom, 1) == 1 for monomial, _ in polynomial.terms)


def _multiplied(polynomial: Polynomial, quotient: Atom, by: int) -> Polynomial:
    """A number times the divisor of a quotient."""
    result = number(0)
    for monomial, coefficient in polynomial.terms:
        if (quotient, 1) in monomial:
            term = multiply(product(monomial - {(quotient, 1)}, coefficient), quotient.arguments[0])
        else:
            term = product(monomial, coefficient * by)
        result = add(result, term)
    return result


def _undone(atom: Atom) -> Iterator[Fact]:
    match atom:
        case Atom("divide", (total, divisor)) if (inner := only_atom(total)) is not None:
            yield from _undone(inner)
            yield inner, multiply(divisor, _of(atom))
        case _:
            pass


def only_atom(polynomial: Polynomial) -> Atom | None:
    """The atom that a number is."""
    match list(polynomial.terms):
        case [(monomial, 1)]:
            match list(monomial):
                case [(atom, 1)]:
                    return atom
                case _:
                    return None
        case _:
            return None


def _atoms(polynomial: Polynomial) -> list[Atom]:
    """The atoms of a number, always in one order."""
    return sorted({atom for monomial, _ in polynomial.terms for atom, _ in monomial}, key=shown_atom)


def _of(atom: Atom) -> Polynomial:
    return product(frozenset(((atom, 1),)), 1)
