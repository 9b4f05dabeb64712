"""The API reference says what the docstrings say."""

from __future__ import annotations

from pathlib import Path

import rosetta_jit as rj
from tests.api_page import page
from tests.golden import check_golden

PAGE = Path(__file__).resolve().parent.parent / "docs" / "api.md"


def test_the_page_is_made_from_the_docstrings():
    check_golden(PAGE, page())


def test_the_page_has_every_public_name():
    text = PAGE.read_text("utf-8")
    assert [name for name in rj.__all__ if f"### rj.{name}" not in text] == []
