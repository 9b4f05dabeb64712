"""Protocol Buffers as a `Framework`: where its front ends, encodings and manners are found."""

from __future__ import annotations

from rosetta_jit.frameworks.base import Framework

HERE = "rosetta_jit.frameworks.protobuf"
ENCODING = f"{HERE}.encoding:encode_type"
OWN_TYPES = {
    "any": ("Any",),
    "duration": ("Duration",),
    "empty": ("Empty",),
    "field_mask": ("FieldMask",),
    "source_context": ("SourceContext",),
    "struct": ("Struct", "Value", "ListValue"),
    "timestamp": ("Timestamp",),
    "wrappers": (*(f"{kind}Value" for kind in ("Double", "Float", "Int64", "UInt64", "Int32", "UInt32", "Bool", "String", "Bytes")),),
}
"""Which file of `google/protobuf` declares which messages."""

FRAMEWORK = Framework(
    "protobuf",
    features=f"{HERE}.features:PROBES",
    definition=f"{HERE}.definition:definition",
    announcement=f"{HERE}.announcement:announcement",
    idl={".proto": f"{HERE}.idl:parse"},
    encodings={"protobuf": ENCODING, "protobuf-partial": ENCODING},
    homes={f"google.protobuf.{name}": f"google/protobuf/{file}.proto" for file, names in OWN_TYPES.items() for name in names},
    infer=f"{HERE}.infer:infer",
    manners=f"{HERE}.manners:PROTOBUF",
)
