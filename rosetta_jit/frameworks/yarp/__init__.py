"""YARP: bottles in three dialects, their schemas, and their text form."""

from __future__ import annotations

from typing import TYPE_CHECKING

if not TYPE_CHECKING:
    from rosetta_jit.startup.late import late_modules

    __getattr__ = late_modules(__name__, "diagnostics")
