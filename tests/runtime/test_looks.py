"""How messages, their classes and programs look to people: help, completion, representations, notebooks."""

from __future__ import annotations

import base64
import inspect
import io
import pydoc
import re
from rlcompleter import Completer

import numpy as np
import pytest
from PIL import Image

import rosetta_jit as rj
from rosetta_jit.runtime.looks.brief import brief_message

HOSTILE = "<script>alert(1)</script>\"'&<img src=x onerror=alert(1)>"
Y, X = np.mgrid[0:12, 0:16]
COLORS = np.stack([X * 15, Y * 20, (X + Y) * 7], 2).astype(np.uint8)


@pytest.fixture(scope="module")
def decoder():
    return rj.Decoder.of("sensor_msgs/Imu", encoding="ros1")


def test_help_shows_fields_and_no_internals(decoder):
    text = pydoc.render_doc(decoder.holder_type, renderer=pydoc.plaintext)
    assert " |  orientation_covariance: float64[9]\n" in text
    assert re.search(r"Imu\(\s*(\| *)?header=...,\s*(\| *)?orientation=...,", text)
    assert not re.findall(r"\b(?:lanes_|family_|access_|parent_|entry_|index_|programs_|lay_out_|picture_|_kept_\d)", text)
    text = pydoc.render_doc(decoder, renderer=pydoc.plaintext)
    assert "Decodes messages into holders" in text
    assert "orientation_covariance: float64[9]\n" in text
    assert "many: Decode many messages, without the interpreter lock.\n" in text
    assert not re.findall(r"call_slowly|\b\w+_:", text)
    text = pydoc.render_doc(rj.Batch, renderer=pydoc.plaintext)
    assert re.findall(r"\b[a-z]\w+\b", text.partition("Data descriptors")[2].partition("---")[0]) == ["defined", "here", "errors", "lanes"]
    assert not re.findall(r"_family|_handed|_kept", text)
    assert "sensor_msgs" not in pydoc.render_doc(rj.Decoder, renderer=pydoc.plaintext)


@pytest.mark.parametrize("of", [rj.Decoder, rj.Encoder, rj.Bridge, rj.Decoders, rj.Encoders])
def test_classes_show_no_internals(of):
    text = pydoc.render_doc(of, renderer=pydoc.plaintext)
    assert not re.findall(r"^ \|  (?!__)(?:\w+_|_\w+)\b", text, re.MULTILINE)


def test_units_and_enums_stand_in_the_docstring():
    schema = {
        "j.bottle-schema": '"j" (("angle" :double (:unit "degree")))',
        "c.proto": 'syntax = "proto3"; package c; enum Color { RED = 0; BLUE = 7; } message M { Color color = 1; optional int32 n = 2; }',
    }
    of = {"backend": "python", "schema": schema}
    assert "angle: float64, degree" in rj.Decoder.of("j", encoding="yarp3", imports=["j.bottle-schema"], **of).new().__doc__
    made = rj.Decoder.of("c.M", imports=["c.proto"], **of).holder_type
    assert "color: Color: RED = 0, BLUE = 7" in made.__doc__
    assert "n: int32, may be absent" in inspect.getdoc(made)


def test_completion_offers_what_is_meant_to_be_used(decoder):
    offered = {name for name in dir(decoder.new()) if not name.startswith("_")}
    assert {"header", "orientation", "serialize", "to_dict"} <= offered
    assert not [name for name in offered if name.endswith("_")]
    assert set(dir(decoder.new().header)) >= {"stamp", "frame_id", "seq"}
    assert {name for name in dir(decoder) if not name.startswith("_")} == {
        "builtin", "definition", "holder_type", "into", "to", "kernel", "many", "mapping", "new", "of", "reset", "stage", "state"
    }  # fmt: skip
    assert {"Decoder", "Encoder", "Batch", "Holder", "check", "infer"} <= set(dir(rj))
    assert all(hasattr(rj, name) for name in dir(rj))


def test_signatures(decoder):
    assert str(inspect.signature(decoder)) == "(message, holder=None, /)"
    assert list(inspect.signature(rj.Decoder).parameters) == ["mapping", "options"]
    assert list(inspect.signature(decoder.holder_type).parameters)[:2] == ["header", "orientation"]


def test_representations_of_programs():
    assert repr(rj.Decoder.of("std_msgs/Empty", encoding="ros1", backend="python")) == "<Decoder of std_msgs/Empty, ros1>"
    torso = "yarp/icub/torso_state.mapping"
    encoder = rj.Encoder(torso, encoding="yarp4", backend="python")
    assert repr(encoder) == f"<Encoder of {torso}, from rst.kinematics.JointAngles, yarp4>"
    assert repr(rj.check(torso)) == "<mapping between rst.kinematics.JointAngles and yarp.icub.torso.state, no warnings>"


