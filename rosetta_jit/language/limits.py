"""The limits of the mapping language: what keeps a compiler's time and memory in proportion to the text. docs/security.md prints them."""

from __future__ import annotations

# --- A mapping's text ---------------------------------------------------------------------------------------------------

MAX_CHARACTERS = 1 << 20
"""characters of a mapping"""

MAX_TOKENS = 50_000
"""words and signs of a mapping: some sixteen thousand rules, which take seconds"""

MAX_IMPORTS = 200
"""imports of a mapping"""

MAX_NESTING = 64
"""brackets and blocks within each other, operators of an expression, steps of a path"""

MAX_STATE = 64
"""state variables of a mapping"""

MAX_WIRES = 16
"""wires of a mapping"""

MAX_SIGNAL_BYTES = 64
"""bytes of a frame of signals: as many as CAN FD has"""

MAX_LIMIT = 1 << 40
"""bytes that a `limit` allows"""

MAX_LIMIT_DIGITS = 20
"""digits of the number of a `limit`"""

MAX_DIGITS = 400
"""digits of a number: a float64 has at most 309 before its point"""

MAX_PIECES = 20
"""values in the text of a `reject`, and texts before, between and behind them"""

MAX_VALUE_TOKENS = 64
"""words and signs of a value in such a text"""

MAX_UNIT_FIELDS = 5000
"""fields of a file of units"""

MAX_UNIT_STEPS = 64
"""steps of a path in a file of units"""

MAX_UNIT_PROBLEMS = 50
"""reports of one file of units"""

MAX_UNIT = 64
"""characters of the name of a unit"""


# --- Other files --------------------------------------------------------------------------------------------------------

MAX_MAPPINGS = 64
"""mappings that one mapping uses, those that they use included"""

MAX_USES = 1000
"""uses of mappings in all: each is a copy of their rules"""

MAX_COPIED = 10_000
"""rules that all uses of mappings copy"""

MAX_VIA_DEPTH = 16
"""the number of `to depth`"""


# --- Parameters and lists -----------------------------------------------------------------------------------------------

MAX_ITEMS = 500
"""items of a list, of a parameter or in the text"""

MAX_PARAMETER_BYTES = 1000
"""bytes of a parameter's text"""

MAX_LIST_BYTES = 20_000
"""bytes of all texts of a list"""

MAX_CHOSEN = 5000
"""items of all lists at all places where one of them is chosen"""

MAX_SINGLE = 32
"""items of a list of constants that are assigned one by one"""

MAX_PARAMETERS = 32
"""parameters of a declared function"""


# --- Rules --------------------------------------------------------------------------------------------------------------

MAX_PROBLEMS = 200
"""reports of one mapping after which no more rules are looked at: most of them say the same"""

MAX_DEFAULTS = 1_000
"""fields that one `default` sets"""

MAX_DEFAULT_DEPTH = 20
"""structs within each other that a `default` looks into"""

MAX_MADE = 1000
"""rules that `[]`, slices and orders of a block come to"""

MAX_LISTED = 256
"""elements named by `.a[[…]]` and `permuted`"""

MAX_KNOWN_COUNT = 1 << 62
"""a count that is computed beforehand: larger ones stay written out, and are refused where they are typed"""

MAX_KINDS = 500
"""kinds of elements that are told apart by their units"""

MAX_WHOLE_DEPTH = 20
"""values within each other whose units are looked at in a whole one"""

MAX_WHOLE_VALUES = 10_000
"""values whose units are looked at in a whole one"""

MAX_CHECKED_WAYS = 64
"""ways through a block by `when`"""

MAX_ELEMENTS_SHOWN = 8
"""elements that a report names"""

MAX_NAME = 200
"""characters of a file name that a report shows"""

MAX_LABELS = 5_000
"""labels that all values of discriminators together are compared with"""


# --- Expressions --------------------------------------------------------------------------------------------------------

MAX_CASES = 500
"""keys of a table of numbers"""

MAX_TEXT_CASES = 50
"""keys of a table of texts"""

MAX_COMPARED = 64
"""bytes of a text that a field is compared with"""

MAX_PATTERN = 64
"""bytes of a text that another is searched for"""

MAX_PADDED = 1 << 16
"""bytes that `padded` fills"""

MAX_WRITTEN = 4096
"""bytes of a text in quotes that is computed with"""

MAX_OTHERS = 16
"""numbers that `others` leaves out"""

MAX_DECIMALS = 17
"""decimals that `text` writes"""

MAX_KEY_SHOWN = 80
"""characters of a key that an error shows"""


# --- Both directions and laws -------------------------------------------------------------------------------------------

MAX_CONDITIONS = 8
"""conditions within each other that choose among fields which are parts of one value"""

MAX_BLOCKS = 200
"""blocks that conditions in expressions are split into: a sum of them doubles with each"""

MAX_TOGETHER = 6
"""fields that relations of their sums are solved for together"""

MAX_PARTS = 100_000
"""parts of all expressions that are put in place of fields"""

MAX_TESTED = 16
"""constants of one block that a field is compared with"""

MAX_ATOMS = 1000
"""atoms of a polynomial: products of sums and nested substitutions grow exponentially"""

MAX_ATOM_DEPTH = 40
"""atoms within arguments of atoms: every walk over them is recursive"""

MAX_SUBSTITUTED = 20
"""numbers that are put in the place of others"""

MAX_WORK = 200_000
"""rules of the second direction, times ways through the first one, that are followed"""

MAX_LOOPS = 6
"""loops within each other that laws look at"""

MAX_WAYS = 64
"""ways through the first direction that laws follow"""

MAX_LOOKED = 300
"""rules for one field that laws look at"""

MAX_ORDERED = 1_000
"""rules in loops that are compared with other loops"""
