"""Checks, and the way out of a body where one does not hold.

A failing edge leads through a cold block of its own, where the offset and the indices are computed, to the one block of the body that
takes failures; so the hot path holds compares and branches alone.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from rosetta_jit.backends.llvm.alike import Number
from rosetta_jit.backends.llvm.exits import StoredExit
from rosetta_jit.backends.llvm.expr import expression
from rosetta_jit.backends.llvm.frame import Frame
from rosetta_jit.backends.llvm.sites import site_of
from rosetta_jit.backends.llvm.values import COLD, I64, constant
from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.rewrite import locals_in
from rosetta_jit.kernel.terms import BEGIN

if TYPE_CHECKING:
    from llvmlite import ir

ANY_SITE = -1
"""Stands for the site where only the indices of failures count."""


def require(frame: Frame, at: nodes.Expr, size: nodes.Expr, failure: nodes.Failure) -> None:
    """Check ``at >= 0``, ``size >= 0`` and ``size <= end - at``: a difference that cannot wrap where the first holds.

    Of a size that is known that is one comparison without signs.
    """
    builder = frame.builder
    start = expression(frame, at)
    if isinstance(size, nodes.Const) and not _is_behind_begin(at):
        check(frame, builder.icmp_unsigned("<", start, frame.limit(int(size.value))), failure)
        return
    length = expression(frame, size)
    holds = builder.icmp_signed("<=", length, builder.sub(frame.parameters.end, start))
    for value, is_positive in ((start, _is_behind_begin(at)), (length, isinstance(size, nodes.Const))):
        if not is_positive:
            holds = builder.and_(holds, builder.icmp_signed(">=", value, constant(0)))
    check(frame, holds, failure)


def _is_behind_begin(at: nodes.Expr) -> bool:
    match at:
        case nodes.Binary("add", base, nodes.Const(_, offset)):
            return base == BEGIN and offset >= 0
        case _:
            return at == BEGIN or isinstance(at, nodes.Const)


def check(frame: Frame, holds: ir.Value, failure: nodes.Failure) -> None:
    """Go on where the condition holds. In a body of very many checks, those that report the same lead to one block."""
    told = _told(frame, failure.site, failure.at, *failure.indices)

    def printed() -> None:
        fail(frame, (failure.site,), constant(1), expression(frame, failure.at), failure.indices)

    go_on(frame, holds, frame.block("good"), on_the_way(frame, "broken", told, printed))


def cold(frame: Frame, holds: ir.Value) -> ir.Block:
    """Where to go on if the condition holds; the frame prints what to do else."""
    good, broken = frame.block("good"), frame.block("broken")
    go_on(frame, holds, good, broken)
    frame.builder.position_at_end(broken)
    return good


def go_on(frame: Frame, holds: ir.Value, good: ir.Block, otherwise: ir.Block) -> None:
    """Go on in a block where the condition holds, as it nearly always does."""
    frame.builder.cbranch(holds, good, otherwise).set_weights(COLD)
    frame.builder.position_at_end(good)


def _told(frame: Frame, site: int, *numbers: nodes.Expr) -> tuple[object, ...] | None:
    """What a failure reports, and what that is computed from; None where it is not stored, or is another one for each caller or stretch."""
    if not isinstance(frame.failed, StoredExit) or frame.caller is not None or not frame.has_one_stretch:
        return None
    names = sorted(set[str]().union(*map(locals_in, numbers)))
    return (site, numbers, *(frame.locals[each] for each in names))


def fail(frame: Frame, sites: tuple[int, ...], number: ir.Value, offset: ir.Value, indices: tuple[nodes.Expr, ...]) -> None:
    """Leave the body at the site of a number, counted from 1; what a routine's sites and indices are, its caller says."""
    while frame.caller is not None:
        frame, call = frame.caller
        sites, indices = tuple(call.sites[each - 1] for each in sites), call.indices
    (site, column), failed = site_of(frame, number, sites), frame.failed
    if not isinstance(failed, StoredExit):
        failed.enter(frame.builder, [site, offset, *(expression(frame, each) for each in indices)])
        return
    found, through = [site, offset], failed.block
    if indices and (told := _told(frame, ANY_SITE, *indices)) is not None:
        through = _stores_indices(frame, failed, indices, told)
    else:
        found += [expression(frame, each) for each in indices]
    failed.enter(frame.builder, found, through if column is None else _adds_number(frame, failed, column, through))


def on_the_way(frame: Frame, name: str, told: tuple[object, ...] | None, printed: Callable[[], None]) -> ir.Block:
    """A block that leads out of the body. In one of very many checks, there is one for all that have the same to tell, if that is known."""
    shared = frame.failed.shared if isinstance(frame.failed, StoredExit) else {}
    found = None if told is None else shared.get(told)
    if found is None:
        here, found = frame.builder.block, frame.block(name)
        if told is not None:
            shared[told] = found
        frame.builder.position_at_end(found)
        printed()
        frame.builder.position_at_end(here)
    return found


def _stores_indices(frame: Frame, failed: StoredExit, indices: tuple[nodes.Expr, ...], told: tuple[object, ...]) -> ir.Block:
    """The block that stores indices on the way out: one for all failures in a round of a loop, whose indices are the same."""

    def printed() -> None:
        failed.enter_with_indices(frame.builder, [expression(frame, each) for each in indices])

    return on_the_way(frame, "indices", told, printed)


def _adds_number(frame: Frame, failed: StoredExit, column: int, through: ir.Block) -> ir.Block:
    """The block that adds a number of the stretch's row to the site on the way out: one for all failures that go on alike."""
    stretch = frame.stretch
    assert stretch is not None

    def printed() -> None:
        builder, word = frame.builder, failed.words[0]
        number = stretch.number(builder, Number(column, 0))
        builder.store(builder.add(builder.load(word, typ=I64, align=8), number), word, align=8)
        builder.branch(through)

    return on_the_way(frame, "site", ("site", column, through), printed)
