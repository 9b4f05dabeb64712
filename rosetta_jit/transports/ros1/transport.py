"""ROS 1 as a `Transport`."""

from __future__ import annotations

from rosetta_jit.transports.address import Option
from rosetta_jit.transports.base import Transport

HERE = "rosetta_jit.transports.ros1"

TRANSPORTS = (
    Transport(
        "ROS 1",
        ("ros1",),
        "ros1:/imu",
        subscribe=f"{HERE}.streaming:subscribe",
        publish=f"{HERE}.streaming:RosSink",
        call=f"{HERE}.calls:RosCaller",
        serve=f"{HERE}.calls:serve",
        names=f"{HERE}.streaming:topics",
        check=f"{HERE}.node:graph_name",
        types={"ros1": "ros1"},
        asks=("type", "md5"),
        options={
            "type": Option("text", "*", "the type's name, `sensor_msgs/Imu`; `*` takes any"),
            "md5": Option("text", "*", "the md5 sum of the type; `*` takes any"),
            "definition": Option("text", "", "the type's full text, which is told to who subscribes"),
            "latch": Option("flag", False, "who subscribes later gets the last message"),
            "master": Option("text", "", "the master's URI; by default ROS_MASTER_URI, else http://127.0.0.1:11311"),
            "host": Option(
                "text", "", "the address of this machine that others are told; by default ROS_IP or ROS_HOSTNAME, else 127.0.0.1"
            ),
            "name": Option("text", "", "the node's name; by default one is made up"),
            "patient": Option("flag", False, "begin without a master, and wait for it"),
        },
    ),
)
