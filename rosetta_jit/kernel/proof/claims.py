"""What kernels owe, each with its words: what is claimed, and what a kernel has where the claim cannot be proven."""

from __future__ import annotations

from rosetta_jit.kernel.nodes import WIDTH
from rosetta_jit.startup.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class Claim:
    """What an obligation claims, and what the kernel has where the claim cannot be proven."""

    holds: str
    otherwise: str


SIZE = Claim("the size is not negative", "a size that may be negative")
WITHIN_LANE = Claim("the bytes lie within the lane", "bytes outside the lane")
BEFORE_END = Claim("the bytes lie before the end of the message", "bytes beyond the end of the message")
AFTER_BEGIN = Claim("the bytes lie behind the begin of the message", "bytes before the begin of the message")
WITHIN_ROW = Claim("the field lies within its row", "a field outside its row")
ALIGNED = Claim("the field is aligned", "a field that is not aligned")
OFFSET = Claim("the offset is not negative", "a negative offset")
BELOW_CAPACITY = Claim("the row is less than the lane's capacity", "a row outside its lane")
ROW_NUMBER = Claim("the row is not negative", "a row that may be negative")
LANE = Claim("the lane exists", "no such lane")
DIVISOR = Claim("the divisor is not zero", "a division that may be by zero")
QUOTIENT = Claim("the quotient does not wrap", "a division that may overflow")
SHIFT = Claim("the shift is less than the width", "a shift by the width or more")
POSITION = Claim("the position is not negative", "a position that may be negative")
WITHIN_TABLE = Claim("the table has a value of that number", "a value that the table may not have")
APART = Claim("target and source do not overlap", "a copy onto itself")
FILLED_APART = Claim("the function does not fill what it reads", "a function that fills what it reads")
ROW_COUNT = Claim("the count of rows is not negative", "a count of rows that may be negative")
RESERVED = Claim("the rows were reserved", "rows that were not reserved")
RETURNS = Claim("every path ends with a Return", "a path ends without Return")
BOUNDED = Claim("something that the loop does not change bounds its measure", "a loop that nothing bounds")
PROGRESS = Claim("the round makes progress", "a round that makes no progress")
INVARIANT_KEPT = Claim("the round keeps the invariant", "an invariant that a round breaks")
INVARIANT_FIRST = Claim("the invariant holds before the first round", "an invariant that does not hold at first")
PROMISE = Claim("the routine keeps its promise", "a routine that may break its promise")
DEMANDS = Claim("the call gives what the routine requires", "a call that asks for what may not be there")

UNREACHABLE = Claim("no message takes this path", "a path that a message takes")
RELATION_FIRST = Claim("what is inferred of the loop holds before the first round", "a relation that does not hold at first")
RELATION_KEPT = Claim("the round keeps what is inferred of the loop", "a relation that a round breaks")
ALL_PATHS = Claim("what is known where paths meet holds on each of them", "a fact that one of the paths breaks")
OPERATION = Claim("what is known of the operation holds", "a fact that an operation breaks")
BOUNDS = Claim("the bounds of the sum hold", "a sum beyond its bounds")
"""The last six are claims of the proof itself: it proves what it infers, or leaves it out."""

NO_WRAP = {type_: Claim(f"the {type_} arithmetic does not wrap", f"{type_} arithmetic that may wrap") for type_ in WIDTH}
"""That arithmetic of a type stays within its range."""
