"""The limits that all readers of texts share. docs/security.md prints them."""

from __future__ import annotations

MAX_ERRORS = 20
"""syntax errors of a text, after which reading stops: later ones are mostly consequences of earlier ones"""

MAX_REMEMBERED = 64
"""files of which a process remembers what they declare"""

MAX_REMEMBERED_CHARACTERS = 16 * 1024
"""characters that one of these may have, with all that it imports"""

MAX_FILE_BYTES = 4 << 20
"""bytes of one file that a program is made from"""

MAX_TEXT_BYTES = 64 << 20
"""bytes of all files that a program is made from"""

MAX_LISTED_FILES = 1000
"""files of a folder among which the one is looked for that an import means"""
