"""The UTF-8 check as a private LLVM function: eight ASCII bytes at a time, else one character at a time by Unicode 15, table 3-7."""

from __future__ import annotations

from typing import TYPE_CHECKING

from llvmlite import ir

from rosetta_jit.backends.llvm.frame import I1, I8, I64, POINTER, constant

if TYPE_CHECKING:
    from collections.abc import Sequence

NAME = "rosetta_is_text"
HIGH_BITS = 0x8080808080808080


def is_text_function(module: ir.Module) -> ir.Function:
    """``i1 rosetta_is_text(bytes, size)``, defined in the module at the first call."""
    if NAME in module.globals:
        return module.globals[NAME]
    function = ir.Function(module, ir.FunctionType(I1, [POINTER, I64]), NAME)
    function.linkage = "internal"
    _Check(function).define()
    return function


class _Check:
    """The blocks of the function; ``position`` is the only variable."""

    def __init__(self, function: ir.Function) -> None:
        self.function = function
        self.bytes, self.size = function.args
        self.builder = ir.IRBuilder(function.append_basic_block("entry"))
        self.position = self.builder.alloca(I64, name="position")
        self.builder.store(constant(0), self.position)

    def define(self) -> None:
        builder, append = self.builder, self.function.append_basic_block
        ascii_, eight, one, lead, good, bad = (append(name) for name in ("ascii", "eight", "one", "lead", "good", "bad"))
        builder.branch(ascii_)
        self._ascii(ascii_, eight, one)
        builder.position_at_end(one)
        builder.cbranch(builder.icmp_signed("<", self._at(), self.size), lead, good)
        self._character(lead, ascii_, bad)
        for block, answer in ((good, 1), (bad, 0)):
            builder.position_at_end(block)
            builder.ret(ir.Constant(I1, answer))

    def _ascii(self, ascii_: ir.Block, eight: ir.Block, one: ir.Block) -> None:
        """Step over eight bytes while there are eight and none has its high bit set."""
        builder = self.builder
        builder.position_at_end(ascii_)
        behind = builder.add(self._at(), constant(8), flags=("nsw",))
        builder.cbranch(builder.icmp_signed("<=", behind, self.size), eight, one)
        builder.position_at_end(eight)
        word = builder.load(self._byte(0), typ=I64, align=1)
        plain = builder.icmp_unsigned("==", builder.and_(word, constant(HIGH_BITS)), constant(0))
        step = self.function.append_basic_block("step")
        builder.cbranch(plain, step, one)
        builder.position_at_end(step)
        builder.store(behind, self.position)
        builder.branch(ascii_)

    def _character(self, lead: ir.Block, again: ir.Block, bad: ir.Block) -> None:
        """Table 3-7: the first byte says how many follow, and narrows the range of the second.

        That excludes overlong forms, surrogates, and what lies beyond U+10FFFF.
        """
        builder = self.builder
        builder.position_at_end(lead)
        first = builder.load(self._byte(0), typ=I8, align=1)
        single, many = self.function.append_basic_block("single"), self.function.append_basic_block("many")
        builder.cbranch(builder.icmp_unsigned("<", first, ir.Constant(I8, 0x80)), single, many)
        builder.position_at_end(single)
        self._advance(1, again)
        builder.position_at_end(many)
        low = self._choose(first, ((0xE0, 0xA0), (0xF0, 0x90)), 0x80)
        high = self._choose(first, ((0xED, 0x9F), (0xF4, 0x8F)), 0xBF)
        for least, most, following in ((0xC2, 0xDF, 1), (0xE0, 0xEF, 2), (0xF0, 0xF4, 3)):
            mine, other = self.function.append_basic_block("mine"), self.function.append_basic_block("other")
            builder.cbranch(self._within(first, ir.Constant(I8, least), ir.Constant(I8, most)), mine, other)
            builder.position_at_end(mine)
            fine = self._following((low, high), following, bad)
            good = self.function.append_basic_block("good")
            builder.cbranch(fine, good, bad)
            builder.position_at_end(good)
            self._advance(1 + following, again)
            builder.position_at_end(other)
        builder.branch(bad)

    def _following(self, second: tuple[ir.Value, ir.Value], count: int, bad: ir.Block) -> ir.Value:
        """Whether the bytes after the first are what they must be; go to ``bad`` where the text ends before them."""
        builder = self.builder
        there = self.function.append_basic_block("there")
        builder.cbranch(builder.icmp_signed(">", builder.sub(self.size, self._at()), constant(count)), there, bad)
        builder.position_at_end(there)
        fine = self._within(builder.load(self._byte(1), typ=I8, align=1), *second)
        for index in range(2, count + 1):
            tail = builder.load(self._byte(index), typ=I8, align=1)
            fine = builder.and_(fine, self._within(tail, ir.Constant(I8, 0x80), ir.Constant(I8, 0xBF)))
        return fine

    def _choose(self, first: ir.Value, special: Sequence[tuple[int, int]], otherwise: int) -> ir.Value:
        chosen: ir.Value = ir.Constant(I8, otherwise)
        for lead, bound in special:
            chosen = self.builder.select(self.builder.icmp_unsigned("==", first, ir.Constant(I8, lead)), ir.Constant(I8, bound), chosen)
        return chosen

    def _within(self, byte: ir.Value, low: ir.Value, high: ir.Value) -> ir.Value:
        builder = self.builder
        return builder.and_(builder.icmp_unsigned(">=", byte, low), builder.icmp_unsigned("<=", byte, high))

    def _at(self) -> ir.Value:
        return self.builder.load(self.position, typ=I64)

    def _byte(self, index: int) -> ir.Value:
        at = self.builder.add(self._at(), constant(index), flags=("nsw",))
        return self.builder.gep(self.bytes, [at], source_etype=I8)

    def _advance(self, count: int, block: ir.Block) -> None:
        self.builder.store(self.builder.add(self._at(), constant(count), flags=("nsw",)), self.position)
        self.builder.branch(block)
