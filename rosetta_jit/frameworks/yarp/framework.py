"""YARP as a `Framework`: where its front ends, encodings and manners are found."""

from __future__ import annotations

from rosetta_jit.frameworks.base import Framework

HERE = "rosetta_jit.frameworks.yarp"
ENCODING = f"{HERE}.encoding:encode_type"

FRAMEWORK = Framework(
    "yarp",
    features=f"{HERE}.features:PROBES",
    definition=f"{HERE}.definition:definition",
    idl={".bottle-schema": f"{HERE}.bottle_schema.front_end:parse", ".thrift": f"{HERE}.thrift.front_end:parse"},
    infer=f"{HERE}.drafting.infer:infer",
    manners=f"{HERE}.manners:BOTTLE",
    transcoding=f"{HERE}.transcoding:tree",
    encodings={"yarp": ENCODING, "yarp3": ENCODING, "yarp4": ENCODING, "yarp2012": ENCODING},
)
