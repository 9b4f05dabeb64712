"""The bundled recordings of the real YARP, against an independent computation in numpy."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import rosetta_jit as rj
from rosetta_jit.recording import read_messages

RECORDINGS = Path(__file__).resolve().parents[2] / "rosetta_jit" / "demo" / "recordings"
LAYOUTS = {
    "camera_image": lambda pixels: pixels,
    "camera_image_bgr": lambda pixels: pixels[..., ::-1],
    "camera_image_planar": lambda pixels: pixels.transpose(2, 0, 1),
}


def messages(dialect, name):
    return [message.data for message in read_messages(RECORDINGS / f"icub-{dialect}" / f"{name}.rec.xz")]


@pytest.mark.parametrize("encoding", ["own", "yarp"])
@pytest.mark.parametrize("dialect", ["yarp3", "yarp4"])
@pytest.mark.parametrize(("name", "begin"), [("torso_state", 8), ("left_arm_state", 8), ("torso_command", 32)])
def test_joints(dialect, name, begin, encoding):
    decode = rj.Decoder(f"yarp/icub/{name}.mapping", encoding=dialect if encoding == "own" else encoding, backend="llvm")
    encode = rj.Encoder(f"yarp/icub/{name}.mapping", encoding=dialect, backend="llvm")
    for message in messages(dialect, name):
        degrees = np.frombuffer(message, "<f8", offset=begin)
        angles = decode(message)
        assert np.array_equal(angles.angles, (degrees * (np.pi / 180)).astype(np.float32))
        written = encode(angles)
        assert written[:begin] == message[:begin]
        assert np.allclose(np.frombuffer(written, "<f8", offset=begin), degrees, rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize("dialect", ["yarp3", "yarp4"])
@pytest.mark.parametrize("name", ["cam_left", "cam_right", "cam_odd_width"])
@pytest.mark.parametrize("mapping", LAYOUTS)
def test_images(dialect, name, mapping):
    decode = rj.Decoder(f"yarp/icub/{mapping}.mapping", encoding=dialect, backend="llvm")
    encode = rj.Encoder(f"yarp/icub/{mapping}.mapping", encoding=dialect, backend="llvm")
    for message in messages(dialect, name):
        width, height = np.frombuffer(message, "<i4", 2, offset=44)
        rows = np.frombuffer(message, np.uint8, offset=60).reshape(height, -1)
        pixels = rows[:, : width * 3].reshape(height, width, 3)
        image = decode(message)
        assert (image.width, image.height, image.channels) == (width, height, 3)
        assert np.array_equal(image.view("data"), LAYOUTS[mapping](pixels).ravel())
        written = np.frombuffer(encode(image), np.uint8)
        assert bytes(written[:60]) == message[:60]
        assert np.array_equal(written[60:].reshape(height, -1)[:, : width * 3], rows[:, : width * 3])  # YARP leaves rubbish in the padding
