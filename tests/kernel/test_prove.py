"""The prover, judged by z3: what it proves is true, and what it needs to prove it does."""

from __future__ import annotations

import pytest
import z3
from hypothesis import example, given, settings
from hypothesis import strategies as st

from rosetta_jit.kernel.nodes import Binary, Compare, Const, Convert, Load, Local, Select
from rosetta_jit.kernel.proof import integers
from rosetta_jit.kernel.proof.formula import All, Any, equal, negated
from rosetta_jit.kernel.proof.linear import Linear, contradict, minus, plus, shifted, times
from rosetta_jit.kernel.proof.obligations import UnprovenError
from rosetta_jit.kernel.proof.prove import Facts
from rosetta_jit.kernel.proof.scope import entry
from rosetta_jit.kernel.proof.symbolic import evaluate
from rosetta_jit.kernel.terms import index
from tests.kernel.kernels import kernel

I64 = (-(1 << 63), (1 << 63) - 1)

coefficients = st.integers(-4, 4)
sums = st.tuples(st.integers(-20, 20), st.lists(coefficients, min_size=4, max_size=4))


def linear(atoms, drawn):
    constant, factors = drawn
    total = Linear(constant)
    for atom, factor in zip(atoms, factors, strict=True):
        total = plus(total, times(atom, factor))
    return total


def z3_sum(names, total):
    return z3.Sum([z3.IntVal(total.constant), *(c * names[a] for a, c in total.terms)])


def z3_formula(names, formula):
    match formula:
        case bool():
            return z3.BoolVal(formula)
        case Linear():
            return z3_sum(names, formula) >= 0
        case All(parts):
            return z3.And(*(z3_formula(names, part) for part in parts))
        case Any(parts):
            return z3.Or(*(z3_formula(names, part) for part in parts))


def follows(names, known, goal):
    """Whether z3 finds no counterexample."""
    solver = z3.Solver()
    solver.set("timeout", 5000)
    solver.add(*known, z3.Not(goal))
    return solver.check() != z3.sat


formulas = st.recursive(
    sums,
    lambda inner: st.tuples(st.sampled_from(["all", "any", "not"]), st.lists(inner, min_size=1, max_size=3)),
    max_leaves=4,
)


def formula(atoms, drawn):
    match drawn:
        case ("all", parts):
            return All(tuple(formula(atoms, part) for part in parts))
        case ("any", parts):
            return Any(tuple(formula(atoms, part) for part in parts))
        case ("not", parts):
            return negated(formula(atoms, parts[0]))
        case total:
            return linear(atoms, total)


@settings(max_examples=150, deadline=None)
@given(facts=st.lists(formulas, max_size=6), goal=formulas)
def test_what_is_proven_is_true(facts, goal):
    table, names = Facts(), [z3.Int(f"x{k}") for k in range(4)]
    atoms = [table.fresh(-50, 50) for _ in names]
    known = [z3.And(name >= -50, name <= 50) for name in names]
    for drawn in facts:
        fact = formula(atoms, drawn)
        table.assume(fact)
        known.append(z3_formula(names, fact))
    wanted = formula(atoms, goal)
    if table.proves_thoroughly(wanted):
        assert follows(names, known, z3_formula(names, wanted))


@settings(max_examples=150, deadline=None)
@given(facts=st.lists(sums, min_size=2, max_size=6))
@example(facts=[(0, [0, 0, -1, 1]), (0, [0, 1, -1, 0]), (0, [1, 0, 0, -1]), (0, [1, 0, 1, 0]), (0, [-1, -1, 0, -1]), (-1, [-1, 0, 1, 1])])
def test_contradictions_are_found_over_rationals(facts):
    """Elimination is complete over rationals, so that it finds what z3 finds there; over integers it may find more."""
    names = [z3.Int(f"x{k}") for k in range(4)]
    table = Facts()
    atoms = [table.fresh(*I64) for _ in names]
    rows = [linear(atoms, fact) for fact in facts]
    found = contradict([row for row in rows if row.terms], 100_000)
    rows = [row for row in rows if row.terms]
    solver = z3.Solver()
    reals = [z3.Real(f"r{k}") for k in range(4)]
    solver.add(*(z3_sum(reals, row) >= 0 for row in rows))
    if solver.check() == z3.unsat:
        assert found
    if found:
        solver = z3.Solver()
        solver.add(*(z3_sum(names, row) >= 0 for row in rows))
        assert solver.check() == z3.unsat


