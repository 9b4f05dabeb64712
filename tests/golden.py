"""Golden files: the text that a test expects, kept beside the input that makes it.

``UPDATE_GOLDENS=1 pytest`` writes what is missing or has changed; the difference is then reviewed like code.
"""

from __future__ import annotations

import os
from pathlib import Path

GOLDEN = Path(__file__).parent / "golden"


def check_golden(path: Path, text: str) -> None:
    """Compare ``text`` with the file at ``path``, or write it there when UPDATE_GOLDENS is set."""
    if os.environ.get("UPDATE_GOLDENS"):
        path.write_text(text, encoding="utf-8")
    assert path.exists(), f"{path} is missing: run with UPDATE_GOLDENS=1 and review it"
    assert path.read_text(encoding="utf-8") == text
