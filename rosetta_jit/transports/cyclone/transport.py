"""ROS 2 over DDS as a `Transport`."""

from __future__ import annotations

from rosetta_jit.transports.address import Option
from rosetta_jit.transports.base import Transport

HERE = "rosetta_jit.transports.cyclone.client"

TRANSPORTS = (
    Transport(
        "DDS, and ROS 2 over it",
        ("dds", "ros2-dds"),
        "ros2-dds:/chatter?type=std_msgs/msg/String",
        subscribe=f"{HERE}:subscribe",
        publish=f"{HERE}:DdsSink",
        extra=("cyclonedds", "cyclonedds"),
        types={"ros2-dds": "ros2"},
        asks=("type",),
        options={
            "type": Option("text", "", "the type's name: `std_msgs/msg/String` for ros2-dds, as DDS has it for dds"),
            "struct": Option(
                "object", None, "cyclonedds' class of the type, for peers that compare the structure of types, not only the name"
            ),
            "domain": Option("number", 0, "of DDS; ROS_DOMAIN_ID"),
            "interface": Option(
                "text", "", "of the network, by name; by default what CYCLONEDDS_URI says, else lo; `auto`: Cyclone's choice"
            ),
            "reliable": Option(
                "flag", True, "what is lost on the way is sent again; a reliable reader takes nothing of a writer that is not"
            ),
            "keep": Option("number", 10, "so many messages wait for a reader; 0: all"),
            "transient": Option("flag", False, "who comes later gets the last messages (transient local)"),
        },
    ),
)
