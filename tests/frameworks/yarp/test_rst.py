"""The shipped mappings between YARP's images, vectors and matrices and RST: bytes of real YARP in, values by numpy, and back."""

from __future__ import annotations

import json
import struct
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import rosetta_jit as rj

VECTORS = Path(__file__).resolve().parents[2] / "vectors" / "yarp"
GRAY, RGB, BGR = ("COLOR_GRAYSCALE", "COLOR_RGB", "COLOR_BGR")
KINDS = {
    "rgb": (RGB, 8, 3),
    "bgr": (BGR, 8, 3),
    "float": (GRAY, 32, 1),
    "rgbfloat": (RGB, 32, 3),
}
"""Pixels that RST has a word for: colors, bits and channels."""
DEPTHS = {
    "rgb": [8] * 3,
    "bgr": [8] * 3,
    "rgba": [8] * 4,
    "bgra": [8] * 4,
    "float": [32],
    "rgbfloat": [32] * 3,
    "rgbint": [32] * 3,
    "hsv": [8] * 3,
    "monosigned": [8],
}


@cache
def messages(dialect):
    return {entry["name"]: bytes.fromhex(entry["hex"]) for entry in json.loads((VECTORS / f"{dialect}.json").read_text())}


@cache
def programs(name, dialect, backend, **parameters):
    path = f"yarp/sig/{name}.mapping"
    given = {each: list(value) if isinstance(value, tuple) else value for each, value in parameters.items()}
    return tuple(kind(path, encoding=dialect, backend=backend, parameters=given) for kind in (rj.Decoder, rj.Encoder))


def parts(data):
    """Pixel code, width, height, and the rows of a captured image without their padding."""
    code = data[20:24]
    depth, size = struct.unpack_from("<2i", data, 32)
    width, height = struct.unpack_from("<2i", data, 44)
    rows = np.frombuffer(data[60:], np.uint8).reshape(height, -1) if height else np.zeros((0, 0), np.uint8)
    assert size == len(data) - 60
    return code.rstrip(b"\0").decode(), width, height, rows[:, : width * depth].tobytes()


