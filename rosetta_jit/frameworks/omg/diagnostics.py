"""What can be wrong in a file of OMG IDL, and what CDR cannot carry."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.diagnostics import Diagnostic, Mistake, error

if TYPE_CHECKING:
    from rosetta_jit.source import Span


def _short(text: str) -> str:
    return text if len(text) <= 40 else f"{text[:40]}..."


def _a(noun: str) -> str:
    return f"{'an' if noun[0] in 'aeiou' else 'a'} {noun}"


# The preprocessor


def unknown_directive(span: Span, word: str) -> Diagnostic:
    return error("directive", f"there is no directive `#{_short(word)}`", span, "unknown")


def macro_parameters(span: Span, name: str) -> Diagnostic:
    return error("macro", f"the macro `{_short(name)}` has parameters", span, "not supported", "Write out what it stands for.")


def expansion(span: Span, limit: int) -> Diagnostic:
    return error("macro", f"the macros of this file become more than {limit} tokens", span, "expands on and on")


user_error = Mistake("error-directive", "the file refuses to be read", "says so itself")


def missing_file(span: Span, path: str) -> Diagnostic:
    return error(
        "missing-file",
        f"there is no file `{_short(path)}`",
        span,
        "not found on the search path",
        "Add the folder that the path starts in to the search path.",
    )


def too_many_files(span: Span, limit: int) -> Diagnostic:
    return error("too-many-files", f"more than {limit} files are included", span, "one too many")


open_condition = Mistake("condition", "a conditional does not end", "starts here", help="Close it with `#endif`.")


def no_condition(span: Span, word: str) -> Diagnostic:
    return error("condition", f"`#{word}` belongs to no `#if`", span, "nothing is open here")


def after_else(span: Span, word: str) -> Diagnostic:
    return error("condition", f"`#{word}` stands behind `#else`", span, "the conditional had its last part")


# Tokens


unclosed_string = Mistake("syntax", "a string or character does not end on its line", "starts here")


def unclosed_comment(span: Span) -> Diagnostic:
    from rosetta_jit.source import Span as Place

    return error("syntax", "a comment does not end", Place(span.source, span.start, span.start + 2), "starts here", "Close it with `*/`.")


def stray(span: Span, text: str) -> Diagnostic:
    return error("syntax", f"`{text}` is no character of IDL", span, "cannot stand here")


def unexpected(span: Span, text: str, wanted: str) -> Diagnostic:
    return error("syntax", f"`{_short(text)}` cannot stand here", span, f"expected {wanted}")


def unfinished(span: Span, wanted: str) -> Diagnostic:
    return error("syntax", "the file ends in the middle of a declaration", span, f"expected {wanted}")


def end_of_line(span: Span, wanted: str) -> Diagnostic:
    return error("syntax", "the line ends in the middle of a condition", span, f"expected {wanted}")


def nesting(span: Span, limit: int, what: str) -> Diagnostic:
    return error("nesting", f"more than {limit} {what} stand within one another", span, "one too many")


def keyword(span: Span, text: str, word: str) -> Diagnostic:
    label = "a keyword" if text == word else f"differs from the keyword `{word}` in case alone"
    return error("keyword", f"nothing can be called `{text}`", span, label, f"Write `_{text}`: that names `{text}`.")


def wrong_literal(span: Span, why: str) -> Diagnostic:
    return error("literal", f"this is no literal: {why}", span, "cannot be read")


# Names


def name_too_long(span: Span, limit: int) -> Diagnostic:
    return error("name-length", f"a name has more than {limit} characters", span, "too long")


def repeated_name(span: Span, full: str, kind: str, name: str, other: str, first: Span) -> Diagnostic:
    alike = "" if full.rpartition("::")[2] == name else "Names that differ in case alone are the same."
    return error(
        "repeated-name", f"`{full}` has two meanings", span, f"the second one, {_a(kind)}", alike, (f"the {other} `{name}` is at {first}",)
    )


def name_of_scope(span: Span, name: str, scope: str) -> Diagnostic:
    return error("repeated-name", f"`{name}` is the name of the scope around it", span, f"stands in `{scope}`")


def used_before(span: Span, name: str, other: str, used: Span) -> Diagnostic:
    return error(
        "used-name",
        f"`{name}` means `{other}` here already",
        span,
        "cannot get a second meaning",
        "Choose another name; those that differ in case alone are the same.",
        (f"it is used at {used}",),
    )


def unknown_name(span: Span, name: str, why: str) -> Diagnostic:
    return error(
        "unknown-name", f"there is no `{_short(name)}`", span, "unknown", why[:1].upper() + why[1:] + "." if why[0] != "`" else why + "."
    )


def other_case(span: Span, part: str, name: str, first: Span) -> Diagnostic:
    return error("case", f"`{part}` is declared as `{name}`", span, "differs in case", f"Write `{name}`.", (f"`{name}` is at {first}",))


def wrong_kind(span: Span, full: str, kind: str, wanted: str) -> Diagnostic:
    return error("wrong-kind", f"`{full}` is no {wanted}", span, f"this is {_a(kind)}")


def incomplete(span: Span, full: str, state: str) -> Diagnostic:
    label = "within itself" if state == "open" else "declared, and not defined yet"
    return error("incomplete", f"`{full}` is not known in full here", span, label, f"`sequence<{full}>` can be used already.")


def never_defined(span: Span, full: str) -> Diagnostic:
    return error("incomplete", f"`{full}` is declared and never defined", span, "has no members anywhere")


# Constants


def wrong_value(span: Span, wanted: str, got: str) -> Diagnostic:
    help_ = "Write it with a decimal point." if wanted in ("float", "double") and "integer" in got else ""
    return error("value", f"{got} is no value of `{wanted}`", span, f"expected one of `{wanted}`", help_)


def out_of_range(span: Span, value: str, wanted: str) -> Diagnostic:
    return error("range", f"{value} does not fit into `{wanted}`", span, "out of range")


def too_long(span: Span, length: int, maximum: int) -> Diagnostic:
    return error("range", f"the string has {length} characters", span, f"its type allows {maximum}")


def wrong_operand(span: Span, operator: str, got: str) -> Diagnostic:
    return error("operator", f"`{operator}` is not for {got}", span, "cannot be computed")


division_by_zero = Mistake("operator", "nothing can be divided by zero", "is zero")
shift = Mistake("operator", "a shift goes over 0 to 63 bits", "too far")
no_constant_type = Mistake("value", "a constant cannot have this type", "expected a number, character, string, boolean or enum")


# Declarations


def bound(span: Span, value: int) -> Diagnostic:
    return error("bound", f"{value} is no number of elements", span, "expected 1 to 4294967295")


def map_key(span: Span, word: str) -> Diagnostic:
    return error("map", f"a map cannot have `{word}` as keys", span, "expected an integer, a string, a boolean or an enum")


def union_switch(span: Span, word: str) -> Diagnostic:
    return error("union", f"a union cannot be switched by `{word}`", span, "expected an integer, a character, a boolean or an enum")


def repeated_label(span: Span, first: Span) -> Diagnostic:
    return error("union", "two cases have the same label", span, "again", "", (f"the first one is at {first}",))


needless_default = Mistake("union", "every value has a case already", "can never be chosen", help="Remove the default.")


def unsupported(span: Span | None, full: str, what: str) -> Diagnostic:
    return error("unsupported", f"`{full}` cannot be represented: it needs `{what}`", span, "not supported")


def too_many_members(span: Span, limit: int) -> Diagnostic:
    return error("inheritance", f"the structs of this file inherit more than {limit} members", span, "one struct too many")


# Annotations


def annotation(span: Span, name: str, why: str) -> Diagnostic:
    return error("annotation", f"`@{name}` {why}", span, "cannot be used like this")


def repeated_id(span: Span, number: int, first: str) -> Diagnostic:
    return error("member-id", f"two members have the id {number}", span, f"taken by `{first}`", "Choose one with `@id`.")


def repeated_ordinal(span: Span, number: int, first: str) -> Diagnostic:
    return error("enum", f"two enumerators have the value {number}", span, f"taken by `{first}`")


def no_optionals(span: Span | None, name: str) -> Diagnostic:
    return error("optional-member", f"`{name}` is optional, which CORBA has no bytes for", span, help_='choose encoding="cdr"')


def no_mutables(span: Span | None, name: str) -> Diagnostic:
    return error("mutable-struct", f"`{name}` is mutable, which CORBA has no bytes for", span, help_='choose encoding="cdr"')


def recursive_parameter(span: Span | None, name: str) -> Diagnostic:
    what = f"`{name}` is recursive and has an id and a length before it, which rosetta_jit does not write"
    help_ = "make it a sequence in a struct that is not mutable"
    return error("recursive-parameter", what, span, help_=help_)


def deep_recursion(span: Span | None, name: str, most: int) -> Diagnostic:
    what = f"`{name}` has more than {most} sizes around a recursive struct, which cdr2 does not carry"
    return error("deep-recursion", what, span, help_="make the structs between them final")


def nested_recursion(span: Span | None, name: str) -> Diagnostic:
    what = f"the elements of `{name}` contain a recursive struct, and are not recursive themselves"
    return error("nested-recursion", what, span, help_="make the recursive struct itself the element")


def no_such_scalar(span: Span | None, name: str) -> Diagnostic:
    return error("no-encoding", f"CDR has no bytes for `{name}`", span)
