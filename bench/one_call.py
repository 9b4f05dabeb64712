"""Run as a program: what one call takes in this new process, in multiples of `len()`, measured in turns; prints them as JSON.

`python -m bench.one_call FOLDER` leaves its mappings in a folder. A process keeps its luck with where code and data lie, so that one alone
says what a call takes there, not what calls take.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import rosetta_jit as rj
from bench.figures import ratio
from bench.messages import joints_mapping, specialised, tagged
from bench.turns import Effort

EFFORT = Effort(rounds=9, round_s=0.01, quick=False)
LEN = "len()"
MESSAGES = {"24 specialised doubles": (24, specialised(24)), "16 tagged doubles": (16, tagged(16))}


def main(folder: Path) -> dict[str, dict[str, float]]:
    """By message and what is called: the median of the rounds."""
    return {what: _ratios(joints_mapping(count, folder), message) for what, (count, message) in MESSAGES.items()}


def _ratios(mapping: Path, message: bytes) -> dict[str, float]:
    decode, encode = rj.Decoder(mapping, encoding="yarp3"), rj.Encoder(mapping, encoding="yarp3")
    timed = {
        "builtin": EFFORT.call(decode.builtin, message),
        "decode": EFFORT.call(decode, message),
        "encode": EFFORT.call(encode, decode.into(message, decode.new())),
        LEN: EFFORT.call(len, message),
    }
    taken = EFFORT.in_turns(timed)
    return {who: ratio(rounds, taken[LEN]).median for who, rounds in taken.items()}


if __name__ == "__main__":
    print(json.dumps(main(Path(sys.argv[1]))))
