"""Lists of protoc's classes that grow and shrink, and what they keep of fields that the schema does not know."""

from __future__ import annotations

import pytest

import rosetta_jit as rj
from rosetta_jit.api.options import type_request
from rosetta_jit.generate.build import Wishes, generated
from tests.generate import cpp, native
from tests.generate.cpp import QUICK
from tests.generate.driver import answers
from tests.generate.test_cpp import BOTH, same

TEXT = """syntax = "{syntax}"; package t;
message N {{ {optional} int32 x = 1; }}
message M {{
  repeated bytes blobs = 1; repeated string texts = 2; repeated N ns = 3; {optional} N n = 4; repeated bool flags = 5 [packed = true];
}}
"""
UNKNOWN = b"\xa0\x06\x07"
TOO_LONG = [b"\xa0\x86\x00\x07", b"\xa0\x86\x80\x80\x00\x07", b"\xa0\x06\x87\x80\x00", b"\xa0\x86\x80\x80\x00\x87" + b"\x80" * 8 + b"\x00"]
"""The same field, whose tag or number takes more bytes than it needs."""
REFUSED = [b"\xa0\x86\x80\x80\x80\x00\x07", b"\xa0\x86\x80\x80\x10\x07", b"\xa0\x06\x87" + b"\x80" * 9 + b"\x00", b"\xa3\x06\xa4"]
"""Fields that are none."""


def sized(tag: int, body: bytes) -> bytes:
    return bytes([tag, len(body)]) + body


def texts(count: int, size: int) -> bytes:
    """Byte strings and texts, of a length and one less by turns."""
    bodies = [bytes([97 + number % 26]) * (size - number % 2) for number in range(count)]
    return b"".join(sized(10, each) for each in bodies) + b"".join(sized(18, each) for each in bodies)


def messages() -> list[bytes]:
    lists = [texts(count, size) for count in (0, 1, 5, 2, 9) for size in (1, 4, 9, 15, 16, 17, 40, 33)]
    inner = [sized(26, b"\x08\x05"), sized(26, b"\x08\x05" + UNKNOWN), sized(34, UNKNOWN), UNKNOWN]
    mixed = [b"".join(inner[:number]) for number in range(5)] + [b"".join(inner), *inner]
    flags = [sized(42, bytes(number % 2 for number in range(count))) for count in (1, 7, 8, 9, 40, 100)]
    return [*lists, *mixed, *flags, *(one + other for one, other in zip(mixed, lists, strict=False))]


@cpp.needs_cpp
@pytest.mark.parametrize("syntax", ["proto2", pytest.param("proto3", marks=pytest.mark.campaign)])
def test_lists_and_unknown_fields(syntax, tmp_path):
    text = TEXT.format(syntax=syntax, optional="optional" if syntax == "proto2" else "")
    native.protoc(tmp_path, "t", text)
    options = {"encoding": "protobuf", "schema": {"t.proto": text}}
    request = type_request("decode", "t.M", options)
    name = cpp.write(tmp_path, generated(request, "cpp", BOTH, "unit", Wishes(holder="protobuf", include="t.pb.h")))
    good = messages()
    given = [*good, *(each[:-1] for each in good if each), *good, *REFUSED, *(sized(34, each) for each in REFUSED)]
    program = native.program_of_protoc(tmp_path, name, "t", QUICK)
    library = rj.Decoder.of("t.M", **options), rj.Encoder.of("t.M", **options)
    same(answers(program, given), *library, given)
    given = [*TOO_LONG, *(sized(34, each) for each in TOO_LONG)]
    same(answers(program, given), *library, [*[UNKNOWN] * len(TOO_LONG), *[sized(34, UNKNOWN)] * len(TOO_LONG)])
