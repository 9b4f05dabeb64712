"""The limits of OMG IDL, of CORBA and of ROS 2. docs/security.md prints them."""

from __future__ import annotations

MAX_FILES = 4096
"""files that one file includes, directly or not"""

MAX_EXPANDED = 100_000
"""tokens and macros that all macros of a file become: a few lines could ask for any number"""

MAX_NESTING = 32
"""modules, structs and sequences within each other"""

MAX_TYPE_DEPTH = 32
"""arrays, sequences and maps within each other, through typedefs too"""

MAX_OPERATORS = 100
"""operators of an expression within each other: a chain of *n* operators is *n* deep"""

MAX_DIGITS = 400
"""digits of a number: the longest finite `double` without an exponent has 309"""

MAX_NAME = 512
"""characters of a qualified name: a file of *n* bytes needs no more than a small multiple of *n*"""

MAX_BASES = 64
"""interfaces among which an inherited name is looked for"""

MAX_INHERITED = 100_000
"""members that all structs of a file inherit together"""

MAX_SYNTAX_ERRORS = 20
"""syntax errors of one file, after which reading stops"""

MAX_REPORTED = 100
"""problems that one report lists"""
