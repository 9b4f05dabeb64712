"""Kernels made by hand as C: rows without fields, one row in lane 0, messages that begin at 0."""

from __future__ import annotations

import ctypes
from functools import cache

import numpy as np

from rosetta_jit.generate.c.header import STATUSES, header
from rosetta_jit.generate.c.holder.lanes import Lane, Lanes
from rosetta_jit.generate.c.holder.rows import Member, Struct
from rosetta_jit.generate.c.printing.functions import print_kernel
from rosetta_jit.generate.c.source import source
from rosetta_jit.generate.unit import Unit
from rosetta_jit.kernel.passes.alone import alone
from rosetta_jit.kernel.state import USED, lane_word
from rosetta_jit.model.layout import Lane as LayoutLane
from rosetta_jit.model.layout import Layout, Number
from rosetta_jit.model.types import Schema
from rosetta_jit.model.types import Struct as Type
from tests.generate.bridge import Error, compiled

SCHEMA = Schema({"Raw": Type("Raw", ())})


@cache
def library(kernel):
    """The kernel as a decoder in C, and which of its sites the table has."""
    kernel = alone(kernel)
    raws = [Struct(f"unit_raw_{k}", "raw", stride, (Member("bytes", 0, "u8", stride),)) for k, stride in enumerate(kernel.strides)]
    names = [("message" if k == 0 else f"lane_{k}", f"lane_{k}_used") for k in range(len(raws))]
    own = tuple(Lane(*names[k], raw.size, raw) for k, raw in enumerate(raws))
    lanes = Lanes("unit", own, len(own))
    layout = Layout(tuple(LayoutLane(f"lane{k}", raw.size, Number(0, "u8")) for k, raw in enumerate(raws)))
    unit = Unit("unit", (), layout, (1,) * len(own), {"decode": kernel}, type="Raw", schema=SCHEMA)
    printed = {"decode": print_kernel(kernel, lanes, "decode")}
    return compiled(source(unit, lanes, tuple(raws), printed), header(unit, lanes, tuple(raws), 0), "unit"), printed["decode"].sites


def outcome(kernel, message, rows):
    """As `tests.backends.engines.outcome`, without the position that a success gives."""
    code, sites = library(kernel)
    size = kernel.strides[0]
    padded = -(-size // 8)
    words = np.zeros(padded + 3 * (len(kernel.strides) - 1) + 2, np.int64)
    for k, lane in enumerate(rows.lanes[1:]):
        words[padded + 3 * k : padded + 3 * k + 2] = lane.ctypes.data, len(lane) // kernel.strides[k + 1]
    error = Error()
    given = ctypes.create_string_buffer(message, len(message)) if message else None
    status = code.unit_decode(ctypes.c_void_p(words.ctypes.data), given, ctypes.c_size_t(len(message)), ctypes.byref(error))
    if status == 0:
        rows.lanes[0][:size] = words.view(np.uint8)[:size]
        for k in range(1, len(kernel.strides)):
            rows.state[lane_word(k, USED)] = words[padded + 3 * (k - 1) + 2]
        return rows.seen(0, 4)
    if status == 1:
        return (-1, [error.lane, error.missing])
    seen = STATUSES[status], error.path.decode()
    site = next(number for number in sites[1:] if (kernel.sites[number].kind, kernel.sites[number].path) == seen)
    return (-1 - site, [error.offset, site], list(error.indices))
