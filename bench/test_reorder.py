"""Images whose bytes change places, against moving as many bytes: ROS 1 to RST, and back."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import pytest

import rosetta_jit as rj
from bench.contest import Contender
from bench.messages import anew
from bench.ros_wire import Ros1

CHAPTER = "Images in another order"
OURS, MOVE = "rosetta_jit", "memmove"
AT_MOST = 1.6
SIZES = ((640, 480), (1920, 1080))
SWAP = """import "ros1/sensor_msgs/Image.msg"
import "rst/vision/Image.proto"
data-holder: rst.vision.Image
wire-schema: sensor_msgs/Image
unpack-rules:
  ignore .header
  ignore .encoding
  ignore .is_bigendian
  .width = .width
  .height = .height
  default .channels
  default .depth
  default .color_mode
  default .data_order
  .data = reversed(rows(.data, .height, .width * 3, .step), 3)
"""


@dataclass(frozen=True, slots=True)
class Unpack:
    """What is read: bytes a pixel and of padding a row, the encoding; without a ``mapping`` it is `SWAP`."""

    what: str
    encoding: str
    pixel: int
    mapping: str = "ros1/image.mapping"
    padding: int = 0
    big: int = 0


@dataclass(frozen=True, slots=True)
class Pack:
    """What is written, and from which pixels."""

    what: str
    mapping: str
    wire: str
    width_less: int = 0
    image: dict[str, object] = field(default_factory=dict[str, object])


READ = (
    Unpack("image of padded rows, unpadded", "rgb8", 3, padding=8),
    Unpack("image, RGB to BGR", "rgb8", 3, ""),
    Unpack("image, YUV pairs swapped", "yuv422", 2),
    Unpack("image, 16 bits, bytes swapped", "mono16", 2, big=1),
    Unpack("image, interleaved to planar", "rgb8", 3, "ros1/image_planar.mapping"),
    Unpack("image, 16 bits, interleaved to planar", "rgb16", 6, "ros1/image_planar.mapping"),
)
PLANES = {"data_order": "DATA_SEPARATE"}
MIXED = {"data_order": "DATA_INTERLEAVED"}
WRITTEN = (
    Pack("image, planar to interleaved", "ros1/image.mapping", "ros1", 0, PLANES),
    Pack("image, rows padded", "yarp/icub/camera_image.mapping", "yarp3", 2, MIXED),
    Pack("image, planar to interleaved and padded", "yarp/icub/camera_image.mapping", "yarp3", 2, PLANES),
)


@pytest.mark.parametrize("size", SIZES, ids=lambda size: f"{size[0]}x{size[1]}")
@pytest.mark.parametrize("job", READ, ids=lambda job: job.what)
def test_unpacking_against_memmove(job, size, tmp_path, effort, compare, record):
    (tmp_path / "swap.mapping").write_text(SWAP)
    message, pixels = camera(job, *size)

    def decoder():
        return rj.Decoder(job.mapping or tmp_path / "swap.mapping", encoding="ros1")

    assert bytes(decoder()(message).data) == by_numpy(job, pixels).tobytes()
    outcome = compare(
        CHAPTER,
        f"{job.what}, {size[0]}x{size[1]}",
        [
            Contender(OURS, "ours", "an RST image, used again", effort.placed(lambda: effort.call(decoder(), anew(message)))),
            Contender(MOVE, "limit", "as many bytes, elsewhere", effort.placed(lambda: moved(effort, pixels))),
            Contender("numpy, unchecked", "peer", "an array, anew", effort.call(lambda: by_numpy(job, pixels).copy())),
        ],
    )
    record(f"{job.what}, {size[0]}x{size[1]}", outcome.ratio(OURS, MOVE), AT_MOST, "x memmove", took(outcome))


@pytest.mark.parametrize("size", SIZES, ids=lambda size: f"{size[0]}x{size[1]}")
@pytest.mark.parametrize("job", WRITTEN, ids=lambda job: job.what)
def test_packing_against_memmove(job, size, effort, compare, record):
    encode = rj.Encoder(job.mapping, encoding=job.wire)
    width, height = size[0] - job.width_less, size[1]
    source = np.random.default_rng(0).integers(0, 256, width * height * 3, np.uint8)

    fields = {"width": width, "height": height, "channels": 3, "data": source.tobytes(), **job.image}
    image = encode.holder_type.from_dict(fields)
    size_bytes = len(encode(image))
    assert encode.into(image, bytearray(size_bytes)) == size_bytes

    def written():
        return effort.call(encode.into, encode.holder_type.from_dict(fields), bytearray(size_bytes))

    outcome = compare(
        CHAPTER,
        f"{job.what}, {width}x{height}",
        [
            Contender(OURS, "ours", "a message, in a buffer that is there", effort.placed(written)),
            Contender(MOVE, "limit", "as many bytes, elsewhere", effort.placed(lambda: moved(effort, source))),
        ],
    )
    record(f"{job.what}, {width}x{height}", outcome.ratio(OURS, MOVE), AT_MOST, "x memmove", took(outcome))


def moved(effort, pixels):
    """So many bytes, moved from one place to another."""
    return effort.call(np.copyto, np.empty_like(pixels), pixels.copy())


def took(outcome):
    return f"{outcome.took(OURS).median / 1000:.2f} µs"


def camera(job, width, height):
    """A message, and its pixels without padding, as a view of its rows."""
    rows = np.random.default_rng(0).integers(0, 256, (height, width * job.pixel + job.padding), np.uint8)
    wire = Ros1()
    wire.header()
    wire.pack("II", height, width)
    wire.text(job.encoding.encode())
    wire.pack("BI", job.big, rows.shape[1])
    wire.blob(rows.tobytes())
    return bytes(wire.data), rows[:, : width * job.pixel]


def by_numpy(job, pixels):
    if not job.mapping:
        return pixels.reshape(-1, 3)[:, ::-1]
    if job.mapping.endswith("planar.mapping"):
        return pixels.reshape(-1, 3, job.pixel // 3).transpose(1, 0, 2)
    return pixels.reshape(-1, 2)[:, ::-1] if job.pixel == 2 else pixels


COLOURS = ("bayer_rggb8", "yuv422", "nv12")


@pytest.mark.parametrize("encoding", COLOURS)
def test_colours_against_opencv(encoding, effort, compare, record):
    """In one thread; a message to an image of RST against one array to another."""
    cv2 = pytest.importorskip("cv2")
    cv2.setNumThreads(1)
    code = {"bayer_rggb8": cv2.COLOR_BayerRGGB2RGB, "yuv422": cv2.COLOR_YUV2RGB_UYVY, "nv12": cv2.COLOR_YUV2RGB_NV12}[encoding]
    width, height = SIZES[0]
    shape = {"bayer_rggb8": (height, width), "yuv422": (height, width, 2), "nv12": (height * 3 // 2, width)}[encoding]
    pixels = np.random.default_rng(0).integers(0, 256, shape, np.uint8)
    fields = {"height": height, "width": width, "encoding": encoding, "step": pixels.size // shape[0], "data": pixels.tobytes()}
    write = rj.Encoder.of("sensor_msgs/Image", imports=["ros1/sensor_msgs/Image.msg"], encoding="ros1")
    message, target = write(write.holder_type.from_dict(fields)), np.empty((height, width, 3), np.uint8)

    def ours():
        return effort.call(rj.Decoder("ros1/image_rgb.mapping", encoding="ros1"), anew(message))

    contenders = [
        Contender(OURS, "ours", "an RST image, used again", effort.placed(ours)),
        Contender(
            "OpenCV", "peer", "an array, from another", effort.placed(lambda: effort.call(lambda: cv2.cvtColor(pixels, code, target)))
        ),
    ]
    outcome = compare(CHAPTER, f"image, {encoding} to RGB, {width}x{height}", contenders)
    record(f"{encoding} to RGB, {width}x{height}", outcome.ratio(OURS, "OpenCV"), 2.0, "x OpenCV", took(outcome))
