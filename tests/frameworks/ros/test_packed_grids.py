"""Maps as they go over slow links: runs of equal cells, and one bit a cell."""

from __future__ import annotations

import numpy as np
import pytest

import rosetta_jit as rj

RUNS = "packed/occupancy_grid.mapping"
BITS = "packed/binary_grid.mapping"


def test_runs_of_cells() -> None:
    decode, encode = rj.Decoder(RUNS), rj.Encoder(RUNS)
    read = rj.Decoder.of("rosetta_jit/GridRuns")
    rng = np.random.default_rng(7)
    cells = np.repeat(rng.choice(np.array([-1, 0, 100], np.int8), 400), rng.integers(1, 30, 400))[:6000]
    grid = encode.holder_type.from_dict(
        {"header": {"frame_id": "map"}, "info": {"width": 60, "height": len(cells) // 60, "resolution": 0.05}, "data": cells}
    )
    sent = encode(grid)
    runs = np.flatnonzero(np.diff(cells)) + 1
    packed = read(sent)
    assert np.array_equal(packed.values, cells[np.concatenate([[0], runs])])
    assert np.array_equal(packed.counts, np.diff(np.concatenate([[0], runs, [len(cells)]])))
    assert decode(sent) == grid
    assert len(sent) < len(cells) / 3
    with pytest.raises(rj.EncodeError, match="the cells do not fill the grid"):
        encode(encode.holder_type.from_dict({"info": {"width": 2, "height": 2}, "data": [0, 0, 0]}))


def test_a_small_message_is_no_larger_map_than_the_mapping_says() -> None:
    decode = rj.Decoder(RUNS)
    write = rj.Encoder.of("rosetta_jit/GridRuns")
    found = decode(write(write.holder_type.from_dict({"info": {"width": 8000, "height": 8000}, "values": [-1], "counts": [64_000_000]})))
    assert len(found.data) == 64_000_000
    too_many = {"info": {"width": 65_536, "height": 65_535}, "values": [-1], "counts": [65_536 * 65_535]}
    with pytest.raises(rj.DecodeError) as error:
        decode(write(write.holder_type.from_dict(too_many)))
    assert (error.value.kind, error.value.path) == ("count", ".data")


def test_one_bit_a_cell() -> None:
    decode, encode = rj.Decoder(BITS), rj.Encoder(BITS)
    occupied = np.zeros(32, np.bool_)
    occupied[[0, 9, 24]] = True
    grid = encode.holder_type.from_dict({"width": 5, "height": 5, "resolution": 0.5, "occupied": occupied})
    sent = encode(grid)
    assert sent.endswith(np.packbits(occupied, bitorder="little").tobytes())
    assert decode(sent) == grid
    with pytest.raises(rj.EncodeError, match="the cells do not fill the grid"):
        encode(encode.holder_type.from_dict({"width": 5, "height": 5, "occupied": [True] * 8}))
