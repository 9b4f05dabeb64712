"""What `.msg`, `.srv` and `.action` files of ROS 1 can say."""

from __future__ import annotations

from rosetta_jit.frameworks.ros.features import PROBES as SHARED
from rosetta_jit.frameworks.ros.features import first_part

MESSAGES = SHARED | {"time": "time x", "duration": "duration x"}
ADDED = {
    "std_msgs/Header.msg": "uint32 seq\ntime stamp\nstring frame_id",
    "actionlib_msgs/GoalID.msg": "time stamp\nstring id",
    "actionlib_msgs/GoalStatus.msg": "GoalID goal_id\nuint8 status\nstring text",
}
"""What actionlib adds to actions needs these."""

PROBES = {
    ".msg": MESSAGES,
    ".srv": first_part(MESSAGES, 1, "ProbeRequest", {}),
    ".action": first_part(MESSAGES, 2, "ProbeGoal", ADDED),
}
