"""Images between ROS 1 and RST: every encoding that both have, padding, byte order and planes, against numpy."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest

import rosetta_jit as rj

pytest.importorskip("rosbags")

from rosbags.typesys import Stores, get_typestore

STORE = get_typestore(Stores.ROS1_NOETIC)
BACKENDS = ["llvm", "python", "interpreter"]
WIDTH, HEIGHT = 5, 3


@dataclass(frozen=True)
class Row:
    """One row of the table of encodings; ``size`` is bytes a channel, ``back`` what packing writes."""

    color: str
    channels: int
    size: int
    back: str
    swapped: bool = False


ENCODINGS = {
    "mono8": Row("COLOR_GRAYSCALE", 1, 1, "mono8"),
    "8UC1": Row("COLOR_GRAYSCALE", 1, 1, "mono8"),
    "mono16": Row("COLOR_GRAYSCALE", 1, 2, "mono16"),
    "16UC1": Row("COLOR_GRAYSCALE", 1, 2, "mono16"),
    "32FC1": Row("COLOR_GRAYSCALE", 1, 4, "32FC1"),
    "rgb8": Row("COLOR_RGB", 3, 1, "rgb8"),
    "rgb16": Row("COLOR_RGB", 3, 2, "rgb16"),
    "bgr8": Row("COLOR_BGR", 3, 1, "bgr8"),
    "bgr16": Row("COLOR_BGR", 3, 2, "bgr16"),
    "yuv422": Row("COLOR_YUV422", 2, 1, "yuv422", swapped=True),
    "yuv422_yuy2": Row("COLOR_YUV422", 2, 1, "yuv422"),
}
DEPTHS = {1: "DEPTH_8U", 2: "DEPTH_16U", 4: "DEPTH_32F"}


@cache
def programs(backend, name="image"):
    decode = rj.Decoder(f"ros1/{name}.mapping", encoding="ros1", backend=backend)
    return decode, rj.Encoder("ros1/image.mapping", encoding="ros1", backend=backend)


def message(**fields):
    stamp = STORE.types["builtin_interfaces/msg/Time"](sec=5, nanosec=6)
    header = STORE.types["std_msgs/msg/Header"](seq=3, stamp=stamp, frame_id="camera")
    made = STORE.types["sensor_msgs/msg/Image"](header=header, **{"width": WIDTH, "height": HEIGHT, "is_bigendian": 0, **fields})
    return bytes(STORE.serialize_ros1(made, made.__msgtype__))


def camera(encoding, padding, *, big):
    """A message, and its pixels as bytes by row, column, channel and byte of the channel, the low one first."""
    row = ENCODINGS[encoding]
    length = WIDTH * row.channels * row.size
    rows = np.random.default_rng(7).integers(0, 256, (HEIGHT, length + padding), np.uint8)
    data = message(encoding=encoding, is_bigendian=int(big), step=length + padding, data=rows.ravel())
    pixels = rows[:, :length].reshape(HEIGHT, WIDTH, row.channels, row.size)
    if row.swapped:
        pixels = pixels[:, :, ::-1]
    return data, pixels[..., ::-1] if big else pixels


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("big", [False, True], ids=["little", "big"])
@pytest.mark.parametrize("padding", [0, 3])
@pytest.mark.parametrize("encoding", ENCODINGS)
def test_every_encoding(encoding, padding, big, backend):
    decode, encode = programs(backend)
    row = ENCODINGS[encoding]
    data, pixels = camera(encoding, padding, big=big)
    image = decode(data)
    found = image.to_dict()
    assert bytes(image.data) == pixels.tobytes()
    assert (found["width"], found["height"], found["channels"]) == (WIDTH, HEIGHT, row.channels)
    assert (found["color_mode"], found["depth"], found["data_order"]) == (row.color, DEPTHS[row.size], "DATA_INTERLEAVED")
    back = STORE.deserialize_ros1(encode(image), "sensor_msgs/msg/Image")
    assert (back.width, back.height, back.encoding, back.is_bigendian) == (WIDTH, HEIGHT, row.back, 0)
    assert back.step == WIDTH * row.channels * row.size
    assert bytes(back.data) == (pixels[:, :, ::-1] if row.back == "yuv422" else pixels).tobytes()


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("big", [False, True], ids=["little", "big"])
@pytest.mark.parametrize("padding", [0, 3])
@pytest.mark.parametrize("encoding", [name for name, row in ENCODINGS.items() if row.channels != 2])
def test_planes(encoding, padding, big, backend):
    decode, encode = programs(backend, "image_planar")
    row = ENCODINGS[encoding]
    data, pixels = camera(encoding, padding, big=big)
    image = decode(data)
    assert bytes(image.data) == pixels.transpose(2, 0, 1, 3).tobytes()
    assert image.to_dict()["data_order"] == "DATA_SEPARATE"
    back = STORE.deserialize_ros1(encode(encode.holder_type.from_dict(image.to_dict())), "sensor_msgs/msg/Image")
    assert (back.encoding, bytes(back.data)) == (row.back, pixels.tobytes())


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("encoding", ["rgba8", "bgra8", "bayer_rggb8", "8SC1", "64FC1", "rgb8 ", "rgb", ""])
def test_other_encodings_are_refused(encoding, backend):
    data = message(encoding=encoding, step=8 * WIDTH, data=np.zeros(8 * WIDTH * HEIGHT, np.uint8))
    for name in ("image", "image_planar"):
        with pytest.raises(rj.DecodeError, match="RST has") as error:
            programs(backend, name)[0](data)
        assert error.value.kind == "rejected"


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    ("step", "size", "kind", "text"),
    [(15, 44, "index", "no such"), (14, 45, "rejected", "the rows overlap"), (1 << 31, 45, "index", "no such")],
)
def test_rows_that_are_not_there(step, size, kind, text, backend):
    with pytest.raises(rj.DecodeError, match=text) as error:
        programs(backend)[0](message(encoding="rgb8", step=step, data=np.zeros(size, np.uint8)))
    assert error.value.kind == kind


IMAGE = {
    "width": 2,
    "height": 1,
    "channels": 3,
    "depth": "DEPTH_8U",
    "color_mode": "COLOR_RGB",
    "data_order": "DATA_SEPARATE",
    "data": bytes(6),
}


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"width": 3}, "do not fill the image"),
        ({"depth": "DEPTH_16U"}, "do not fill the image"),
        ({"channels": 1, "width": 6}, "as many channels as the colors have"),
        ({"color_mode": "COLOR_GRAYSCALE"}, "as many channels as the colors have"),
        ({"color_mode": "COLOR_YUV"}, "no name for these colors"),
        ({"depth": "DEPTH_32F", "data": bytes(24)}, "no name for these colors"),
        ({"color_mode": "COLOR_YUV422", "channels": 2, "data": bytes(4)}, "do not lie side by side"),
    ],
)
def test_images_that_ros_has_no_name_for(change, text, backend):
    _, encode = programs(backend)
    assert encode(encode.holder_type.from_dict(IMAGE))
    with pytest.raises(rj.EncodeError, match=text) as error:
        encode(encode.holder_type.from_dict({**IMAGE, **change}))
    assert error.value.kind == "rejected"


def test_without_words_an_image_is_of_planes_in_rgb():
    """RST's own defaults: three channels of 8 bits, all red first."""
    _, encode = programs("interpreter")
    image = encode.holder_type.from_dict({"width": 2, "height": 1, "data": bytes([1, 2, 3, 4, 5, 6])})
    back = STORE.deserialize_ros1(encode(image), "sensor_msgs/msg/Image")
    assert (back.encoding, bytes(back.data)) == ("rgb8", bytes([1, 3, 5, 2, 4, 6]))
