"""Objects that a process has one of: sockets and threads are of no use behind a fork, so a forked process makes its own."""

from __future__ import annotations

import os
from functools import cache
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable

T = TypeVar("T")


def per_process(make: Callable[[], T]) -> Callable[[], T]:
    """What gives the one object of this process, which is made when it is first asked for."""

    @cache
    def of_process(_: int) -> T:
        return make()

    return lambda: of_process(os.getpid())
