"""Objects of which each process has one. Sockets and threads do not survive a fork, so a forked process makes its own."""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import cache
from typing import TypeVar

T = TypeVar("T")


def per_process(make: Callable[[], T]) -> Callable[[], T]:
    """A function that returns the one object of this process, and makes it at the first call."""

    @cache
    def of_process(_: int) -> T:
        return make()

    return lambda: of_process(os.getpid())
