"""Errors go from one process to another, as pools of processes send them."""

from __future__ import annotations

import pickle

import pytest

import rosetta_jit as rj
from rosetta_jit.errors import AddressError, BridgeError, EncodeError, LogError, TransportError, ValuesError

MESSAGES = [
    rj.DecodeError("truncated", ".a[3]", "the message ends here", 17),
    EncodeError("range", ".a", "too large"),
    ValuesError(".a", "must be a number"),
    TransportError("closed", "tcp://localhost:1", "the peer is gone"),
]


def sent(error):
    return pickle.loads(pickle.dumps(error))  # noqa: S301 - our own


@pytest.mark.parametrize("error", MESSAGES, ids=lambda error: type(error).__name__)
def test_errors_of_messages_and_peers(error):
    assert (type(sent(error)), str(sent(error)), vars(sent(error))) == (type(error), str(error), vars(error))


def test_reports(tmp_path):
    file = tmp_path / "wrong.mapping"
    file.write_text("data-holder: x\n")
    with pytest.raises(rj.MappingError) as caught:
        rj.Decoder(file)
    arrived = sent(caught.value)
    assert (type(arrived), str(arrived), arrived.diagnostics) == (rj.MappingError, str(caught.value), caught.value.diagnostics)
    for kind in (rj.SchemaError, LogError, BridgeError, AddressError):
        assert str(sent(kind(caught.value.diagnostics))) == str(caught.value)
