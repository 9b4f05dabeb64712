"""OROCOS: C++ headers and typelib's registries, RTT's and Rock's ways of writing C++ objects."""

from __future__ import annotations

from typing import TYPE_CHECKING

if not TYPE_CHECKING:
    from rosetta_jit.startup.late import late_modules

    __getattr__ = late_modules(__name__, "diagnostics")
