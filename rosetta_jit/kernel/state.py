"""The words through which a kernel and the runtime talk: one int64 array a holder.

    0 valid    1 epoch    2 error site    3 lane to grow    4 missing rows    5 … 8 indices of the error's path    9 result
    10 address of the hidden lanes' words    11 how many hidden lanes there are
    12 now, in ns since 1970    13 number of the message in row 0
    14 error offset    15 about how many bytes of rows nothing refers to any more
    16 address of the registers of the program that runs
    17 + 4 k   address, capacity, used length, stride of lane k

The words of hidden lane k, 4 k words behind their address, are its address and its capacity in bytes: each kernel divides them into rows of
its own. Of a hidden lane that must grow, word 4 has the missing bytes.

Addresses and lengths are written by the runtime; a kernel writes words 2 to 8 and 14, and the used lengths. Word 9 is what a failed kernel
returned, for who called it through an entry (`backends/entry/*.ll`), which until then keeps there what it needs afterwards. Words 12 and
13 are for kernels that ask (`kernel.nodes.HostValue`), and word 16 leads kernels to what they keep from one message to the next
(`kernel.nodes.Register`).

The epoch counts the changes of the lanes. It is negative (``~epoch``) while somebody changes them, or runs a kernel on them, in a way that
another thread can interrupt: until it is positive again, nobody else may use them (`runtime.lanes.Lanes`). Kernels know nothing of it.
"""

from __future__ import annotations

VALID, EPOCH, ERROR_SITE, GROW_LANE, GROW_ROWS, ERROR_INDICES = 0, 1, 2, 3, 4, 5
CLEAN, UNSETTLED = 1, 2
"""Values of the state's word `VALID`, besides 0. An unsettled holder reads as usual, but must be settled before it is encoded: spans are
borrowed from a message, or much of the lanes is not used any more. Encoders accept 1 and leave 2 to their slow path."""

RESULT, GROW = 9, -1
"""What a failed kernel returned; `GROW` is the result of one that lacked room."""
UNUSUAL = -1 << 63
"""What the first of a kernel's bodies gives where the next one is to be asked: no place in a message, and the number of no failure."""
HIDDEN, HIDDEN_COUNT = 10, 11
NOW, NUMBER = 12, 13
ERROR_OFFSET = 14
WASTED = 15
REGISTERS = 16
INDEX_WORDS = 4
LANES, LANE_WORDS = 17, 4
ADDRESS, CAPACITY, USED, STRIDE = 0, 1, 2, 3


def lane_word(lane: int, word: int) -> int:
    """Index of one word of a lane."""
    return LANES + LANE_WORDS * lane + word


def state_words(lanes: int) -> int:
    """Length of the state of a holder with that many lanes."""
    return LANES + LANE_WORDS * lanes
