"""Zenoh, and ROS 2 over it, as `Transport`s."""

from __future__ import annotations

from rosetta_jit.transports.address import Option
from rosetta_jit.transports.base import Transport

HERE = "rosetta_jit.transports.zenoh"

SESSION = {
    "connect": Option("text", "", "endpoints to connect to, with commas between: tcp/127.0.0.1:7447"),
    "listen": Option("text", "", "endpoints to listen at: tcp/127.0.0.1:7447"),
    "mode": Option(("peer", "client"), "peer", "of the session"),
    "scout": Option("flag", False, "look for others by multicast; without it, only `connect` and `listen` make connections"),
    "config": Option("text", "", "a configuration file of zenoh, instead of these"),
}

TRANSPORTS = (
    Transport(
        "zenoh",
        ("zenoh",),
        "zenoh:robot/arm/**",
        subscribe=f"{HERE}.client:subscribe",
        publish=f"{HERE}.client:ZenohSink",
        call=f"{HERE}.calls:ZenohCaller",
        serve=f"{HERE}.calls:serve",
        extra=("zenoh", "zenoh"),
        options=SESSION,
    ),
    Transport(
        "ROS 2 over zenoh (rmw_zenoh)",
        ("ros2-zenoh",),
        "ros2-zenoh:/chatter",
        subscribe=f"{HERE}.ros2:subscribe",
        publish=f"{HERE}.ros2:Ros2Sink",
        names=f"{HERE}.ros2:topics",
        check="rosetta_jit.transports.ros2_names:topic_of",
        extra=("zenoh", "zenoh"),
        types={"ros2-zenoh": "ros2"},
        options=SESSION
        | {
            "domain": Option("number", 0, "ROS_DOMAIN_ID"),
            "type": Option("text", "*", "the type's name, `std_msgs/msg/String`; `*` takes any"),
            "hash": Option("text", "*", "the type's hash, `RIHS01_…`; `*` takes any"),
            "node": Option("text", "rosetta_jit", "the node's name, as `ros2 node list` shows it"),
        },
    ),
)
