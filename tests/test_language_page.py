"""What the language reference claims is what the compiler does: inversions, functions, kinds of errors, links."""

from __future__ import annotations

import re
from pathlib import Path
from typing import get_args

import pytest

import rosetta_jit as rj
from rosetta_jit.errors import Kind
from rosetta_jit.explain.content import explanation
from rosetta_jit.language.arrays.array_functions import ARGUMENTS
from rosetta_jit.language.functions import calls
from rosetta_jit.language.groups import group_functions
from rosetta_jit.language.installed import names, shipped
from rosetta_jit.language.laws.chain import UNSHOWN
from tests.golden import check_golden

DOCS = Path(__file__).resolve().parent.parent / "docs"
PAGE = (DOCS / "language.md").read_text("utf-8")
INVERSIONS = (DOCS / "inversions.md").read_text("utf-8")
HEAD = 'import "w.bottle-schema"\nimport "h.proto"\ndata-holder: lab.H\nwire-schema: w\nrules:\n'
WIRE = {
    "n": ":int64",
    "i": ":int",
    "x": ":double",
    "f": ":float32",
    "t": ":bool",
    "s": ":string",
    "d": ":blob",
    "p": "(:list :uint8 (:length 16))",
    "l": "(:list :double)",
    "w": "(:list :string)",
}
HOLDER = {
    "n": "required int64",
    "i": "required int32",
    "x": "required double",
    "f": "required float",
    "t": "required bool",
    "c": "required Color",
    "s": "required string",
    "d": "required bytes",
    "p": "required bytes",
    "l": "repeated double",
    "w": "repeated string",
}
COLORS = "enum Color { GRAY = 0; RGB = 1; BGR = 2; }"
"""The types of fields, by name, as the page says above its table."""


def rows() -> list[tuple[list[str], list[str], str, str]]:
    """The relations of each row, what they pack as, and both laws."""
    table = INVERSIONS[INVERSIONS.index("| relation | packs as |") :].partition("\n\n")[0].splitlines()[2:]
    cells = [[cell.strip() for cell in line.split("|")[1:-1]] for line in table]
    return [(_codes(relation), _codes(packs), messages, holders) for relation, packs, _, messages, holders in cells]


def _codes(cell: str) -> list[str]:
    return [code for _, code in re.findall(r"(`+)(.+?)\1(?!`)", cell)]


def _fields(relations: list[str]) -> tuple[set[str], set[str]]:
    """The fields that relations name of the holder and of the wire."""
    held: set[str] = set()
    sent: set[str] = set()
    for relation in relations:
        left, _, right = re.sub(r"for .*?\) ", "", relation).partition(" <-> ")
        held |= set(re.findall(r"\.([a-z])\b", left))
        sent |= set(re.findall(r"\.([a-z])\b", right))
    return held, sent


@pytest.mark.parametrize(("relations", "packs", "messages", "holders"), rows(), ids=[" ".join(row[0]) for row in rows()])
def test_inversions(tmp_path, monkeypatch, relations, packs, messages, holders):
    held, sent = _fields(relations)
    wire = " ".join(f'("{each}" {WIRE[each]})' for each in sorted(sent) or ["i"])
    fields = " ".join(f"{HOLDER[each]} {each} = {number};" for number, each in enumerate(sorted(held), 1))
    rules = "\n  ".join([*relations, *([] if sent else ["ignore .i"])])
    (tmp_path / "w.bottle-schema").write_text(f'"w" ({wire})')
    (tmp_path / "h.proto").write_text(f'syntax = "proto2"; package lab; {COLORS} message H {{ {fields} }}')
    (tmp_path / "m.mapping").write_text(f"{HEAD}  {rules}\n")
    monkeypatch.chdir(tmp_path)
    pack = next(each for each in explanation("m.mapping", encoding="yarp4").directions if each.name == "pack")
    assert [line.text for line in pack.lines if not line.text.startswith("default")] == packs
    laws = rj.check("m.mapping").laws
    assert laws is not None
    for law, told in ((laws.messages, messages), (laws.holders, holders)):
        if not sent and law is laws.messages:
            continue  # what the wire has besides is ignored
        assert law.kind == told
        assert UNSHOWN.why not in str(law)


