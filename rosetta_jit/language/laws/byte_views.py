"""Numbers within bytes, on the way back: what a byte of a number is that was read from bytes, and a number whose bytes were written."""

from __future__ import annotations

from collections.abc import Callable

from rosetta_jit.language.conversions import same
from rosetta_jit.language.typed import INT64, Access, Binary, Call, Const, Expr, IndexStep, Local, Place
from rosetta_jit.model.types import Float, Int

UINT8 = Int(8, signed=False)
BYTE = Local("(byte)", INT64)
"""The number of a byte while it is asked what all of them are."""


def byte_of(call: Call) -> Access | None:
    """The byte of an array or of bytes that a byte of a number is which was read there; None where it is none of those."""
    match call:
        case Call("byte", (Call() as number, nth)) if (read := _read(number)) is not None:
            place, first, size, is_big = read
            back = Binary("-", Binary("+", first, Const(size - 1, INT64), INT64), nth, INT64)
            return _at(place, back if is_big else Binary("+", first, nth, INT64))
        case _:
            return None


def number_of(call: Call, of: Callable[[Expr], Expr], read: Callable[[Access], Expr]) -> Expr | None:
    """The number whose bytes were written where a call reads one; None where that does not follow.

    ``of`` makes an expression one of what the first direction read, and ``read`` gives what it has set a place to.
    """
    found = _read(call)
    if found is None:
        return None
    place, first, size, is_big = found
    byte = read(_at(place, Binary("+", of(first), BYTE, INT64)))
    match byte:
        case Call("byte", (number, nth)) if same(number.type, call.type) and nth == _order(size, is_big=is_big):
            return number
        case _:
            return None


def _order(size: int, *, is_big: bool) -> Expr:
    """Which byte of a number comes at a place, from the lowest."""
    return Binary("-", Const(size - 1, INT64), BYTE, INT64) if is_big else BYTE


def _read(call: Call) -> tuple[Place, Expr, int, bool] | None:
    """Of a number that is read from bytes: these, its first byte, how many it has, and whether the high one comes first."""
    match call:
        case Call(function, (Access(place), first, *order)) if function.endswith("_at") and isinstance(call.type, Int | Float):
            constants = [each.value for each in order if isinstance(each, Const)]
            return None if len(constants) < len(order) else (place, first, call.type.bits // 8, constants == [True])
        case _:
            return None


def _at(place: Place, index: Expr) -> Access:
    return Access(Place(place.side, (*place.steps, IndexStep(index)), UINT8), UINT8)
