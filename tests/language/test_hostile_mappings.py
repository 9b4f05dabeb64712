"""Mappings that try to crash, to hang or to flood: each ends in a short report that is safe to print, or is simply right."""

from __future__ import annotations

import time

import pytest

import rosetta_jit as rj
from rosetta_jit.diagnostics import MAX_REPORTED, Diagnostic, render, render_all, to_json
from rosetta_jit.errors import MappingError
from rosetta_jit.frameworks.installed import Readers, installed
from rosetta_jit.language.check.mapping import check
from rosetta_jit.language.parse.mapping import parse
from rosetta_jit.lowering import writer
from rosetta_jit.parsing.search import SearchPath
from rosetta_jit.source import Source, Span

FIELDS = range(300)
FILES = (
    (
        "h.proto",
        'syntax = "proto2"; package h; message H { repeated int32 a = 999; '
        + "".join(f"optional int32 f{i} = {i + 1};" for i in FIELDS)
        + "}",
    ),
    ("w.bottle-schema", '"w" (' + "".join(f'("f{i}" :int)' for i in FIELDS) + '("a" (:list :int)))'),
)
HEAD = 'import "h.proto"\nimport "w.bottle-schema"\ndata-holder: h.H\nwire-schema: w\n'
READERS = Readers({name: installed()[name] for name in ("yarp", "protobuf")})
SECONDS = 10
"""Each takes a few on a machine with nothing else to do."""

UNPACK = {
    "brackets": ".f1 = " + "(" * 20_000,
    "nested conversions": ".f1 = " + "int32(" * 20_000 + ".f1" + ")" * 20_000,
    "nots": ".f1 = 1 if " + "not " * 20_000 + "true else 2",
    "minus": ".f1 = " + "-" * 40_000 + "1",
    "choices": ".f1 = " + "1 if true else " * 10_000 + "2",
    "sum": ".f1 = " + ".f1 + " * 20_000 + "2",
    "powers": "len(.a) = " + " * ".join(["(.f1 + .f2 + .f3 + .f4 + .f5)"] * 12),
    "indices": ".f1 = " + ".a[" * 15_000 + "0" + "]" * 15_000,
    "steps": ".f1 = " + ".f1" * 15_000,
    "loops within loops": "for i from 0 to 1 " * 10_000,
    "whens within whens": "when .f1 > 0 " * 10_000,
    "loops as deep as may be": "len(.a) = 1 " + " ".join(f"for i{n} from 0 to 1" for n in range(60)) + " .a[0] = 1" + " end" * 60,
    "ways": "".join(f"when .f{i} > 0 .f{i} = 1 else .f{i} = 2 end\n" for i in FIELDS),
    "table": ".f1 = table(.f1) {" + ", ".join(f"{i} = {i}" for i in range(10_000)) + "}",
    "table in table": ".f1 = " + "table(.f1) { 1 = " * 5_000,
    "one rule again and again": ".f1 = .f1\n" * 3_000,
    "unknown fields": "".join(f".g{i} = .g{i}\n" for i in range(2_000)),
    "elements from behind": "len(.a) = 3000\n" + "".join(f".a[{i}] = {i}\n" for i in reversed(range(3_000))),
    "loops of unlike steps": "len(.a) = .f1\n" + "".join(f"for i from {i} to .f{i} .a[i * {i}] = {i} end\n" for i in FIELDS),
    "exceptions": "same names except " + ", ".join(f".f{i % 300}" for i in range(10_000)),
    "errors of syntax": ".f1 = = 3\n" * 10_000,
    "quotes": '"\n' * 40_000,
    "dots": "." * 40_000,
    "a long name": ".f1 = " + "x" * 1_000_000,
    "a long number": ".f1 = " + "9" * 1_000_000,
    "a long text": 'reject "' + "x" * 1_000_000 + '"',
    "a text that does not end": 'reject "' + "\\" * 999_999,
    "a long line": ".f1 = .f1" + " " * 900_000 + "+ .nowhere",
    "nul, bell, escape": '.f1 = ."\x00\x07\x1b[2J\x1b]0;title\x07"',
    "text that turns round": '.f1 = ."\u202e\u2066\u200b\ufeff"',
    "lone surrogates": '.f1 = ."\ud800"',
    "carriage returns": ".f1 = .f1\r.f2 = .nowhere\r\n",
    "other ends of lines": ".f1 = .nowhere\x0b\x0c\u2028\u2029\x85",
}
BOTH = {
    "relations": ".f1 <-> .f1\n" * 1_500,
    "loops of relations": "len(.a) <-> len(.a)\n" + "for i from 0 to len(.a) .a[i] <-> .a[i] end\n" * 500,
    "what has no inverse": ".f1 <-> int32(sqrt(.f1))\n" * 1_500,
}


