"""CORBA as a `Framework`: where its front ends, encodings and manners are found."""

from __future__ import annotations

from rosetta_jit.frameworks.base import ANY_BYTE, Framework

HERE = "rosetta_jit.frameworks.corba"
CDR = "rosetta_jit.frameworks.omg.cdr:encode_type"

FRAMEWORK = Framework(
    "corba",
    features=f"{HERE}.features:PROBES",
    idl={".idl": "rosetta_jit.frameworks.omg.idl:parse"},
    encodings={"cdr-giop": CDR},
    manners=f"{HERE}.manners:OMNIORB",
    leniencies={
        "cdr-giop": {
            "bool": f"{ANY_BYTE} (omniORB)",
            "text": "bytes that are no UTF-8 are kept (omniORB, whose char is ISO 8859-1)",
            "enum": "numbers that the enum does not name are kept (TAO)",
            "bounds": "more than a bound allows is read and written (TAO)",
            "trailing": "up to three bytes may be left over",
        }
    },
    byte_orders=("cdr-giop",),
)
