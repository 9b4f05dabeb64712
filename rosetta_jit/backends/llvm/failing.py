"""Checks, and the way out of a body where one does not hold.

A failing edge leads through a cold block of its own, where the offset and the indices are computed, to the one block of the body that
takes failures; so the hot path holds compares and branches alone.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.backends.llvm.expr import expression
from rosetta_jit.backends.llvm.frame import COLD, Frame, StoredExit, constant
from rosetta_jit.backends.llvm.sites import site_of
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
    shared = frame.failed.shared if isinstance(frame.failed, StoredExit) else {}
    told = _told(frame, failure.site, failure.at, *failure.indices) if isinstance(frame.failed, StoredExit) else None
    broken = None if told is None else shared.get(told)
    good = cold(frame, holds, broken)
    if broken is None:
        if told is not None:
            shared[told] = frame.builder.block
        fail(frame, (failure.site,), constant(1), expression(frame, failure.at), failure.indices)
    frame.builder.position_at_end(good)


def cold(frame: Frame, holds: ir.Value, known: ir.Block | None = None) -> ir.Block:
    """Where to go on if the condition holds; the frame prints what to do else, unless a block is known that does it."""
    good = frame.block("good")
    cold = frame.block("broken") if known is None else known
    frame.builder.cbranch(holds, good, cold).set_weights(COLD)
    frame.builder.position_at_end(cold)
    return good


def _told(frame: Frame, site: int, *numbers: nodes.Expr) -> tuple[object, ...] | None:
    """What a failure reports, and what that is computed from; None where it is another site or another index for each caller or stretch."""
    if frame.caller is not None or not frame.has_one_stretch:
        return None
    names = sorted(set[str]().union(*map(locals_in, numbers)))
    return (site, numbers, *(frame.locals[each] for each in names))


def fail(frame: Frame, sites: tuple[int, ...], number: ir.Value, offset: ir.Value, indices: tuple[nodes.Expr, ...]) -> None:
    """Leave the body at the site of a number, counted from 1; what a routine's sites and indices are, its caller says."""
    while frame.caller is not None:
        frame, call = frame.caller
        sites, indices = tuple(call.sites[each - 1] for each in sites), call.indices
    found = [site_of(frame, number, sites), offset]
    if indices and isinstance(frame.failed, StoredExit) and (told := _told(frame, ANY_SITE, *indices)) is not None:
        frame.failed.enter(frame.builder, found, _stores_indices(frame, frame.failed, indices, told))
    else:
        frame.failed.enter(frame.builder, [*found, *(expression(frame, each) for each in indices)])


def _stores_indices(frame: Frame, failed: StoredExit, indices: tuple[nodes.Expr, ...], told: tuple[object, ...]) -> ir.Block:
    """The block that stores indices on the way out: one for all failures in a round of a loop, whose indices are the same."""
    if told not in failed.shared:
        here, shared = frame.builder.block, frame.block("indices")
        failed.shared[told] = shared
        frame.builder.position_at_end(shared)
        failed.enter_with_indices(frame.builder, [expression(frame, each) for each in indices])
        frame.builder.position_at_end(here)
    return failed.shared[told]
