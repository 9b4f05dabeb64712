"""Several wires: a message that fills its part of a holder, against the same message and rules in a mapping of its own."""

from __future__ import annotations

from pathlib import Path

import pytest

import rosetta_jit as rj
from bench.contest import Contender

CHAPTER = "Several wires"
OURS, ALONE, LEN = "rosetta_jit, one of two wires", "rosetta_jit, a mapping of its own", "len()"
AT_MOST = 1.2
"""Its part is cleared field by field, where a mapping of its own clears the holder in one go; and the message is counted."""

CALL = 2.5
"""One call, in multiples of `len()`."""

JOINED = (Path(__file__).parent.parent / "mappings" / "joined" / "odometry.mapping").read_text()
PARTS = {
    "pose": (
        "geometry_msgs/PoseWithCovarianceStamped",
        "  .header = .header\n  .pose = .pose\n  default .child_frame_id\n  default .twist\n",
    ),
    "velocity": (
        "geometry_msgs/TwistWithCovarianceStamped",
        "  .child_frame_id = .header.frame_id\n  .twist = .twist\n  default .header\n  default .pose\n",
    ),
}
IMPORTS = "".join(line for line in JOINED.splitlines(keepends=True) if line.startswith("import"))
FILES = {"odometry.mapping": JOINED} | {
    f"{wire}.mapping": f"{IMPORTS}data-holder: nav_msgs/Odometry\nwire-schema: {type_}\nunpack-rules:\n{rules}"
    for wire, (type_, rules) in PARTS.items()
}


@pytest.mark.parametrize("wire", PARTS)
def test_an_arrival(wire, effort, compare, record):
    joined, encode = rj.Decoders("odometry.mapping", schema=FILES), rj.Encoders("odometry.mapping", schema=FILES)
    odometry = encode.new()
    odometry.header.frame_id, odometry.child_frame_id = "odom", "base_link"
    message, alone = encode[wire](odometry), rj.Decoder(f"{wire}.mapping", schema=FILES)
    outcome = compare(
        CHAPTER,
        f"the {wire} of an odometry, {len(message)} bytes",
        [
            Contender(OURS, "ours", "the holder of both", effort.call(joined[wire], message)),
            Contender(ALONE, "ours", "a holder", effort.call(alone, message)),
            Contender(LEN, "limit", "a number", effort.call(len, message)),
        ],
    )
    took = f"{outcome.took(OURS).median:.1f} ns a message"
    record(f"the {wire} of two wires", outcome.ratio(OURS, ALONE), AT_MOST, "x a mapping of its own", took)
    record(f"the {wire} of two wires, one call", outcome.ratio(OURS, LEN), CALL, "x len()", took)
