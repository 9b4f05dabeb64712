"""What linear reasoning may know of integer operations that are not linear: products, quotients, bits.

Each function returns the exact mathematical result as a `Linear`; what cannot be said linearly becomes an atom with facts about it. None
of them asks whether the result fits its type: that is an obligation of `symbolic`.
"""

from __future__ import annotations

from rosetta_jit.kernel.proof.formula import equal
from rosetta_jit.kernel.proof.linear import Linear, coefficient_of, minus, plus, shifted, times
from rosetta_jit.kernel.proof.prove import Facts

FACTS_TO_MULTIPLY = 8

WORD = 64
"""Bits of the widest integer: by more nothing is shifted where a kernel runs, but a mapping may say so."""

Range = tuple[int, int]


def product(facts: Facts, left: Linear, right: Linear) -> Linear:
    """``left * right``, as a sum of products of atoms."""
    if not left.terms:
        return times(right, left.constant)
    if not right.terms:
        return times(left, right.constant)
    total = plus(times(Linear(0, left.terms), right.constant), times(Linear(0, right.terms), left.constant))
    total = shifted(total, left.constant * right.constant)
    for a, c in left.terms:
        for b, d in right.terms:
            total = plus(total, times(_monomial(facts, a, b), c * d))
    return total


def look_at_whole_sums(facts: Facts, left: Linear, right: Linear) -> None:
    """Learn of ``left * right`` what follows from their bounds as wholes: of ``a - b`` these may be narrow where each may be anything.

    The facts are many, and each is one more among which a later proof has to look: they are for a product that is not proven without.
    """
    facts.derive(equal(product(facts, left, right), product(facts, _as_atom(facts, left), _as_atom(facts, right))))


def _as_atom(facts: Facts, total: Linear) -> Linear:
    """An atom that stands for a sum, with what is known of the sum as a whole."""
    if len(total.terms) < 2:
        return total
    atom = facts.named(("sum", total), *facts.widest(total))
    facts.derive(equal(atom, total))
    facts.derive(shifted(atom, -facts.lower(total)))
    facts.derive(shifted(times(atom, -1), facts.upper(total)))
    one, coefficient = total.terms[0]
    for fact in facts.sums_about(one, FACTS_TO_MULTIPLY):
        factor, left = divmod(coefficient_of(fact, one), coefficient)
        if not left:
            facts.derive(plus(minus(fact, times(total, factor)), times(atom, factor)))
    return atom


def _monomial(facts: Facts, a: int, b: int) -> Linear:
    """The product of two atoms."""
    key = _monomial_key(a, b)
    is_new = not facts.has(key)
    atom = facts.named(key, *_corners(facts.born(a), facts.born(b)))
    low, high = _corners((facts.lows[a], facts.highs[a]), (facts.lows[b], facts.highs[b]))
    facts.derive(shifted(atom, -low))
    facts.derive(shifted(times(atom, -1), high))
    if is_new or facts.lower(atom) >= 0:
        _multiply_facts(facts, a, b)
        _multiply_facts(facts, b, a)
    return atom


def _monomial_key(a: int, b: int) -> tuple[str, int, int]:
    return ("mul", min(a, b), max(a, b))


def _corners(first: Range, second: Range) -> Range:
    values = [x * y for x in first for y in second]
    return min(values), max(values)


def _multiply_facts(facts: Facts, atom: int, factor: int) -> None:
    """Facts about an atom, times a factor >= 0, where all the products are known: ``i <= n - 1`` gives ``i * s <= n * s - s``."""
    if facts.lows[factor] < 0:
        return
    unit = Linear(0, ((factor, 1),))
    for fact in facts.sums_about(atom, FACTS_TO_MULTIPLY):
        if all(facts.has(_monomial_key(a, factor)) for a, _ in fact.terms):
            total = times(unit, fact.constant)
            for a, c in fact.terms:
                total = plus(total, times(facts.named(_monomial_key(a, factor), 0, 0), c))
            facts.derive(total)
    known = facts.named(_monomial_key(atom, factor), 0, 0)
    facts.derive(minus(known, times(unit, facts.lows[atom])))
    facts.derive(minus(times(unit, facts.highs[atom]), known))


def quotient(facts: Facts, left: Linear, right: Linear) -> Linear:
    """``left / right``, toward zero; the divisor is not zero."""
    bound = max(abs(facts.lower(left)), abs(facts.upper(left)))
    if not right.terms and right.constant > 0:
        return _constant_quotient(facts, left, right.constant)
    result = _no_larger(facts, ("div", left, right), left, bound)
    if facts.lower(left) >= 0 and facts.lower(right) >= 1:
        facts.derive(result)
        facts.derive(minus(left, result))
        covered = product(facts, result, right)
        facts.derive(minus(left, covered))
        facts.derive(shifted(minus(plus(covered, right), left), -1))
    return result


