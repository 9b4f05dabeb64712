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


def together(streams: int, *, lane: int = BYTES, step: int | None = None, type_: str = "u8") -> For:
    """`.message[step * i + c] = .lane[count * c + i]`."""
    body: list[Stmt] = []
    for number in range(streams):
        body += [
            Let(f"row{number}", add(mul(COUNT, number), ROUND)),
            Let(f"byte{number}", Get(type_, Place(lane, Local("i64", f"row{number}"), 0))),
            Store(add(mul(ROUND, step or streams), index(number)), Local(type_, f"byte{number}")),
        ]
    return For("i", COUNT, tuple(body))


def apart(streams: int, at: Expr) -> For:
    """`.lane[count * c + i] = .message[at + c]`."""
    return For(
        "i",
        COUNT,
        tuple(SetField(Place(BYTES, add(mul(COUNT, each), ROUND), 0), Load("u8", add(at, index(each)))) for each in range(streams)),
    )


@pytest.mark.parametrize(
    "loop", [together(3), together(4), apart(3, mul(ROUND, 3)), apart(4, Binary("add", mul(ROUND, 4), COUNT))], ids=str
)
def test_loops_of_channels_are_told_a_width(loop):
    assert widths.joins_streams(loop, STRIDES)


@pytest.mark.parametrize(
    "loop",
    [
        together(2),
        together(5),
        together(3, lane=BLOCKS),
        together(3, step=4),
        together(3, type_="u16"),
        apart(3, Binary("mul", ROUND, COUNT)),
        apart(3, Binary("mul", ROUND, ROUND)),
        apart(3, Binary("div", ROUND, index(2))),
        For("i", COUNT, (*together(3).body, For("j", COUNT, ()))),
        For("i", COUNT, (*together(3).body, Let("x", Const("f64", 1.0)))),
    ],
    ids=str,
)
def test_others_are_not(loop):
    """Bytes of messages within a message, or that lie apart, LLVM would move one by one."""
    assert not widths.joins_streams(loop, STRIDES)


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
