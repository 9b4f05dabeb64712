"""The table of shipped mappings in the guide is what their rules say."""

from __future__ import annotations

import os
import re
from pathlib import Path

from rosetta_jit.explain.operations import OPERATIONS, operations
from rosetta_jit.language.parse.mapping import parse
from rosetta_jit.source import Source

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "mappings.md"
TABLE = re.compile(r"(?<=test_pairs.py -->\n).*?(?=<!-- pairs: end -->)", re.DOTALL)
LETTERS = dict(zip(OPERATIONS, "ARSCPLXGD", strict=True))


def table():
    paths = sorted((ROOT / "mappings" / "ros1").glob("*.mapping"))
    uses = {path: operations(str(path)) for path in paths}
    lines = ["| mapping `ros1/…` | ROS 1 | RST | to unpack | to pack |", "|---|---|---|---|---|"]
    for path, found in uses.items():
        mapping = parse(Source(path.name, path.read_text()))
        letters = ["".join(LETTERS[name] for name, ways in found.items() if way in ways) or "-" for way in ("unpack", "pack")]
        if not (mapping.pack_rules or mapping.rules):
            letters[1] = ""
        lines.append(f"| `{path.name}` | {mapping.wire_type} | {mapping.holder_type.removeprefix('rst.')} | {' | '.join(letters)} |")
    counts = ", ".join(f"{letter} {sum(name in found for found in uses.values())}" for name, letter in LETTERS.items())
    return "\n".join(lines) + f"\n\nOf these {len(paths)}, in either direction: {counts}.\n"


def test_the_table_of_the_guide():
    """``UPDATE_GOLDENS=1 pytest`` writes it anew after a change of the mappings."""
    expected, page = table(), PAGE.read_text("utf-8")
    if os.environ.get("UPDATE_GOLDENS"):
        page = TABLE.sub(lambda _: expected, page, count=1)
        PAGE.write_text(page, "utf-8")
    assert TABLE.findall(page) == [expected]
