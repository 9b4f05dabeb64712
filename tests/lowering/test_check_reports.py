"""Every wrong mapping in tests/golden/mapping gives the report beside it, and every report that there is, is given by one of them."""

from __future__ import annotations

import inspect
import json
from typing import TYPE_CHECKING

import pytest

from rosetta_jit.catalogue import check as check_words
from rosetta_jit.catalogue import derive as derive_words
from rosetta_jit.catalogue import mapping as mapping_words
from rosetta_jit.catalogue import resolve as resolve_words
from rosetta_jit.catalogue import units as units_words
from rosetta_jit.cells import cells
from rosetta_jit.diagnostics import MAX_LINE, render, render_all, to_json
from rosetta_jit.errors import MappingError
from rosetta_jit.frameworks.base import Readers, installed
from rosetta_jit.frontend.mapping import parse
from rosetta_jit.frontend.search import SearchPath
from rosetta_jit.lowering.check import check
from rosetta_jit.source import Source
from tests.golden import GOLDEN, check_golden

if TYPE_CHECKING:
    from pathlib import Path

    from rosetta_jit.diagnostics import Diagnostic


FOLDER = GOLDEN / "mapping"
WRONG = sorted(FOLDER.glob("*.mapping"))
FRONT_ENDS = Readers({name: installed()[name] for name in ("yarp", "protobuf", "lcm")})
FILES = {path.name: path.read_text() for path in FOLDER.iterdir() if path.suffix in {".proto", ".bottle-schema", ".lcm", ".txt", ".units"}}
CATALOGUE = (mapping_words, resolve_words, check_words, derive_words, units_words)
MAKERS = ("error", "warning", "placed", "in_one_way")
OF_FILES = ("file_too_large", "file_not_text", "file_unreadable", "mapping_not_found")
"""What takes files: tests/frontend/test_search.py has it."""

OF_BOTH_WAYS = ("alike_blocks", "too_complex", "too_many_blocks", "unknown_condition")
"""What rules for both directions cannot decide: test_both_ways.py and test_hostile_mappings.py have it."""

OF_PIECES = ("many_pieces", "lone_brace", "no_value")
"""Values in the texts of rejections, and parameters: test_rejections.py and test_parameters.py have it."""

ELSEWHERE = (*OF_FILES, *OF_BOTH_WAYS, *OF_PIECES)


def diagnostics(path: Path) -> tuple[Diagnostic, ...]:
    try:
        found = check(parse(Source(path.name, path.read_text())), FRONT_ENDS, SearchPath(files=tuple(FILES.items())))
    except MappingError as error:
        return error.diagnostics
    return found.warnings


@pytest.mark.parametrize("path", WRONG, ids=lambda path: path.stem)
def test_report(path: Path) -> None:
    found = diagnostics(path)
    check_golden(path.with_suffix(".err"), f"{render_all(found)}\n")
    assert found
    for each in found:
        assert each.code
        assert each.help or each.notes or each.message.startswith("expected"), each  # what to do, or what there is
        assert json.loads(json.dumps(to_json(each)))["code"] == each.code


@pytest.mark.parametrize("path", WRONG, ids=lambda path: path.stem)
def test_carets_stand_below_the_place(path: Path) -> None:
    for each in diagnostics(path):
        assert each.span is not None
        _, _, _, line, caret, *_ = render(each).splitlines()
        before, marks = cells(caret[: caret.index("^")]), caret.count("^")
        assert all(char.isprintable() for char in line)
        assert cells(line) <= 2 * MAX_LINE
        written = each.span.source.text[each.span.start : each.span.end].partition("\n")[0]
        if written.isascii() and written.isprintable() and len(written) < 40:
            at = next(number for number in range(len(line) + 1) if cells(line[:number]) == before)
            assert line[at : at + marks] == written or not written.strip()


def test_every_report_has_a_wrong_mapping(monkeypatch: pytest.MonkeyPatch) -> None:
    made: set[tuple[str, str]] = set()

    def recording(module, name, function):
        def record(*arguments, **options):
            made.add((module.__name__, name))
            return function(*arguments, **options)

        return record

    functions = [
        (module, name, function)
        for module in CATALOGUE
        for name, function in inspect.getmembers(module, inspect.isfunction)
        if function.__module__ == module.__name__ and function.__annotations__.get("return") == "Diagnostic"
        if name not in {*MAKERS, *ELSEWHERE}
    ]
    for module, name, function in functions:
        monkeypatch.setattr(module, name, recording(module, name, function))
    for path in WRONG:
        diagnostics(path)
    assert {(module.__name__, name) for module, name, _ in functions} - made == set()


def test_the_corpus_is_large_enough() -> None:
    assert len(WRONG) >= 60
