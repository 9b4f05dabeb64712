"""The limits of looking for the types that may have been meant. docs/security.md prints them."""

from __future__ import annotations

MAX_FILES = 5000
"""files of a folder that are looked at: a search path may have any number"""

MAX_GUESSES = 50
"""names of files in which a type may be declared"""

MAX_READ = 8
"""files that are read to say which types they declare"""
