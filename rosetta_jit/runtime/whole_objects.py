"""Objects that are handed over at once (`rosetta_jit.runtime.holder.objects.foreign.Whole`): what programs do with those of one class.

Such an object overwrites all that a holder has, so the holders between it and the program's bytes need not be emptied. Each function keeps
some of them, one for each thread that runs it at the same time.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rosetta_jit.runtime.limits import MAX_SPARES

if TYPE_CHECKING:
    from collections.abc import Callable

    from rosetta_jit.runtime.holder.objects.foreign import Whole


def encoding(encode: Callable[..., Any], new: Callable[[], Any], whole: Whole) -> Callable[..., Any]:
    """An encoder's call for objects of one class."""
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
