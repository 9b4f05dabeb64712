"""`python -m bench.bridge_load latency | topics | images | shared | soak`: prints what it finds."""

from __future__ import annotations

import argparse

from bench.bridge_load.endurance import soak
from bench.bridge_load.latency import latency
from bench.bridge_load.throughput import images, shared, topics

WORK = {"latency": latency, "topics": topics, "images": images, "shared": shared, "soak": soak}


def main() -> int:
    parser = argparse.ArgumentParser(prog="bench.bridge_load", description="What a running bridge adds, and what it carries.")
    parser.add_argument("work", choices=WORK)
    parser.add_argument("--seconds", type=float, help="how long, in place of 10 (topics), 5 (images, shared) or 3600 (soak)")
    arguments = parser.parse_args()
    if arguments.seconds is not None and arguments.work == "latency":
        parser.error("latency takes as long as its messages do")
    how = {} if arguments.seconds is None else {"seconds": arguments.seconds}
    for name, value in WORK[arguments.work](**how).items():
        print(f"{name:20} {value:,.3f}")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
