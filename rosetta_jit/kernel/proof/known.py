"""Proofs of routines that need not be made again: whoever has a place to keep them says so."""

from __future__ import annotations

from collections.abc import Callable, Generator
from contextlib import contextmanager
from contextvars import ContextVar

Prove = Callable[[], None]
"""Makes a proof; raises where there is none."""

Keeper = Callable[[str, Prove], None]
"""Makes the proof of what a text claims, unless it is known to have been made."""

_keeper: ContextVar[Keeper | None] = ContextVar("keeper", default=None)


@contextmanager
def kept_by(keeper: Keeper) -> Generator[None]:
    """Inside, this one is asked for proofs of routines."""
    token = _keeper.set(keeper)
    try:
        yield
    finally:
        _keeper.reset(token)


def once(claim: object, prove: Prove) -> None:
    """Make a proof of a claim, whose repr says all that the proof depends on, unless it is known."""
    keeper = _keeper.get()
    if keeper is None:
        prove()
    else:
        keeper(repr(claim), prove)
