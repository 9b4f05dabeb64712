"""Run as a program: threads share what they should not, for some seconds; what they get must be right, or `InUse`.

`python -m tests.api.sharing KIND SECONDS` prints how often each thread got a right value and how often an error. A wrong value ends it with
exit code 1, and memory that two of them use at once ends it in whatever way the system has.
"""

from __future__ import annotations

import faulthandler
import sys

from tests.api.sharing.turns import KINDS, Turns


def main(name, seconds):
    faulthandler.enable()
    sys.setswitchinterval(1e-6)
    turns = Turns(seconds)
    KINDS[name](turns)
    print(turns.counts)
    assert any(right for right, _ in turns.counts.values()), "where all are refused each time, nothing is shown"


if __name__ == "__main__":
    main(sys.argv[1], float(sys.argv[2]))