def test_representations_of_messages_stay_short(decoder):
    imu = decoder.new()
    imu.header.frame_id, imu.angular_velocity.z = "x" * 1000, 0.5
    assert "angular_velocity=Vector3(x=0.0, y=0.0, z=0.5)" in repr(imu)
    assert "… 1000 characters" in repr(imu)
    cloud = rj.Decoder.of("sensor_msgs/PointCloud2", encoding="ros1", backend="python").new()
    cloud.data = bytes(1 << 20)
    assert "… 1048576 bytes" in repr(cloud)
    assert len(repr(cloud)) < 500
    assert len(cloud._repr_html_()) < 6000


def test_texts_are_escaped_in_notebooks(decoder):
    imu = decoder.new()
    imu.header.frame_id = HOSTILE
    messages = [rj.Encoder.of("sensor_msgs/Imu", encoding="ros1")(imu)] * 3
    for html in (imu._repr_html_(), imu.header._repr_html_(), decoder.many(messages)._repr_html_()):
        assert "<script" not in html
        assert "<img" not in html
        assert "&lt;script&gt;" in html


def test_a_batch_in_a_notebook_shows_names_of_enums_and_the_begin_of_long_fields():
    schema = {
        "c.proto": """syntax = "proto3"; package c; enum Color { RED = 0; BLUE = 7; }
            message M { Color color = 1; optional int32 n = 2; oneof one { int32 a = 3; string b = 4; } repeated string texts = 5; }"""
    }
    decoder = rj.Decoder.of("c.M", imports=["c.proto"], schema=schema, backend="python")
    message = decoder.new()
    message.color, message.b = 7, "b"
    message.texts.extend(["x" * 100] * 4)
    html = decoder.many([message.SerializeToString()])._repr_html_()
    color, n, a, b, texts = re.findall(r"<td[^>]*>([^<]*)</td>", html)
    assert (color, n, a, b) == ("BLUE", "", "", "&#x27;b&#x27;")
    assert texts.endswith("xx…")
    assert len(texts) < 300
    assert '<table style="margin:0">' in html


def test_arrays_are_summed_up_in_notebooks():
    scan = rj.Decoder.of("sensor_msgs/LaserScan", encoding="ros1", backend="python").new()
    scan.ranges, scan.intensities = np.linspace(0, 10, 1080), np.full(9, np.nan)
    html = scan._repr_html_()
    assert "0 … 10, mean 5 <svg" in html
    assert "1080 in all" in html
    assert "no finite number" in html
    scan.ranges[:2] = np.finfo(np.float32).max, np.inf
    assert "1 not finite" in scan._repr_html_()


def test_what_is_not_shown_in_notebooks_is_counted(decoder):
    status = rj.Decoder.of("diagnostic_msgs/DiagnosticArray", encoding="ros1", backend="python").new()
    status.status = [{"name": "one", "values": [{"key": "k"}]}] * 5
    assert "<summary>5 messages</summary>" in status._repr_html_()
    assert "… 2 messages more" in status._repr_html_()
    assert "<summary>1 message</summary>" in status._repr_html_()
    message = rj.Encoder.of("sensor_msgs/Imu", encoding="ros1")(decoder.new())
    assert "… 1 message more" in decoder.many([message] * 6)._repr_html_()
    assert "more" not in decoder.many([message] * 5)._repr_html_()


def test_numbers_are_shown_with_the_digits_that_they_have():
    angles = rj.Decoder("yarp/icub/torso_state.mapping", backend="python").new()
    angles.angles.append(0.1)
    assert repr(angles) == "angles: 0.1\n"
    assert "[0.1]" in angles._repr_html_()


def test_a_holder_that_cannot_be_read_says_so(decoder):
    holder = decoder.new()
    with pytest.raises(rj.DecodeError):
        decoder(b"", holder)
    assert holder._repr_html_() == "&lt;Imu: the last decode failed&gt;"


def test_pages_of_hostile_types_stay_small():
    fields = " ".join(f"int32 f{number} = {number + 2};" for number in range(300))
    schema = {"w.proto": f'syntax = "proto3"; package w; message N {{ repeated N kids = 1; {fields} }}'}
    holder = rj.Decoder.of("w.N", imports=["w.proto"], schema=schema, backend="python").new()
    node = holder
    for _ in range(10):
        node.kids.add()
        node = node.kids.add()
    assert len(repr(holder._repr_html_())) < 300_000
    plain = brief_message(holder)
    assert len(plain) < 50_000
    assert plain.endswith("…)")


