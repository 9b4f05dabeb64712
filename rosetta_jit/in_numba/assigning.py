"""Numbers that compiled functions assign, ``holder.header.seq = 7``: `rosetta_jit.runtime.holder.arena`, in LLVM where it is short.

An assignment makes the field present, and the messages around it. Presence that is one bit is set here; a union that enters another case,
a message that has something of fixed length, and a discriminator, which selects the case of a union, are left to Python.

Numba converts the number to the field's type before this code sees it, as where an element of an array is assigned.
"""

from __future__ import annotations

from collections.abc import Callable
from ctypes import CFUNCTYPE, c_int64, py_object
from functools import cache
from typing import TYPE_CHECKING, Any, cast

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.errors import NumbaTypeError
from numba.extending import lower_setattr_generic

from rosetta_jit.backends.llvm.values import I64, constant
from rosetta_jit.in_numba.c_call import call_c
from rosetta_jit.in_numba.reading import Reader, cell_type
from rosetta_jit.in_numba.types import MessageType
from rosetta_jit.model.types import Bool, Enum
from rosetta_jit.runtime.holder import arena
from rosetta_jit.runtime.holder.record import Bit, Choice, Presence, Scalar
from rosetta_jit.runtime.lanes import Lanes

if TYPE_CHECKING:
    from numba.core.base import BaseContext
    from numba.core.typing.templates import Signature

    from rosetta_jit.in_numba.ownership import Taken

NO_ENUMERATOR = "a closed enum has no such value"
NO_MEMORY = "there is no memory for what an assignment makes present"

_CHANGE = CFUNCTYPE(c_int64, py_object, c_int64)
"""A change of a holder in Python: given what has taken the holder, and a row; whether there was memory for it."""


class _Assignment(Reader):
    """What prints code that assigns to one field of a message."""

    def run(self, node: Scalar, presences: tuple[Presence | None, ...], value: ir.Value) -> None:
        """Check the value, make the field present and store it."""
        self.check_valid()
        self.check_enumerator(node, value)
        row = self.value.row
        for presence in presences:
            if presence is not None:
                self.mark(presence, row)
        stored = self.context.cast(self.builder, value, types.boolean, types.uint8) if isinstance(node.type, Bool) else value
        self.builder.store(stored, self.cell_address(node.cell, row))
        if node.choice is not None:
            self.change(_chooser(node.choice), row)

    def check_enumerator(self, node: Scalar, value: ir.Value) -> None:
        """Raise where a closed enum has no such value."""
        if not (isinstance(node.type, Enum) and node.type.closed):
            return
        known: ir.Value = cgutils.false_bit
        for number in dict.fromkeys(number for _, number in node.type.values):
            same = self.builder.icmp_signed("==", value, ir.Constant(cell_type(node.cell), number))
            known = self.builder.or_(known, same)
        self.refuse_if(self.builder.not_(known), NO_ENUMERATOR, ValueError)

    def mark(self, presence: Presence, row: ir.Value) -> None:
        """Make a field present."""
        if isinstance(presence, Bit) and not presence.initial:
            place = self.cell_address(presence.cell, row)
            self.builder.store(self.builder.or_(self.builder.load(place, typ=I64), ir.Constant(I64, presence.mask)), place)
            return
        with cgutils.if_unlikely(self.builder, self.builder.not_(self.is_present(presence, row))):
            self.change(_marker(presence), row)

    def change(self, function: object, row: ir.Value) -> None:
        """Let Python change a row."""
        done = call_c(self.context, self.builder, function, I64, [self.value.taken, row])
        self.refuse_if(self.builder.icmp_signed("==", done, constant(0)), NO_MEMORY, MemoryError)


@cache
def _marker(presence: Presence) -> Any:
    """The C function that makes a field present, as long as the process lives: its address stands in compiled code."""
    return _changer(lambda lanes, row: arena.mark(lanes, presence, row))


@cache
def _chooser(choice: Choice) -> Any:
    """The same for the case of a union that a discriminator selects."""
    return _changer(lambda lanes, row: arena.choose(lanes, choice, row))


def _changer(change: Callable[[Lanes, int], None]) -> Any:
    def changed(taken: Taken, row: int) -> int:
        try:
            change(taken.lanes, row)
        except MemoryError:
            return 0
        taken.keep_memory()
        return 1

    return _CHANGE(changed)


@lower_setattr_generic(MessageType)
def _assign(context: BaseContext, builder: ir.IRBuilder, signature: Signature, arguments: list[ir.Value], name: str) -> ir.Value:
    type_ = cast("MessageType", signature.args[0])
    entry = type_.record.entries[name]
    if not isinstance(entry.node, Scalar):
        raise NumbaTypeError(
            f"`{name}` of `{type_.record.struct}` is no number: compiled code assigns numbers, and elements of arrays of numbers"
        )
    _Assignment(context, builder, type_, arguments[0]).run(entry.node, (*type_.record.touch, entry.presence), arguments[1])
    return context.get_dummy_value()
