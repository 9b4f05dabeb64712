"""What the standards of the Object Management Group share: OMG IDL, and Common Data Representation."""

from __future__ import annotations

from typing import TYPE_CHECKING

if not TYPE_CHECKING:
    from rosetta_jit.startup.late import late_modules

    __getattr__ = late_modules(__name__, "diagnostics")
