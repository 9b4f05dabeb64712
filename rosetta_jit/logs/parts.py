"""Some decoded messages of a channel: one batch of them, and their times."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, TypeAlias

from rosetta_jit.errors import DecodeError
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from rosetta_jit.api.programs import Decoder
    from rosetta_jit.logs.staging import Staged
    from rosetta_jit.runtime.batch import Batch

OnError: TypeAlias = Literal["raise", "skip", "mask"]
CLOCKS = ("log_time", "publish_time")
"""The columns of times that a table has beside the fields of messages."""


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """Some decoded messages of a channel, and their times in nanoseconds since 1970.

    Attributes
    ----------
    batch
        Filled again for the next part.
    log_ns, publish_ns
        Of the messages in it.
    first
        The number of the first among all messages that are read.
    staged
        All messages as bytes, also those that ``batch.errors`` has.
    """

    batch: Batch
    log_ns: NDArray[np.int64]
    publish_ns: NDArray[np.int64]
    first: int
    staged: Staged


def decoded_staged(decoder: Decoder, staged: Staged, batch: Batch | None, on_error: OnError, first: int) -> Part:
    """Decode what is staged into a batch, if there is one already; ``first`` is the number of its first message among all.

    Raises
    ------
    DecodeError
        A message is not what its type promises; the path begins with its number among all.
    """
    try:
        batch = decoder.many(staged.data.data, staged.offsets, into=batch, on_error=on_error)
        return Part(batch, staged.log_ns[batch.kept], staged.publish_ns[batch.kept], first, staged)
    except DecodeError as error:
        number, _, path = error.path.removeprefix("[").partition("]")
        raise DecodeError(error.kind, f"[{first + int(number)}]{path}", error.detail, error.offset) from None
