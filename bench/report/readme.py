"""What a run leaves in the repository: a dozen rows and a picture of them for the README, and all rows for docs/benchmarks.md."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bench.report.markdown import targets
from bench.report.plot import multiples

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from bench.figures import Row

BEGIN, END = "<!-- speed: written by `make bench` -->\n", "<!-- speed: end -->"
TABLE, PICTURE = "docs/benchmarks.md", "docs/speed.svg"

HEADLINES = (
    "one call, 24 specialised doubles, `builtin`",
    "24 specialised doubles, against a dynamic C++ decoder",
    "`many`, 10⁶ such messages, read and written",
    "image, unpadded and channels swapped",
    "Imu, against the fastest Python peer",
    "Imu, five values, decoded and read",
    "JointState, 32 joints, against roscpp in C++",
    "PoseArray 1000, against the fastest Python peer",
    "PointCloud2, 100,000 points, copied",
    "Image 640x480, borrowed",
    "RST JointAngles, unpacked, decode",
    "100,000 messages to Arrow, nested",
    "fresh process to first decode, warm cache",
)
"""The rows that the README shows."""


def write_in(root: Path, rows: Sequence[Row]) -> None:
    """Write the table and the picture, and replace what stands between the marks of the README and of the page of benchmarks."""
    first = [row for name in HEADLINES for row in rows if row.what == name]
    if first:
        (root / PICTURE).write_text(multiples(first), "utf-8")
    _replace(root / "README.md", targets(first))
    _replace(root / TABLE, targets(rows))


def _replace(page: Path, table: str) -> None:
    head, begin, rest = page.read_text("utf-8").partition(BEGIN)
    _, end, tail = rest.partition(END)
    if begin and end:
        page.write_text(f"{head}{begin}{table}{end}{tail}", "utf-8")
