"""Room for rows: a kernel that has too little of it says in which lane, and is called again."""

from __future__ import annotations

from llvmlite import ir

from rosetta_jit.backends.llvm.exits import StoredExit
from rosetta_jit.backends.llvm.failing import go_on, on_the_way
from rosetta_jit.backends.llvm.frame import Frame
from rosetta_jit.backends.llvm.values import I64, constant, state_word
from rosetta_jit.kernel.state import GROW, GROW_LANE, GROW_ROWS


def reserve(frame: Frame, lane: int, count: ir.Value) -> None:
    """Return GROW unless the rows are free; a negative count, seen as unsigned, never is."""
    builder = frame.builder
    used = builder.load(frame.used_slot(lane), typ=I64)
    free = builder.sub(frame.capacity(lane), used, flags=("nsw",))
    go_on(frame, builder.icmp_unsigned("<=", count, free), frame.block("enough"), _small(frame, lane, count))


def grow(frame: Frame) -> ir.Block:
    """The block of a large body that returns GROW."""
    return on_the_way(frame, "grow", ("grow",), lambda: frame.leave(constant(GROW)))


def _small(frame: Frame, lane: int, count: ir.Value) -> ir.Block:
    """The block for where rows are missing: a large body has one for each lane and constant number of rows."""
    is_alike = isinstance(count, ir.Constant) and frame.has_one_stretch

    def printed() -> None:
        _tell(frame, lane, count)
        if isinstance(frame.failed, StoredExit):
            frame.builder.branch(grow(frame))
        else:
            frame.leave(constant(GROW))

    return on_the_way(frame, "small", ("small", lane, count) if is_alike else None, printed)


def _tell(frame: Frame, lane: int, count: ir.Value) -> None:
    """Say in which lane rows are missing, and how many."""
    builder, state = frame.builder, frame.parameters.state
    missing = builder.sub(count, builder.sub(frame.capacity(lane), builder.load(frame.used_slot(lane), typ=I64), flags=("nsw",)))
    builder.store(frame.lane_number(lane), state_word(builder, state, GROW_LANE), align=8)
    if frame.is_hidden(lane):
        missing = builder.mul(missing, constant(frame.strides[lane]))
    builder.store(missing, state_word(builder, state, GROW_ROWS), align=8)
