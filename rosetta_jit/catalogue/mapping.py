"""What can be wrong in the text of a mapping, and in what it imports."""

from __future__ import annotations

import re
from collections.abc import Iterable

from rosetta_jit.catalogue.suggestions import closest, shorten
from rosetta_jit.catalogue.unexpected import instead
from rosetta_jit.diagnostics import Diagnostic, Mistake, error, warning
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import replace

EXPECTATIONS = (
    ("INTEGER", "a value"),
    ("STAR", "an operator"),
    ("FOR", "a rule"),
    ("IMPORT", "a statement"),
    ("EQUAL", "`=`"),
    ("RELATES", "`<->`"),
    ("COLON", "`:`"),
    ("LPAR", "`(`"),
    ("RPAR", "`)`"),
    ("LSQB", "`[`"),
    ("RSQB", "`]`"),
    ("RBRACE", "`}`"),
    ("COMMA", "`,`"),
    ("FROM", "`from`"),
    ("TO", "`to`"),
    ("BY", "`by`"),
    ("END", "`end`"),
    ("MEMBER", "`.field`"),
    ("START", "a field (`.name`)"),
    ("NAME", "a name"),
    ("STRING", "a text in quotes"),
)
"""Token kind → how a person calls what may stand there, in the order in which it is listed."""

CALLED = {"double": "float64", "float": "float32", "int": "int32", "long": "int64", "byte": "uint8", "boolean": "bool", "text": "string"}
"""What other languages call the types of numbers."""

WORDS = {
    kind: kind.strip("_").lower()
    for kind in (
        *("IMPORT", "PARAMETER", "STATE", "FUNCTION", "_SAME", "NAMES", "IGNORE", "DEFAULT", "REST", "REJECT", "FOR", "FROM", "TO", "BY"),
        *("END", "WHEN", "ELSE", "IF", "AND", "OR", "NOT", "VIA", "DEPTH", "WHERE", "WITH", "EXCEPT", "OTHERWISE", "LIST", "OF"),
    )
} | {
    kind: f"{kind.lower().replace('_', '-')}:"
    for kind in ("DATA_HOLDER", "WIRE_SCHEMA", "LIMIT", "ROUNDING", "EDITION", "RULES", "UNPACK_RULES", "PACK_RULES")
}
"""Token kind → the word of the language that it is, with the colon that follows a statement's."""

STARTS_VALUE = frozenset({"LPAR", "LSQB", "START", "NAME", "STRING"})
STARTS_RULE = frozenset({"START"})


def unexpected(span: Span, kind: str, expected: frozenset[str]) -> Diagnostic:
    if (second := _second_value(span, kind, expected)) is not None:
        return second
    found = span.source.text[span.start : span.end]
    name = "the end of the file" if kind == "$END" else f"`{shorten(found)}`"
    message = f"expected {_listed(_expected(expected))}, found {name}"
    return error("syntax", message, span, "not expected here", help_=_help(span, kind, expected))


def _second_value(span: Span, kind: str, expected: frozenset[str]) -> Diagnostic | None:
    """The report of a rule that ends with a second value: it stands where the next rule's place would, and so is noticed late."""
    if kind not in ("START", "FOR", "WHEN", "IGNORE", "DEFAULT", "REJECT", "_SAME") or not expected & {"RELATES", "EQUAL"}:
        return None
    text = span.source.text
    line = text[: span.start].rstrip()
    start = line.rfind("\n") + 1
    found = re.search(r"=[^=\n]*\S[ \t]+(\.\w[\w.\[\]]*)$", line[start:]) or re.search(r"<->[^\n]*\S[ \t]+(\.\w[\w.\[\]]*)$", line[start:])
    if found is None or "\n" not in text[len(line) : span.start]:
        return None
    place = Span(span.source, start + found.start(1), start + found.end(1))
    cast = re.search(r"\(([A-Za-z]\w*)\)[ \t]*$", line[start : place.start])
    called = re.search(r"(?<![\w.])([A-Za-z]\w*)[ \t]*$", line[start : place.start])
    help_ = "an operator, or a line, is missing before it"
    if cast:
        help_ = f"a number becomes one of another type so: `{CALLED.get(cast[1], cast[1])}({found[1]})`"
    elif called:
        help_ = f"what a function takes stands in brackets: `{called[1]}({found[1]})`"
    return error("syntax", f"expected an operator or a rule, found `{shorten(found[1])}`", place, "a second value", help_=help_)


def _help(span: Span, kind: str, expected: frozenset[str]) -> str:
    found = span.source.text[span.start : span.end]
    return (
        _undotted(span, kind, expected)
        or instead(span, kind, expected)
        or _meant(span, kind, expected)
        or _itself(span)
        or _hint(found, kind, expected)
    )


def _meant(span: Span, kind: str, expected: frozenset[str]) -> str:
    """The word of the language that may stand there and is spelt nearly so; empty where there is none."""
    if kind != "NAME":
        return ""
    written = re.match(r"[A-Za-z_-]+:?", span.source.text[span.start : span.start + 20])
    meant = None if written is None else closest(written[0], sorted(WORDS[each] for each in expected & WORDS.keys()))
    return f"did you mean `{meant}`?" if meant else ""


