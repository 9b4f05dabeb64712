"""The limits of `.proto` files and of schemas inferred from messages. docs/security.md prints them."""

from __future__ import annotations

# --- Files --------------------------------------------------------------------------------------------------------------

MAX_FILES = 4096
"""files that one `.proto` file imports, directly or not"""

MAX_NESTING = 32
"""messages within messages, and lists and messages within the value of an option, as in protoc"""

MAX_DIGITS = 40
"""digits of an integer: no integer of the language has more, and converting takes quadratic time"""

MAX_NAME = 512
"""characters of an absolute name: a file of *n* bytes needs no more than a small multiple of *n*"""

MAX_COMMENT = 4000
"""characters of a comment that are searched for units"""

# --- Reports ------------------------------------------------------------------------------------------------------------

MAX_SYNTAX_ERRORS = 20
"""syntax errors of one file, after which reading stops"""

MAX_REPORTED = 100
"""problems that one report lists"""

MAX_SHOWN = 40
"""characters of a wrong name that a report repeats"""

# --- Schemas inferred from messages -------------------------------------------------------------------------------------

MAX_INFERRED_DEPTH = 16
"""messages within messages that are looked into"""

MAX_INFERRED_FIELDS = 1_000
"""fields of one message type"""
