"""A proven kernel without what cannot fail is not proven again; whatever else differs is."""

from __future__ import annotations

from dataclasses import replace

import pytest

from rosetta_jit.kernel.ir import Routine
from rosetta_jit.kernel.nodes import Expect, For, If, Let, Load, Place, Require, Return, SetField
from rosetta_jit.kernel.passes import order as passes
from rosetta_jit.kernel.passes.drop import drop, without
from rosetta_jit.kernel.passes.hoist import hoist
from rosetta_jit.kernel.passes.simplify import simplify
from rosetta_jit.kernel.proof.verify import VerificationError, settled, verify
from rosetta_jit.kernel.proof.without_checks import is_less
from rosetta_jit.kernel.terms import BEGIN, ROW, add, index
from rosetta_jit.kernel.traits import is_large
from rosetta_jit.kernel.walk import statements
from tests.kernel import kernels
from tests.kernel.kernels import ROW_EXISTS, compare, expect, i64, kernel, need
from tests.kernel.random_kernels import random_kernel


def of(*body):
    """A kernel of some statements, with one that reads and one that returns behind them."""
    return kernel((*body, Let("n", Load("i64", BEGIN)), Return(BEGIN)))


TWICE = of(need(BEGIN, 16), need(BEGIN, 8))
INSIDE = of(need(BEGIN, 16), For("i", index(3), (need(BEGIN, 8), expect(compare("lt", i64("i"), 2)))))


def body(made):
    return [type(stmt) for stmt, _ in statements(made.bodies[0])]


@pytest.mark.parametrize("proven", [TWICE, INSIDE])
def test_a_kernel_without_what_is_known_is_less(proven):
    known = settled(proven)
    less = without(proven, known)
    assert len(known) == 1
    assert body(less) != body(proven)
    assert is_less(less, proven, known)
    assert is_less(proven, proven, frozenset())


@pytest.mark.parametrize("proven", [TWICE, INSIDE])
def test_nothing_else_may_be_gone_or_be_another(proven):
    known = settled(proven)
    less = without(proven, known)
    first, *rest = less.bodies[0]
    others = [
        (need(BEGIN, 8), *rest),  # a check of less
        tuple(rest),
        (first, *rest[:-1]),
        (first, *rest, *rest[-1:]),
        (*rest, first),
    ]
    assert not any(is_less(replace(less, bodies=(other,)), proven, known) for other in others)
    assert not is_less(less, proven, frozenset())
    assert not is_less(replace(less, strides=(*less.strides, 8)), proven, known)
    assert not is_less(replace(less, bodies=less.bodies * 2), proven, known)


def test_each_body_is_compared():
    two = replace(TWICE, bodies=(TWICE.bodies[0], INSIDE.bodies[0]))
    known = settled(two)
    less = without(two, known)
    first, second = less.bodies
    assert is_less(less, two, known)
    for bodies in ((first, second[1:]), (first[1:], second), (second, first), (first, first)):
        assert not is_less(replace(less, bodies=bodies), two, known)


def test_nothing_may_be_gone_behind_what_cannot_be_left_out():
    """A comparison that ends there would find nothing left over."""
    returns = of(need(BEGIN, 16), If(compare("ge", index(1), 0), (Return(add(BEGIN, 8)),)))
    first, branch, *_ = returns.bodies[0]
    assert not is_less(kernel((first,)), returns, frozenset({id(branch)}))
    first, let, _ = of(need(BEGIN, 16)).bodies[0]
    assert not is_less(kernel((first,)), kernel((first, let, Return(BEGIN))), frozenset({id(let)}))


def test_loops_may_not_change_their_counts_or_lose_checks_inside():
    known = settled(INSIDE)
    first, loop, *rest = without(INSIDE, known).bodies[0]
    for other in (replace(loop, count=index(2)), replace(loop, body=()), replace(loop, variable="j")):
        assert not is_less(replace(INSIDE, bodies=((first, other, *rest),)), INSIDE, known)


def test_only_checks_and_decided_branches_are_left_out():
    """Whatever the ids say."""
    first, let, end = of(need(BEGIN, 16)).bodies[0]
    proven = kernel((first, let, end))
    assert not is_less(kernel((first, end)), proven, frozenset({id(let)}))


def test_a_decided_branch_that_may_return_needs_a_proof():
    """What stands behind it could be out of every path's reach."""
    decided = compare("ge", index(1), 0)
    plain = of(need(BEGIN, 16), If(decided, (need(BEGIN, 24),)))
    known = frozenset({id(plain.bodies[0][1])})
    assert settled(plain) == known
    assert is_less(without(plain, known), plain, known)
    returns = of(need(BEGIN, 16), If(decided, (Return(add(BEGIN, 8)),)))
    known = frozenset({id(returns.bodies[0][1])})
    assert not is_less(without(returns, known), returns, known)


