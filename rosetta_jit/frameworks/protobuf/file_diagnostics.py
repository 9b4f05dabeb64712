"""What can be wrong with a `.proto` file as text and as a file: its signs, its imports, its descriptor."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.frameworks.protobuf.diagnostics import problem

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

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
    """A token where the grammar has none like it."""
    label = f"expected {_alternatives(expected)}"
    return problem("syntax", f"`{text[:40]}` cannot stand here", span, label)


def unfinished(span: Span, expected: Collection[str]) -> Diagnostic:
    """The end of the file within a statement."""
    return problem("syntax", "the file ends in the middle of a statement", span, f"expected {_alternatives(expected)}")


def _alternatives(expected: Collection[str]) -> str:
    words = [word for token, word in TOKENS.items() if token in expected]
    if {"OPTION", "SEMICOLON"} <= set(expected):
        words = ["a statement", *(word for word in words if word != TOKENS["DOT"])]
    elif "IDENT" in expected:
        words.insert(0, "a name")
    return " or ".join(words) if words else "something else"


def nesting(span: Span, limit: int) -> Diagnostic:
    """More brackets open at once than may be."""
    return problem("nesting", f"more than {limit} brackets are open at once", span, "one too many", "Declare the inner types outside.")


def unclosed_string(span: Span) -> Diagnostic:
    """A quotation mark without its partner."""
    return problem("syntax", "a string does not end on its line", span, "starts here", "Close it; `\\n` stands for a new line.")


def unclosed_comment(span: Span) -> Diagnostic:
    """`/*` without `*/`."""
    return problem("syntax", "a comment does not end", span, "starts here", "Close it with `*/`.")


def wrong_number(span: Span, wanted: str) -> Diagnostic:
    """A number that is misspelt, or of the wrong kind for its place."""
    return problem("number", "this is no such number", span, f"expected {wanted}", "Write 10, 0x0a, 012 or, where it may be one, 1.5e3.")


def wrong_escape(span: Span) -> Diagnostic:
    """A backslash with something behind it that means nothing."""
    return problem("escape", "nothing is written like this in a string", span, "not an escape", "A backslash itself is `\\\\`.")


def not_utf8(span: Span) -> Diagnostic:
    """The name of a file, or a reserved name, that is not text."""
    return problem("text", "this is not text in UTF-8", span, "bytes that are no characters")


def name_too_long(span: Span | None, limit: int) -> Diagnostic:
    """A name longer than the limit."""
    return problem("name-length", f"a name has more than {limit} characters", span, "too long")


def unknown_syntax(span: Span, value: str) -> Diagnostic:
    """A version of the language that does not exist."""
    return problem("syntax-version", f"there is no syntax {value!r}", span, "unknown", 'Use "proto2" or "proto3".')


def second_package(span: Span | None) -> Diagnostic:
    """Another `package` in the same file."""
    return problem("package", "a file has one package", span, "a second one")


def missing_file(span: Span | None, path: str) -> Diagnostic:
    """An import that leads nowhere."""
    return problem(
        "missing-file",
        f"there is no file `{path}`",
        span,
        "not found on the search path",
        "Add the folder that the path starts in to the search path.",
    )


def import_cycle(span: Span | None, names: Sequence[str]) -> Diagnostic:
    """An import that leads back to its own file."""
    note = " imports ".join(f"`{name}`" for name in names)
    return Diagnostic("error", "import-cycle", "a file imports itself", span, label="leads back", notes=(note,))


def repeated_import(span: Span | None, path: str) -> Diagnostic:
    """The same import again."""
    return problem("repeated-import", f"`{path}` is imported twice", span, "again")


def repeated_file(name: str) -> Diagnostic:
    """Two files of a descriptor set with one name."""
    return problem("repeated-file", f"the file `{name}` comes twice", None, "")


def too_many_files(limit: int) -> Diagnostic:
    """More files than may be imported."""
    return problem("too-many-files", f"more than {limit} files are imported", None, "")


def bad_descriptor(reason: str) -> Diagnostic:
    """A descriptor that protoc would not have written."""
    return problem("descriptor", f"this is no usable file descriptor set: {reason}", None, "")


def unsupported_descriptor(file: str, syntax: str) -> Diagnostic:
    """A descriptor of a file in a version of the language that is not known."""
    known = "proto2, proto3 and the editions 2023 and 2024 are known"
    return problem("edition", f"the file `{file[:100]}` is written in `{syntax[:40]}`; {known}", None, "")
