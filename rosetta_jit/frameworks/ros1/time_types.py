"""The types `time` and `duration` of ROS 1. They stand apart from the front end, which a process that only holds messages never needs."""

from __future__ import annotations

from rosetta_jit.model.types import Field, Int, Struct

UINT32, INT32 = Int(32, signed=False, spelling="uint32"), Int(32, spelling="int32")

STRUCTS = {
    "time": Struct("time", (Field("secs", UINT32), Field("nsecs", UINT32))),
    "duration": Struct("duration", (Field("secs", INT32), Field("nsecs", INT32))),
}
