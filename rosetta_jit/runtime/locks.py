"""Locks of the whole process, for what its threads make once and share. None is held while anything but our own code runs."""

from __future__ import annotations

import os
from _thread import RLock
from typing import TYPE_CHECKING, Any, cast

if TYPE_CHECKING:
    from contextlib import AbstractContextManager


def shared_lock() -> AbstractContextManager[object]:
    """A lock that the child of a fork finds free: the thread that held it in the parent is not there to give it back."""
    lock = RLock()
    if hasattr(os, "register_at_fork"):
        os.register_at_fork(after_in_child=cast("Any", lock)._at_fork_reinit)  # noqa: SLF001 - as the standard library does
    return lock
