"""The limits of typelib registries and C++ headers. docs/security.md prints them."""

from __future__ import annotations

# --- Typelib registries -------------------------------------------------------------------------------------------------

MAX_ELEMENTS = 200_000
"""elements of a registry"""

MAX_TYPE_DEPTH = 32
"""arrays and containers within each other"""

MAX_NESTING = 32
"""structs and arrays within each other"""

MAX_FIELDS = 1 << 16
"""numbers that a struct unfolds to: hostile ones double at each level"""

MAX_SIZE = 1 << 30
"""bytes of a struct"""

MAX_PADDING = 256
"""bytes of padding in one place"""

MAX_PROBLEMS = 20
"""reports of one registry or header"""

# --- C++ headers --------------------------------------------------------------------------------------------------------

MAX_FILES = 200
"""files that a header includes, directly or not"""

MAX_CHARACTERS = 8 << 20
"""characters of a header with all that it includes"""

MAX_PROCESSOR_SECONDS = 4
"""seconds of processor time for a header: plain data takes some hundredths of one"""

MAX_COMPILER_BYTES = 1 << 30
"""bytes of memory that the C++ compiler takes for a header"""

MAX_DECLARATION_DEPTH = 32
"""arrays, vectors and structs of a header within each other"""

MAX_MEMBERS = 100_000
"""members of all structs"""

MAX_ERRORS = 20
"""errors of the C++ compiler that a report lists"""
