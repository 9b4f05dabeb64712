"""Room for rows: a kernel that has too little of it says in which lane, and is called again."""

from __future__ import annotations

from llvmlite import ir

from rosetta_jit.backends.llvm.frame import COLD, I64, Frame, StoredExit, constant, state_word
from rosetta_jit.kernel.state import GROW, GROW_LANE, GROW_ROWS


def reserve(frame: Frame, lane: int, count: ir.Value) -> None:
    """Return GROW unless the rows are free; a negative count, seen as unsigned, never is."""
    builder = frame.builder
    used = builder.load(frame.used_slot(lane), typ=I64)
    free = builder.sub(frame.capacity(lane), used, flags=("nsw",))
    enough, small, is_new = frame.block("enough"), *_small(frame, lane, count)
    builder.cbranch(builder.icmp_unsigned("<=", count, free), enough, small).set_weights(COLD)
    if is_new:
        builder.position_at_end(small)
        _grow(frame, lane, count)
    builder.position_at_end(enough)


def _small(frame: Frame, lane: int, count: ir.Value) -> tuple[ir.Block, bool]:
    """The block for where rows are missing, and whether it is a new one: a large body has one for each lane and constant number of rows."""
    if not (isinstance(frame.failed, StoredExit) and isinstance(count, ir.Constant) and frame.has_one_stretch):
        return frame.block("small"), True
    told, shared = ("small", lane, count), frame.failed.shared
    is_new = told not in shared
    if is_new:
        shared[told] = frame.block("small")
    return shared[told], is_new


def _grow(frame: Frame, lane: int, count: ir.Value) -> None:
    """Return GROW, and say for which lane and for how many rows."""
    builder, state = frame.builder, frame.parameters.state
    missing = builder.sub(count, builder.sub(frame.capacity(lane), builder.load(frame.used_slot(lane), typ=I64), flags=("nsw",)))
    builder.store(frame.lane_number(lane), state_word(builder, state, GROW_LANE), align=8)
    if frame.is_hidden(lane):
        missing = builder.mul(missing, constant(frame.strides[lane]))
    builder.store(missing, state_word(builder, state, GROW_ROWS), align=8)
    frame.leave(constant(GROW))
