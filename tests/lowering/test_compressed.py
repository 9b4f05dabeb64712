"""Images that mappings compress and decompress, against Pillow itself; in both directions and every backend."""

from __future__ import annotations

import io
import struct
import zlib
from contextlib import suppress

import numpy as np
import pytest
from PIL import Image

import rosetta_jit as rj

BACKENDS = ["llvm", "python", "interpreter"]
FILES = {
    "raw.proto": """syntax = "proto2"; package p;
message Raw {
  required uint32 width = 1; required uint32 height = 2; required uint32 channels = 3; required uint32 depth = 4; required bytes data = 5;
}
message Packed { required string name = 1; required bytes data = 2; }""",
    "packed.bottle-schema": '"packed" (("name" :string) ("data" :blob))',
    "m.mapping": """import "raw.proto"
import "packed.bottle-schema"
data-holder: p.Raw
wire-schema: packed
unpack-rules:
  .width = uint32(image_width(.data))
  .height = uint32(image_height(.data))
  .channels = uint32(image_channels(.data))
  .depth = uint32(image_depth(.data))
  .data = decompress(.data)
  ignore .name
pack-rules:
  .name = "jpeg" if .depth == 1 else "png"
  .data = compress(.data, "png16", .width, .height, .channels) if .depth == 16
    else compress(.data, "jpeg", .width, .height, .channels, 80) if .depth == 1
    else compress(.data, "png", .width, .height, .channels)
""",
}


def wire(data):
    encode = rj.Encoder.of("packed", schema=FILES, imports=["packed.bottle-schema"], encoding="yarp3", backend="interpreter")
    return encode(encode.holder_type.from_dict({"name": "x", "data": data}))


def unwired(message):
    return rj.Decoder.of("packed", schema=FILES, imports=["packed.bottle-schema"], encoding="yarp3", backend="interpreter")(message)


def picture(mode, size=(13, 7)):
    rng = np.random.default_rng(len(mode))
    channels = {"L": 1, "LA": 2, "RGB": 3, "RGBA": 4}[mode]
    return Image.frombytes(mode, size, rng.integers(0, 256, size[0] * size[1] * channels, np.uint8).tobytes())


def saved(image, format_="PNG", **options):
    written = io.BytesIO()
    image.save(written, format_, **options)
    return written.getvalue()


@pytest.mark.parametrize("backend", [*BACKENDS, "llvm"])
def test_decompress(backend):
    decode = rj.Decoder("m.mapping", schema=FILES, encoding="yarp3", backend=backend)
    for mode, channels in (("L", 1), ("LA", 2), ("RGB", 3), ("RGBA", 4)):
        image = picture(mode)
        found = decode(wire(saved(image)))
        assert (found.width, found.height, found.channels, found.depth) == (13, 7, channels, 8)
        assert bytes(found.data) == image.tobytes()
    jpeg = saved(picture("RGB", (64, 48)), "JPEG")
    assert bytes(decode(wire(jpeg)).data) == Image.open(io.BytesIO(jpeg)).tobytes()
    deep = np.arange(0, 13 * 7 * 700, 700, np.uint16).reshape(7, 13)
    found = decode(wire(saved(Image.fromarray(deep))))
    assert (found.channels, found.depth, bytes(found.data)) == (1, 16, deep.tobytes())
    palette = picture("RGB").quantize(16)
    assert bytes(decode(wire(saved(palette))).data) == palette.convert("RGB").tobytes()
    bits = picture("L").convert("1")
    assert bytes(decode(wire(saved(bits))).data) == bits.convert("L").tobytes()


