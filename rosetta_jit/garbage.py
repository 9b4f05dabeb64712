"""Fewer searches for garbage while a program is made: a compiler makes objects by the hundred thousand, and hardly a cycle among them."""

from __future__ import annotations

import gc
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Generator

SELDOM = 200_000
"""New objects between two searches; Python's own 700 make searches an eighth of the time. What is garbage meanwhile stays bounded."""


@contextmanager
def seldom_collected() -> Generator[None]:
    """Inside, Python looks for garbage seldom; where it looks seldom or never as it is, this changes nothing.

    Threads may be inside at once: who comes first says what holds, until he leaves.
    """
    before = gc.get_threshold()
    if not 0 < before[0] < SELDOM:
        yield
        return
    gc.set_threshold(SELDOM, *before[1:])
    try:
        yield
    finally:
        gc.set_threshold(*before)
