"""A gamepad as it goes over a radio link: a bit a button, a byte an axis."""

from __future__ import annotations

import numpy as np
import pytest

import rosetta_jit as rj

GAMEPAD = "packed/gamepad.mapping"


def test_a_bit_a_button() -> None:
    decode, encode = rj.Decoder(GAMEPAD), rj.Encoder(GAMEPAD)
    read = rj.Decoder.of("rosetta_jit/GamepadFrame")
    buttons = [1, 0, 0, 1, 1, 0, 0, 0, 1, 0, 1]
    joy = encode.holder_type.from_dict({"header": {"frame_id": "pad"}, "axes": [1.0, -1.0, 0.0, 64 / 127], "buttons": buttons})
    frame = read(encode(joy))
    assert frame.held == sum(bit << number for number, bit in enumerate(buttons))
    assert frame.axes.tolist() == [127, -127, 0, 64]
    found = decode(encode(joy))
    assert found.buttons.tolist() == buttons
    assert np.allclose(found.axes, joy.axes, atol=1 / 254)
    assert encode(found) == encode(joy)


def test_all_frames_come_back() -> None:
    decode, encode = rj.Decoder(GAMEPAD), rj.Encoder(GAMEPAD)
    write = rj.Encoder.of("rosetta_jit/GamepadFrame")
    frame = write.holder_type.from_dict({"axes": list(range(-127, 128))})
    for frame.held in range(1 << 11):
        message = write(frame)
        assert encode(decode(message)) == message


@pytest.mark.parametrize("wrong", [{"buttons": [0] * 10}, {"buttons": [0] * 10 + [2]}, {"buttons": [0] * 11, "axes": [1.01]}])
def test_what_no_frame_can_say_is_refused(wrong) -> None:
    encode = rj.Encoder(GAMEPAD)
    with pytest.raises(rj.EncodeError):
        encode(encode.holder_type.from_dict(wrong))