@pytest.mark.parametrize("backend", [*BACKENDS, "llvm"])
def test_compress(backend):
    encode = rj.Encoder("m.mapping", schema=FILES, encoding="yarp3", backend=backend)
    for mode, channels in (("L", 1), ("LA", 2), ("RGB", 3), ("RGBA", 4)):
        image = picture(mode)
        raw = {"width": 13, "height": 7, "channels": channels, "depth": 8, "data": image.tobytes()}
        found = unwired(encode(encode.holder_type.from_dict(raw)))
        assert (found.name, Image.open(io.BytesIO(bytes(found.data))).tobytes()) == ("png", image.tobytes())
    image = picture("RGB", (64, 48))
    jpeg = {"width": 64, "height": 48, "channels": 3, "depth": 1, "data": image.tobytes()}
    assert bytes(unwired(encode(encode.holder_type.from_dict(jpeg))).data) == saved(image, "JPEG", quality=80)
    deep = np.arange(0, 13 * 7 * 700, 700, np.uint16)
    raw = {"width": 13, "height": 7, "channels": 1, "depth": 16, "data": deep.tobytes()}
    again = rj.Decoder("m.mapping", schema=FILES, encoding="yarp3", backend=backend)(encode(encode.holder_type.from_dict(raw)))
    assert again.to_dict() == raw
    good = {"width": 13, "height": 7, "channels": 1, "depth": 8, "data": bytes(91)}
    for wrong, why in (({"width": 14}, "as many"), ({"channels": 5}, "no such"), ({"width": 0}, "no such"), ({"depth": 16}, "as many")):
        with pytest.raises(rj.EncodeError, match=why) as error:
            encode(encode.holder_type.from_dict({**good, **wrong}))
        assert (error.value.kind, error.value.path) == ("image", ".data")


def png(width, height, *, depth=8, colour=2, body=b""):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", width, height, depth, colour, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(body)) + chunk(b"IEND", b"")


