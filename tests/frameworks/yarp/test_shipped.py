"""Messages of the real YARP through the schemas that are shipped for their types, to their values and back to their bytes."""

from __future__ import annotations

import json
import struct
from pathlib import Path

import pytest

import rosetta_jit as rj
from rosetta_jit.frameworks.yarp.bottle import write
from rosetta_jit.frameworks.yarp.tags import DIALECTS, vocab
from rosetta_jit.frameworks.yarp.text import parse_text

VECTORS = Path(__file__).resolve().parents[2] / "vectors" / "yarp"
BACKENDS = ("llvm", "python", "interpreter")
DOUBLE = {"yarp3": 10, "yarp4": 20}
FLOAT = {"yarp3": 128, "yarp4": 10}
PIXELS = {
    "rgb": "Rgb",
    "rgba": "Rgba",
    "bgra": "Bgra",
    "bgr": "Bgr",
    "float": "Float",
    "rgbfloat": "RgbFloat",
    "hsv": "Hsv",
    "monosigned": "MonoSigned",
    "rgbint": "RgbInt",
    "mono": "Mono",
}
XYZ = [{"x": 1.0, "y": 2.0, "z": 3.0}, {"x": -1.0, "y": -2.0, "z": -3.0}]
XYZRGBA = {"x": 1.0, "y": 2.0, "z": 3.0, "b": 30, "g": 20, "r": 10, "a": 40}
VALUES = {
    "vec_double_3": ("Vector", {"values": [1.0, -2.5, 1e-10]}),
    "vec_double_0": ("Vector", {"values": []}),
    "vec_int_4": ("VectorOfInt", {"values": [-2, -1, 0, 1]}),
    "matrix_2x3": ("Matrix", {"rows": 2, "cols": 3, "values": [0.5, 1.5, 2.5, 10.5, 11.5, 12.5]}),
    "matrix_1x1": ("Matrix", {"rows": 1, "cols": 1, "values": [7.0]}),
    "sound_4x2": (
        "Sound",
        {
            "samples": 4,
            "channels": 2,
            "sample_bytes": 2,
            "frequency": 16000,
            "data": [0, 100, 200, 300, 1, 101, 201, 301],
            "markers": [],
        },
    ),
    "pointcloud_xyz_2": ("PointCloudXYZ", {"width": 2, "height": 1, "point_type": 2, "dense": 1, "points": XYZ}),
    "pointcloud_xyzrgba_1": (
        "PointCloudXYZRGBA",
        {"width": 1, "height": 1, "point_type": 0x02000006, "dense": 1, "points": [XYZRGBA]},
    ),
}


def messages(dialect):
    return {entry["name"]: bytes.fromhex(entry["hex"]) for entry in json.loads((VECTORS / f"{dialect}.json").read_text())}


def programs(name, dialect, backend="interpreter"):
    options = {"encoding": dialect, "backend": backend}
    return rj.Decoder.of(name, **options), rj.Encoder.of(name, **options)


def text(words):
    return struct.pack("<i", len(words)) + words


# --- what the real YARP wrote -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("dialect", ["yarp3", "yarp4"])
def test_vectors_matrices_sounds_and_point_clouds(dialect, backend):
    found = messages(dialect)
    for name, (type_, values) in VALUES.items():
        decode, encode = programs(f"yarp.sig.{type_}", dialect, backend)
        assert decode(found[name]).to_dict() == values, name
        assert encode(decode(found[name])) == found[name], name


@pytest.mark.parametrize("dialect", ["yarp3", "yarp4"])
def test_images_of_all_pixels(dialect):
    images = {name: data for name, data in messages(dialect).items() if "img_" in name}
    assert len(images) == 16
    for backend in BACKENDS:
        decode, encode = programs("yarp.sig.FlexImage", dialect, backend)
        for name, data in images.items():
            image = decode(data)
            depth, size, quantum, width, height = struct.unpack_from("<iihxxii" if dialect == "yarp3" else "<5i", data, 32)
            shown = (image.geometry.depth, image.geometry.size, image.geometry.quantum, image.geometry.width, image.geometry.height)
            assert shown == (depth, size, quantum, width, height)
            assert (image.pixel_code, bytes(image.pixels)) == (struct.unpack_from("<i", data, 20)[0], data[60:])
            if dialect == "yarp3":  # a flag that older ones lack
                data = data[:42] + b"\1\0" + data[44:]  # noqa: PLW2901
            assert encode(image) == data, name


