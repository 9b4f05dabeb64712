"""The limits of YARP's languages, Thrift and bottle schemas. docs/security.md prints them."""

from __future__ import annotations

# --- Bottle schemas -----------------------------------------------------------------------------------------------------

MAX_FORMS = 160
"""parentheses within parentheses of a bottle schema: two for each level of a message, and room for expressions"""

MAX_NESTING = 64
"""lists within lists of a bottle, below the top one: YARP has no limit and overflows its stack"""

MAX_DIGITS = 100
"""digits of a number in a bottle schema: none with more fits any field"""

MAX_TERMS = 256
"""terms of a computed value with all that it is computed from: fields can double them line by line"""

MAX_PADDING = 64
"""bytes of a `:padding`"""

MAX_KEY = 80
"""characters of a key that its field's name keeps, which leaves room to tell it from others"""

MAX_PROBLEMS = 50
"""reports of one bottle schema, after which reading stops: nobody mends more at once"""

MAX_SHOWN = 100
"""characters of a hostile name that a report repeats"""

# --- Schemas inferred from bottles --------------------------------------------------------------------------------------

MAX_PLACES = 64
"""elements of one type that get a name each; more of them become a list"""

MAX_VALUE_SHOWN = 40
"""characters of a value that a comment of an inferred schema shows"""

# --- Thrift -------------------------------------------------------------------------------------------------------------

MAX_FILES = 200
"""files that one Thrift file includes, directly or not"""

MAX_TYPE_DEPTH = 32
"""types within each other of Thrift"""

MAX_THRIFT_DIGITS = 400
"""digits of a number in a Thrift file"""

MAX_ANCESTORS = 32
"""services that one extends, directly or not"""

MAX_FUNCTIONS = 1 << 14
"""functions of all services of a Thrift file"""
