"""Every Python example of the documents runs."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
DOCUMENTS = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_examples_run(document):
    names: dict[str, object] = {}
    for block in re.findall(r"```python\n(.*?)```", document.read_text(), re.DOTALL):
        exec(compile(block, str(document), "exec"), names)  # noqa: S102 - our own documents


def test_the_documented_mapping_is_the_shipped_one():
    text = (ROOT / "docs" / "mappings.md").read_text()
    shipped = (ROOT / "mappings" / "yarp" / "icub" / "torso_state.mapping").read_text()
    rules = [line.strip() for line in shipped.splitlines() if line.startswith("  ")]
    assert all(rule in text for rule in rules)