@given(st.lists(sums, max_size=6), sums)
@example([(-5, [1, 1, 0, 0]), (9, [-1, -1, 0, 0])], (3, [1, 1, 0, 0]))
def test_both_ends_of_a_sum_are_those_of_it_and_its_opposite(facts, asked):
    known = Facts()
    atoms = [known.fresh(-9, 9) for _ in range(4)]
    for each in facts:
        known.assume(linear(atoms, each))
    total = linear(atoms, asked)
    assert known.ends(total) == (known.lower(total), known.lower(times(total, -1))) == (known.lower(total), -known.upper(total))


def test_rollback_gives_back_what_was_known():
    table = Facts()
    x, y = table.fresh(0, 100), table.fresh(0, 100)
    table.assume(minus(x, y))
    mark = table.mark()
    table.assume(shifted(x, -50))
    table.assume(shifted(minus(x, y), -7))
    table.assume(Any((shifted(x, -99), shifted(y, -9))))
    assert table.proves(shifted(minus(x, y), -7))
    gained = table.rollback(mark)
    assert not table.proves(shifted(x, -1))
    assert not table.proves(shifted(minus(x, y), -1))
    assert table.proves(minus(x, y))
    assert gained[x.terms] == 50
    assert table.mark() == mark


def test_contradiction_proves_everything_until_it_is_rolled_back():
    table = Facts()
    x = table.fresh(0, 100)
    mark = table.mark()
    table.assume(shifted(x, -101))
    assert table.proves(formula=False)
    table.rollback(mark)
    assert not table.proves(formula=False)


def test_alternatives():
    table = Facts()
    n, x = table.fresh(*I64), table.fresh(0, 100)
    table.assume(negated(equal(n, Linear(0))))
    assert table.proves(negated(equal(n, Linear(0))))
    table.assume(n)
    assert table.proves(shifted(n, -1)) or table.proves_thoroughly(shifted(n, -1))
    table.assume(Any((shifted(x, -10), shifted(x, -20))))
    assert table.proves(shifted(x, -10))


# --- operations ---

PAIRS = st.tuples(st.integers(-40, 40), st.integers(-40, 40))
OPERATIONS = {
    "mul": integers.product,
    "div": integers.quotient,
    "rem": integers.remainder,
    "and": lambda facts, a, b: integers.bits_and(facts, a, b, I64),
    "or": lambda facts, a, b: integers.bits_or(facts, a, b, I64, exclusive=False),
    "xor": lambda facts, a, b: integers.bits_or(facts, a, b, I64, exclusive=True),
    "shl": lambda facts, a, b: integers.shift_left(facts, a, b, I64),
    "shr": lambda facts, a, b: integers.shift_right(facts, a, b, I64),
}


@pytest.mark.parametrize("op", OPERATIONS)
@settings(max_examples=60, deadline=None)
@given(left=PAIRS, right=PAIRS, constant=st.booleans(), values=st.tuples(st.floats(0, 1), st.floats(0, 1)))
def test_facts_about_operations_hold_for_all_values(op, left, right, constant, values):
    """No two values in the ranges may contradict what is taken as known about the result."""
    from rosetta_jit.kernel import arithmetic

    table = Facts()
    low, high = sorted(left)
    bottom, top = sorted(right)
    if op in {"shl", "shr"}:
        bottom, top = sorted((abs(bottom), abs(top)))
    if op in {"div", "rem"} and bottom <= 0 <= top:
        bottom, top = 1, max(1, top)
    a = table.fresh(low, high)
    y = round(bottom + values[1] * (top - bottom))
    b = Linear(y) if constant else table.fresh(bottom, top)
    x = round(low + values[0] * (high - low))
    result = OPERATIONS[op](table, a, b)
    table.assume(equal(a, Linear(x)))
    table.assume(equal(b, Linear(y)))
    table.assume(equal(result, Linear(arithmetic.binary("i64", op, x, y))))
    assert not table.proves_thoroughly(formula=False)


@settings(max_examples=100, deadline=None)
@given(st.data())
def test_masks(data):
    from rosetta_jit.kernel import arithmetic

    type_ = data.draw(st.sampled_from(["i64", "u8", "u64"]))
    limits = arithmetic.limits(type_)
    x = data.draw(st.integers(*limits))
    bits = data.draw(st.integers(0, 8))
    mask = data.draw(st.sampled_from([arithmetic.wrapped(type_, -(1 << bits)), (1 << bits) - 1, x]))
    mask = arithmetic.wrapped(type_, mask)
    table = Facts()
    a = table.fresh(*limits)
    result = integers.bits_and(table, a, Linear(mask), limits)
    table.assume(equal(a, Linear(x)))
    table.assume(equal(result, Linear(x & mask)))
    assert not table.impossible
    assert not table.proves_thoroughly(formula=False)


def scope_with(*values):
    """A scope whose locals x0, x1, … are any i64 between two bounds."""
    scope = entry(kernel(()).strides)
    for number, (low, high) in enumerate(values):
        scope.locals[f"x{number}"] = "i64", scope.facts.fresh(low, high)
    return scope


