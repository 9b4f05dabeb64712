"""What a mapping asks of the program: the time, and functions that it declares."""

from __future__ import annotations

from collections.abc import Callable
from time import time_ns as _time_ns
from typing import Any

now: Callable[[], int] = _time_ns
"""What `now()` says in the mapping: ns since 1970."""

functions: dict[str, Callable[..., Any]] = {}
"""The functions that the mapping declares, which you give by name. One that raises `Refused` refuses the message."""


class Refused(Exception):  # noqa: N818 - an answer, no error
    """A function of yours does not accept its arguments."""
