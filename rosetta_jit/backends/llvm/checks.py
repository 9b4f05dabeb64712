"""Shapes of long kernels on which LLVM would spend more than linear time: very many checks of one value, very many stores in one block.

Values that very many checks ask about, one check after another, are other values to LLVM from time to time.

Of each value LLVM remembers all that was asked of it before, and goes through that again for the next question: of a thousand checks it
would make a million. An instruction that does nothing, but may do anything for all that LLVM knows, ends its memory. So it does for
stores, each of which LLVM compares with all before it. What a stretch of stores needs of the message is loaded where the stretch
begins: to make one load of several, LLVM goes through all that stands between them and their stores.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, cast

from llvmlite import ir

from rosetta_jit.backends.llvm import stmt as llvm_stmt
from rosetta_jit.backends.llvm.frame import Frame, Variable
from rosetta_jit.backends.llvm.values import F32, F64, I32, I64, forgotten
from rosetta_jit.kernel.nodes import Block, Expect, Fill, If, Let, Load, Require, Return, SetField, Stmt, Store
from rosetta_jit.kernel.rewrite import locals_in
from rosetta_jit.kernel.walk import expressions_of
from rosetta_jit.startup.late import late

if TYPE_CHECKING:
    from rosetta_jit.backends.llvm import outline, vectors
else:
    outline, vectors = late("rosetta_jit.backends.llvm", "outline", "vectors")

OFTEN = 64
"""Checks of one value from which on it is another one."""

STORES = 128
"""Stores one behind another among which LLVM may look for those that belong together."""

ANY_MEMORY = ir.FunctionType(ir.VoidType(), [])
"""The type of an instruction that does nothing, but may write to all memory for all that LLVM can tell."""

STRAIGHT = Let | Require | Expect | SetField | Fill | Return
"""The statements of a body that stores nothing in the message, and runs through."""

BITS: dict[ir.Type, ir.Type] = {I32: I32, I64: I64, F32: I32, F64: I64}
"""The types of values that fit in a register, and the integers of their size."""


def body(frame: Frame, statements: Block, *, in_vectors: bool = False) -> None:
    """Print a body's statements; if ``in_vectors``, what is computed for stores side by side together."""
    reads: Counter[str] = Counter()
    stores = 0
    many = sum(isinstance(each, Expect | If) for each in statements) > OFTEN
    parts = llvm_stmt.parts(frame, statements)
    print_part = cast("Callable[[Frame, vectors.Part], None]", vectors.print_part if in_vectors else llvm_stmt.print_part)
    for part in _in_stretches(vectors.joined(statements, parts, frame.strides) if in_vectors else parts):
        print_part(frame, part)
        stores += isinstance(part, SetField | Store)
        if stores == STORES and not frame.builder.block.is_terminated:
            frame.builder.asm(ANY_MEMORY, "", "~{memory}", [], side_effect=True)
            stores = 0
        if many and isinstance(part, Expect | If):
            reads.update(locals_in(part.condition))
            for name in [name for name, times in reads.items() if times >= OFTEN]:
                _renew(frame, name)
                del reads[name]


def _in_stretches(parts: Sequence[vectors.Part]) -> Iterator[vectors.Part]:
    """The same parts; what stands at a known place of the message is loaded at the begin of the stretch of stores that first needs it."""
    straight = [each for each in parts if isinstance(each, STRAIGHT)]
    if len(straight) < len(parts) or sum(isinstance(each, SetField) for each in straight) <= STORES:
        yield from parts
        return
    loads, stretch, stores = dict[str, Let](), list["Stmt"](), 0
    for part in straight:
        if isinstance(part, Let) and isinstance(part.value, Load) and locals_in(part.value) <= outline.FIXED:
            loads[part.name] = part
            continue
        stretch.append(part)
        stores += isinstance(part, SetField)
        if stores == STORES:
            needed = set[str]().union(*(locals_in(expr) for each in stretch for expr in expressions_of(each)))
            yield from [loads.pop(name) for name in [*loads] if name in needed]
            yield from stretch
            stretch, stores = [], 0
    yield from loads.values()
    yield from stretch


def _renew(frame: Frame, name: str) -> None:
    """Give a local a value that LLVM knows nothing of."""
    value = frame.locals.get(name)
    if value is None or isinstance(value, Variable) or frame.builder.block.is_terminated:
        return
    bits = BITS.get(value.type)
    if bits is not None and not isinstance(value, ir.Constant | ir.Argument):
        number = frame.builder.bitcast(value, bits)
        frame.locals[name] = frame.builder.bitcast(forgotten(frame.builder, number), value.type)
