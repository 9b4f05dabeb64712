r"""YARP's text form of a bottle, both ways, quirks included: ``[set] [poss] (0.5 1.0) "a b" {1 2}``.

The text form is bytes: a string in it may hold any. Its rules are those of os/impl/BottleImpl.cpp (fromString, smartAdd)
and os/impl/Storable.cpp as measured on 3.12.3 and 4.0.0. Parsing never refuses a text but for its nesting: tokens that
make no sense are strings, and what is unbalanced is dropped. The text form cannot say int8, int16, float32, or a dict.
"""

from __future__ import annotations

import re
from math import copysign, isnan
from typing import assert_never

from rosetta_jit.errors import EncodeError
from rosetta_jit.frameworks.yarp.limits import MAX_NESTING
from rosetta_jit.frameworks.yarp.tags import Dialect, vocab
from rosetta_jit.frameworks.yarp.tree import Dict, Item, List, Path, Value, path_text, specialised

DECIMAL_DIGITS = 21
"""DECIMAL_DIG where long double has 64 bits of mantissa: YARP prints every float with so many digits."""

_BARE = re.compile(rb"[A-Za-z_][A-Za-z_0-9.\-]*")
_WORDS = {b"inf": float("inf"), b"-inf": float("-inf"), b"nan": float("nan")}
_NUMBER = re.compile(rb"[0+\-]*(?:[1-9.eE][0-9.eE+\-]*)?")
_HEX_NUMBER = re.compile(rb"[0+\-]*[xX][0+\-xX]*(?:[1-9.a-fA-F][0-9.a-fA-F+\-]*)?")
_INTEGER = re.compile(rb"[+-]?(?:0[xX][0-9a-fA-F]+|[0-9]+)")
_DECIMAL = re.compile(rb"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
_HEX_FLOAT = re.compile(rb"[+-]?0[xX](?:[0-9a-fA-F]+\.?[0-9a-fA-F]*|\.[0-9a-fA-F]+)")
_ESCAPES = {ord("\n"): b"\\n", ord("\r"): b"\\r", 0: b"\\0", ord("\\"): b"\\\\", ord('"'): b'\\"'}
_UNESCAPES = {b"n": b"\n", b"r": b"\r", b"0": b"\0"}
_SPACES = b" \t\n\r"


def to_text(bottle: List) -> bytes:
    """The text that YARP prints for a bottle, without a line end."""
    return b" ".join(_item_text(item) for item in bottle.items)


def parse_text(text: bytes | str, dialect: Dialect) -> List:
    """The bottle that YARP makes of a text (a str is taken as UTF-8), its lists specialised as YARP does.

    Raises
    ------
    EncodeError
        For lists nested deeper than a message may.
    """
    octets = text.encode("utf-8", "surrogateescape") if isinstance(text, str) else text
    return _parse_items(octets, dialect, ())


def _item_text(item: Item) -> bytes:
    match item:
        case Value():
            return _value_text(item)
        case List():
            return b"(" + to_text(item) + b")"
        case Dict(content):
            return b"(" + to_text(content) + b")"
        case _:
            assert_never(item)


def _value_text(item: Value) -> bytes:
    match item.value:
        case bytes(octets):
            return _blob_text(octets) if item.tag == "blob" else _string_text(octets)
        case float(number):
            return _float_text(number)
        case int(number):
            return _vocab_text(number) if item.tag in {"vocab32", "vocab64"} else b"%d" % number
        case _:
            assert_never(item.value)


def _blob_text(octets: bytes) -> bytes:
    return b"{" + b" ".join(b"%d" % byte for byte in octets) + b"}"


def _string_text(octets: bytes) -> bytes:
    if _BARE.fullmatch(octets) and octets not in {b"true", b"false"}:
        return octets
    return b'"' + b"".join(_ESCAPES.get(byte) or bytes((byte,)) for byte in octets) + b'"'


def _vocab_text(code: int) -> bytes:
    """A vocab in brackets; of a negative one nothing is left, since YARP takes it apart with C's remainder."""
    if code in {0, vocab(b"1")}:
        return b"true" if code else b"false"
    octets = code.to_bytes(8, "little") if code > 0 else b""
    return b"[" + octets.replace(b"\0", b"") + b"]"


def _float_text(number: float) -> bytes:
    text = f"{number:.{DECIMAL_DIGITS}g}"
    if isnan(number) and copysign(1.0, number) < 0:
        return b"-nan.0"  # C prints -nan, which YARP takes for a number without a point
    if not any(mark in text for mark in ".ein"):
        text += ".0"
    return text.encode()


def _parse_items(text: bytes, dialect: Dialect, path: Path) -> List:
    if len(path) > MAX_NESTING:
        raise EncodeError("nesting", path_text(path), f"lists are nested deeper than {MAX_NESTING}")
    items: list[Item] = []
    for token in _tokens(text):
        items.append(_parse_token(token, dialect, (*path, len(items))))
    return specialised(items)


def _tokens(text: bytes) -> list[bytes]:
    """The pieces between separators outside quotes and brackets; a last one that is not closed is lost."""
    tokens: list[bytes] = []
    start: int | None = None
    quoted = escaped = False
    round_depth = curly_depth = 0
    for at, byte in enumerate(text + b" "):
        if escaped:
            escaped = False
            continue
        if start is None:
            if byte in _SPACES:
                continue
            start = at
        quoted ^= byte == 0x22
        if not quoted:
            round_depth += (byte == 0x28) - (byte == 0x29)
            curly_depth += (byte == 0x7B) - (byte == 0x7D)
        escaped = byte == 0x5C
        if byte in b", \t\n\r" and not (quoted or round_depth or curly_depth):
            if at > start:
                tokens.append(text[start:at])
            start = None
    return tokens


def _parse_token(token: bytes, dialect: Dialect, path: Path) -> Item:
    if token == b"null":
        return Value("vocab32", vocab(token))
    if token in _WORDS:
        return Value("float64", _WORDS[token])
    if _is_number(token):
        return _parse_number(token, dialect)
    match token[:1]:
        case b"(":
            return _parse_items(token[1:-1], dialect, path)
        case b"[":
            return _parse_vocab(token, dialect)
        case b"{":
            return Value("blob", bytes(_byte(item) for item in _parse_items(token[1:-1], dialect, path).items))
        case _:
            return _parse_string(token)


def _is_number(token: bytes) -> bool:
    """Whether YARP takes a token for a number: more generous than any number format, so `-` is 0 and `1-2` is 1."""
    if token[:1] not in b"0123456789+-." or token == b".":
        return False
    preamble = token[: len(token) - len(token.lstrip(b"0+-xX"))]
    if preamble.count(b"+") + preamble.count(b"-") > 1 or token.count(b".") > 1:
        return False
    mark = max(preamble.rfind(b"x"), preamble.rfind(b"X"))
    if mark < 0:
        return _NUMBER.fullmatch(token) is not None
    return len(token) - (mark + 1) <= 8 and _HEX_NUMBER.fullmatch(token) is not None


def _parse_number(token: bytes, dialect: Dialect) -> Value:
    exponent = rb"." if b"x" in token.lower() else rb".eE"
    if any(byte in exponent for byte in token):
        return Value("float64", _strtod(token))
    number = _strtoll(token)
    if -(2**31) <= number < 2**31:
        return Value("int32", number)
    if "int64" in dialect.tags:
        return Value("int64", number)
    return Value("int32", (number + 2**31) % 2**32 - 2**31)


def _strtod(token: bytes) -> float:
    """C's strtod of the whole token, or 0.0 where it stops before the end."""
    if _DECIMAL.fullmatch(token):
        return float(token)
    return float.fromhex(token.decode()) if _HEX_FLOAT.fullmatch(token) else 0.0


def _strtoll(token: bytes) -> int:
    """C's strtoll with base 0: hexadecimal after 0x, octal after 0, as far as it goes, and held to 64 bits."""
    found = _INTEGER.match(token)
    if found is None:
        return 0
    sign = -1 if token[:1] == b"-" else 1
    digits = found[0].lstrip(b"+-")
    if digits[:2] in {b"0x", b"0X"}:
        number = int(digits, 16)
    elif digits[:1] == b"0":
        number = int(digits[: len(digits) - len(digits.lstrip(b"01234567"))], 8)
    else:
        number = int(digits[:20])
    return max(-(2**63), min(sign * number, 2**63 - 1))


def _parse_vocab(token: bytes, dialect: Dialect) -> Value:
    """YARP 4 makes a vocab64 of what does not fit a vocab32; the others cut it."""
    if "vocab64" in dialect.tags and len(token) > 6:
        return Value("vocab64", vocab(token[1:-1][:8], 8))
    return Value("vocab32", vocab(token[1:-1][:4]))


def _byte(item: Item) -> int:
    """What YARP makes of an element of a blob: its integer value cut to a byte, 0 for what has none."""
    match item:
        case Value(_, int(number)):
            return number & 0xFF
        case Value(_, float(number)) if abs(number) < 2**31:
            return int(number) & 0xFF
        case _:
            return 0


def _parse_string(token: bytes) -> Value:
    quoted = token[:1] == b'"'
    inner = token[1:-1] if quoted else token
    octets = re.sub(rb"\\(.?)", lambda escape: _UNESCAPES.get(escape[1], escape[1]), inner, flags=re.DOTALL)
    if not quoted and octets in {b"true", b"false"}:
        return Value("vocab32", vocab(b"1") if octets == b"true" else 0)
    return Value("string", octets)
