"""The words of diagnostics: a function or a value for each mistake, a module for each subject. Frameworks have their own.

A function takes the place and the facts and returns a `Diagnostic`; whoever notices the mistake says no word of its own. Modules are
imported from here as a whole (`from rosetta_jit.catalogue import units`): that loads each when its words are needed, and most processes
need none.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if not TYPE_CHECKING:
    from rosetta_jit.startup.late import Late

    def __getattr__(name):
        if name.startswith("_"):
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        return Late(f"{__name__}.{name}")