@pytest.mark.parametrize("dialect", ["yarp3", "yarp4"])
def test_images_of_one_kind_of_pixel(dialect):
    for name, data in messages(dialect).items():
        if name.startswith("img_"):
            decode, encode = programs(f"yarp.sig.ImageOfPixel{PIXELS[name.split('_')[1]]}", dialect)
            assert encode(decode(data)) == data, name
    decode, _ = programs("yarp.sig.ImageOfPixelRgb", dialect)
    with pytest.raises(rj.DecodeError, match=r"constant: .* at `.pixel_code`"):
        decode(messages(dialect)["img_bgr_4x3"])


@pytest.mark.parametrize("name", ["VectorOfFloat", "VectorOfUnsignedChar"])
def test_vectors_of_yarp4(name):
    decode, encode = programs(f"yarp.sig.{name}", "yarp4")
    data = struct.pack("<ii2f", 256 | 10, 2, 1.5, -2.0) if name == "VectorOfFloat" else struct.pack("<ii3B", 256 | 32, 3, 0, 1, 255)
    assert decode(data).to_dict()["values"] == ([1.5, -2.0] if name == "VectorOfFloat" else [0, 1, 255])
    assert encode(decode(data)) == data


def test_the_dialect_is_found():
    for dialect in ("yarp3", "yarp4"):
        found = messages(dialect)
        for name in ("vec_double_3", "matrix_2x3", "sound_4x2", "pointcloud_xyz_2", "property_a1"):
            type_ = "yarp.os.Property" if name == "property_a1" else f"yarp.sig.{VALUES[name][0]}"
            decode = rj.Decoder.of(type_, backend="python")
            assert decode(found[name]).to_dict() == programs(type_, dialect, "python")[0](found[name]).to_dict()


@pytest.mark.parametrize("dialect", ["yarp3", "yarp4"])
def test_point_clouds_that_promise_too_much(dialect):
    decode, _ = programs("yarp.sig.PointCloudXYZ", dialect)
    cases = json.loads((VECTORS / f"malformed-{dialect}.json").read_text())
    clouds = [bytes.fromhex(case["hex"]) for case in cases if case["kind"] == "pointcloud"]
    clouds += [struct.pack("<iiibiii", 1 << 16, 1 << 16, 2, 1, 256 | DOUBLE[dialect], 0, 0)[: 21 + extra] for extra in (0, 4)]
    assert len(clouds) == 4
    for data in clouds:
        with pytest.raises(rj.DecodeError):
            decode(data)


# --- properties -------------------------------------------------------------------------------------------------------------

PROPERTY = '(a 1) (b 2.5) (c hello) (d true) (e (1.0 2.0)) (f (1 2)) (g ("x y" z)) (h ()) (k {1 2 255})'
PROPERTIES = [
    ("a", "integer", 1),
    ("b", "number", 2.5),
    ("c", "text", "hello"),
    ("d", "vocab", vocab(b"1")),
    ("e", "numbers", [1.0, 2.0]),
    ("f", "integers", [1, 2]),
    ("g", "texts", ["x y", "z"]),
    ("h", "nothing", {}),
    ("k", "blob", b"\1\2\xff"),
]


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("dialect", ["yarp2012", "yarp3", "yarp4"])
def test_properties(dialect, backend):
    decode, encode = programs("yarp.os.Property", dialect, backend)
    data = write(parse_text(PROPERTY, DIALECTS[dialect]), DIALECTS[dialect])
    shown = [(each["key"], each["value"]["_d"], each["value"][each["value"]["_d"]]) for each in decode(data).to_dict()["entries"]]
    assert shown == PROPERTIES
    assert encode(decode(data)) == data


def test_property_of_the_real_yarp():
    for dialect in ("yarp3", "yarp4"):
        decode, encode = programs("yarp.os.Property", dialect)
        data = messages(dialect)["property_a1"]
        assert [(each.key, each.value.integer) for each in decode(data).entries] == [("a", 1)]
        assert encode(decode(data)) == data


