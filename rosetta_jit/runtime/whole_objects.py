"""Objects that are handed over at once (`rosetta_jit.runtime.holder.objects.foreign.Whole`), or by compiled code that sets all fields
(`rosetta_jit.runtime.holder.objects.steps`): what programs do with those of one class.

Such an object overwrites all that a holder has, so the holders between it and the program's bytes need not be emptied. Each function keeps
some of them, one for each thread that runs it at the same time.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rosetta_jit.runtime.attributes.code import functions, library
from rosetta_jit.runtime.attributes.handing import handing
from rosetta_jit.runtime.holder.objects.foreign import Whole
from rosetta_jit.runtime.holder.objects.steps import LEFT, Steps
from rosetta_jit.runtime.limits import MAX_SPARES


def encoding(encode: Callable[..., Any], new: Callable[[], Any], whole: Whole, *, is_plain: bool) -> Callable[..., Any]:
    """An encoder's call for objects of one class. ``is_plain`` says that it writes their own bytes as they are, once these are checked."""
    take, spares = whole.take, list[Any]()

    def call(value: object, *more: object) -> Any:
        try:
            holder = spares.pop()
        except IndexError:
            holder = new()
        try:
            take(holder, value)
            return encode(holder, *more)
        finally:
            if len(spares) < MAX_SPARES:
                spares.append(holder)

    if library() is None:
        return call
    check = None if is_plain and whole.is_exact else whole.programs.decode
    last = None if is_plain else encode
    return handing("hand_in", decode=check, encode=last, new=new, over=whole.bytes_of, slow=call, in_c=whole.in_c)


def encoding_by_steps(
    encode: Callable[..., Any], new: Callable[[], Any], steps: Steps, otherwise: Callable[..., Any]
) -> Callable[..., Any]:
    """The same where compiled code takes the objects; ``otherwise`` encodes those that it leaves to Python.

    Holders are emptied in between nevertheless: texts and arrays that are assigned again and again would leave gaps.
    """
    take, spares = functions()["take_anew"], list[tuple[Any, bytes]]()

    def call(value: object, *more: object) -> Any:
        try:
            spare = spares.pop()
        except IndexError:
            made = new()
            spare = made, made.lanes_.plan.fresh
        holder, fresh = spare
        try:
            taken = take(steps.table, holder, value, fresh)
        except LEFT:
            taken = False
        if not taken:
            return otherwise(value, *more)
        try:
            return encode(holder, *more)
        finally:
            if len(spares) < MAX_SPARES:
                spares.append(spare)

    return call


def decoding(decode: Callable[..., Any], new: Callable[[], Any], make: Callable[[Any], Any]) -> Callable[[Any], Any]:
    """A decoder's `to` for one class, whose objects ``make`` makes of a holder."""
    spares = list[Any]()

    def to(message: Any) -> Any:
        try:
            holder = spares.pop()
        except IndexError:
            holder = new()
        try:
            return make(decode(message, holder))
        finally:
            if len(spares) < MAX_SPARES:
                spares.append(holder)

    return to


def decoding_whole(decode: Callable[..., Any], new: Callable[[], Any], whole: Whole, *, is_plain: bool) -> Callable[[Any], Any]:
    """The same of a class whose objects are handed over at once. ``is_plain`` says that messages are bytes of which objects can be made."""
    slow = decoding(decode, new, whole.make)
    if library() is None:
        return slow
    check = None if is_plain and whole.is_exact else decode
    last = None if is_plain else whole.programs.encode
    return handing("hand_out", decode=check, encode=last, new=new, over=whole.of_bytes, slow=slow, in_c=whole.in_c)
