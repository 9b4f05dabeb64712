"""What `.msg` files of ROS 1 can say."""

from __future__ import annotations

from rosetta_jit.frameworks.ros.features import PROBES as SHARED

PROBES = {".msg": SHARED | {"time": "time x", "duration": "duration x"}}
