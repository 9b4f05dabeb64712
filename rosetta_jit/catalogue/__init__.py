"""The words of diagnostics: a function or a value for each mistake, a module for each subject. Frameworks have their own.

A function takes the place and the facts and returns a `Diagnostic`; whoever notices the mistake says no word of its own. Modules are
imported from here as a whole (`from rosetta_jit.catalogue import units`): that loads each when its words are needed, and most processes
need none.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if not TYPE_CHECKING:
    from rosetta_jit.startup.late import late_modules

    __getattr__ = late_modules(__name__)