def test_a_branch_that_messages_decide_stays():
    assert not settled(of(need(BEGIN, 16), If(compare("gt", Load("i64", BEGIN), 0), (need(BEGIN, 24),))))


def many(count):
    """A large kernel: numbers behind one another, each checked twice."""
    places = (add(BEGIN, at) for at in range(0, 8 * count, 8))
    parts = (part for at in places for part in (need(at, 8), need(at, 8), SetField(Place(0, ROW, 0), Load("i64", at))))
    return kernel((ROW_EXISTS, *parts, Return(BEGIN)))


def counted(monkeypatch, made):
    """How often the passes prove a kernel, and what they make of it."""
    proofs = []
    for name in ("settled", "verify"):
        function = getattr(passes, name)
        monkeypatch.setattr(passes, name, lambda kernel, function=function: (proofs.append(kernel), function(kernel))[1])
    return passes.run(made), len(proofs)


def test_a_large_kernel_is_proven_once(monkeypatch):
    large = many(1500)
    assert is_large(large)
    made, proofs = counted(monkeypatch, large)
    assert proofs == 1
    assert body(made).count(Require) < 10
    verify(made)


def test_a_kernel_that_changes_after_its_proof_is_proven_again(monkeypatch):
    made, proofs = counted(monkeypatch, kernels.counted_list())
    assert proofs >= 2
    verify(made)


def test_a_kernel_that_no_later_pass_changes_is_not(monkeypatch):
    _, proofs = counted(monkeypatch, simplify(TWICE))
    assert proofs == 1


@pytest.mark.parametrize("seed", range(40))
def test_what_drop_makes_is_less_and_can_be_proven(seed):
    proven = random_kernel(seed)
    known = settled(proven)
    less = without(proven, known)
    assert less == drop(proven)
    assert is_less(less, proven, known)
    verify(less)
    verify(passes.run(proven))


def test_expects_go_as_requires_do():
    proven = of(need(BEGIN, 16), expect(compare("ge", index(1), 0)))
    known = settled(proven)
    assert is_less(without(proven, known), proven, known)
    assert Expect not in body(without(proven, known))


def test_a_routine_that_changes_behind_the_proof_is_proven_again():
    """Its new text reads what nothing has checked, so the pass is refused."""
    routine = Routine("r", (), (), (Let("x", index(0)),), (), (), TWICE.sites[:1])
    calling = replace(TWICE, routines=(routine,))

    def spoil(made):
        return replace(made, routines=(replace(routine, body=(Let("x", Load("i64", add(BEGIN, 1 << 20))),)),))

    assert passes.run(calling, (drop, spoil)).routines == (routine,)


def spoiled(made):
    """A kernel whose first body reads what nothing has checked."""
    first, *rest = made.bodies[0]
    return replace(made, bodies=((Let("spoiled", Load("i64", add(BEGIN, 1 << 20))), first, *rest), *made.bodies[1:]))


@pytest.mark.parametrize("order", [(drop, spoiled), (drop, drop, spoiled), (spoiled,), (spoiled, drop)])
def test_a_body_that_is_spoiled_behind_the_proof_is_not_used(order):
    assert passes.run(TWICE, order).bodies[0][0] is TWICE.bodies[0][0]


def test_what_drop_makes_is_proven_where_it_is_not_less(monkeypatch):
    """Were it to leave out what is needed, the comparison would notice, and then the proof."""
    monkeypatch.setattr(passes, "without", lambda made, _: spoiled(made))
    assert passes.run(TWICE, (drop,)).bodies[0][0] is TWICE.bodies[0][0]


def test_a_pass_that_is_not_followed_is_left_out_alone():
    """Passes before and behind it are used."""
    made = passes.run(INSIDE, (drop, spoiled, drop, simplify))
    assert body(made) == body(passes.run(INSIDE, (drop, simplify)))
    assert made != INSIDE


def test_without_drop_a_kernel_is_proven():
    verify(passes.run(TWICE, (simplify,)))
    with pytest.raises(VerificationError):
        passes.run(spoiled(TWICE), (hoist,))


UNSOUND = {
    "a name that is bound twice": kernel((Let("n", index(0)), Let("n", index(1)), Return(BEGIN))),
    "a site that does not exist": kernel((Require(BEGIN, index(8), replace(need(BEGIN, 8).failure, site=99)), Return(BEGIN))),
}


@pytest.mark.parametrize("order", [(), (drop,), passes.PASSES])
@pytest.mark.parametrize("unsound", UNSOUND.values(), ids=UNSOUND)
def test_a_kernel_whose_text_is_not_sound_is_refused(unsound, order):
    with pytest.raises(VerificationError):
        passes.run(unsound, order)