@pytest.mark.parametrize("backend", BACKENDS)
def test_what_is_no_image(backend):
    decode = rj.Decoder("m.mapping", schema=FILES, encoding="yarp3", backend=backend)
    good, jpeg = saved(picture("RGB")), saved(picture("RGB", (64, 48)), "JPEG")
    broken = [
        b"",
        b"\x89PNG",
        b"no image",
        good[:-40],
        jpeg[:300],
        jpeg[: len(jpeg) // 2],
        png(4, 4, body=b"\0" * 5),
        saved(picture("L"), "BMP"),
    ]
    for data in broken:
        with pytest.raises(rj.DecodeError, match="damaged") as error:
            decode(wire(data))
        assert error.value.kind == "image"
        assert "m.mapping:" in str(error.value)
    for data in (png(16000, 16000), png(1 << 30, 1 << 30), png(100_000, 1, colour=0), saved(Image.new("L", (65000, 5000)), "JPEG")):
        with pytest.raises(rj.DecodeError, match="too large"):
            decode(wire(data))
    for data in (saved(picture("RGBA").convert("CMYK"), "JPEG"), png(2, 2, depth=16, body=b"\0" * 26)):
        with pytest.raises(rj.DecodeError, match="another kind"):
            decode(wire(data))
    assert bytes(decode(wire(good)).data) == picture("RGB").tobytes()


def test_damaged_images_never_crash():
    decode = rj.Decoder("m.mapping", schema=FILES, encoding="yarp3")
    rng = np.random.default_rng(7)
    for data in (saved(picture("RGB")), saved(picture("L", (40, 40)), "JPEG")):
        for _ in range(300):
            changed = bytearray(data)
            for at in rng.integers(0, len(data), 3):
                changed[at] = rng.integers(0, 256)
            with suppress(rj.DecodeError):
                decode(wire(bytes(changed)))


@pytest.mark.parametrize("backend", BACKENDS)
def test_many_in_threads(backend):
    from concurrent.futures import ThreadPoolExecutor

    pictures = [picture(mode, (8 + number, 5)) for number, mode in enumerate(["L", "RGB", "RGBA"] * 4)]
    messages = [wire(saved(each)) for each in pictures]
    offsets = np.cumsum([0, *map(len, messages)])
    decode = rj.Decoder("m.mapping", schema=FILES, encoding="yarp3", backend=backend)
    with ThreadPoolExecutor(4) as pool:
        batches = list(pool.map(lambda _: decode.many(b"".join(messages), offsets), range(6)))
    for batch in batches:
        assert [bytes(message.data) for message in batch] == [each.tobytes() for each in pictures]
    encode = rj.Encoder("m.mapping", schema=FILES, encoding="yarp3", backend=backend)
    buffer, places = encode.many(batches[0])
    assert bytes(unwired(buffer[places[4] : places[5]]).data) == saved(pictures[4], compress_level=1)


@pytest.mark.parametrize("backend", BACKENDS)
def test_on_protobuf_and_from_image_to_image(backend):
    mapping = """import "raw.proto"
data-holder: p.Raw
wire-schema: p.Packed
unpack-rules:
  .width = 1 .height = 1 .channels = 1
  .depth = uint32(image_width(compress(decompress(.data), "png", image_width(.data), image_height(.data), 3)))
  .data = compress(decompress(.data), "jpeg", image_width(.data), image_height(.data), image_channels(.data), 95)
  ignore .name
pack-rules:
  .name = "raw"
  .data = decompress(.data)
"""
    files = {**FILES, "m.mapping": mapping}
    write = rj.Encoder.of("p.Packed", schema=files, imports=["raw.proto"], backend="interpreter")
    read = rj.Decoder.of("p.Packed", schema=files, imports=["raw.proto"], backend="interpreter")
    decode = rj.Decoder("m.mapping", schema=files, backend=backend)
    image = picture("RGB", (40, 30))
    found = decode(write(write.holder_type.from_dict({"name": "a", "data": saved(image)})))
    assert (found.depth, bytes(found.data)) == (40, saved(image, "JPEG", quality=95))
    encode = rj.Encoder("m.mapping", schema=files, backend=backend)
    assert bytes(read(encode(found)).data) == Image.open(io.BytesIO(bytes(found.data))).tobytes()


def test_a_warm_start_and_lifetimes(monkeypatch):
    first = rj.Decoder("m.mapping", schema=FILES, encoding="yarp3")
    message = wire(saved(picture("RGB")))
    monkeypatch.setattr("rosetta_jit.pipeline.build.Build.image", None)
    second = rj.Decoder("m.mapping", schema=FILES, encoding="yarp3")
    assert bytes(second(message).data) == picture("RGB").tobytes()
    del second
    assert bytes(first(message).data) == picture("RGB").tobytes()


@pytest.mark.parametrize("backend", ["llvm", "interpreter"])
def test_without_the_library(monkeypatch, backend):
    monkeypatch.setattr("rosetta_jit.runtime.images.find_spec", lambda _: None)
    files = {
        **FILES,
        "m.mapping": FILES["m.mapping"].replace("\npack-rules", '\n  reject "wide" when image_width(.data) == 12345\npack-rules', 1),
    }
    with pytest.raises(rj.MappingError, match="Pillow") as error:
        rj.Decoder("m.mapping", schema=files, encoding="yarp3", backend=backend)
    assert error.value.diagnostics[0].help == "pip install rosetta-jit[images]"


@pytest.mark.parametrize("backend", BACKENDS)
def test_ros_and_rst(backend):
    encode = rj.Encoder("ros1/compressed_image.mapping", backend=backend)
    decode = rj.Decoder("ros1/compressed_image.mapping", backend=backend)
    read = rj.Decoder.of("sensor_msgs/CompressedImage", framework="ros1", backend="interpreter")
    image = picture("RGB")
    raw = {"data": image.tobytes(), "width": 13, "height": 7, "channels": 3, "depth": "DEPTH_8U", "color_mode": "COLOR_RGB"}
    raw["data_order"] = "DATA_INTERLEAVED"
    message = encode(encode.holder_type.from_dict(raw))
    assert Image.open(io.BytesIO(bytes(read(message).data))).tobytes() == image.tobytes()
    assert decode(message).to_dict() == raw
    deep = np.arange(91, dtype=np.uint16) * 700
    grey = {**raw, "data": deep.tobytes(), "channels": 1, "depth": "DEPTH_16U", "color_mode": "COLOR_GRAYSCALE"}
    assert decode(encode(encode.holder_type.from_dict(grey))).to_dict() == grey
    write = rj.Encoder.of("sensor_msgs/CompressedImage", framework="ros1", backend="interpreter")
    with pytest.raises(rj.DecodeError, match="transparency"):
        decode(write(write.holder_type.from_dict({"format": "png", "data": saved(picture("RGBA"))})))


BOTH_WAYS = """import "raw.proto"
import "packed.bottle-schema"
data-holder: p.{}
wire-schema: {}
rules:
{}"""
MEASURED = """  .width <-> uint32(image_width(.data))
  .height <-> uint32(image_height(.data))
  .channels <-> uint32(image_channels(.data))
  .depth <-> 8
  .data <-> decompress(.data, "png", image_width(.data), image_height(.data), image_channels(.data))
  ignore .name
"""
WIRED = """  .name <-> .name
  .data <-> compress(.data, "{}", 13, 7, 3)
  ignore .width
  ignore .height
"""


def relation(holder, wire_type, rules, backend="llvm"):
    files = {**FILES, "raw.bottle-schema": '"raw" (("name" :string) ("width" :int) ("height" :int) ("data" :blob))'}
    head = 'import "raw.bottle-schema"\n' if wire_type == "raw" else ""
    files["m.mapping"] = head + BOTH_WAYS.format(holder, wire_type, rules)
    return [each("m.mapping", schema=files, encoding="yarp3", backend=backend) for each in (rj.Decoder, rj.Encoder)]


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("mode", ["L", "RGB", "RGBA"])
def test_an_image_that_says_its_measures_is_a_relation(mode, backend):
    decode, encode = relation("Raw", "packed", MEASURED, backend)
    assert str(decode.mapping.laws.holders) == "exact inverse"
    assert [loss.why for loss in decode.mapping.laws.messages.losses if loss.place == ".data"] == [
        "what is compressed anew has other bytes"
    ]
    image = picture(mode)
    raw = decode(wire(saved(image)))
    assert (raw.width, raw.height, raw.channels, raw.data) == (*image.size, len(image.getbands()), image.tobytes())
    again = encode(raw)
    assert Image.open(io.BytesIO(unwired(again).data)).tobytes() == image.tobytes()
    assert decode(again) == raw
    wrong = encode.holder_type.from_dict({**raw.to_dict(), "width": 12})
    with pytest.raises(rj.EncodeError, match="not as many"):
        encode(wrong)


def test_pixels_whose_measures_stand_beside_them_are_a_relation():
    rules = """  .width <-> uint32(.width)
  .height <-> uint32(.height)
  .channels <-> 3
  .depth <-> 8
  .data <-> permuted(decompress(.data, "png", .width, .height, 3), [2, 1, 0])
  ignore .name
"""
    decode, encode = relation("Raw", "raw", rules)
    image = picture("RGB")
    held = {"width": 13, "height": 7, "channels": 3, "depth": 8, "data": image.tobytes()}
    message = encode(encode.holder_type.from_dict(held))
    assert decode(message).to_dict() == held
    narrower = message.replace(struct.pack("<i", 13), struct.pack("<i", 12), 1)
    with pytest.raises(rj.DecodeError, match="another width") as error:
        decode(narrower)
    assert (error.value.kind, error.value.path) == ("image", ".data")


@pytest.mark.parametrize(("format_", "law"), [("png", "exact inverse"), ("jpeg", "JPEG changes pixels a little")])
def test_what_is_compressed_to_unpack_is_decompressed_to_pack(format_, law):
    decode, encode = relation("Packed", "raw", WIRED.format(format_))
    assert (law in {loss.why for loss in decode.mapping.laws.messages.losses if loss.place == ".data"}) == (format_ == "jpeg")
    pixels = np.full((7, 13, 3), (200, 100, 50), np.uint8).tobytes()
    held = decode.holder_type.from_dict({"name": "shot", "data": compressed(pixels, format_)})
    message = encode(held)
    assert pixels in message or format_ == "jpeg"
    found = Image.open(io.BytesIO(decode(message).data))
    assert found.format == format_.upper()
    assert np.allclose(np.frombuffer(found.tobytes(), np.uint8), np.frombuffer(pixels, np.uint8), atol=3)


def compressed(pixels, format_):
    return saved(Image.frombytes("RGB", (13, 7), pixels), format_.upper())


def test_a_law_of_pixels_in_another_order_says_that_it_is_not_shown():
    files = {"t/I.msg": "uint32 width\nuint32 height\nuint8[] data\n"}
    order = 'permuted(decompress(.data, "png", .width, .height, 3), [2, 1, 0])'
    rules = f"  .width <-> .width\n  .height <-> .height\n  .data <-> {order}\n"
    files["m.mapping"] = f'import "t/I.msg"\ndata-holder: t/I\nwire-schema: t/I\nrules:\n{rules}'
    laws = rj.check("m.mapping", schema=files).laws
    assert [loss.why for loss in laws.holders.losses] == ["it cannot be shown that its value comes back"]
