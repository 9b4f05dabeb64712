"""Protocol Buffers as a `Framework`: where its front ends, encodings and manners are found."""

from __future__ import annotations

from rosetta_jit.frameworks.base import Framework

HERE = "rosetta_jit.frameworks.protobuf"
ENCODING = f"{HERE}.encoding:encode_type"

FRAMEWORK = Framework(
    "protobuf",
    features=f"{HERE}.features:PROBES",
    definition=f"{HERE}.definition:definition",
    announcement=f"{HERE}.announcement:announcement",
    idl={".proto": f"{HERE}.idl:parse"},
    encodings={"protobuf": ENCODING, "protobuf-partial": ENCODING},
    infer=f"{HERE}.infer:infer",
    manners=f"{HERE}.manners:PROTOBUF",
)