@pytest.mark.parametrize(
    "value",
    [
        *(f"{name}(.x)" for name in ("abs", "floor", "ceil", "round", "sqrt", "sin", "cos", "tan", "asin", "acos", "atan")),
        *(f"{name}(.x, 1.0)" for name in ("min", "max")),
        "align(.n, 2)",
        *(f".n {operator} 2" for operator in ("%", "|", "<<")),
        *(f"{name}(.s)" for name in ("lower", "upper", "strip", "fraction")),
        'replace(.s, "a", "b")',
        'part(.s, "a", 0)',
        "slice(.s, 0, 1)",
    ],
)
def test_what_is_not_turned_round(value):
    (field,) = set(re.findall(r"\.([a-z])", value))
    files = {
        "w.bottle-schema": f'"w" (("{field}" {WIRE[field]}))',
        "h.proto": f'syntax = "proto2"; package lab; message H {{ {HOLDER["n" if "fraction" in value else field]} a = 1; }}',
        "m.mapping": f"{HEAD}  .a <-> {value}\n",
    }
    with pytest.raises(rj.MappingError) as error:
        rj.Encoder("m.mapping", schema=files, encoding="yarp4", backend="interpreter")
    assert [each.code for each in error.value.diagnostics] == ["no-inverse"]
    told = INVERSIONS[INVERSIONS.index("Several values give the same") :].partition("\n\n")[0]
    assert re.search(rf"`{re.escape(re.sub(r'[.(].*', '', value) or value.split()[1])}`", told)


def test_every_function_is_told():
    functions = {*names(), *group_functions(), *ARGUMENTS, *calls.INTEGERS, *calls.FLOATS}
    told = PAGE.replace("`int8_at(b, i)` … `uint64_at(b, i)`", " ".join(f"`{name}(" for name in names() if re.search(r"int\d+_at", name)))
    assert {name for name in {*functions, "has", "bool"} if f"`{name}(" not in told} == set()


TABLES = {
    "numbers": "| function | takes | gives |",
    "groups": "| function | takes | gives |",
    "elements": "| function | takes | gives |",
    "arrays": "| function | gives | else, an error of kind |",
    "texts": "| function | gives | else, an error of kind |",
    "bytes": "| function | gives | else, an error of kind |",
    "images": "| function | takes | gives |",
}


def test_tables_of_functions_are_printed_from_their_records():
    def printed(match):
        table = match["table"]
        rows = dict.fromkeys(row for function in shipped() for row in function.rows if row.table == table)
        lines = [TABLES[table], "|---|---|---|", *(f"| {row.forms} | {' | '.join(row.cells)} |".replace("|  |", "| |") for row in rows)]
        return "\n".join([match["head"], *lines, match["end"]])

    table = r"(?P<head><!-- functions: (?P<table>\w+), [^\n]*)\n.*?\n(?P<end><!-- end of functions -->)"
    text, count = re.subn(table, printed, PAGE, flags=re.DOTALL)
    assert count == len(TABLES)
    check_golden(DOCS / "language.md", text)


def test_every_kind_of_error_is_told():
    table = PAGE[PAGE.index("| kind | when |") :].partition("\n\n")[0]
    assert {kind for kind in get_args(Kind) if f"`{kind}`" not in table} == set()


def test_every_operation_has_an_example():
    from rosetta_jit.explain.operations import OPERATIONS

    chapter = (DOCS / "operations.md").read_text("utf-8")
    found = {title.lower(): "```python" in text for title, text in re.findall(r"\n## (.*?)\n(.*?)(?=\n## |\Z)", chapter, re.DOTALL)}
    assert found == dict.fromkeys(OPERATIONS, True)


@pytest.mark.parametrize("page", sorted(DOCS.glob("*.md")), ids=lambda path: path.name)
def test_links_lead_somewhere(page):
    for file, anchor in re.findall(r"\]\(([a-z-]*\.md)?#([a-z-]+)\)", page.read_text("utf-8")):
        titles = re.findall(r"^#+ (.*)$", (DOCS / file if file else page).read_text("utf-8"), re.MULTILINE)
        assert anchor in {re.sub(r"[^a-z0-9 -]", "", title.lower()).replace(" ", "-") for title in titles}
