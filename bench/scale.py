"""What a million logs cost on a thousand machines: `python -m bench.scale` measures rates here, and simulates the rest.

The simulation goes from event to event. A driver hands out logs one after another, each to the core that is free first. A core opens a log
by some requests, and then reads and decodes it piece by piece, by requests of the size that fsspec reads at once. The cores of a machine
share its network, and all machines what the object storage gives. Now and then a machine is lost, and what its cores read is read again.

Rates of decoding are measured. What machines, networks and requests do and cost is assumed: see `World`.
"""

from __future__ import annotations

import heapq
import random
import sys
import tempfile
import time
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import rosetta_jit as rj

if TYPE_CHECKING:
    from collections.abc import Iterator

GIGA = 1e9
REPLACED_S = 60.0
"""Until another machine has taken the place of one that is lost."""


@dataclass(frozen=True, slots=True)
class World:
    """What is assumed.

    Attributes
    ----------
    decode_s
        Seconds of a core for a gigabyte of a log.
    network, storage
        Bytes a second of a machine, and of the object storage for all of them.
    latency_s, read
        Of a request, and the bytes that one reads.
    opening
        Requests that open a log.
    dispatch
        Logs a second that the driver hands out; ``listed`` are the names a second that a listing gives.
    lost_s
        Seconds from one loss of a machine to its next.
    hour, requests
        Dollars for an hour of a machine, and for a million requests.
    """

    decode_s: float
    logs: int = 1_000_000
    size: float = 10 * GIGA
    machines: int = 1000
    cores: int = 32
    network: float = 25e9 / 8
    storage: float = 1e12
    latency_s: float = 0.03
    read: float = 5 * 2**20
    opening: int = 5
    dispatch: float = 1000.0
    listed: float = 10_000.0
    lost_s: float = 30 * 86_400.0
    hour: float = 1.5
    requests: float = 0.4


@dataclass(frozen=True, slots=True)
class Outcome:
    """What came of it: seconds, dollars for machines and for requests, logs that were read again, and what most of the time went for."""

    seconds: float
    machines: float
    requests: float
    again: int
    limit: str


def parts(world: World) -> dict[str, float]:
    """Seconds of a core for one log, by what it waits for; reading and decoding overlap, since one thread reads ahead."""
    bandwidth = min(world.network / world.cores, world.storage / (world.machines * world.cores))
    reads = world.size / world.read
    transfer, waiting = world.size / bandwidth, reads * world.latency_s
    limit = "storage" if world.storage < world.network * world.machines else "network"
    return {limit: transfer, "latency of requests": waiting, "decoding": world.size / GIGA * world.decode_s}


def simulated(world: World, seed: int = 0) -> Outcome:
    """One job."""
    took = parts(world)
    decoding = took.pop("decoding")
    a_log = world.opening * world.latency_s + max(decoding, sum(took.values()))
    free = [(0.0, core) for core in range(world.machines * world.cores)]
    dice, again, end = random.Random(seed), 0, 0.0  # noqa: S311 - nobody is to be kept from guessing
    losses = [[dice.expovariate(1 / world.lost_s)] for _ in range(world.machines)]
    handed, listed = 0.0, 0.0
    waiting = world.logs
    while waiting:
        waiting -= 1
        listed += 1 / world.listed
        handed = max(handed + 1 / world.dispatch, listed)
        begin, core = heapq.heappop(free)
        begin = max(begin, handed)
        done, lost = begin + a_log * dice.uniform(0.9, 1.1), losses[core // world.cores]
        while lost[-1] < done:
            lost.append(lost[-1] + dice.expovariate(1 / world.lost_s))
        moment = next((each for each in lost if begin < each < done), None)
        if moment is not None:
            again, waiting = again + 1, waiting + 1
            done = moment + REPLACED_S
        end = max(end, done)
        heapq.heappush(free, (done, core))
    everything = {**took, "decoding": decoding, "handing out logs": handed * world.machines * world.cores / world.logs}
    calls = world.logs * (world.opening + world.size / world.read)
    dollars = world.machines * world.hour * end / 3600
    return Outcome(end, dollars, calls / 1e6 * world.requests, again, max(everything, key=everything.__getitem__))


def measured(make: Any, rounds: int = 5) -> float:
    """Seconds of processor for a gigabyte of a log into Arrow, at best."""
    with tempfile.TemporaryDirectory() as folder:
        path: Path = make(Path(folder) / "a.mcap")
        channel, best = rj.open(path)[rj.open(path).topics[0]], float("inf")
        for _ in range(rounds):
            begin = time.process_time()
            assert sum(table.num_rows for table in channel.tables())
            best = min(best, time.process_time() - begin)
        return best * GIGA / path.stat().st_size


def rates() -> dict[str, float]:
    """Of a log of point clouds, and of one of small messages that are compressed."""
    from bench.subjects import POINT_CLOUD_2
    from bench.test_large_logs import uncompressed
    from bench.test_logs import mcap_file

    clouds, imus = partial(uncompressed, subject=POINT_CLOUD_2, size=300_000_000), partial(mcap_file, count=100_000)
    return {"point clouds": measured(clouds), "Imus, zstd": measured(imus)}


def cases(decode: dict[str, float]) -> Iterator[tuple[str, World]]:
    """What is asked."""
    for what, seconds in decode.items():
        yield f"{what}", World(seconds)
    base = World(decode["Imus, zstd"])
    yield "the same, requests of 64 MB", replace(base, read=64 * 2**20)
    yield "and storage that gives 10 TB/s", replace(base, read=64 * 2**20, storage=1e13)
    yield "and a driver that hands out 100 logs a second", replace(base, read=64 * 2**20, storage=1e13, dispatch=100.0)
    yield "and a machine that is lost each day", replace(base, read=64 * 2**20, storage=1e13, lost_s=86_400.0)
    yield "a million logs of 10 MB", replace(base, size=10e6)


def main() -> int:
    """Print a table."""
    decode = rates()
    for what, seconds in decode.items():
        print(f"measured: {what}: {seconds:.2f} s of a core for a gigabyte", file=sys.stderr)
    print("| logs | hours | machines | requests | read again | most of the time goes for |")
    print("|---|---|---|---|---|---|")
    for what, world in cases(decode):
        found = simulated(world)
        row = f"{found.seconds / 3600:.2f} | {found.machines:,.0f} $ | {found.requests:,.0f} $ | {found.again:,} | {found.limit}"
        print(f"| {what} | {row} |")
    return 0


if __name__ == "__main__":
    sys.exit(main())
