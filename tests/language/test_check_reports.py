"""Every wrong mapping in tests/golden/mapping gives the report beside it, and every report that there is, is given by one of them."""

from __future__ import annotations

import inspect
import json
import sys
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING

import pytest

from rosetta_jit.diagnostics import MAX_LINE, render, render_all, to_json
from rosetta_jit.errors import MappingError
from rosetta_jit.frameworks.installed import Readers, installed
from rosetta_jit.language.check.mapping import check
from rosetta_jit.language.parse.mapping import parse
from rosetta_jit.parsing.search import SearchPath
from rosetta_jit.source import Source
from rosetta_jit.startup.late import Late
from rosetta_jit.terminal import cells
from tests.golden import GOLDEN, check_golden

if TYPE_CHECKING:
    from pathlib import Path

    from rosetta_jit.diagnostics import Diagnostic


FOLDER = GOLDEN / "mapping"
WRONG = sorted(FOLDER.glob("*.mapping"))
FRONT_ENDS = Readers({name: installed()[name] for name in ("yarp", "protobuf", "lcm")})
SCHEMAS = [path for path in FOLDER.iterdir() if path.suffix in {".proto", ".bottle-schema", ".lcm", ".txt", ".units"}]
FILES = {path.name: path.read_text() for path in (*SCHEMAS, *(FOLDER / "used").iterdir())}
"""What the wrong mappings import, and the mappings that they use."""

CATALOGUE = tuple(
    f"rosetta_jit.catalogue.{name}"
    for name in (
        "mapping",
        "resolve",
        "fields",
        "rest",
        "check",
        "derive",
        "units",
        "layouts",
        "state",
        "texts",
        "nested",
        "functions",
        "images",
        "unit_files",
        "bind",
        "number_bytes",
        "groups",
        "checksums",
        "wires",
    )
)
MAKERS = ("error", "warning", "note", "placed", "in_one_way")
OF_FILES = ("file_too_large", "texts_too_large", "file_not_text", "file_unreadable", "mapping_not_found", "in_used")
"""What takes files: tests/language/test_search_path.py, tests/parsing/test_budget.py and tests/api/test_state.py have it."""

OF_BOTH_WAYS = ("alike_blocks", "too_complex", "too_many_blocks", "unknown_condition")
"""What rules for both directions cannot decide: test_both_ways.py and test_hostile_mappings.py have it."""

OF_PIECES = ("many_pieces", "lone_brace", "no_value")
"""Values in the texts of rejections, and parameters: test_rejections.py and test_parameters.py have it."""

OF_PROGRAMS = ("missing", "unknown", "needless", "not_given", "not_declared", "does_not_compile", "no_compiler", "no_library")
"""What is given to a program, and what is not installed: test_parameters.py, test_functions.py and test_compressed.py have it."""

OF_WIRES = ("unsaid", "single", "cannot_borrow", "not_here")
"""What programs of a mapping with several wires are refused: tests/api/test_wires.py has it."""

OF_SIZES = (
    "many_copies",
    "many_defaults",
    "many_mappings",
    "many_uses",
    "many_items",
    "long_list",
    "mixed_list",
    "too_many",
    "too_many_parts",
)
"""More than is compiled: `test_what_is_too_large` and test_parameters.py have it."""

OF_WIDE_TEXTS = ("wide_text", "text_length")
"""Text of 16-bit units, which the frameworks here lack: `test_wide_texts` has it."""

OF_UNIONS = ("other_case", "late_discriminator", "many_labels")
"""Discriminators, which the frameworks here lack: test_unions.py has it."""

ELSEWHERE = (*OF_UNIONS, *OF_FILES, *OF_BOTH_WAYS, *OF_PIECES, *OF_PROGRAMS, *OF_WIRES, *OF_SIZES, *OF_WIDE_TEXTS)


@cache
def diagnostics(path: Path) -> tuple[Diagnostic, ...]:
    try:
        found = check(parse(Source(path.name, path.read_text())), FRONT_ENDS, SearchPath(files=tuple(FILES.items())))
    except MappingError as error:
        return error.diagnostics
    return (*found.warnings, *found.notes)


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


