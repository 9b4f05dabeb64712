"""How full a store is, without a look at every file of it: a file in which each writer notes what it wrote.

    usage  = record*
    record = u64, little-endian: the bytes of one file that was written or, with the highest bit set, of all files that a look found

Whoever looks at all files empties the usage first and notes the total afterwards: what others write meanwhile is rather counted twice than
never. Whatever is wrong with the usage costs a look, and so does every 256th record: what it says is not believed for long.
"""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING

from rosetta_jit.runtime.limits import MAX_USAGE_RECORDS

if TYPE_CHECKING:
    from rosetta_jit.runtime.cache.stores import Store

USAGE = "usage"
TOTAL = 1 << 63
_RECORD = struct.Struct("<Q")


def note(store: Store, size_bytes: int, *, max_bytes: int) -> bool:
    """Note that a file was written; whether all files may be larger now than they should be."""
    noted = store.append(USAGE, _RECORD.pack(size_bytes), limit=MAX_USAGE_RECORDS * _RECORD.size)
    if noted is None or len(noted) % _RECORD.size:
        return True
    records = [record for (record,) in _RECORD.iter_unpack(noted)]
    totals = [record - TOTAL for record in records if record >= TOTAL]
    return not totals or max(totals) + sum(record for record in records if record < TOTAL) > max_bytes


def begin_look(store: Store) -> None:
    """From here on, what is written is noted beside the total to come."""
    store.write(USAGE, b"")


def end_look(store: Store, total_bytes: int) -> None:
    """Note what all files take."""
    store.append(USAGE, _RECORD.pack(TOTAL + total_bytes), limit=MAX_USAGE_RECORDS * _RECORD.size)
