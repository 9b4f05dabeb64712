"""Padding behind a payload: as much as the options of its header announce (DDS-XTypes 1.3, 7.6.3.1.2)."""

from __future__ import annotations

import pytest

import rosetta_jit as rj

SCHEMA = {"probe/msg/Text.msg": "string text\n"}
HEADER = {"cdr": 1, "cdr2": 7}


def payload(encoding, announced, padding, text="é"):
    data = text.encode() + b"\0"
    return bytes((0, HEADER[encoding], 0, announced)) + len(data).to_bytes(4, "little") + data + padding


def decoder(encoding, **options):
    return rj.Decoder.of("probe/msg/Text", encoding=encoding, schema=SCHEMA, backend="interpreter", **options)


@pytest.mark.parametrize("encoding", HEADER)
@pytest.mark.parametrize(("text", "size"), [("abc", 0), ("é", 1), ("x", 2), ("", 3)])
def test_what_is_announced(encoding, text, size):
    assert decoder(encoding)(payload(encoding, size, b"\xff" * size, text)).text == text
    assert decoder(encoding)(payload(encoding, size | 0xFC, bytes(size), text)).text == text  # other bits mean nothing


@pytest.mark.parametrize("encoding", HEADER)
@pytest.mark.parametrize(("announced", "there", "kind"), [(0, 1, "trailing"), (1, 2, "trailing"), (1, 0, "truncated"), (3, 1, "truncated")])
def test_any_other(encoding, announced, there, kind):
    data = payload(encoding, announced, bytes(there))
    with pytest.raises(rj.DecodeError) as error:
        decoder(encoding)(data)
    assert error.value.kind == kind
    assert decoder(encoding, lenient=["trailing"])(data).text == "é"


@pytest.mark.parametrize("encoding", HEADER)
def test_more_than_can_be_announced(encoding):
    with pytest.raises(rj.DecodeError):
        decoder(encoding, lenient=["trailing"])(payload(encoding, 0, bytes(4)))


@pytest.mark.parametrize("backend", ["interpreter", "python", "numba"])
def test_written(backend):
    for encoding, text, expected in [
        ("cdr", "é", payload("cdr", 0, b"")),
        ("cdr2", "é", payload("cdr2", 1, b"\0")),
        ("cdr2", "abc", payload("cdr2", 0, b"", "abc")),
        ("cdr2", "", payload("cdr2", 3, bytes(3), "")),
    ]:
        encode = rj.Encoder.of("probe/msg/Text", encoding=encoding, schema=SCHEMA, backend=backend)
        holder = encode.holder_type()
        holder.text = text
        assert bytes(encode(holder)) == expected
        assert decoder(encoding)(expected).text == text
