"""A stand-in for the library: a holder of one byte, so that the commands are tested by themselves."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

import rosetta_jit
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.errors import DecodeError, MappingError

MISTAKE = Diagnostic("error", "unknown-field", "no field `z`", help="name one of x, y")
DOUBT = Diagnostic("warning", "unused-import", "nothing is used of b.proto")


class StubHolder:
    def __init__(self, values):
        self.values = values
        self.samples = np.array(values.get("samples", ()), np.float32)

    def to_dict(self):
        return self.values

    @classmethod
    def from_dict(cls, values):
        return cls(values)

    def __str__(self):
        return f"number: {self.values['number']}"


class StubDecoder:
    def __init__(self, mapping, *, encoding=None, parameters=None, wire=None, **_):
        if mapping == "wrong.mapping":
            raise MappingError((MISTAKE,))
        self.parameters, self.wire = parameters, wire
        self.encoding = encoding or "own"

    def __call__(self, message):
        if not message:
            raise DecodeError("truncated", "", "no byte", 0)
        values = {"number": message[0], "data": bytes(message), "samples": [0.5] * message[0], "inner": {"depth": float("inf")}}
        return StubHolder(values)

    def stage(self, name):
        return f"{type(self).__name__} {self.encoding} {name}"


class StubEncoder(StubDecoder):
    holder_type = StubHolder

    def __call__(self, holder):
        return holder.values["data"]


@pytest.fixture(autouse=True)
def library(monkeypatch):
    calls = SimpleNamespace(inferred=None)

    def check(mapping, *, encoding=None, framework=None):
        assert encoding is None
        assert framework is None or mapping == "wrong.mapping"
        if mapping == "wrong.mapping":
            raise MappingError((MISTAKE,))
        return SimpleNamespace(warnings=(DOUBT,) if mapping == "doubtful.mapping" else (), notes=())

    def infer(messages, *, name, encoding):
        calls.inferred = list(messages)
        return f'"{name}" ; {encoding}\n'

    for name, stand_in in {"Decoder": StubDecoder, "Encoder": StubEncoder, "check": check, "infer": infer}.items():
        monkeypatch.setattr(rosetta_jit, name, stand_in, raising=False)
    return calls
