"""RSB as a `Transport`."""

from __future__ import annotations

from rosetta_jit.transports.address import Option
from rosetta_jit.transports.base import Transport

HERE = "rosetta_jit.transports.rsb"

TRANSPORTS = (
    Transport(
        "RSB",
        ("rsb",),
        "rsb:/arm/left?port=55555",
        subscribe=f"{HERE}.streaming:subscribe",
        publish=f"{HERE}.streaming:RsbSink",
        call=f"{HERE}.calls:RsbCaller",
        serve=f"{HERE}.calls:serve",
        check=f"{HERE}.scopes:scope_of",
        types={"rsb": "protobuf"},
        options={
            "host": Option("text", "127.0.0.1", "where the bus is; who serves it listens there"),
            "port": Option("number", 55555, "of the bus"),
            "role": Option(("auto", "server", "client"), "auto", "serve the bus or connect to it; auto serves it unless somebody does"),
            "type": Option("text", "", "the wire schema of what is sent: `.rst.kinematics.JointAngles`, `utf-8-string`"),
            "patient": Option("flag", False, "begin without a bus, and wait for it"),
        },
    ),
)
