"""LCM as a `Framework`: where its front ends, encodings and manners are found."""

from __future__ import annotations

from rosetta_jit.frameworks.base import ANY_BYTE, Framework

HERE = "rosetta_jit.frameworks.lcm"

FRAMEWORK = Framework(
    "lcm",
    features=f"{HERE}.features:PROBES",
    definition=f"{HERE}.definition:definition",
    idl={".lcm": f"{HERE}.idl:parse"},
    encodings={"lcm": f"{HERE}.encoding:encode_type"},
    manners=f"{HERE}.manners:LCM_GEN",
    leniencies={"lcm": {"bool": f"{ANY_BYTE} (lcm-gen)", "trailing": "bytes behind the message are left alone (lcm-gen)"}},
)
