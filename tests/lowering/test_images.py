"""The kernels of camera images, whose speed depends on what is left in their innermost loops."""

from __future__ import annotations

import pytest

from rosetta_jit.kernel.nodes import Copy, For, Let, SetField, Store
from rosetta_jit.kernel.walk import statements
from rosetta_jit.pipeline.build import Build
from rosetta_jit.pipeline.request import Request


def kernel(mapping, direction):
    build = Build(Request(direction, mapping=f"yarp/icub/{mapping}.mapping", encoding="yarp3"))
    return build.kernels[0]


def innermost(kernel):
    loops = [stmt for body in kernel.bodies for stmt, _ in statements(body) if isinstance(stmt, For)]
    return [loop for loop in loops if not any(isinstance(stmt, For) for stmt, _ in statements(loop.body))]


def moving(loops):
    return [loop for loop in loops if any(isinstance(stmt, SetField | Store) for stmt in loop.body)]


@pytest.mark.parametrize("direction", ["decode", "encode"])
@pytest.mark.parametrize("mapping", ["camera_image_bgr", "camera_image_planar"])
def test_pixels_are_moved_without_a_check(mapping, direction):
    loops = moving(innermost(kernel(mapping, direction)))
    assert loops
    for loop in loops:
        moves = [stmt for stmt in loop.body if isinstance(stmt, SetField | Store)]
        assert len(moves) == 3
        assert all(isinstance(stmt, Let | SetField | Store) for stmt in loop.body)


@pytest.mark.parametrize(("direction", "copies", "planes"), [("decode", 2, 0), ("encode", 1, 1)])
def test_rows_are_copied(direction, copies, planes):
    """Decoding copies all rows at once where they have no padding; encoding makes pixels of planes, besides."""
    made = kernel("camera_image", direction)
    found = [stmt for body in made.bodies for stmt, _ in statements(body) if isinstance(stmt, Copy)]
    assert len(found) == copies * len(made.bodies)
    assert len(moving(innermost(made))) == planes * len(made.bodies)