X, Y, Z = (Local("i64", f"x{k}") for k in range(3))


def test_products_and_their_bounds():
    scope = scope_with((0, 1 << 20), (0, 1 << 20), (0, 1 << 20))
    _, i = evaluate(scope, X)
    _, n = evaluate(scope, Y)
    _, area = evaluate(scope, Binary("mul", Y, Z))
    scope.facts.assume(shifted(minus(n, i), -1))
    _, at = evaluate(scope, Binary("add", Binary("mul", X, Z), Z))
    assert scope.facts.proves(minus(area, at))


def test_counts_guarded_by_division():
    scope = scope_with((0, 1 << 62), (1, 1 << 40), I64)
    _, limit = evaluate(scope, Binary("div", X, Y))
    _, n = evaluate(scope, Z)
    with pytest.raises(UnprovenError, match="wrap"):
        evaluate(scope, Binary("mul", Z, Y))
    scope.facts.assume(All((n, minus(limit, n))))
    _, total = evaluate(scope, Binary("mul", Z, Y))
    _, room = evaluate(scope, X)
    assert scope.facts.proves(minus(room, total))


def test_alignment():
    scope = scope_with((0, 1 << 40))
    _, up = evaluate(scope, Binary("and", Binary("add", X, index(7)), index(-8)))
    _, x = evaluate(scope, X)
    assert scope.facts.proves(minus(up, x))
    assert scope.facts.proves(shifted(minus(x, up), 7))
    over = Binary("rem", X, index(8))
    _, padding = evaluate(scope, Select(Compare("eq", over, index(0)), index(0), Binary("sub", index(8), over)))
    assert scope.facts.proves(All((padding, shifted(times(padding, -1), 7))))


def test_conversions_keep_what_fits():
    scope = scope_with((0, 255))
    _, x = evaluate(scope, X)
    assert evaluate(scope, Convert("u8", X)) == ("u8", x)
    assert evaluate(scope, Convert("i64", Convert("u8", X))) == ("i64", x)
    _, narrow = evaluate(scope, Convert("i8", X))
    assert scope.facts.proves(shifted(narrow, 128))
    assert not scope.facts.proves(narrow)
    assert evaluate(scope, Convert("bool", Const("f64", 1.0))) == ("bool", None)


def test_loads_are_never_the_same_value():
    scope = scope_with()
    scope.facts.assume(shifted(scope.locals["end"][1], -8))
    scope.facts.assume(shifted(minus(scope.locals["end"][1], scope.locals["begin"][1]), -8))
    load = Load("i32", Local("i64", "begin"))
    (_, first), (_, second) = evaluate(scope, load), evaluate(scope, load)
    assert not scope.facts.proves(minus(first, second))


def test_choices_of_which_nothing_is_known_are_not_one():
    """Two conditions that say nothing may differ, though they look the same."""
    scope = scope_with()
    scope.locals |= dict.fromkeys(("one", "other"), ("bool", None))
    _, first = evaluate(scope, Select(Local("bool", "one"), index(0), index(1)))
    _, second = evaluate(scope, Select(Local("bool", "other"), index(0), index(1)))
    assert not scope.facts.proves_thoroughly(minus(first, second))
    assert scope.facts.proves(first)


def test_what_is_unknown_is_not_known_again():
    """Two formulas of which nothing is known are alike, and do not follow from each other."""
    facts = Facts()
    n = facts.fresh(0, 10)
    high = shifted(n, -5)
    for vague in (Any((None, None)), Any((high, All((high, None)), None)), Any((Any((None, high)), All((high, shifted(n, -7)))))):
        facts.assume(vague)
        assert not facts.proves(vague)
        assert not facts.shows(vague)
    half = Any((All((shifted(n, -9), None)), shifted(times(n, -1), 1)))
    facts.assume(half)
    assert facts.proves(Any((shifted(n, -9), shifted(times(n, -1), 1))))
    assert not facts.proves(half)


def test_a_product_of_a_sum_of_which_more_is_known_than_of_its_parts():
    """``(a - b) * s``, where both may be anything and their difference is the number of an element."""
    facts = Facts()
    a, b = facts.fresh(*I64), facts.fresh(*I64)
    count, size = facts.fresh(0, 1 << 57), facts.fresh(0, 12)
    number = minus(a, b)
    facts.assume(All((number, shifted(minus(count, number), -1))))
    found = integers.product(facts, number, size)
    integers.look_at_whole_sums(facts, number, size)
    assert facts.proves_thoroughly(All((found, shifted(times(found, -1), 12 << 57))))
    assert not facts.proves_thoroughly(shifted(times(found, -1), 1 << 57))