BEFORE = {"RSQB": r"(?<![\w.])([A-Za-z_]\w*)\[$", "MEMBER": r"(?<![\w.])([A-Za-z_]\w*\[[^][\n]*\])$"}
"""What stands before a token, by kind, where the dot of a field was forgotten."""

SET_HERE = r"[A-Za-z_]\w*(\.\w+|\[[^][\n]*\])*[ \t]*(=|<->)"


def _undotted(span: Span, kind: str, expected: frozenset[str]) -> str:
    """A hint where a field lacks its dot; empty where none does."""
    text = span.source.text
    if kind == "NAME" and "START" in expected and ("FOR" not in expected or re.match(SET_HERE, text[span.start : span.end + 100])):
        name = text[span.start : span.end]
    else:
        found = re.search(BEFORE[kind], text[max(0, span.start - 100) : span.start]) if kind in BEFORE else None
        name = found[1] if found else ""
    if name and (declared := re.search(rf"(?m)^[ \t]*(state|parameter)[ \t]+{re.escape(name)}\b", text)) is not None:
        return f"a state variable is set by `state {shorten(name)} = ...`" if declared[1] == "state" else "no rule sets a parameter"
    return f"a field begins with a dot: `.{shorten(name)}`" if name else ""


def _expected(kinds: frozenset[str]) -> list[str]:
    implied = (STARTS_VALUE if "INTEGER" in kinds else frozenset[str]()) | (STARTS_RULE if "FOR" in kinds else frozenset[str]())
    named = [name for kind, name in EXPECTATIONS if kind in kinds - implied]
    return named or (["`else`"] if "ELSE" in kinds else [f"`{WORDS[kind]}`" for kind in sorted(kinds & WORDS.keys())])


def _itself(span: Span) -> str:
    """A hint where a lone dot stands for the message; empty elsewhere."""
    text = span.source.text
    is_lone = text[span.start : span.end] == "." and re.match(r"[ \t]*[,)]", text[span.end : span.end + 100]) is not None
    return "the message itself is no value: write its fields as a list, `[.x, .y, .z, .w]`" if is_lone else ""


def _hint(found: str, kind: str, expected: frozenset[str]) -> str:
    if kind == "UNCLOSED":
        return 'close the text with `"` on the same line'
    if kind == "EQUAL" and "RELATES" in expected:
        return "under `rules:` a rule is for both directions: `.place <-> value`"
    if kind == "RELATES" and "EQUAL" in expected:
        return "`<->` stands under `rules:`; here a place is set: `.place = value`"
    if kind == "MEMBER" or found == ".":
        return "a path is written without blanks and begins with a dot: `.a.b[0]`"
    if kind == "END":
        return "every `end` closes one `for` or `when`"
    if "INTEGER" in expected:
        return "a value is a field (`.a.b[0]`), a number, a text in quotes, a function of those, or a table"
    if "IMPORT" in expected and "FOR" not in expected:
        names = ("import", "parameter", "function", "data-holder:", "wire-schema:", "rules:", "unpack-rules:")
        return f"statements are {', '.join(f'`{name}`' for name in names)} and `pack-rules:`"
    return ""


def nesting(span: Span, limit: int) -> Diagnostic:
    return error(
        "nesting",
        f"nested deeper than {limit} levels",
        span,
        "this is one level too many",
        help_="split the expression; every operator of a long sum counts as one level",
    )


def escape(span: Span, text: str) -> Diagnostic:
    return error("escape", f"unknown escape `{text}`", span, help_=r"known are \" \\ \n \t \r")


lone_brace = Mistake(
    "lone-brace", "a brace that belongs to no other", "here", help="a value stands in braces: `{.name}`; write a brace as `{{` or `}}`"
)
no_value = Mistake("syntax", "braces hold one value", "more than one")


def many_pieces(span: Span | None, most: int) -> Diagnostic:
    return error("many-pieces", f"a text has at most {most} values and texts between them", span)


def number(span: Span, target: str) -> Diagnostic:
    return error("number", f"the number does not fit {target}", span, "too large", help_="write a smaller one")


def compared_index(span: Span | None) -> Diagnostic:
    written = "" if span is None else span.source.text[span.start : span.end].replace("==", "=", 1)
    help_ = f"the element with that key is found by one `=`: `[{shorten(written)}]`"
    return error("key-field", "a comparison is no number of an element", span, "true or false", help_=help_)


key_field = Mistake(
    "key-field", "elements are known by a field, or a field of one", "this is none", help='write `.a[.key = "x"]`, or `.a[.keys[] = "x"]`'
)
via_of_several = Mistake("syntax", "`via` maps one message, and several places stand here", help="write a rule for each message")
filter_both_ways = Mistake(
    "filter",
    "a filter goes one way: the elements that it drops do not come back",
    help="write it with `=` below `unpack-rules:`, and below `pack-rules:` what the array of the wire is to be",
)
filter_of_several = Mistake("filter", "a filter is of one array, and several places stand here", help="write a rule with `where` for each")
picked = Mistake("picked", "a list of elements has numbers alone", help="`.a[[2, 0, 1]]`; loops and rules for one element take any index")


