"""The limits of what is remembered of texts, and of looking for the types that may have been meant. docs/security.md prints them."""

from __future__ import annotations

MAX_RECENT = 2
"""mappings and types of which a process remembers what was read and checked"""

MAX_RECENT_BYTES = 256 * 1024
"""bytes of text that one of these may have, with all that it imports"""

MAX_FILES = 5000
"""files of a folder that are looked at: a search path may have any number"""

MAX_GUESSES = 50
"""names of files in which a type may be declared"""

MAX_READ = 8
"""files that are read to say which types they declare"""
