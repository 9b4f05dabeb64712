"""YARP as a `Transport`."""

from __future__ import annotations

from rosetta_jit.transports.address import Option
from rosetta_jit.transports.base import Transport

HERE = "rosetta_jit.transports.yarp"

TRANSPORTS = (
    Transport(
        "YARP",
        ("yarp",),
        "yarp:/icub/torso/state:o",
        subscribe=f"{HERE}.streaming:subscribe",
        publish=f"{HERE}.streaming:YarpSink",
        call=f"{HERE}.calls:YarpCaller",
        serve=f"{HERE}.calls:serve",
        names=f"{HERE}.names:ports",
        check=f"{HERE}.names:port_name",
        options={
            "open": Option(
                ("yes", "no", ""),
                "",
                "open a port of that name, or connect to it; by default who publishes or serves opens, who subscribes or calls connects",
            ),
            "name": Option("text", "", "the name of the own port where it connects to another; by default one is made up"),
            "carrier": Option(
                ("tcp", "fast_tcp", "udp", "mcast"),
                "tcp",
                "of connections that are made: tcp acknowledges each message, fast_tcp none; udp and mcast may lose some",
            ),
            "server": Option("text", "", "host:port of the name server; by default what `yarp conf` says, else 127.0.0.1:10000"),
            "host": Option("text", "127.0.0.1", "the address of this machine at which the port listens, and which others are told"),
            "wait": Option("flag", False, "a slow reader makes the sender wait; else the message is dropped for this reader"),
            "patient": Option("flag", False, "begin without a name server, and wait for it"),
            "dialect": Option(("yarp3", "yarp4"), "yarp3", "how bottles are written that come as text"),
        },
    ),
)