def _no_larger(facts: Facts, key: tuple[str, Linear, Linear | int], operand: Linear, bound: int) -> Linear:
    """The atom of a term that is never further from zero than an operand, and here at most by ``bound``."""
    low, high = facts.widest(operand)
    most = max(abs(low), abs(high))
    atom = facts.named(key, -most, most)
    facts.derive(shifted(atom, bound))
    facts.derive(shifted(times(atom, -1), bound))
    return atom


def _constant_quotient(facts: Facts, left: Linear, divisor: int) -> Linear:
    if not left.terms:
        value = abs(left.constant) // divisor
        return Linear(value if left.constant >= 0 else -value)
    bound = max(abs(facts.lower(left)), abs(facts.upper(left)))
    result = _no_larger(facts, ("div", left, divisor), left, bound)
    rest = minus(left, times(result, divisor))
    facts.derive(shifted(rest, divisor - 1))
    facts.derive(shifted(times(rest, -1), divisor - 1))
    if facts.lower(left) >= 0:
        facts.derive(rest)
        facts.derive(result)
        facts.derive(shifted(times(result, -1), facts.upper(left) // divisor))
    return result


def remainder(facts: Facts, left: Linear, right: Linear) -> Linear:
    """``left % right``, with the sign of ``left``; the divisor is not zero."""
    if not right.terms and right.constant > 0:
        return minus(left, times(_constant_quotient(facts, left, right.constant), right.constant))
    bound = max(abs(facts.lower(right)), abs(facts.upper(right))) - 1
    result = _no_larger(facts, ("rem", left, right), left, bound)
    if facts.lower(left) >= 0:
        facts.derive(result)
        facts.derive(minus(left, result))
        if facts.lower(right) >= 1:
            facts.derive(shifted(minus(right, result), -1))
    return result


def bits_and(facts: Facts, left: Linear, right: Linear, limits: Range) -> Linear:
    """``left & right``."""
    if not left.terms:
        left, right = right, left
    if not right.terms and not left.terms:
        return Linear(left.constant & right.constant)
    result = facts.named(("and", left, right, limits), *limits)
    mask = right.constant if not right.terms else None
    for operand in (left, right):
        if facts.lower(operand) >= 0:
            facts.derive(result)
            facts.derive(minus(operand, result))
    if mask is not None:
        _clears_low_bits(facts, left, mask if mask < 0 or limits[0] < 0 else mask - limits[1] - 1, result)
    return result


def _clears_low_bits(facts: Facts, operand: Linear, mask: int, result: Linear) -> None:
    """Facts of a mask ``-(2 ** k)``: it rounds down by less than 2 ** k."""
    if mask < 0 and (-mask) & (-mask - 1) == 0:
        facts.derive(minus(operand, result))
        facts.derive(shifted(minus(result, operand), -mask - 1))


def bits_or(facts: Facts, left: Linear, right: Linear, limits: Range, *, exclusive: bool) -> Linear:
    """``left | right``, or ``left ^ right``."""
    if not left.terms and not right.terms:
        return Linear(left.constant ^ right.constant if exclusive else left.constant | right.constant)
    result = facts.named(("xor" if exclusive else "or", left, right, limits), *limits)
    if facts.lower(left) >= 0 and facts.lower(right) >= 0:
        bits = max(facts.upper(left).bit_length(), facts.upper(right).bit_length())
        facts.derive(result)
        facts.derive(shifted(times(result, -1), (1 << bits) - 1))
        facts.derive(minus(plus(left, right), result))
        if not exclusive:
            facts.derive(minus(result, left))
            facts.derive(minus(result, right))
    return result


def shift_left(facts: Facts, left: Linear, right: Linear, limits: Range) -> Linear:
    """``left << right``, high bits dropped."""
    if not right.terms and 0 <= right.constant < WORD:
        whole = times(left, 1 << right.constant)
        if limits[0] <= facts.lower(whole) and facts.upper(whole) <= limits[1]:
            return whole
    return facts.named(("shl", left, right, limits), *limits)


def shift_right(facts: Facts, left: Linear, right: Linear, limits: Range) -> Linear:
    """``left >> right``: a division that rounds down."""
    result = facts.named(("shr", left, right, limits), *limits)
    if facts.lower(left) >= 0:
        facts.derive(result)
        facts.derive(minus(left, result))
    if not right.terms and 0 <= right.constant < WORD:
        rest = minus(left, times(result, 1 << right.constant))
        facts.derive(rest)
        facts.derive(shifted(times(rest, -1), (1 << right.constant) - 1))
        facts.derive(shifted(result, -(facts.lower(left) >> right.constant)))
        facts.derive(shifted(times(result, -1), facts.upper(left) >> right.constant))
    return result
