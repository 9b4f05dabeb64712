"""Images of random sizes, paddings and orders through the shipped mappings, against numpy."""

from __future__ import annotations

import random
from functools import cache

import numpy as np
import pytest

import rosetta_jit as rj

IMAGES = 6
ENCODINGS = {
    "mono8": ("GRAYSCALE", 1, 1),
    "mono16": ("GRAYSCALE", 1, 2),
    "32FC1": ("GRAYSCALE", 1, 4),
    "rgb8": ("RGB", 3, 1),
    "bgr8": ("BGR", 3, 1),
    "rgb16": ("RGB", 3, 2),
    "bgr16": ("BGR", 3, 2),
    "yuv422": ("YUV422", 2, 1),
}
"""What ROS calls pixels: their colors, channels, and bytes of a channel."""

DEPTHS = {1: "DEPTH_8U", 2: "DEPTH_16U", 4: "DEPTH_32F"}
CAMERAS = {"camera_image": ("RGB", False), "camera_image_bgr": ("BGR", False), "camera_image_planar": ("RGB", True)}
"""The mappings of YARP's cameras: the colors, and whether unpacking makes planes."""


@cache
def program(kind, name, encoding, backend):
    return kind(f"{name}.mapping", encoding=encoding, backend=backend)


@cache
def writer(wire, encoding):
    return rj.Encoder.of(wire, imports=[IMPORTS[wire]], encoding=encoding, backend="python")


IMPORTS = {"sensor_msgs/Image": "ros1/sensor_msgs/Image.msg", "yarp.icub.camera.image": "yarp/icub/camera_image.bottle-schema"}


def picture(rng, channels, size):
    """Pixels by row, column, channel and byte of the channel, the low one first."""
    height, width = rng.choice([1, 2, 3, 5]), rng.choice([1, 2, 3, 4, 7])
    return np.frombuffer(rng.randbytes(height * width * channels * size), np.uint8).reshape(height, width, channels, size)


def in_rows(rng, pixels, stride):
    """The bytes of pixels whose rows begin ``stride`` apart, with anything behind each."""
    rows = pixels.reshape(pixels.shape[0], -1)
    padding = [np.frombuffer(rng.randbytes(stride - rows.shape[1]), np.uint8) for _ in rows]
    return b"".join(bytes(row) + bytes(more) for row, more in zip(rows, padding, strict=True))


def image(pixels, color, *, is_planar):
    height, width, channels, size = pixels.shape
    data = pixels.transpose(2, 0, 1, 3) if is_planar else pixels
    return {
        "data": data.tobytes(),
        "width": width,
        "height": height,
        "channels": channels,
        "depth": DEPTHS[size],
        "color_mode": f"COLOR_{color}",
        "data_order": "DATA_SEPARATE" if is_planar else "DATA_INTERLEAVED",
    }


def check_ros(seed, backend):
    rng = random.Random(f"ros {seed}")
    for _ in range(IMAGES):
        encoding = rng.choice(list(ENCODINGS))
        is_planar = encoding != "yuv422" and rng.random() < 0.5
        color, channels, size = ENCODINGS[encoding]
        decode = program(rj.Decoder, f"ros1/image{'_planar' if is_planar else ''}", "ros1", backend)
        encode, write = program(rj.Encoder, "ros1/image", "ros1", backend), writer("sensor_msgs/Image", "ros1")
        pixels, is_big = picture(rng, channels, size), rng.random() < 0.5
        sent = pixels[..., ::-1] if is_big else pixels
        sent = sent[:, :, ::-1] if encoding == "yuv422" else sent
        height, width = pixels.shape[:2]
        step = width * channels * size + rng.choice([0, 0, 1, 5])
        header = {"header": {"seq": 1, "stamp": {"secs": 2, "nsecs": 3}, "frame_id": "x"}}
        values = {**header, "width": width, "height": height, "encoding": encoding, "is_bigendian": int(is_big), "step": step}
        found = decode(write(write.holder_type.from_dict({**values, "data": in_rows(rng, sent, step)}))).to_dict()
        assert found == image(pixels, color, is_planar=is_planar), (seed, backend, values)
        back = decode(encode(encode.holder_type.from_dict(found))).to_dict()
        assert back == found, (seed, backend, values)


def check_cameras(seed, backend):
    rng = random.Random(f"yarp {seed}")
    for _ in range(IMAGES):
        name = rng.choice(list(CAMERAS))
        color, is_planar = CAMERAS[name]
        encoding = rng.choice(["yarp3", "yarp4"])
        decode, encode = (program(kind, f"yarp/icub/{name}", encoding, backend) for kind in (rj.Decoder, rj.Encoder))
        write = writer("yarp.icub.camera.image", encoding)
        pixels, quantum = picture(rng, 3, 1), rng.choice([1, 2, 4, 8, 8])
        height, width = pixels.shape[:2]
        sent = in_rows(rng, pixels, -(-3 * width // quantum) * quantum)
        geometry = {"quantum": quantum, "width": width, "height": height}
        message = write(write.holder_type.from_dict({"geometry": geometry, "pixels": sent}))
        seen = pixels[:, :, ::-1] if color == "BGR" else pixels
        found = decode(message).to_dict()
        assert found == image(seen, color, is_planar=is_planar), (seed, backend, name, geometry)
        other = image(seen, color, is_planar=rng.random() < 0.5)
        again = decode(encode(encode.holder_type.from_dict(other))).to_dict()
        assert again == found, (seed, backend, name, geometry)


@pytest.mark.parametrize("backend", ["llvm", "python"])
@pytest.mark.parametrize("check", [check_ros, check_cameras])
def test_images(check, backend):
    check(0, backend)


@pytest.mark.campaign
@pytest.mark.parametrize("block", range(10))
def test_campaign(block):
    for seed in range(100 * block + 1000, 100 * block + 1100):
        for backend in ("llvm", "python"):
            check_ros(seed, backend)
            check_cameras(seed, backend)
