"""The tables beside the grammars are fresh, and our parser does with them what lark does."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path

import pytest
from lark import Token
from lark.exceptions import UnexpectedCharacters, UnexpectedToken

from rosetta_jit.frameworks.protobuf.proto import syntax
from rosetta_jit.frameworks.yarp.bottle_schema import sexpr
from rosetta_jit.language.parse import templates
from rosetta_jit.parsing import parsers
from rosetta_jit.parsing.lalr import Tree, UnexpectedCharacterError, UnexpectedTokenError
from rosetta_jit.parsing.tables import _printable, lark_of

ROOT = Path(__file__).resolve().parents[2]


@dataclass(frozen=True)
class Case:
    """A grammar, how its parser is made, and the suffix of texts in its language."""

    grammar: Path
    suffix: str
    start: str = "start"
    mistake_tokens: tuple[str, ...] = ()

    def ours(self):
        return parsers.parser_of(self.grammar, start=self.start, mistake_tokens=self.mistake_tokens)

    def larks(self):
        return lark_of(self.grammar.read_text("utf-8"), start=self.start, mistake_tokens=self.mistake_tokens)

    def texts(self):
        """Texts, and some that are cut off or have a sign too many."""
        for path in sorted([*(ROOT / "mappings").rglob(f"*{self.suffix}"), *(ROOT / "idl").rglob(f"*{self.suffix}")])[:60]:
            text = path.read_text("utf-8")
            yield text
            yield text[: len(text) * 2 // 3]
            yield text[: len(text) // 2] + ' ) "' + text[len(text) // 2 :]


CASES = {
    "mapping": Case(templates.GRAMMAR, ".mapping", mistake_tokens=templates.MISTAKES),
    "proto": Case(syntax.GRAMMAR, ".proto", syntax.START, syntax.MISTAKES),
    "bottle": Case(sexpr.GRAMMAR, ".bottle-schema"),
}


@pytest.fixture(params=CASES.values(), ids=CASES)
def case(request):
    return request.param


def test_every_grammar_has_fresh_tables(case):
    """``UPDATE_GOLDENS=1 pytest`` makes them anew after a change of a grammar."""
    tables = case.grammar.with_suffix(parsers.SUFFIX)
    wanted = parsers.tables_of(case.grammar, start=case.start, mistake_tokens=case.mistake_tokens)
    if os.environ.get("UPDATE_GOLDENS"):
        tables.write_text(wanted, "utf-8")
    assert tables.read_text("utf-8") == wanted, "run with UPDATE_GOLDENS=1"


def test_there_is_no_grammar_besides():
    assert {path.name for path in (ROOT / "rosetta_jit").rglob("*.lark")} == {each.grammar.name for each in CASES.values()}


def test_texts_become_what_lark_makes_of_them(case):
    ours, larks = case.ours(), case.larks()
    outcomes = [(our_outcome(ours, text), lark_outcome(larks, text)) for text in case.texts()]
    assert len({type(ours) for ours, _ in outcomes}) > 1, "some are read and some are not"
    for ours, theirs in outcomes:
        assert ours == theirs


def test_what_fits_next_is_what_lark_accepts(case):
    """After each token of a text, and where one does not fit."""
    parser, larks = case.ours().parser(), case.larks().parse_interactive()
    tokens = next(list(case.ours().lex(text)) for text in case.texts() if len(text) < 4000)
    for token in [*tokens[: len(tokens) // 2], tokens[0].of_kind("STRANGE")]:
        assert parser.accepted() == larks.accepts()
        with pytest.raises(UnexpectedTokenError) if token.type == "STRANGE" else nullcontext():
            parser.feed(token)
        with pytest.raises(UnexpectedToken) if token.type == "STRANGE" else nullcontext():
            larks.feed_token(Token(token.type, str(token)))
    assert parser.accepted() == larks.accepts()


def our_outcome(grammar, text):
    """The tree of a text, as lists, or where and at what the parser stopped."""
    try:
        return our_tree(grammar.parse(grammar.lex(text)))
    except UnexpectedTokenError as error:
        return error.token.type, str(error.token), error.token.start_pos if error.token.type != "$END" else None
    except UnexpectedCharacterError as error:
        return (error.at,)


def lark_outcome(lark, text):
    try:
        return lark_tree(lark.parse(text))
    except UnexpectedToken as error:
        return error.token.type, str(error.token), error.token.start_pos if error.token.type != "$END" else None
    except UnexpectedCharacters as error:
        return (error.pos_in_stream,)


def our_tree(tree):
    if isinstance(tree, Tree):
        return [tree.data, tree.start_pos, tree.end_pos, *map(our_tree, tree.children)]
    return tree.type, str(tree), tree.start_pos, tree.end_pos


def lark_tree(tree):
    if not isinstance(tree, Token):
        return [str(tree.data), *(getattr(tree.meta, name, -1) for name in ("start_pos", "end_pos")), *map(lark_tree, tree.children)]
    return tree.type, str(tree), tree.start_pos, tree.end_pos


def test_a_changed_grammar_does_not_use_old_tables(case, tmp_path):
    grammar = Path(shutil.copy(case.grammar, tmp_path))
    tables = Path(shutil.copy(case.grammar.with_suffix(parsers.SUFFIX), tmp_path))
    changed = Case(grammar, case.suffix, case.start, case.mistake_tokens)
    grammar.write_text(grammar.read_text("utf-8") + "// more\n", "utf-8")
    stale = case.ours().tables
    fresh = changed.ours().tables
    assert fresh == {**stale, "digest": fresh["digest"]}
    assert fresh["digest"] != stale["digest"]
    tables.unlink()
    assert changed.ours().tables == fresh


@pytest.mark.parametrize("damaged", ["", "%", "{}", "%digest\n"])
def test_damaged_tables_are_made_anew(case, tmp_path, damaged):
    grammar = Path(shutil.copy(case.grammar, tmp_path))
    grammar.with_suffix(parsers.SUFFIX).write_text(damaged, "utf-8")
    assert Case(grammar, case.suffix, case.start, case.mistake_tokens).ours().tables == case.ours().tables


@pytest.mark.parametrize("pattern", ["[ \t\n\f\r\v]+", "\\\n", "\\\\\n", "\\\\n", "[^\\\t]\\t", r"\d\n"])
def test_patterns_are_written_in_one_line(pattern):
    printable = _printable(pattern)
    assert printable.isprintable()
    for text in ("\n", "\t", "\\\n", "\\n", "a\t", "\t\t", "\\\\", " \v\f", "1\n"):
        assert bool(re.fullmatch(printable, text)) == bool(re.fullmatch(pattern, text))


def test_fresh_tables_need_no_lark():
    program = "import sys; sys.modules['lark'] = None; import rosetta_jit; rosetta_jit.check('yarp/icub/torso_state.mapping')"
    subprocess.run([sys.executable, "-c", program], check=True)
