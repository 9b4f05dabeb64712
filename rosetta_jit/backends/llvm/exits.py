"""The blocks by which a body ends: edges lead to them from all over it, each with its values."""

from __future__ import annotations

from collections.abc import Sequence

from llvmlite import ir

from rosetta_jit.backends.llvm.values import I64, constant
from rosetta_jit.startup.dataclass import dataclass, field

INDICES = 2
"""Which of the words of a failure is its first index: before it stand the site and the offset."""


@dataclass(slots=True)
class Exit:
    """A block that several edges lead to, with the values that they bring."""

    block: ir.Block
    phis: tuple[ir.PhiInstr, ...]

    @staticmethod
    def new(entry: ir.IRBuilder, name: str, values: int) -> Exit:
        """An empty one, for so many values."""
        block = entry.function.append_basic_block(name)
        builder = ir.IRBuilder(block)
        return Exit(block, tuple(builder.phi(I64) for _ in range(values)))

    def drop(self) -> None:
        """No edge leads here: a block without edges cannot have phis."""
        for phi in self.phis:
            self.block.instructions.remove(phi)
        ir.IRBuilder(self.block).unreachable()

    def enter(self, builder: ir.IRBuilder, values: Sequence[ir.Value]) -> None:
        """End the builder's block with a jump here; values that are not given are 0."""
        for phi, value in zip(self.phis, (*values, *[constant(0)] * (len(self.phis) - len(values))), strict=True):
            phi.add_incoming(value, builder.block)
        builder.branch(self.block)

    @property
    def is_reached(self) -> bool:
        return bool(self.phis[0].incomings)


@dataclass(slots=True)
class StoredExit:
    """A block that very many edges lead to: each stores its values in words of the state, whose addresses are computed once.

    LLVM looks through all edges of a phi for each edge that it moves, which takes quadratic time. So it does with blocks whose last
    instructions are the same; theirs stores the site, in which they differ. ``shared`` are blocks on the way that store the same indices
    for many edges, by these and by the values that they are computed from. ``numbers`` are those of the words.
    """

    block: ir.Block
    words: tuple[ir.Value, ...]
    numbers: tuple[int, ...]
    is_reached: bool = False
    shared: dict[tuple[object, ...], ir.Block] = field(default_factory=dict[tuple[object, ...], "ir.Block"])

    def enter(self, builder: ir.IRBuilder, values: Sequence[ir.Value], through: ir.Block) -> None:
        """End the builder's block with a jump to a block on the way, or to this; words whose values are not given stay as they are."""
        self._store(builder, self.words, values)
        builder.branch(through)
        self.is_reached = True

    def drop(self) -> None:
        """No edge leads here."""
        ir.IRBuilder(self.block).unreachable()

    def enter_with_indices(self, builder: ir.IRBuilder, indices: Sequence[ir.Value]) -> None:
        """The same where the site and the offset are stored before."""
        self._store(builder, self.words[INDICES:], indices)
        builder.branch(self.block)

    def _store(self, builder: ir.IRBuilder, words: Sequence[ir.Value], values: Sequence[ir.Value]) -> None:
        for word, value in reversed(tuple(zip(words, values, strict=False))):
            builder.store(value, word, align=8)
