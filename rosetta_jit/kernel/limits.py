"""The limits of kernels, and of the work that passes and the proof put into them. docs/security.md prints them."""

from __future__ import annotations

# --- Kernels ------------------------------------------------------------------------------------------------------------

MAX_BLOCKS = 100
"""blocks of statements within each other"""

MAX_EXPRESSION = 100
"""operators of an expression within each other"""

MAX_DIGITS = 800
"""digits of a number in a text that are read one by one: a tie of two float64 has 767. Of further ones it counts whether all are 0"""

MAX_PLACES = 17
"""decimals that a float is written with"""

# --- Passes -------------------------------------------------------------------------------------------------------------

MAX_UNROLLED_ROUNDS = 16
"""rounds of a loop that is written out"""

MAX_UNROLLED_STATEMENTS = 64
"""statements that such a loop becomes"""

MAX_PIECE = 128
"""bytes of fields side by side that become one move without a loop"""

MAX_PIECES = 8
"""such moves that a run of fields becomes; a longer run is moved by a loop"""

MAX_PASSED = 12
"""statements between loops that become one"""

MAX_STREAMS = 6
"""arrays that such a loop goes through: the nearest cache of many processors has room for eight that begin at one place of a page"""

MAX_HOISTED_NODES = 64
"""operators of a position that is computed before its loop"""

# --- Proof --------------------------------------------------------------------------------------------------------------

MAX_POSITION = 1 << 60
"""the end of any buffer: a quarter of what 64 bits can address"""

MAX_ROWS = 1 << 48
"""rows that a lane has room for"""

MAX_LOOP_ROUNDS = 1 << 20
"""rounds of a loop that neither the message nor a value bounds"""

MAX_TERMS = 6
"""terms of a sum that gets no name: sums over many fields would cost more with each field"""

MAX_USED_TERMS = 2
"""the same of the used length of a lane, which grows with each text that is put together"""

MAX_FORMULA = 64
"""parts of a formula that is remembered: of larger ones nothing is known"""

MAX_TRIED = 8
"""facts about one unknown, the latest ones, that are tried as a summand"""

MAX_CASES = 2
"""distinctions of cases within each other"""

MAX_PROPAGATED = 4
"""terms of a sum that bounds each of its unknowns by the bounds of the others"""

MAX_PROOFS = 256
"""routines of which a process remembers that they were proven"""

MAX_Z3_STEPS = 20_000_000
"""steps that z3 takes for one question, some seconds: the answer is the same on a machine that has other work"""
