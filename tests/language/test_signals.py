"""Signals within the bytes of a frame, against plain Python's integers."""

from __future__ import annotations

import random
from typing import Any

import pytest

import rosetta_jit as rj
from rosetta_jit.language.signal_bits import signal_of

BACKENDS = ["llvm", "python", "interpreter"]
FILES = {
    "can/msg/Frame.msg": "uint32 id\nuint8[8] data\n",
    "car.idl": """module car { enum Gears { PARK, DRIVE, REVERSE };
      @final struct State { double speed; float torque; boolean brake; Gears gear; long counter; unsigned long long rest; }; };""",
}
RULES = """import "can/msg/Frame.msg"
import "car.idl"
data-holder: car::State
wire-schema: can/msg/Frame
rules:
  .speed <-> signal(.data, "7|16@0+") * 0.01
  .torque <-> float32(signal(.data, "20|12@1-") * 0.5)
  .brake <-> bool(signal(.data, "16|1@1+"))
  .gear <-> car::Gears(signal(.data, "17|2@1+"))
  .counter <-> signal(.data, "19|1@0+")
  .rest <-> uint64(signal(.data, "32|32@1+"))
unpack-rules:
  reject "no frame of the car" when .id != 0x1a0
pack-rules:
  .id = 0x1a0
"""


def reference(text: str, data: bytes) -> int:
    """A signal bit by bit, by the numbers that DBC files give them."""
    place, _, form = text.partition("@")
    start, length = map(int, place.split("|"))
    numbers = [start]
    while len(numbers) < length:
        last = numbers[-1]
        numbers.append(last + 1 if form[0] == "1" else last - 1 if last % 8 else last + 15)
    bits = [data[each // 8] >> each % 8 & 1 for each in (numbers if form[0] == "1" else numbers[::-1])]
    value = sum(bit << place for place, bit in enumerate(bits))
    return value - (1 << length) if form[1] == "-" and bits[-1] else value


def described(count: int) -> list[str]:
    """Signals within eight bytes."""
    chosen, found = random.Random(7), ["0|64@1+", "7|64@0-", "0|64@1-", "7|64@0+", "3|1@0-", "63|1@1+"]
    while len(found) < count:
        text = f"{chosen.randrange(64)}|{chosen.randrange(1, 64)}@{chosen.choice('01')}{chosen.choice('+-')}"
        signal = signal_of(text)
        if signal is not None and signal.size <= 8:
            found.append(text)
    return found


@pytest.mark.parametrize("backend", BACKENDS)
def test_signals_are_read(backend):
    texts = described(24)
    fields = "".join(f"{'uint64' if text.endswith(('64@1+', '64@0+')) else 'int64'} s{number}\n" for number, text in enumerate(texts))
    rules = "".join(f'  .s{number} = signal(.data, "{text}")\n' for number, text in enumerate(texts))
    files = {
        **FILES,
        "can/msg/All.msg": fields,
        "m.mapping": 'import "can/msg/Frame.msg"\nimport "can/msg/All.msg"\ndata-holder: can/msg/All\nwire-schema: can/msg/Frame\n'
        f"unpack-rules:\n{rules}  ignore .id\n",
    }
    decode = rj.Decoder("m.mapping", schema=files, backend=backend)
    write = rj.Encoder.of("can/msg/Frame", schema=files, imports=["can/msg/Frame.msg"], backend="interpreter")
    chosen = random.Random(3)
    for data in (b"\0" * 8, b"\xff" * 8, bytes(range(0x11, 0x99, 0x11)), *(chosen.randbytes(8) for _ in range(4))):
        found = decode(write(write.holder_type.from_dict({"id": 1, "data": list(data)}))).to_dict()
        assert found == {f"s{number}": reference(text, data) for number, text in enumerate(texts)}


def programs(backend: str, rules: str = RULES) -> tuple[rj.Decoder, rj.Encoder, rj.Decoder, rj.Encoder]:
    files = {**FILES, "m.mapping": rules}
    options: dict[str, Any] = {"schema": files, "backend": backend}
    own: dict[str, Any] = {"schema": files, "imports": ["can/msg/Frame.msg"], "backend": "interpreter"}
    return (
        rj.Decoder("m.mapping", **options),
        rj.Encoder("m.mapping", **options),
        rj.Decoder.of("can/msg/Frame", **own),
        rj.Encoder.of("can/msg/Frame", **own),
    )


@pytest.mark.parametrize("backend", BACKENDS)
def test_signals_both_ways(backend):
    decode, encode, read, write = programs(backend)
    chosen = random.Random(5)
    for _ in range(20):
        data = bytearray(chosen.randbytes(8))
        data[2] = data[2] & ~6 | chosen.choice([0, 2, 4])  # no fourth gear
        message = write(write.holder_type.from_dict({"id": 0x1A0, "data": list(data)}))
        state = decode(message)
        assert state.speed == reference("7|16@0+", data) * 0.01
        assert state.torque == reference("20|12@1-", data) * 0.5
        assert (state.brake, state.counter) == (bool(data[2] & 1), data[2] >> 3 & 1)
        assert encode(state) == message
    known = state.to_dict()
    for name, wrong in (("speed", 656.0), ("speed", 0.005), ("torque", 1024.0), ("counter", 2), ("counter", -1), ("rest", 1 << 40)):
        with pytest.raises(rj.EncodeError) as error:
            encode(encode.holder_type.from_dict({**known, name: wrong}))
        assert error.value.kind == "range"
    assert read(encode(state)).id == 0x1A0


def test_laws_of_signals():
    laws = programs("interpreter")[0].mapping.laws
    assert str(laws) == "messages: exact inverse\nholders: exact inverse"
    laws = programs("interpreter", RULES.replace('  .counter <-> signal(.data, "19|1@0+")\n', "  default .counter\n"))[0].mapping.laws
    assert laws is not None
    assert [loss.place for loss in laws.messages.losses] == [".data"]


TURNS = """import "can/msg/Frame.msg"
import "can/msg/Page.msg"
data-holder: can/msg/Page
wire-schema: can/msg/Frame
rules:
  ignore .id
  when signal(.data, "0|8@1+") == 1
    .page <-> signal(.data, "0|8@1+")
    .speed <-> signal(.data, "8|16@1+") * 0.01
    default .heat
  else when signal(.data, "0|8@1+") == 2
    .page <-> signal(.data, "0|8@1+")
    .heat <-> signal(.data, "8|8@1-") * 0.5
    default .speed
  else
    reject "no such page"
  end end
"""


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_signal_says_which_others_a_frame_has(backend):
    files = {**FILES, "can/msg/Page.msg": "uint8 page\nfloat64 speed\nfloat64 heat\n", "m.mapping": TURNS}
    decode, encode = (each("m.mapping", schema=files, encoding="ros1", backend=backend) for each in (rj.Decoder, rj.Encoder))
    for page, data in (
        ({"page": 1, "speed": 100.0, "heat": 0.0}, "0110270000000000"),
        ({"page": 2, "speed": 0.0, "heat": -1.5}, "02fd000000000000"),
    ):
        message = encode(encode.holder_type.from_dict(page))
        assert message.hex() == "00000000" + data
        assert decode(message).to_dict() == page
    with pytest.raises(rj.EncodeError, match="no such page"):
        encode(encode.holder_type.from_dict({"page": 3}))
    with pytest.raises(rj.DecodeError, match="no such page"):
        decode(bytes.fromhex("00000000" + "03fd000000000000"))
