"""Real YARP beside us, where it is installed: it reads what we write, we read what it writes, and both print and parse alike."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import rosetta_jit as rj
from rosetta_jit.frameworks.yarp.bottle import read, write
from rosetta_jit.frameworks.yarp.tags import YARP3, YARP4, vocab
from rosetta_jit.frameworks.yarp.text import parse_text, to_text
from rosetta_jit.frameworks.yarp.tree import Dict, List, specialised
from tests.frameworks.yarp.real_yarp import build, seems_installed
from tests.frameworks.yarp.test_bottle import BOTTLES

if not seems_installed():
    pytest.skip("YARP is not installed: `make yarp` builds it", allow_module_level=True)

RANDOM = np.random.default_rng(20120401)
PIXELS = {
    "Mono": (1, 1), "Mono16": (2, 1), "Rgb": (1, 3), "Rgba": (1, 4), "Bgr": (1, 3), "Bgra": (1, 4), "Hsv": (1, 3), "Int": (4, 1),
    "Float": (4, 1), "RgbInt": (4, 3), "RgbFloat": (4, 3), "MonoSigned": (1, 1),
}  # fmt: skip
"""Bytes of a channel, and channels."""

POINTS = ("XY", "XYZ", "XYZI", "XYZRGBA", "Normal", "XYZNormal", "XYZNormalRGBA", "InterestPointXYZ")


@pytest.fixture(scope="module")
def yarp(tmp_path_factory):
    found = build(tmp_path_factory.mktemp("real"))
    if found is None:
        pytest.skip("YARP is not installed")
    yield found
    found.close()


@pytest.fixture
def dialect(yarp):
    return YARP4 if yarp.version.startswith("4") else YARP3


def normal(item):
    """As YARP writes it: a list of one kind of element is a specialised one."""
    return specialised([normal(each) for each in item.items]) if isinstance(item, List) else item


def has_dict(item):
    """Whether there is a dict in it, of which YARP keeps what has a key, in an order of its own."""
    return isinstance(item, Dict) or (isinstance(item, List) and any(map(has_dict, item.items)))


@settings(max_examples=300, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(bottle=BOTTLES.filter(lambda bottle: not has_dict(bottle)))
def test_bottles_survive_it(yarp, dialect, bottle):
    written = write(bottle, dialect)
    assert read(yarp.rewritten("yarp.os.Bottle", written), dialect) == normal(bottle)
    assert yarp.text_of(written) == to_text(bottle)


TEXT = st.text(st.sampled_from('ab1290.-+e(){}[]" \\x,\n'), max_size=30)


@settings(max_examples=500, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(text=TEXT)
def test_text_is_parsed_as_it_does(yarp, dialect, text):
    assert write(parse_text(text, dialect), dialect) == yarp.bytes_of(text.encode())


def survives(yarp, dialect, name, fill):
    """Fill a message of a type, write it, let YARP read it and write it again: the same bytes, and ours to read."""
    encode = rj.Encoder.of(name, encoding=dialect.name, backend="llvm")
    holder = encode.new()
    fill(holder)
    written = encode(holder)
    again = yarp.rewritten(name, written)
    assert again == written
    assert encode(rj.Decoder.of(name, encoding=dialect.name, backend="llvm")(again)) == written


def fill_image(image, size, bytes_, channels):
    image.geometry.width, image.geometry.height, image.geometry.quantum = width, height, quantum = size
    rows = np.zeros((height, -(-width * bytes_ * channels // quantum) * quantum), np.uint8)
    rows[:, : width * bytes_ * channels] = RANDOM.integers(0, 256, (height, width * bytes_ * channels))
    image.pixels = rows.tobytes()


@pytest.mark.parametrize("size", [(1, 1, 8), (5, 3, 8), (16, 2, 1), (7, 4, 4)])
@pytest.mark.parametrize("pixel", PIXELS)
def test_images(yarp, dialect, pixel, size):
    survives(yarp, dialect, f"yarp.sig.ImageOfPixel{pixel}", lambda image: fill_image(image, size, *PIXELS[pixel]))


@pytest.mark.parametrize(("pixel", "bytes_"), [("HsvFloat", 4), ("RgbSigned", 1)])
def test_images_that_it_declares_and_dies_of(yarp, dialect, pixel, bytes_):
    with pytest.raises(ValueError, match="dies"):
        survives(yarp, dialect, f"yarp.sig.ImageOfPixel{pixel}", lambda image: fill_image(image, (2, 2, 8), bytes_, 3))


@pytest.mark.parametrize("points", POINTS)
def test_point_clouds(yarp, dialect, points):
    def fill(cloud):
        cloud.width, cloud.height = 3, 2
        cloud.points = [{} for _ in range(6)]
        for point in cloud.points:
            for name, value in point.to_dict().items():
                setattr(point, name, type(value)(RANDOM.integers(0, 100)))

    survives(yarp, dialect, f"yarp.sig.PointCloud{points}", fill)


def test_numbers(yarp, dialect):
    def vector(holder):
        holder.values = RANDOM.normal(size=7)

    def integers(holder):
        holder.values = RANDOM.integers(-1000, 1000, 5)

    def matrix(holder):
        holder.rows, holder.cols, holder.values = 2, 3, RANDOM.normal(size=6)

    def stamp(holder):
        holder.sequence, holder.time = 17, 1234.5

    survives(yarp, dialect, "yarp.sig.Vector", vector)
    survives(yarp, dialect, "yarp.sig.VectorOfInt", integers)
    survives(yarp, dialect, "yarp.sig.Matrix", matrix)
    survives(yarp, dialect, "yarp.os.Stamp", stamp)


def test_sounds(yarp, dialect):
    def fill(sound):
        sound.samples, sound.channels, sound.sample_bytes, sound.frequency = 4, 2, 2, 16_000
        sound.data = RANDOM.integers(-(2**15), 2**15, 8)

    def fill_as_image(sound):
        sound.image.pixel_code, sound.image.geometry.depth, sound.more.frequency = vocab(b"mo16"), 2, 16_000
        fill_image(sound.image, (4, 2, 2), 2, 1)

    if yarp.version.startswith("3.5"):
        survives(yarp, dialect, "yarp.sig.SoundImage", fill_as_image)
    else:
        survives(yarp, dialect, "yarp.sig.Sound", fill)


@pytest.mark.parametrize(
    "value",
    [
        {"integer": 5},
        {"number": 0.5},
        {"text": "left arm"},
        {"vocab": 1},
        {"blob": b"\0\1\2"},
        {"numbers": [0.5, 1.5]},
        {"integers": [1, 2, 3]},
        {"texts": ["a", "b"]},
    ],
)
def test_properties(yarp, dialect, value):
    def fill(holder):
        holder.entries = [{"key": "only", "value": value}]

    survives(yarp, dialect, "yarp.os.Property", fill)