@pytest.mark.parametrize(("dialect", "backend"), [("yarp3", "python"), ("yarp4", "llvm")])
def test_images(dialect, backend):
    decode, encode = programs("image", dialect, backend)
    read = rj.Decoder.of("yarp.sig.FlexImage", encoding=dialect, backend="interpreter")
    for name, data in messages(dialect).items():
        if not name.startswith("img_"):
            continue
        _, width, height, pixels = parts(data)
        kind = name.split("_")[1]
        if kind not in KINDS:
            with pytest.raises(rj.DecodeError, match="RST has no such pixels"):
                decode(data)
            continue
        colors, bits, channels = KINDS[kind]
        head = {"width": width, "height": height, "channels": channels, "depth": f"DEPTH_{bits}{'F' if bits == 32 else 'U'}"}
        assert decode(data).to_dict() == {**head, "color_mode": colors, "data_order": "DATA_INTERLEAVED", "data": pixels}, name
        assert parts(encode(decode(data))) == parts(data), name
        if width:
            planes = np.frombuffer(pixels, np.uint8).reshape(width * height, channels, bits // 8).swapaxes(0, 1).tobytes()
            planar = {**decode(data).to_dict(), "data_order": "DATA_SEPARATE", "data": planes}
            assert read(encode(encode.holder_type.from_dict(planar))).to_dict() == read(encode(decode(data))).to_dict()


@pytest.mark.parametrize("backend", ["llvm", "python"])
def test_images_that_a_simulator_cannot_send(backend):
    """Grey ones, of which no vector is at hand with this header, are those that the header's own words describe."""
    decode, encode = programs("image", "yarp4", backend)
    write = rj.Encoder.of("yarp.sig.FlexImage", encoding="yarp4", backend="interpreter")
    for code, bits in ((b"mono", 8), (b"mo16", 16)):
        size = 3 * bits // 8
        geometry = {"depth": bits // 8, "quantum": 8, "width": 3, "height": 2}
        rows = np.arange(16, dtype=np.uint8).reshape(2, 8)
        rows[:, size:] = 0
        values = {"pixel_code": int.from_bytes(code, "little"), "geometry": geometry, "pixels": rows.tobytes()}
        sent = write(write.holder_type.from_dict(values))
        found = decode(sent).to_dict()
        assert (found["color_mode"], found["depth"], found["data"]) == (GRAY, f"DEPTH_{bits}U", rows[:, :size].tobytes())
        assert encode(decode(sent)) == sent
    values["geometry"]["depth"] = 1
    with pytest.raises(rj.DecodeError, match="other sizes than their code says"):
        decode(write(write.holder_type.from_dict(values)))
    held = {
        "width": 1,
        "height": 1,
        "channels": 3,
        "depth": "DEPTH_16U",
        "color_mode": RGB,
        "data_order": "DATA_INTERLEAVED",
        "data": bytes(6),
    }
    for change, words in (
        ({}, "no colors of 16 bits"),
        ({"color_mode": BGR, "depth": "DEPTH_32F", "data": bytes(12)}, "green and red have 8 bits"),
        ({"color_mode": "COLOR_YUV"}, "how the bytes of YUV lie"),
        ({"data": bytes(5)}, "do not fill the image"),
        ({"channels": 1, "data": bytes(2)}, "as many channels"),
    ):
        with pytest.raises(rj.EncodeError, match=words):
            encode(encode.holder_type.from_dict({**held, **change}))


@pytest.mark.parametrize(("dialect", "backend"), [("yarp3", "python"), ("yarp4", "llvm")])
def test_images_of_all_pixels(dialect, backend):
    decode, encode = programs("image_example", dialect, backend)
    for name, data in messages(dialect).items():
        if name.startswith("img_"):
            code, width, height, pixels = parts(data)
            found = decode(data)
            properties = [{"key": "pixel_code", "value": code}]
            depths = DEPTHS[name.split("_")[1]]
            assert found.to_dict() == {"meta_data": properties, "width": width, "height": height, "depths": depths, "data": pixels}, name
            assert parts(encode(found)) == parts(data), name
    wrong = encode.holder_type.from_dict({"meta_data": [{"key": "pixel_code", "value": "mo16"}], "width": 1, "height": 1, "depths": [8]})
    with pytest.raises(rj.EncodeError, match="other bits than their code"):
        encode(wrong)


@pytest.mark.parametrize(("dialect", "backend"), [("yarp3", "python"), ("yarp4", "llvm")])
def test_vectors_of_any_length(dialect, backend):
    decode, encode = programs("vector", dialect, backend)
    for name, count in (("vec_double_0", 0), ("vec_double_3", 3), ("icub_head_state_6", 6), ("icub_arm_state_16", 16)):
        data = messages(dialect)[name]
        degrees = np.frombuffer(data[8:], "<f8")
        assert len(degrees) == count
        angles = decode(data)
        assert np.array_equal(angles.angles, np.radians(degrees).astype(np.float32))
        back = np.frombuffer(encode(angles)[8:], "<f8")
        assert np.allclose(back, degrees, rtol=2e-7, atol=0)


@pytest.mark.parametrize(("dialect", "backend"), [("yarp3", "python"), ("yarp4", "llvm")])
def test_matrices(dialect, backend):
    decode, encode = programs("matrix", dialect, backend)
    for name in ("matrix_1x1", "matrix_2x3"):
        data = messages(dialect)[name]
        found = decode(data)
        assert f"matrix_{found.size.m}x{found.size.n}" == name
        assert bytes(np.asarray(found.data.value)) == data[-8 * found.size.m * found.size.n :]
        assert encode(found) == data
    found.size.m = 4
    with pytest.raises(rj.EncodeError, match="must agree with the fields that determine it"):
        encode(found)
    empty = encode.holder_type.from_dict({"size": {"m": 0, "n": 3}, "data": {}})
    assert decode(encode(empty)).to_dict() == {"size": {"m": 0, "n": 3}, "data": {"value": []}}


@pytest.mark.parametrize("backend", ["llvm", "python"])
def test_joints_with_names(backend):
    data = messages("yarp3")["icub_torso_state_3"]
    degrees = np.frombuffer(data[8:], "<f8")
    for name, given, expected in (
        ("joints_by_rule", {"prefix": "torso_", "first": 1}, [b"torso_1", b"torso_2", b"torso_3"]),
        ("joints", {"names": ("a", "b", "c")}, [b"a", b"b", b"c"]),
    ):
        decode, encode = programs(name, "yarp3", backend, **given)
        joints = decode(data).joints
        assert [bytes(each.name) for each in joints] == expected
        assert [each.value for each in joints] == np.radians(degrees).astype(np.float32).tolist()
        assert np.allclose(np.frombuffer(encode(decode(data))[8:], "<f8"), degrees, rtol=2e-7, atol=0)
        other = decode(data).to_dict()
        other["joints"][1]["name"] = b"elbow"
        with pytest.raises(rj.EncodeError, match="joint 1 has another name"):
            encode(encode.holder_type.from_dict(other))
    with pytest.raises(rj.DecodeError, match="there are 3 joints, and not as many names"):
        programs("joints", "yarp3", backend, names=("a",))[0](data)