def drawn(holder):
    """The pixels that a notebook shows."""
    (found,) = re.findall(r'<img src="data:image/png;base64,([^"]*)"', holder._repr_html_())
    return np.asarray(Image.open(io.BytesIO(base64.b64decode(found))))


def ros_image(encoding_, data_, step_, /, **fields):
    image = rj.Decoder.of("sensor_msgs/Image", encoding="ros1", backend="python").new()
    image.height, image.width, image.encoding, image.step, image.data = 12, 16, encoding_, step_, data_
    for name, value in fields.items():
        setattr(image, name, value)
    return image


def test_images_of_ros_are_drawn():
    padded = np.zeros((12, 60), np.uint8)
    padded[:, :48] = COLORS[:, :, ::-1].reshape(12, 48)
    assert np.array_equal(drawn(ros_image("bgr8", padded.tobytes(), 60)), COLORS)
    assert np.array_equal(drawn(ros_image("mono8", COLORS[:, :, 0].tobytes(), 16)), COLORS[:, :, 0])
    alpha = np.dstack([COLORS, COLORS[:, :, 1]])
    assert np.array_equal(drawn(ros_image("rgba8", alpha.tobytes(), 64)), alpha)
    depth = drawn(ros_image("16UC1", (X * 1000).astype(">u2").tobytes(), 32, is_bigendian=1))
    assert (depth[0, 0], depth[0, -1], depth[5, 8]) == (0, 255, 255 * 8 // 15)
    with_nan = np.where(X == 3, np.nan, X).astype("<f4")
    assert drawn(ros_image("32FC1", with_nan.tobytes(), 64))[0, [0, 3, 15]].tolist() == [0, 0, 255]


def test_images_of_rst_and_yarp_are_drawn():
    image = rj.Decoder.of("rst.vision.Image", backend="python").new()
    image.width, image.height, image.data = 16, 12, COLORS.transpose(2, 0, 1).tobytes()
    assert np.array_equal(drawn(image), COLORS)
    image.data_order, image.color_mode, image.data = 1, 2, COLORS[:, :, ::-1].tobytes()
    assert np.array_equal(drawn(image), COLORS)
    camera = rj.Decoder.of("yarp.sig.FlexImage", encoding="yarp4", backend="python").new()
    camera.pixel_code, camera.geometry.width, camera.geometry.height = int.from_bytes(b"rgb\0", "little"), 16, 12
    camera.geometry.quantum, camera.pixels = 8, COLORS.tobytes()
    assert np.array_equal(drawn(camera), COLORS)


@pytest.mark.parametrize(
    "fields",
    [
        {"height": 0}, {"height": 13}, {"width": 1 << 31}, {"step": 3}, {"step": 1 << 31}, {"encoding": "yuv422"}, {"encoding": HOSTILE},
        {"data": b""}, {"height": (1 << 32) - 1, "step": 0, "width": 0}, {"encoding": "8FC4"},
    ],
)  # fmt: skip
def test_images_that_make_no_sense_are_not_drawn(fields):
    assert "<img" not in ros_image("mono8", bytes(192), 16, **fields)._repr_html_()


def test_large_images_are_thinned_out():
    image = ros_image("mono8", bytes(2000 * 3000), 3000, height=2000, width=3000)
    assert drawn(image).shape == (400, 600)


def test_compressed_images_are_shown_as_they_came():
    image = rj.Decoder.of("sensor_msgs/CompressedImage", encoding="ros1", backend="python").new()
    image.data = b"\xff\xd8\xff\xe0rest"
    assert f'src="data:image/jpeg;base64,{base64.b64encode(image.data).decode()}"' in image._repr_html_()
    image.data = b"<svg onload=alert(1)>"
    assert "<img" not in image._repr_html_()


@pytest.mark.parametrize("name", ["sensor_msgs/Imu", "sensor_msgs/msg/Imu", "rst.kinematics.JointAngles"])
def test_prompts_complete_what_is_meant_to_be_used(name):
    """Python's own prompt asks each base of a class, too."""
    decoder = rj.Decoder.of(name, encoding="ros1" if name == "sensor_msgs/Imu" else None)
    holder = decoder.holder_type()
    nested = [getattr(holder, field) for field in ("orientation",) if hasattr(holder, field)]
    for each in (holder, *nested, decoder):
        offered = Completer({"it": each}).attr_matches("it.")
        assert offered
        assert not [found for found in offered if found.rstrip("()").endswith("_")]
