"""LCM as a `Transport`."""

from __future__ import annotations

from rosetta_jit.transports.address import Option
from rosetta_jit.transports.base import Transport

HERE = "rosetta_jit.transports.lcm.client"

TRANSPORTS = (
    Transport(
        "LCM",
        ("lcm",),
        "lcm:POSE",
        subscribe=f"{HERE}:subscribe",
        publish=f"{HERE}:LcmSink",
        extra=("lcm", "lcm"),
        options={
            "url": Option(
                "text", "", "of LCM; by default LCM_DEFAULT_URL, else udpm://239.255.76.67:7667?ttl=0, which stays on this machine"
            ),
        },
    ),
)
