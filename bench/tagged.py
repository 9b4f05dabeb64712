"""Messages of protobuf of one kind of field each, for what is generated against what protobuf's pure Python makes of the same types."""

from __future__ import annotations

from bench.subjects import Subject


def _varint(number: int) -> bytes:
    written = bytearray()
    while number > 127:
        written.append(number & 127 | 128)
        number >>= 7
    return bytes([*written, number])


def _sized(tag: int, body: bytes) -> bytes:
    return bytes([tag]) + _varint(len(body)) + body


def _tree(depth: int, width: int) -> bytes:
    children = b"".join(_sized(26, _tree(depth - 1, width)) for _ in range(width if depth else 0))
    return _sized(10, b"node%d" % depth) + b"\x10" + _varint(depth + 1) + children


def _value(depth: int) -> bytes:
    """A number, or an array of two values: what each of them is must be there."""
    return b"\x08\x02\x10\x96\x01" if not depth else b"\x08\x07" + 2 * _sized(58, _value(depth - 1))


def _chain(length: int) -> bytes:
    message = b""
    for number in range(1, length + 1):
        message = b"\x08" + _varint(number) + (_sized(18, message) if message else b"")
    return message


def _subject(body: str, message: bytes) -> Subject:
    return Subject("t.M", "protobuf", message, {"schema": {"t.proto": f'syntax = "proto3"; package t; message M {{ {body} }}'}})


def _texts(depth: int, size: int) -> bytes:
    """Messages in one another, each with a text."""
    message = b""
    for _ in range(depth):
        message = (_sized(10, message) if message else b"") + _sized(18, b"x" * size)
    return message


def _lists(number: int) -> str:
    return " ".join(f"repeated {_KINDS[n % len(_KINDS)]} l{n} = {n};" for n in range(1, number + 1))


def _nested(depth: int, message: bytes) -> bytes:
    for _ in range(depth):
        message = _sized(10, message)
    return message


_KINDS = ("string", "bytes", "bool", "float", "double", "fixed32", "sfixed64", "int32", "int64", "uint32", "uint64", "sint32", "sint64")
_EIGHTEEN = (*_KINDS, *_KINDS[:5])
_WITHIN = (
    "".join(f"message {one} {{ {other} in = 1; }} " for one, other in zip("ABCDE", "BCDEF", strict=True)) + "message F { string text = 7; }"
)
_SEVERAL = "message S { int32 a = 1; string b = 2; } " + " ".join(
    f"repeated {kind} l{n} = {n}; map<int32, {kind}> m{n} = {n + 20}; S s{n} = {n + 40}; repeated S r{n} = {n + 60};"
    for n, kind in enumerate(_KINDS[1:13:4], 1)
)
_INTEGERS = [number * 2654435761 % (1 << 1 + number % 30) for number in range(300)]
TAGGED = {
    "100 short texts": _subject("repeated string v = 1;", b"".join(_sized(10, b"joint_%d" % number) for number in range(100))),
    "100 texts of 140 bytes": _subject(
        "repeated string v = 1;", b"".join(_sized(10, b"joint_%d" % (number % 10) * 20) for number in range(100))
    ),
    "300 packed sint32": _subject("repeated sint32 v = 1;", _sized(10, b"".join(map(_varint, _INTEGERS)))),
    "200 unpacked bools": _subject("repeated bool v = 1 [packed = false];", b"\x08\x01\x08\x00" * 100),
    "a tree of 121 messages": _subject("string name = 1; int32 n = 2; repeated M children = 3;", _tree(4, 3)),
    "a dictionary of 20 values of RST": Subject(
        "rst.generic.Dictionary", "protobuf", b"".join(_sized(10, _sized(10, b"key_%d" % n) + _sized(18, _value(n % 3))) for n in range(20))
    ),
    "a chain of 30 messages": _subject("int32 n = 1; M next = 2;", _chain(30)),
    "60 messages with 10 KB of text": _subject("M next = 1; string text = 2;", _texts(60, 10_000)),
    "200 KB of text six messages deep": _subject(f"{_WITHIN} A in = 1;", _nested(6, _sized(58, b"x" * 200_000))),
    "18 fields with their defaults": _subject(" ".join(f"{type_} f{n} = {n};" for n, type_ in enumerate(_EIGHTEEN, 1)), b""),
    "12 lists, maps and messages that are not there": _subject(_SEVERAL, b""),
    "100 lists that are not there": _subject(_lists(100), b""),
    "20 messages of six lists that are not there": _subject(f"message Row {{ {_lists(6)} }} repeated Row rows = 1;", _sized(10, b"") * 20),
    "20 messages of 40 lists that are not there": _subject(f"message Row {{ {_lists(40)} }} repeated Row rows = 1;", _sized(10, b"") * 20),
    "20 messages of 100 lists that are not there": _subject(
        f"message Row {{ {_lists(100)} }} repeated Row rows = 1;", _sized(10, b"") * 20
    ),
    "20 messages of 20 lists, one of which is there": _subject(
        f"message Row {{ {_lists(20)} }} repeated Row rows = 1;", _sized(10, _sized(10, b"abc")) * 20
    ),
    "20 messages of 40 lists, one of which is there": _subject(
        f"message Row {{ {_lists(40)} }} repeated Row rows = 1;", _sized(10, _sized(10, b"abc")) * 20
    ),
    "a message that may contain its own type, one of 40 lists": _subject(f"{_lists(40)} repeated M kids = 41;", _sized(10, b"abcdefgh")),
    "a oneof of 12 cases": _subject(
        f"oneof which {{ {' '.join(f'{type_} f{n} = {n};' for n, type_ in enumerate(_KINDS[:12], 1))} }}", b"\x0a\x01a"
    ),
}