def rounding_type(span: Span, name: str) -> Diagnostic:
    return error("rounding", f"nothing is rounded to {shorten(name)}", span, "not a type to round to", help_="write `rounding: float32`")


def unknown_edition(span: Span, year: str) -> Diagnostic:
    help_ = "write `edition: 2012`, or leave it out: mappings of today have none"
    return error("edition", f"there is no edition {shorten(year)} of the language", span, "not known", help_=help_)


def limit_too_large(span: Span, most: int) -> Diagnostic:
    return error("number", f"a limit is at most {most} bytes", span, "too large", help_="write how many bytes a field may have in a holder")


def missing_statement(span: Span, keyword: str) -> Diagnostic:
    return error("missing-statement", f"the mapping has no `{keyword}:`", span, help_=f"add `{keyword}: type.name`")


def repeated_statement(span: Span, keyword: str) -> Diagnostic:
    return error("repeated-statement", f"`{keyword}:` stands twice", span, "again here", help_="merge the two")


no_rules = Mistake(
    "no-rules",
    "the mapping has no rules for either direction",
    help="add `rules:`, `unpack-rules:` or `pack-rules:`; an empty block says that the direction is not meant to exist",
)


def import_not_found(span: Span | None, name: str, folders: Iterable[str], near: str | None = None) -> Diagnostic:
    """An imported file that is nowhere on the search path; ``near`` is one that may be meant."""
    searched = tuple(f"searched {folder}" for folder in folders)
    return error(
        "import-not-found",
        f'no file "{shorten(name)}" on the search path',
        span,
        "imported here",
        notes=searched,
        help_=f'did you mean "{shorten(near)}"?' if near else "correct the name, or name its folder in ROSETTA_JIT_PATH",
    )


def import_name(span: Span | None, name: str, why: str) -> Diagnostic:
    return error(
        "import-name",
        f'"{shorten(name)}" cannot be imported: {why}',
        span,
        help_="name a file of a folder on the search path, which ROSETTA_JIT_PATH adds to; or a type that such a file declares",
    )


def import_suffix(span: Span | None, name: str, suffixes: Iterable[str]) -> Diagnostic:
    known = ", ".join(sorted(suffixes)) or "none"
    help_ = "import the IDL file that declares the types; mappings themselves are not imported"
    return error("import-suffix", f'no front end reads "{shorten(name)}"', span, notes=(f"known suffixes: {known}",), help_=help_)


def import_repeated(span: Span | None, name: str) -> Diagnostic:
    return warning("import-repeated", f'"{shorten(name)}" is imported twice', span, help_="remove one of the two")


def import_unused(span: Span | None, name: str) -> Diagnostic:
    return warning("import-unused", f'nothing of "{shorten(name)}" is used', span, help_="remove the import")


def misnamed(span: Span | None, named: str, holder: str, wire: str) -> Diagnostic:
    return warning(
        "file-name",
        f"the file is named after `{shorten(named)}`, but maps `{shorten(holder)}` and `{shorten(wire)}`",
        span,
        help_="correct the type, or rename the file",
    )


def conflicting_type(span: Span | None, name: str, first: str, second: str) -> Diagnostic:
    return error(
        "conflicting-type",
        f"`{shorten(name)}` is declared twice, differently",
        span,
        notes=(f"by {first}", f"by {second}"),
        help_="import only one of the two",
    )


def file_too_large(name: str, limit: int) -> Diagnostic:
    return error("file-too-large", f"{name} is larger than {limit >> 20} MiB")


def texts_too_large(name: str, limit: int) -> Diagnostic:
    return error("file-too-large", f"{name} and the files read before it are larger than {limit >> 20} MiB")


def too_many(span: Span | None, what: str, most: int) -> Diagnostic:
    return error("too-many", f"a mapping has at most {most} {what}", span, "one too many", help_="split the mapping")


def file_not_text(name: str) -> Diagnostic:
    return error("file-not-text", f"{name} is not UTF-8 text")


def file_unreadable(name: str, why: str) -> Diagnostic:
    return error("file-unreadable", f"{name} cannot be read: {why}")


def mapping_not_found(name: str, folders: Iterable[str], near: str | None = None) -> Diagnostic:
    """A mapping that is neither a file nor on the search path; ``near`` is one that may be meant."""
    searched = tuple(f"searched {folder}" for folder in folders)
    help_ = f'did you mean "{shorten(near)}"?' if near else ""
    return error("mapping-not-found", f'there is no mapping "{shorten(name)}"', notes=searched, help_=help_)


def placed(problem: Diagnostic, span: Span | None) -> Diagnostic:
    return problem if problem.span else replace(problem, span=span)


def _listed(names: list[str]) -> str:
    if len(names) < 2:
        return "".join(names) or "nothing more"
    return f"{', '.join(names[:-1])} or {names[-1]}"
