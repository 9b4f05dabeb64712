"""Messages for the kernels made by hand: good ones, and what hostile hands make of them."""

from __future__ import annotations

import random
import struct
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

SIGNALLING_F32 = bytes.fromhex("7f800001")  # big-endian: a NaN whose quiet bit is not set

GOOD: dict[str, tuple[bytes, ...]] = {
    "fixed": (b"".join(struct.pack("<id", 10, float(field)) for field in range(10)),),
    "specialised": (struct.pack("<ii24d", 266, 24, *map(float, range(24))),),
    "counted": (struct.pack("<i", 0), struct.pack("<i", 5) + struct.pack(">5h", 1, 2, 3, 400, 32767), struct.pack("<i", 41) + bytes(82)),
    "varints": (b"", bytes([1, 127, 0x80, 1]), b"\xff" * 9 + b"\x01", b"\x05" * 41),
    "attempts": (bytes([7, 0]), bytes([7, 1]), bytes([7, 2, 99])),
    "tagged": (b"\x01abcd", b"\x02" + SIGNALLING_F32 + b"rest", b"\xc8h\xc3\xa9lo" + b"\0", b"\x07", b"\x07abc"),
    "text": tuple(
        text.encode()
        for text in (
            "",
            "a",
            "plain ascii of some length",
            "é",
            "日本語テキスト",
            "eight by\U0001f600te",
            "\u07ff\ud7ff\ue000\uffff\U0010ffff",
        )
    ),
}

BAD_TEXT = tuple(
    bytes.fromhex(text)
    for text in (
        *("80", "bf", "c080", "c1bf", "c2", "e0", "e08080", "e09fbf", "eda080", "edbfbf", "f0808080", "f08fbfbf", "f4908080", "f5808080"),
        *("ff", "e282", "f09f98", "c2c2", "e28228", "f0289898", "61626364656667c3", "616263646566676880"),
    )
)


def hostile(name: str, rounds: int = 40) -> Iterator[bytes]:
    """Good messages, each cut everywhere, each with random bytes changed, and noise."""
    chance = random.Random(name)
    for good in GOOD[name]:
        yield good
        yield good + b"\0"
        yield from (good[:length] for length in range(len(good)))
        for _ in range(rounds if good else 0):
            changed = bytearray(good)
            for _ in range(chance.randint(1, 3)):
                changed[chance.randrange(len(changed))] = chance.choice((0, 1, 2, 7, 127, 128, 200, 255, chance.randrange(256)))
            yield bytes(changed)
    yield from (chance.randbytes(chance.randrange(40)) for _ in range(rounds))
    if name == "text":
        yield from (prefix + bad + suffix for bad in BAD_TEXT for prefix in (b"", b"12345678") for suffix in (b"", b"abcdefgh"))
