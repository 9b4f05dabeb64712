"""docs/architecture.md is in step with the tree: picture and rooms are drawn from `test_layers.MAY_IMPORT`, and paths exist.

``UPDATE_GOLDENS=1 pytest`` draws them anew.
"""

from __future__ import annotations

import ast
import os
import re
from pathlib import Path

import pytest

from tests.test_layers import ANYTHING, MAY_IMPORT, PACKAGE, REPORTS, modules, parsed, reach, within

ROOT = PACKAGE.parent
PAGE = ROOT / "docs" / "architecture.md"
EVERYWHERE = REPORTS | {"startup", "model"}
"""What nearly all may import, and no line of the table says again."""
LEFT_OUT = {"", "__main__", "demo", "file_errors", "recording", "startup"} | REPORTS


def picture():
    """The packages, and which imports which: arrows that follow from others are left out."""
    graph = {}
    for line, allowed in MAY_IMPORT.items():
        package = line.split(".")[0]
        graph.setdefault(package, set()).update(each.split(".")[0] for each in allowed)
    graph = {package: targets - LEFT_OUT - {package} for package, targets in graph.items() if package not in LEFT_OUT}
    arrows = []
    for package, targets in graph.items():
        implied = {further for target in targets for further in reach(graph, target)}
        arrows += [f"  {package} --> {target}" for target in sorted(targets - implied)]
    return "\n".join(["```mermaid", "graph TD", *arrows, "```"])


def rooms():
    """A line a room: what its docstring says, and what else it may import."""
    shown = [each for each in sorted(MAY_IMPORT) if each not in ("", "__main__")]
    table = [f"| [`{each}`](../{folder(each)}) | {idea(each)} | {seen(each)} |" for each in shown]
    return "\n".join(["| room | what it is | may import |", "|---|---|---|", *table])


def folder(room):
    path = modules()[room]
    return str((path.parent if path.name == "__init__.py" else path).relative_to(ROOT))


def idea(room):
    text = ast.get_docstring(parsed(modules()[room]))
    return text.split("\n\n")[0].replace("\n", " ").replace("|", "\\|")


def seen(room):
    """Without what nearly all may import; of a package of which all rooms are allowed, `package.*`."""
    if MAY_IMPORT[room] >= ANYTHING:
        return "all of them"
    allowed = MAY_IMPORT[room] - EVERYWHERE - {room}
    whole = {each for each in allowed if len(lines(each)) > 1 and lines(each) <= allowed | {room}}
    shown = {each for each in allowed if not any(within(each, {package}) for package in whole - {each})}
    return ", ".join(f"`{each or 'rosetta_jit'}{'.*' if each in whole else ''}`" for each in sorted(shown)) or "-"


def lines(package):
    return {line for line in MAY_IMPORT if within(line, {package})}


@pytest.mark.parametrize("part", [picture, rooms], ids=lambda part: part.__name__)
def test_the_page_shows_the_table_of_the_layers(part):
    begin, end = f"<!-- {part.__name__}: drawn by tests/test_architecture_page.py -->\n", f"\n<!-- end of {part.__name__} -->"
    before, _, rest = PAGE.read_text("utf-8").partition(begin)
    old, _, behind = rest.partition(end)
    if os.environ.get("UPDATE_GOLDENS"):
        PAGE.write_text(f"{before}{begin}{part()}{end}{behind}", "utf-8")
        return
    assert old == part()


@pytest.mark.parametrize("page", [PAGE, ROOT / "CONTRIBUTING.md"], ids=lambda page: page.name)
def test_the_paths_that_a_page_names_exist(page):
    text = page.read_text("utf-8")
    named = re.findall(r"`((?:rosetta_jit|tests|docs|bench|mappings)/[\w./-]+)`", text)
    linked = [page.parent / each for each in re.findall(r"\]\((?!https?:|#)([^)#]+)", text)]
    missing = [path for path in (*(ROOT / name for name in named), *linked) if not Path(path).exists()]
    assert named
    assert not missing