def test_properties_are_made_and_found():
    _, encode = programs("yarp.os.Property", "yarp4")
    holder = encode.new()
    holder.entries = [{"key": "name", "value": {"text": "left"}}, {"key": "gain", "value": {"number": 0.5}}]
    assert (holder.find("name").asString(), holder.find("gain").asFloat64()) == ("left", 0.5)
    assert holder.toString() == "(name left) (gain 0.5)"


# --- what the real YARP writes by hand, after its source --------------------------------------------------------------------


@pytest.mark.parametrize("backend", BACKENDS)
def test_markers_of_a_sound(backend):
    marker = struct.pack("<ii", 256, 4) + text(b"k") + text(b"begin") + struct.pack("<iq", 1, 1 << 40)
    data = messages("yarp4")["sound_4x2"][:-4] + struct.pack("<i", 2) + marker * 2
    decode, encode = programs("yarp.sig.Sound", "yarp4", backend)
    assert decode(data).to_dict()["markers"] == [{"key": "k", "label": "begin", "channel": 1, "sample": 1 << 40}] * 2
    assert encode(decode(data)) == data
    with pytest.raises(rj.EncodeError, match=r"count: .* at `.markers`"):
        programs("yarp.sig.Sound", "yarp3", backend)[1](decode(data))


@pytest.mark.parametrize("name", ["XY", "XYZ", "XYZI", "InterestPointXYZ", "Normal", "XYZNormal", "XYZRGBA", "XYZNormalRGBA"])
@pytest.mark.parametrize("dialect", ["yarp3", "yarp4"])
def test_kinds_of_points(dialect, name):
    sizes = {"XY": 8, "XYZ": 16, "XYZNormal": 48, "XYZNormalRGBA": 48}
    decode, encode = programs(f"yarp.sig.PointCloud{name}", dialect)
    cloud = encode.new()
    cloud.width, cloud.height, cloud.points = 3, 2, [{}] * 6
    data = encode(cloud)
    assert len(data) == 13 + 8 + 6 * sizes.get(name, 32)
    assert struct.unpack_from("<ii", data, 13) == (256 | DOUBLE[dialect], 6)
    assert encode(decode(data)) == data
    cloud.height = 3
    with pytest.raises(rj.EncodeError, match="must agree"):
        encode(cloud)


def blobs(pixel, width, height, dialect):
    """An image of bytes as LayeredImage writes it: its header as a blob, and its pixels as another."""
    size = (width + 7) // 8 * 8 * height
    quantum = 8 if dialect == "yarp4" else 8 | 1 << 16
    head = struct.pack("<ii i4s i4s ii 5i ii", 256, 4, 9, b"mat", 9, b"mono", 257, 5, 1, size, quantum, width, height, 12, size)
    return struct.pack("<ii", 12, 60) + head + struct.pack("<ii", 12, size) + bytes([pixel] * size)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("dialect", ["yarp3", "yarp4"])
def test_layered_images(dialect, backend):
    decode, encode = programs("yarp.sig.LayeredImage", dialect, backend)
    layer = struct.pack("<ibibiiibifibiiii", 32, 1, 32, 0, 1, 255, 32, 1, FLOAT[dialect], 0.5, 32, 0, 1, 3, 1, -4)
    for count in (0, 1, 2):
        data = struct.pack("<iiii", 256, 3 + 10 * count, 1, count) + blobs(7, 5, 3, dialect) + (layer + blobs(9, 4, 2, dialect)) * count
        image = decode(data)
        assert (image.header.geometry.width, bytes(image.pixels), len(image.layers)) == (5, b"\7" * 24, count)
        for each in image.layers:
            assert (each.enabled, each.color_key, each.alpha, each.offset_y, bytes(each.pixels)) == (1, 255, 0.5, -4, b"\x09" * 16)
        assert encode(image) == data
        with pytest.raises(rj.DecodeError):
            decode(data[:4] + struct.pack("<i", 4 + 10 * count) + data[8:])


@pytest.mark.parametrize(("dialect", "tag"), [("yarp3", 10), ("yarp4", 20)])
def test_stamps(dialect, tag):
    decode, encode = programs("yarp.os.Stamp", dialect)
    data = struct.pack("<iiiiid", 256, 2, 1, 7, tag, 2.5)
    assert (decode(data).sequence, decode(data).time) == (7, 2.5)
    assert encode(decode(data)) == data
