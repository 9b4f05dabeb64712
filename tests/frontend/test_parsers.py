"""The tables beside the grammars: fresh, and as good as those that lark makes."""

from __future__ import annotations

import json
import os
import shutil
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

from rosetta_jit.frameworks.protobuf.proto import syntax
from rosetta_jit.frameworks.yarp import sexpr
from rosetta_jit.frontend import mapping, parsers

ROOT = Path(__file__).resolve().parents[2]


@dataclass(frozen=True)
class Case:
    """A grammar, how its parser is made, and a text in its language."""

    grammar: Path
    sample: str
    options: dict[str, Any] = field(default_factory=dict)


CASES = {
    "mapping": Case(mapping.GRAMMAR, "mappings/yarp/icub/torso_state.mapping", {"postlex": mapping.Tokens(), "positions": True}),
    "proto": Case(syntax.GRAMMAR, "idl/rst/vision/Image.proto", {"postlex": syntax.WrongTokens(), "start": "file"}),
    "bottle": Case(sexpr.GRAMMAR, "idl/yarp/icub/torso_state.bottle-schema"),
}


@pytest.fixture(params=CASES.values(), ids=CASES)
def case(request):
    return request.param


def test_every_grammar_has_fresh_tables(case):
    """``UPDATE_GOLDENS=1 pytest`` makes them anew after a change of a grammar."""
    tables = case.grammar.with_suffix(parsers.SUFFIX)
    options = {name: case.options.get(name, default) for name, default in (("start", "start"), ("positions", False))}
    wanted = parsers.digest(case.grammar.read_text("utf-8"), options["start"], positions=options["positions"])
    if os.environ.get("UPDATE_GOLDENS") and not (tables.exists() and json.loads(tables.read_text("utf-8"))["digest"] == wanted):
        tables.write_text(parsers.tables_of(case.grammar, **case.options), "utf-8")
    assert json.loads(tables.read_text("utf-8"))["digest"] == wanted, "run with UPDATE_GOLDENS=1"


def test_there_is_no_grammar_besides():
    assert {path.name for path in (ROOT / "rosetta_jit").rglob("*.lark")} == {each.grammar.name for each in CASES.values()}


def test_read_tables_parse_as_made_ones_do(case, tmp_path):
    alone = shutil.copy(case.grammar, tmp_path)
    read, made = parsers.parser_of(case.grammar, **case.options), parsers.parser_of(Path(alone), **case.options)
    text = (ROOT / case.sample).read_text("utf-8")
    assert read.parse(text) == made.parse(text)
    tokens = [(token.type, token.value, token.start_pos) for token in read.lex(text)]
    assert tokens == [(token.type, token.value, token.start_pos) for token in made.lex(text)]
    assert read.parse_interactive().accepts() == made.parse_interactive().accepts()


def test_nothing_is_made_where_tables_are_fresh(case, monkeypatch):
    monkeypatch.setattr(parsers, "Lark", type("Lark", (parsers.Lark,), {"__init__": None}))
    assert parsers.parser_of(case.grammar, **case.options)


@pytest.mark.parametrize("change", ["// more\n", "\n"])
def test_a_changed_grammar_does_not_use_old_tables(case, tmp_path, change):
    grammar = Path(shutil.copy(case.grammar, tmp_path))
    shutil.copy(case.grammar.with_suffix(parsers.SUFFIX), tmp_path)
    grammar.write_text(grammar.read_text("utf-8") + change, "utf-8")
    text = (ROOT / case.sample).read_text("utf-8")
    assert parsers.parser_of(grammar, **case.options).parse(text) == parsers.parser_of(case.grammar, **case.options).parse(text)


def test_another_lark_does_not_use_our_tables(case, monkeypatch):
    before = parsers.digest("x", "start", positions=False)
    monkeypatch.setattr(parsers.lark, "__version__", "0.0")
    assert parsers.digest("x", "start", positions=False) != before
    assert parsers.parser_of(case.grammar, **case.options)
