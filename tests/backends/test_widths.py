"""Loops that put streams of bytes together, or take them apart: which are told a width, and that all bytes are where they belong."""

from __future__ import annotations

import numpy as np
import pytest

import rosetta_jit as rj
from rosetta_jit.backends.llvm import widths
from rosetta_jit.kernel.nodes import Binary, Const, Expr, For, Get, Let, Load, Local, Place, SetField, Stmt, Store
from rosetta_jit.kernel.terms import add, index, mul

ROUND, COUNT, BYTES, BLOCKS = Local("i64", "i"), Local("i64", "count"), 0, 1
STRIDES = (1, 12)
SCHEMA = """
syntax = "proto2";
message Pixels { required bytes data = 1; }
"""


def together(streams: int, *, lane: int = BYTES, at: Expr | None = None, type_: str = "u8") -> For:
    """`.message[at + c] = .lane[count * c + i]`."""
    body: list[Stmt] = []
    for number in range(streams):
        body += [
            Let(f"row{number}", add(mul(COUNT, number), ROUND)),
            Let(f"byte{number}", Get(type_, Place(lane, Local("i64", f"row{number}"), 0))),
            Store(add(at or mul(ROUND, streams), index(number)), Local(type_, f"byte{number}")),
        ]
    return For("i", COUNT, tuple(body))


def swapped(streams: int) -> For:
    """`.message[streams * i + c] = .message[count + streams * i + c]`."""
    at = [add(mul(ROUND, streams), index(number)) for number in range(streams)]
    return For("i", COUNT, tuple(Store(each, Load("u8", Binary("add", COUNT, each))) for each in at))


def apart(streams: int) -> For:
    """`.lane[count * c + i] = .message[streams * i + c]`."""
    rows = [Place(BYTES, add(mul(COUNT, number), ROUND), 0) for number in range(streams)]
    at = [add(mul(ROUND, streams), index(number)) for number in range(streams)]
    return For("i", COUNT, tuple(SetField(row, Load("u8", each)) for row, each in zip(rows, at, strict=True)))


JOINED = [together(3), together(4), together(3, at=Binary("add", mul(ROUND, 3), COUNT)), swapped(3)]


@pytest.mark.parametrize("loop", JOINED, ids=str)
def test_loops_that_join_channels_are_told_a_width(loop):
    assert widths.streams_of(loop, STRIDES) == "joined"


@pytest.mark.parametrize("streams", [3, 4])
def test_loops_that_take_channels_apart_are_told_one_where_nothing_is_left(streams):
    assert widths.streams_of(apart(streams), STRIDES) == "taken apart"


OTHERS = [
    together(2),
    together(5),
    together(3, lane=BLOCKS),
    together(3, at=mul(ROUND, 4)),
    together(3, at=Binary("mul", ROUND, COUNT)),
    together(3, at=Binary("mul", ROUND, ROUND)),
    together(3, at=Binary("div", ROUND, index(2))),
    together(3, type_="u16"),
    apart(2),
    apart(5),
    For("i", COUNT, (*together(3).body, For("j", COUNT, ()))),
    For("i", COUNT, (*together(3).body, Let("x", Const("f64", 1.0)))),
]


@pytest.mark.parametrize("loop", OTHERS, ids=str)
def test_others_are_not(loop):
    """Bytes of messages within a message, or that lie apart, LLVM would move one by one."""
    assert widths.streams_of(loop, STRIDES) is None


@pytest.mark.parametrize("channels", [3, 4])
def test_all_bytes_are_where_they_belong(tmp_path, capfd, channels):
    """Of every count: whole turns of the loop over vectors, and what is left of them. LLVM says nothing of these loops."""
    (tmp_path / "pixels.proto").write_text(SCHEMA)
    (tmp_path / "planes.mapping").write_text(
        f"""
        import "pixels.proto"
        data-holder: Pixels
        wire-schema: Pixels
        rules:
          .data <-> planar(.data, {channels})
        """
    )
    into, out = rj.Decoder(tmp_path / "planes.mapping"), rj.Encoder(tmp_path / "planes.mapping")
    own = rj.Encoder.of("Pixels", imports=[str(tmp_path / "pixels.proto")])
    for count in (0, 1, 2, 63, 64, 65, 100, 127, 128, 129, 1000):
        pixels = np.random.default_rng(count).integers(0, 256, (count, channels), np.uint8)
        message, planes = own({"data": pixels.tobytes()}), pixels.T.tobytes()
        assert bytes(into(message).data) == planes
        assert out(into(message)) == message
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("width", [1, 21, 63, 64, 65, 130])
def test_rows_of_planes_are_what_they_are_in_python(width):
    """Rows are padded, so that one of them is a loop."""
    mapping = "yarp/icub/camera_image.mapping"
    pixels = np.random.default_rng(width).integers(0, 256, 3 * 2 * width, np.uint8).tobytes()
    fields = {"width": width, "height": 2, "channels": 3, "data": pixels, "data_order": "DATA_SEPARATE"}
    compiled, slow = (rj.Encoder(mapping, encoding="yarp3", backend=backend) for backend in ("llvm", "python"))
    assert compiled(fields) == slow(fields)


@pytest.mark.parametrize("width", [1, 21, 63, 64, 65, 128, 130])
def test_rows_of_pixels_are_what_they_are_in_python(width):
    step = 3 * width + 5
    data = np.random.default_rng(width).integers(0, 256, 2 * step, np.uint8).tobytes()
    fields = {"width": width, "height": 2, "step": step, "encoding": "rgb8", "data": data}
    message = rj.Encoder.of("sensor_msgs/Image", encoding="ros1")(fields)
    compiled, slow = (rj.Decoder("ros1/image_planar.mapping", encoding="ros1", backend=backend) for backend in ("llvm", "python"))
    assert bytes(compiled(message).data) == bytes(slow(message).data)
