"""Whether the cache may keep a program: not where it calls a function of the user's that cannot be told from another one.

Such a program is compiled whenever it is made. A note in the cache says so, and why; `rosetta-jit cache info` shows it.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable
from typing import TYPE_CHECKING

from rosetta_jit.runtime.cache.names import request_name

if TYPE_CHECKING:
    from rosetta_jit.pipeline.request import GivenFunction, Request
    from rosetta_jit.runtime.cache.kernels import Cache

MAX_REASONS = 10
"""Reasons in one note."""


def doubts(called: Iterable[GivenFunction]) -> tuple[str, ...]:
    """Why functions are not identified, before they are compiled."""
    return tuple(f"{callee.name}: {why}" for callee in called for why in callee.identity.uncertain)


def doubts_of_compiled(called: Iterable[GivenFunction], addressing: Collection[str]) -> tuple[str, ...]:
    """Why the code of functions cannot be kept that were identified, or are not: they changed meanwhile, or their code has addresses."""
    found: list[str] = []
    for callee in called:
        from rosetta_jit.catalogue import uncertain as words  # most programs call no functions
        from rosetta_jit.runtime.functions.identity import settle

        is_same = settle(callee.identity, callee.function, callee.name)
        if callee.name in addressing:
            found.append(words.address_in_code(callee.name))
        elif callee.identity.digest is not None and not is_same:
            found.append(words.changed_while_compiled(callee.name))
    return tuple(found)


def note(request: Request, cache: Cache, reasons: tuple[str, ...]) -> None:
    """Leave a note in the cache that a program is not kept, or none any more."""
    if not request.functions:
        return
    name = request_name({**request.key(), "functions": [each.name for each in request.functions]})
    if not reasons:
        cache.drop_note(name)
        return
    from rosetta_jit.catalogue import uncertain as words

    more = (words.more_reasons(len(reasons) - MAX_REASONS),) if len(reasons) > MAX_REASONS else ()
    cache.put_note(name, str(request), (*reasons[:MAX_REASONS], *more))
