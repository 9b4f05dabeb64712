"""What can be wrong with a `.proto` file as text and as a file: its signs, its imports, its descriptor."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import TYPE_CHECKING

from rosetta_jit.diagnostics import Diagnostic, Mistake, error

if TYPE_CHECKING:
    from rosetta_jit.source import Span

TOKENS = {
    "SEMICOLON": "`;`",
    "LBRACE": "`{`",
    "RBRACE": "`}`",
    "LPAR": "`(`",
    "RPAR": "`)`",
    "LSQB": "`[`",
    "RSQB": "`]`",
    "LESSTHAN": "`<`",
    "MORETHAN": "`>`",
    "EQUAL": "`=`",
    "COMMA": "`,`",
    "COLON": "`:`",
    "DOT": "`.`",
    "NUMBER": "a number",
    "STRING": "a string",
    "TO": "`to`",
    "MAX": "`max`",
    "STREAM": "`stream`",
    "RPC": "`rpc`",
    "RETURNS": "`returns`",
}
"""Token kind → how a person calls it, in the order in which alternatives are listed."""


def unexpected(span: Span, text: str, expected: Collection[str]) -> Diagnostic:
    label = f"expected {_alternatives(expected)}"
    return error("syntax", f"`{text[:40]}` cannot stand here", span, label)


def unfinished(span: Span, expected: Collection[str]) -> Diagnostic:
    return error("syntax", "the file ends in the middle of a statement", span, f"expected {_alternatives(expected)}")


def _alternatives(expected: Collection[str]) -> str:
    words = [word for token, word in TOKENS.items() if token in expected]
    if {"OPTION", "SEMICOLON"} <= set(expected):
        words = ["a statement", *(word for word in words if word != TOKENS["DOT"])]
    elif "IDENT" in expected:
        words.insert(0, "a name")
    return " or ".join(words) if words else "something else"


def nesting(span: Span, limit: int) -> Diagnostic:
    return error("nesting", f"more than {limit} brackets are open at once", span, "one too many", "Declare the inner types outside.")


unclosed_string = Mistake("syntax", "a string does not end on its line", "starts here", help="Close it; `\\n` stands for a new line.")
unclosed_comment = Mistake("syntax", "a comment does not end", "starts here", help="Close it with `*/`.")


def wrong_number(span: Span, wanted: str) -> Diagnostic:
    return error("number", "this is no such number", span, f"expected {wanted}", "Write 10, 0x0a, 012 or, where it may be one, 1.5e3.")


wrong_escape = Mistake("escape", "nothing is written like this in a string", "not an escape", help="A backslash itself is `\\\\`.")
not_utf8 = Mistake("text", "this is not text in UTF-8", "bytes that are no characters")


def name_too_long(span: Span | None, limit: int) -> Diagnostic:
    return error("name-length", f"a name has more than {limit} characters", span, "too long")


def unknown_syntax(span: Span, value: str) -> Diagnostic:
    return error("syntax-version", f"there is no syntax {value!r}", span, "unknown", 'Use "proto2" or "proto3".')


second_package = Mistake("package", "a file has one package", "a second one")


def missing_file(span: Span | None, path: str) -> Diagnostic:
    return error(
        "missing-file",
        f"there is no file `{path}`",
        span,
        "not found on the search path",
        "Add the folder that the path starts in to the search path.",
    )


def import_cycle(span: Span | None, names: Sequence[str]) -> Diagnostic:
    note = " imports ".join(f"`{name}`" for name in names)
    return error("import-cycle", "a file imports itself", span, "leads back", notes=(note,))


def repeated_import(span: Span | None, path: str) -> Diagnostic:
    return error("repeated-import", f"`{path}` is imported twice", span, "again")


def repeated_file(name: str) -> Diagnostic:
    return error("repeated-file", f"the file `{name}` comes twice", None, "")


def too_many_files(limit: int) -> Diagnostic:
    return error("too-many-files", f"more than {limit} files are imported", None, "")


def bad_descriptor(reason: str) -> Diagnostic:
    return error("descriptor", f"this is no usable file descriptor set: {reason}", None, "")


def unsupported_descriptor(file: str, syntax: str) -> Diagnostic:
    known = "proto2, proto3 and the editions 2023 and 2024 are known"
    return error("edition", f"the file `{file[:100]}` is written in `{syntax[:40]}`; {known}", None, "")
