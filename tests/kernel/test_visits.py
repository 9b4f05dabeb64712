"""What lowering writes to go from row to row is what backends see: also behind the passes."""

from __future__ import annotations

from rosetta_jit.kernel.nodes import Binary, Compare, Const, Get, If, Let, Local, Place, Var
from rosetta_jit.kernel.terms import add, index
from rosetta_jit.kernel.visits import Entered, Stack, entered, entering, goes_back, going, going_back, gone, stack_of

AT, STATE, ROW, DEPTH, ROUNDS = (Local("i64", name) for name in ("at", "state", "here", "depth", "rounds"))
STACK = Stack(AT, STATE, ROW, DEPTH)
START, COUNT = Local("i64", "start"), Local("i64", "count")
WORDS = [Place(2, START, 72 + 8 * word) for word in range(3)]
FOLDED = {Binary("sub", COUNT, index(1)): Binary("add", COUNT, Const("i64", -1))}


def test_states():
    assert gone(STACK, going(STACK, add(AT, 8), 3)) == (add(AT, 8), 3)
    assert gone(STACK, going(Stack(ROW, STATE, AT, DEPTH), AT, 3)) is None
    assert gone(STACK, ()) is None


def test_rows():
    block = entering(STACK, WORDS, START, COUNT, 5)
    assert entered(STACK, block) == Entered(2, START, COUNT, add(DEPTH, 1), 5)
    folded = [type(each)(each.place, FOLDED.get(each.value, each.value)) if hasattr(each, "place") else each for each in block]
    assert entered(STACK, folded) == entered(STACK, block)
    assert entered(STACK, block[1:]) is None
    assert entered(Stack(AT, STATE, DEPTH, ROW), block) is None


def test_back():
    words = [Get("i64", Place(2, ROW, offset)) for offset in (72, 80)]
    left = Local("i64", "left")
    neighbour = going(Stack(ROW, STATE, AT, DEPTH), add(ROW, 1), 4)
    block = (Let("left", Get("i64", Place(2, ROW, 88))), If(Compare("gt", left, index(0)), neighbour, going_back(STACK, words)))
    assert goes_back(STACK, block)
    assert not goes_back(Stack(AT, ROW, STATE, DEPTH), block[:1])


def test_variables():
    begun = [Var(each.name, index(0)) for each in (AT, STATE, ROW, DEPTH, ROUNDS)]
    assert stack_of(begun) == STACK
    assert stack_of([*begun, Var("opened", index(0))]) is None