def stand_ins(name: str) -> list[Late]:
    """What those who report have in place of a module: each its own, which keeps the functions that it was asked for."""
    ours = [vars(module) for each, module in sys.modules.items() if each.startswith("rosetta_jit")]
    return [each for names in ours for each in names.values() if isinstance(each, Late) and vars(each)["_name"] == name]


def test_every_report_has_a_wrong_mapping(monkeypatch: pytest.MonkeyPatch) -> None:
    made: set[tuple[str, str]] = set()

    def recording(module, name, function):
        def record(*arguments, **options):
            made.add((module.__name__, name))
            return function(*arguments, **options)

        return record

    functions = [
        (module, name, function)
        for module in map(import_module, CATALOGUE)
        for name, function in inspect.getmembers(module, inspect.isfunction)
        if function.__module__ == module.__name__ and function.__annotations__.get("return") == "Diagnostic"
        if name not in {*MAKERS, *ELSEWHERE}
    ]
    assert {module.__name__ for module, _, _ in functions} == set(CATALOGUE)
    for module, name, function in functions:
        for each in (module, *stand_ins(module.__name__)):
            monkeypatch.setattr(each, name, recording(module, name, function))
    for path in WRONG:
        diagnostics.__wrapped__(path)
    assert {(module.__name__, name) for module, name, _ in functions} - made == set()


def reports(files: dict[str, str], frameworks: tuple[str, ...] = ("yarp", "protobuf")) -> list[str]:
    """The codes of what is wrong with `m.mapping` among some files."""
    front_ends = Readers({name: installed()[name] for name in frameworks})
    with pytest.raises(MappingError) as error:
        check(parse(Source("m.mapping", files["m.mapping"])), front_ends, SearchPath(files=tuple(files.items())))
    return [each.code for each in error.value.diagnostics if each.severity == "error"]


def test_what_is_too_large() -> None:
    schema = """syntax = "proto2"; package t; message A { optional A x = 1; optional A y = 2; optional int32 n = 3; }
message B { optional B x = 1; optional B y = 2; optional int32 n = 3; }"""
    head = 'import "t.proto"\ndata-holder: t.A\nwire-schema: t.B\nunpack-rules:\n  .n = .n\n'
    ended = f"{head}  default .x default .y ignore .x ignore .y\n"

    def nested(name: str, other: str) -> tuple[str, str]:
        return name, f'{head}  .x = .x via "{other}"\n  .y = .y via "{other}"\n'

    doubling = dict(nested(f"m{n}.mapping" if n else "m.mapping", f"m{n + 1}.mapping") for n in range(11))
    assert reports({"t.proto": schema, **doubling, "m11.mapping": ended})[0] == "many-uses"
    many = "".join(f'  when .n == {n} .x = .x via "m{n}.mapping" else default .x end\n' for n in range(70))
    others = {f"m{n}.mapping": ended for n in range(70)}
    assert "many-mappings" in reports({"t.proto": schema, **others, "m.mapping": head + many})
    wide = "  " + "ignore .n " * 29 + "\n"
    copied = {name: text.replace("  .n = .n\n", "  .n = .n\n" + wide) for name, text in {**doubling, "m11.mapping": ended}.items()}
    assert reports({"t.proto": schema, **copied})[0] == "many-uses"
    required = schema.replace("optional", "required")
    assert reports({"t.proto": required, "m.mapping": f"{head}  default .x default .y ignore .x ignore .y\n"}) == ["many-defaults"] * 2
    units = "t.A:\n" + "  .n: m\n" * 5001
    assert "too-many-units" in reports({"t.proto": schema, "u.units": units, "m.mapping": f'import "u.units"\n{ended}'})


def test_wide_texts() -> None:
    files = {
        "w.idl": "module wide { struct W { wstring s; }; };",
        "t.proto": 'syntax = "proto2"; package t; message T { required string s = 1; }',
        "m.mapping": 'import "w.idl"\nimport "t.proto"\ndata-holder: t.T\nwire-schema: wide::W\nunpack-rules:\n  .s = upper(.s)\n'
        "pack-rules:\n  .s = upper(.s)\n",
    }
    assert reports(files, ("ros2", "protobuf")) == ["wide-text", "wide-text"]


def test_the_corpus_is_large_enough() -> None:
    assert len(WRONG) >= 60
