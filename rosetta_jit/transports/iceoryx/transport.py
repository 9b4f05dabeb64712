"""Shared memory as a `Transport`."""

from __future__ import annotations

from rosetta_jit.transports.address import Option
from rosetta_jit.transports.base import Transport

HERE = "rosetta_jit.transports.iceoryx.client"

TRANSPORTS = (
    Transport(
        "shared memory (iceoryx2)",
        ("iceoryx",),
        "iceoryx:camera/left",
        subscribe=f"{HERE}:subscribe",
        publish=f"{HERE}:IceoryxSink",
        extra=("iceoryx", "iceoryx2"),
        options={
            "first": Option("size", 1 << 16, "room for a message of so many bytes at first; a larger one takes more"),
            "buffer": Option("number", 0, "so many messages wait for a reader; 0: as many as iceoryx2 says. Who makes the service says it"),
            "poll": Option("seconds", 0.05, "how often a source looks for messages of peers that do not notify it"),
        },
    ),
)