def report(text: str) -> str:
    """What is said of a mapping, in bounded time."""
    start = time.process_time()
    try:
        told = render_all(check(parse(Source("hostile.mapping", text)), READERS, SearchPath(files=FILES)).warnings)
    except MappingError as error:
        told = str(error)
    assert time.process_time() - start < SECONDS
    return told


@pytest.mark.parametrize("name", [*UNPACK, *BOTH])
def test_a_report_is_short_and_safe(name):
    text = f"{HEAD}unpack-rules:\n{UNPACK[name]}\n" if name in UNPACK else f"{HEAD}rules:\n{BOTH[name]}\n"
    told = report(text)
    assert len(told) < 100_000
    assert all(line.isprintable() for line in told.split("\n"))


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("#" + "x" * 10_000_000, "file-too-large"),
        (".a = .b\n" * 100_000, "too-many"),
        ("\n".join(f'import "x{i}.proto"' for i in range(30_000)), "too-many"),
        ("\n".join(f'import "x{i}.proto"' for i in range(201)), "too-many"),
    ],
)
def test_what_is_too_large_is_refused_at_once(text, code):
    with pytest.raises(MappingError) as error:
        parse(Source("huge.mapping", text))
    assert [each.code for each in error.value.diagnostics] == [code]


def test_many_diagnostics_are_counted():
    source = Source("long.mapping", "x\n" * 100_000)
    found = [Diagnostic("warning", "w", "doubt", Span(source, 2 * n, 2 * n + 1)) for n in range(99_999)]
    told = render_all([*found, Diagnostic("error", "e", "mistake", Span(source, 199_998, 199_999))])
    assert told.startswith("error[e]: mistake\n")
    assert told.endswith(f"and {100_000 - MAX_REPORTED} more")
    assert to_json(found[-1])["line"] == 99_999


@pytest.mark.parametrize("text", ["\t\t.x", "日本語 .x", "e\u0301e\u0301 .x", "a" * 500 + " .x", "\x00\x1b .x"])
def test_a_caret_stands_below_its_place(text):
    """As many cells before the caret as before the place, however wide the characters are."""
    from rosetta_jit.terminal import cells

    source = Source("m", f"first\n{text} last\n")
    start = source.text.index(".x")
    shown, caret = render(Diagnostic("error", "e", "m", Span(source, start, start + 2), "here")).splitlines()[3:5]
    assert caret.endswith("^^ here")
    assert cells(shown[: shown.index(".x")]) == caret.index("^")


def test_programs_are_of_a_size_that_can_be_compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    """Rules of six words, each of which becomes some twenty statements."""
    monkeypatch.setattr(writer, "MAX_STATEMENTS", 5_000)
    shown = "".join(f'reject "{{upper(replace(.s, \\"a\\", \\"b\\"))}}" when .n == {number}\n' for number in range(400))
    files = {
        "w.bottle-schema": '"w" (("n" :int) ("s" :string))',
        "h.proto": 'syntax = "proto2"; package h; message H { required int32 n = 1; required string s = 2; }',
        "m.mapping": f"{HEAD}rules:\n.n <-> .n .s <-> .s\n{shown}",
    }
    for program in (rj.Decoder, rj.Encoder):
        with pytest.raises(MappingError, match="5,000 statements") as caught:
            program("m.mapping", schema=files, encoding="yarp4")
        assert [each.code for each in caught.value.diagnostics] == ["too-large"]
    files = {"lab/msg/Many.msg": "\n".join(f"string s{number}" for number in range(2_000))}
    with pytest.raises(rj.SchemaError, match="5,000 statements"):
        rj.Decoder.of("lab/msg/Many", schema=files, encoding="cdr")
