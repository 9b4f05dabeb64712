"""Integers that are the same where nothing is refused: quotients that leave no remainder are undone.

divide(x · c, c) = x      divide(x, c) · c = x

Both hold of all that is computed, for what leaves a remainder, and a divisor of 0, is refused.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.lowering.polynomial import Atom, Polynomial, add, multiply, number, product, shown_atom, subtract

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from rosetta_jit.lowering.polynomial import Monomial

MAX_KNOWN = 20
"""Numbers that are put in the place of others."""

Fact = tuple[Atom, Polynomial]
"""What an atom is equal to."""


def are_same(left: Polynomial, right: Polynomial, facts: Sequence[Fact] = ()) -> bool:
    """Whether two numbers are the same; ``facts`` say what lengths and fields are known to be.

    Raises
    ------
    TooComplexError
    """
    if left == right:
        return True
    rest = subtract(_put(left, facts), _put(right, facts))
    rest = _divided(_divided(rest))
    return _put(rest, list(_products(rest))[:MAX_KNOWN]) == number(0)


def mentions(polynomial: Polynomial, atom: Atom) -> bool:
    """Whether an atom occurs, at any depth."""
    found = _atoms(polynomial)
    return atom in found or any(mentions(argument, atom) for each in found for argument in each.arguments)


def _put(polynomial: Polynomial, known: Sequence[Fact]) -> Polynomial:
    """A number with what atoms are equal to in their places, one fact after the other."""
    for atom, value in known[:MAX_KNOWN]:
        polynomial = _replaced(polynomial, atom, value)
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


def _divided(polynomial: Polynomial) -> Polynomial:
    """A number without quotients of products by one of their factors."""
    for atom in _atoms(polynomial):
        match atom:
            case Atom("divide", (total, divisor)) if (found := _quotient(_divided(total), divisor)) is not None:
                polynomial = _replaced(polynomial, atom, found)
            case _:
                pass
    return polynomial


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
