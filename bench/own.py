"""`python -m bench.own MAPPING MESSAGE [--encoding ENCODING]`: what one mapping of one's own costs, beside what nobody gets below.

The message is a file of bytes as the wire has them (`rosetta-jit encode` writes such files). Its time is that of the other benchmarks: of
this thread on a processor, contenders in turns.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

import rosetta_jit as rj
from bench import contest
from bench.contest import Contender
from bench.report import tables
from bench.report.markdown import table
from bench.turns import Effort

if TYPE_CHECKING:
    from collections.abc import Sequence

    from bench.figures import Comparison

MANY_BYTES = 1 << 20
"""What `many` is given: as many copies of the message as fit in it, and one at the least."""


def decoded(effort: Effort, mapping: str, message: bytes, encoding: str | None) -> Comparison:
    """The ways to decode a message, and the limits."""
    decode = rj.Decoder(mapping, encoding=encoding)
    count = max(1, MANY_BYTES // max(1, len(message)))
    buffer, offsets = message * count, np.arange(count + 1, dtype=np.int64) * len(message)
    rows = decode.many(buffer, offsets)
    contenders = [
        Contender("a call", "ours", "a holder, used again", effort.call(decode, message)),
        Contender("a call of `builtin`", "ours", "a holder, used again", effort.call(decode.builtin, message)),
        Contender("a holder anew", "ours", "a holder", effort.call(lambda: decode.into(message, decode.new()))),
        Contender(
            "`many`", "ours", f"{count:,} rows, used again", effort.call(lambda: decode.many(buffer, offsets, into=rows), messages=count)
        ),
        *limits(effort, message),
    ]
    return contest.comparison("", "decode", contenders, contest.held(effort, contenders))


def encoded(effort: Effort, mapping: str, message: bytes, encoding: str | None) -> Comparison:
    """The ways to encode what the message holds."""
    holder, encode = rj.Decoder(mapping, encoding=encoding)(message), rj.Encoder(mapping, encoding=encoding)
    buffer = bytearray(len(encode(holder)))
    contenders = [
        Contender("into a buffer", "ours", "a message, in a buffer that is there", effort.call(encode, holder, buffer, 0)),
        Contender("bytes", "ours", "bytes, anew", effort.call(encode, holder)),
        *limits(effort, message),
    ]
    return contest.comparison("", "encode", contenders, contest.held(effort, contenders))


def limits(effort: Effort, message: bytes) -> list[Contender]:
    """A call from Python, and moving the bytes by one."""
    source, target = np.frombuffer(message, np.uint8), np.empty(len(message), np.uint8)
    return [
        Contender("len()", "limit", "a number", effort.call(len, message)),
        Contender("numpy's copy", "limit", "the message's bytes, elsewhere", effort.call(np.copyto, target, source)),
    ]


def main(given: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="bench.own", description="What decoding and encoding by one mapping cost, beside their limits.")
    parser.add_argument("mapping", help="a mapping, by its path or as the shipped ones are named")
    parser.add_argument("message", type=Path, help="a file with one message, as the wire has it")
    parser.add_argument("--encoding", help="of the wire, where the mapping's framework has several")
    parser.add_argument("--quick", action="store_true", help="few and short rounds")
    asked = parser.parse_args(given)
    effort = Effort.of(quick=asked.quick)
    try:
        message = asked.message.read_bytes()
        for measure in (decoded, encoded):
            found = measure(effort, asked.mapping, message, asked.encoding)
            print(f"{found.title}\n\n{table(*tables.contenders(found))}")
    except (rj.MappingError, rj.DecodeError, rj.EncodeError, OSError, ValueError) as error:
        print(f"bench.own: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
