"""The UTF-8 check as an LLVM function: many ASCII bytes at a time, else one character at a time by Unicode 15, table 3-7.

The bytes behind the last whole vector or word are looked at together with those before them, as the last vector or word of the text. A text
shorter than a vector is looked at from both ends: as many branches for each length, which processors guess better than rounds of a loop.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence

from llvmlite import ir

from rosetta_jit.backends.llvm.values import I1, I8, I64, constant

WORD = 8
VECTOR = 4 * WORD
"""Bytes."""


def define(function: ir.Function) -> None:
    """``i1 rosetta_is_text(bytes, size)``."""
    _Check(function).define()


class _Check:
    """The blocks of the function; ``position`` is the only variable."""

    def __init__(self, function: ir.Function) -> None:
        self.function = function
        self.bytes, self.size = function.args
        self.builder = ir.IRBuilder(function.append_basic_block("entry"))
        self.position = self.builder.alloca(I64, name="position")
        self.builder.store(constant(0), self.position)

    def define(self) -> None:
        builder = self.builder
        long, mixed, words, lead, good, bad = map(self._block, ("long", "mixed", "words", "lead", "good", "bad"))
        has_word = builder.icmp_signed(">=", self.size, constant(WORD))
        some_words, fewer = self._block("some_words"), self._block("fewer")
        builder.cbranch(has_word, some_words, fewer)
        self._below_word(fewer, lead, good)
        self._below_vector(some_words, long, words, good)
        self._long(long, words, good)
        self._mixed(mixed, words, has_word, lead, good)
        self._character(lead, mixed, bad)
        for block, answer in ((good, 1), (bad, 0)):
            builder.position_at_end(block)
            builder.ret(ir.Constant(I1, answer))

    def _below_word(self, start: ir.Block, lead: ir.Block, good: ir.Block) -> None:
        """A text shorter than a word is ASCII if its first and its last bytes are, half a word of them or fewer, which may overlap."""
        builder, width = self.builder, WORD // 2
        builder.position_at_end(start)
        while width:
            some, fewer = self._block(f"some{width}"), self._block("fewer")
            builder.cbranch(builder.icmp_signed(">=", self.size, constant(width)), some, fewer)
            self._ends(some, width, good, lead)
            builder.position_at_end(fewer)
            width //= 2
        builder.branch(good)

    def _below_vector(self, start: ir.Block, long: ir.Block, words: ir.Block, good: ir.Block) -> None:
        """One that is shorter than a vector: the same, with a word or two of them at each end."""
        builder = self.builder
        builder.position_at_end(start)
        short, two, one = self._block("short"), self._block("two"), self._block("one")
        builder.cbranch(builder.icmp_signed(">=", self.size, constant(VECTOR)), long, short)
        builder.position_at_end(short)
        builder.cbranch(builder.icmp_signed(">=", self.size, constant(2 * WORD)), two, one)
        self._ends(two, 2 * WORD, good, words)
        self._ends(one, WORD, good, words)

    def _ends(self, start: ir.Block, width: int, good: ir.Block, other: ir.Block) -> None:
        """Whether the first and the last so many bytes are ASCII."""
        self.builder.position_at_end(start)
        ends = [self._high_bits(at, ir.IntType(8 * width)) for at in (constant(0), self.builder.sub(self.size, constant(width)))]
        self.builder.cbranch(self._is_zero(self.builder.or_(*ends)), good, other)

    def _long(self, start: ir.Block, words: ir.Block, good: ir.Block) -> None:
        """Step over vectors while they are ASCII; where fewer bytes are left, look at the text's last vector."""
        rest = self._step(start, VECTOR, words)
        self._last(rest, VECTOR, good, words)

    def _mixed(self, start: ir.Block, words: ir.Block, has_word: ir.Value, lead: ir.Block, good: ir.Block) -> None:
        """Behind a character that is not ASCII: step over vectors, then words, that are; of a word that is not, over the bytes that are.

        Where fewer bytes are left, look at the text's last word.
        """
        builder = self.builder
        rest = self._step(start, VECTOR, words)
        builder.position_at_end(rest)
        builder.branch(words)
        skip = self._block("skip")
        rest = self._step(words, WORD, skip)
        builder.position_at_end(skip)
        count_bits = builder.cttz if sys.byteorder == "little" else builder.ctlz
        ascii_bits = count_bits(self._high_bits(self._at(), I64), ir.Constant(I1, 1))
        self._advance(builder.lshr(ascii_bits, constant(3)), lead)
        builder.position_at_end(rest)
        some, last = self._block("some"), self._block("last")
        builder.cbranch(builder.icmp_signed("<", self._at(), self.size), some, good)
        builder.position_at_end(some)
        builder.cbranch(has_word, last, lead)
        self._last(last, WORD, good, lead)

    def _last(self, start: ir.Block, width: int, good: ir.Block, other: ir.Block) -> None:
        """Whether the last so many bytes are ASCII."""
        self.builder.position_at_end(start)
        high_bits = self._high_bits(self.builder.sub(self.size, constant(width)), ir.IntType(8 * width))
        self.builder.cbranch(self._is_zero(high_bits), good, other)

    def _step(self, start: ir.Block, width: int, other: ir.Block) -> ir.Block:
        """Step over so many bytes, again and again from ``start`` on; returns where fewer are left.

        Where some of them are not ASCII, go to ``other``.
        """
        builder = self.builder
        there, step, rest = self._block(f"there{width}"), self._block("step"), self._block("rest")
        builder.position_at_end(start)
        behind = builder.add(self._at(), constant(width), flags=("nsw",))
        builder.cbranch(builder.icmp_signed("<=", behind, self.size), there, rest)
        builder.position_at_end(there)
        builder.cbranch(self._is_zero(self._high_bits(self._at(), ir.IntType(8 * width))), step, other)
        builder.position_at_end(step)
        builder.store(behind, self.position)
        builder.branch(start)
        return rest

    def _high_bits(self, at: ir.Value, type_: ir.IntType) -> ir.Value:
        """The high bits of the bytes from an offset on, as one integer: none is set if all are ASCII."""
        bytes_ = self.builder.load(self.builder.gep(self.bytes, [at], source_etype=I8), typ=type_, align=1)
        return self.builder.and_(bytes_, ir.Constant(type_, int.from_bytes(b"\x80" * (type_.width // 8), "little")))

    def _is_zero(self, number: ir.Value) -> ir.Value:
        return self.builder.icmp_unsigned("==", number, ir.Constant(number.type, 0))

    def _block(self, name: str) -> ir.Block:
        return self.function.append_basic_block(name)

    def _character(self, lead: ir.Block, again: ir.Block, bad: ir.Block) -> None:
        """Table 3-7: the first byte says how many follow, and narrows the range of the second.

        That excludes overlong forms, surrogates, and what lies beyond U+10FFFF.
        """
        builder = self.builder
        builder.position_at_end(lead)
        first = builder.load(self._byte(0), typ=I8, align=1)
        single, many, behind = self._block("single"), self._block("many"), self._block("behind")
        builder.cbranch(builder.icmp_unsigned("<", first, ir.Constant(I8, 0x80)), single, many)
        builder.position_at_end(single)
        self._advance(constant(1), again)
        builder.position_at_end(many)
        low = self._choose(first, ((0xE0, 0xA0), (0xF0, 0x90)), 0x80)
        high = self._choose(first, ((0xED, 0x9F), (0xF4, 0x8F)), 0xBF)
        for least, most, following in ((0xC2, 0xDF, 1), (0xE0, 0xEF, 2), (0xF0, 0xF4, 3)):
            mine, other = self._block("mine"), self._block("other")
            builder.cbranch(self._within(first, ir.Constant(I8, least), ir.Constant(I8, most)), mine, other)
            builder.position_at_end(mine)
            fine = self._following((low, high), following, bad)
            good = self._block("good")
            builder.cbranch(fine, good, bad)
            builder.position_at_end(good)
            self._advance(constant(1 + following), behind)
            builder.position_at_end(other)
        builder.branch(bad)
        builder.position_at_end(behind)
        there = self._block("there")
        builder.cbranch(builder.icmp_signed("<", self._at(), self.size), there, again)
        builder.position_at_end(there)
        builder.cbranch(builder.icmp_unsigned("<", builder.load(self._byte(0), typ=I8, align=1), ir.Constant(I8, 0x80)), again, lead)

    def _following(self, second: tuple[ir.Value, ir.Value], count: int, bad: ir.Block) -> ir.Value:
        """Whether the bytes after the first are what they must be; go to ``bad`` where the text ends before them."""
        builder = self.builder
        there = self._block("there")
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

    def _advance(self, count: ir.Value, block: ir.Block) -> None:
        self.builder.store(self.builder.add(self._at(), count, flags=("nsw",)), self.position)
        self.builder.branch(block)
