"""Whether rules work on a message where its bytes lie is decided before it is lowered, and what is in the way is named."""

from __future__ import annotations

import pytest

from rosetta_jit.lowering.rules.in_place import obstacle
from rosetta_jit.pipeline.build import Build
from rosetta_jit.pipeline.request import Request

MESSAGES = {
    "t/P.msg": "float64 x\nstring name\n",
    "t/V.msg": "float64 x\nfloat64 y\n",
    "t/In.msg": "uint32 n\nfloat64 x\nfloat64[] data\nstring text\nt/P[] points\nt/V[] vectors\nt/P one\n",
    "t/Out.msg": "uint32 n\nfloat64 x\nfloat64[] data\nstring text\nt/P[] points\nt/V[] vectors\nt/P one\n",
}
REST = "\n  ignore rest\n  default rest\n"
PLAIN = "  .x <-> .x * 2\n  .data <-> .data\n  .text <-> .text\n  .vectors[].x <-> .vectors[].y\n  .vectors[].y <-> .vectors[].x\n"


def in_the_way(rules, direction, block="rules"):
    text = 'import "t/In.msg" import "t/Out.msg" data-holder: t/Out wire-schema: t/In\n' + f"{block}:\n{rules}{REST}"
    files = tuple({**MESSAGES, "m.mapping": text}.items())
    build = Build(Request(direction, mapping="m.mapping", encoding="ros1", files=files))
    attempts = build.encoding.attempts if direction == "decode" else (build.encoding.written,)
    found = obstacle(build.encoding, attempts, build.types.rules, direction, build.types.schema)
    return found and found.path


@pytest.mark.parametrize("direction", ["decode", "encode", "size"])
@pytest.mark.parametrize(
    ("rules", "block", "paths"),
    [
        ("  .x = .vectors[1].y + float64(len(.data))", "unpack-rules", {"decode": None}),
        ("  .text = .points[0].name", "unpack-rules", {"decode": ("points", "[]", "name")}),
        ("  .x = .points[0].x", "unpack-rules", {"decode": ("points", "[]", "x")}),
        ("  .one = .one", "unpack-rules", {"decode": ("one",)}),
        (PLAIN, "rules", {"decode": None, "encode": None, "size": None}),
        ("  .points[].name <-> .points[].name\n  .points[].x <-> .points[].x", "rules", {"encode": ("points", "[]", "name")}),
        ('  .text <-> .text + "!"', "rules", {"encode": ("text",)}),
    ],
)
def test_obstacles(rules, block, paths, direction):
    if direction in paths:
        assert in_the_way(rules, direction, block) == paths[direction]
