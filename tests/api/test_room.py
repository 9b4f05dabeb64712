"""New holders of a decoder have room for what it has decoded, so that none makes it again."""

from __future__ import annotations

import pytest

import rosetta_jit as rj

CAMERA = "sensor_msgs/CameraInfo"


@pytest.fixture(params=["llvm", "python"])
def decode(request):
    return rj.Decoder.of(CAMERA, encoding="ros1", backend=request.param)


def message(distortions, name=""):
    holder = rj.Decoder.of(CAMERA, encoding="ros1").new()
    holder.distortion_model = name
    holder.D = range(distortions)
    return rj.Encoder.of(CAMERA, encoding="ros1")(holder)


def memory(holder):
    return [buffer.__array_interface__["data"][0] for buffer in holder.lanes_.buffers]


def test_a_message_like_the_last_finds_room(decode):
    sent = message(100, "plumb_bob" * 20)
    tight = decode.new()
    before = memory(tight)
    decode.into(sent, tight)
    assert memory(tight) != before
    roomy = decode.new()
    before = memory(roomy)
    assert decode.into(sent, roomy).D.tolist() == list(range(100))
    assert memory(roomy) == before
    assert roomy == tight


def test_nothing_else_is_new_in_them(decode):
    fresh = decode.holder_type()
    decode(message(100, "plumb_bob" * 20))
    roomy = decode.new()
    assert roomy == fresh
    assert roomy.K.tolist() == [0] * 9  # born with its elements
    encode = rj.Encoder.of(CAMERA, encoding="ros1")
    assert encode(roomy) == encode(fresh)


def test_room_for_much_is_made_when_it_is_needed(decode):
    decode(message(100))
    decode(message(100_000))
    assert decode.new().lanes_.plan.size_bytes < 4096
    decode.new()  # as before
    assert decode.into(message(3), decode.new()).D.tolist() == [0, 1, 2]
