"""What can be wrong in a file of OMG IDL, and what CDR cannot carry."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.diagnostics import Diagnostic

if TYPE_CHECKING:
    from rosetta_jit.source import Span


def _error(code: str, message: str, span: Span | None, label: str, help_: str = "", *notes: str) -> Diagnostic:
    return Diagnostic("error", code, message, span, label=label, notes=notes, help=help_)


def _short(text: str) -> str:
    return text if len(text) <= 40 else f"{text[:40]}..."


def _a(noun: str) -> str:
    return f"{'an' if noun[0] in 'aeiou' else 'a'} {noun}"


# The preprocessor


def unknown_directive(span: Span, word: str) -> Diagnostic:
    """`#` with a word behind it that means nothing."""
    return _error("directive", f"there is no directive `#{_short(word)}`", span, "unknown")


def macro_parameters(span: Span, name: str) -> Diagnostic:
    """`#define F(x) ...`."""
    return _error("macro", f"the macro `{_short(name)}` has parameters", span, "not supported", "Write out what it stands for.")


def expansion(span: Span, limit: int) -> Diagnostic:
    """Macros that become more and more macros."""
    return _error("macro", f"the macros of this file become more than {limit} tokens", span, "expands on and on")


def user_error(span: Span) -> Diagnostic:
    """`#error`."""
    return _error("error-directive", "the file refuses to be read", span, "says so itself")


def missing_file(span: Span, path: str) -> Diagnostic:
    """An `#include` that leads nowhere."""
    return _error(
        "missing-file",
        f"there is no file `{_short(path)}`",
        span,
        "not found on the search path",
        "Add the folder that the path starts in to the search path.",
    )


def too_many_files(span: Span, limit: int) -> Diagnostic:
    """More files than may be included."""
    return _error("too-many-files", f"more than {limit} files are included", span, "one too many")


def open_condition(span: Span) -> Diagnostic:
    """`#if` without `#endif`."""
    return _error("condition", "a conditional does not end", span, "starts here", "Close it with `#endif`.")


def no_condition(span: Span, word: str) -> Diagnostic:
    """`#else` without `#if`."""
    return _error("condition", f"`#{word}` belongs to no `#if`", span, "nothing is open here")


def after_else(span: Span, word: str) -> Diagnostic:
    """`#else` or `#elif` behind `#else`."""
    return _error("condition", f"`#{word}` stands behind `#else`", span, "the conditional had its last part")


# Tokens


def unclosed_string(span: Span) -> Diagnostic:
    """A quotation mark without its partner."""
    return _error("syntax", "a string or character does not end on its line", span, "starts here")


def unclosed_comment(span: Span) -> Diagnostic:
    """`/*` without `*/`."""
    from rosetta_jit.source import Span as Place

    return _error("syntax", "a comment does not end", Place(span.source, span.start, span.start + 2), "starts here", "Close it with `*/`.")


def stray(span: Span, text: str) -> Diagnostic:
    """A character that no token has."""
    return _error("syntax", f"`{text}` is no character of IDL", span, "cannot stand here")


def unexpected(span: Span, text: str, wanted: str) -> Diagnostic:
    """A token where the grammar has none like it."""
    return _error("syntax", f"`{_short(text)}` cannot stand here", span, f"expected {wanted}")


def unfinished(span: Span, wanted: str) -> Diagnostic:
    """The end of the file within a statement."""
    return _error("syntax", "the file ends in the middle of a declaration", span, f"expected {wanted}")


def end_of_line(span: Span, wanted: str) -> Diagnostic:
    """The end of the line within a condition."""
    return _error("syntax", "the line ends in the middle of a condition", span, f"expected {wanted}")


def nesting(span: Span, limit: int, what: str) -> Diagnostic:
    """More than may stand within one another."""
    return _error("nesting", f"more than {limit} {what} stand within one another", span, "one too many")


def keyword(span: Span, text: str, word: str) -> Diagnostic:
    """A name that is a keyword, in whatever case."""
    label = "a keyword" if text == word else f"differs from the keyword `{word}` in case alone"
    return _error("keyword", f"nothing can be called `{text}`", span, label, f"Write `_{text}`: that names `{text}`.")


def wrong_literal(span: Span, why: str) -> Diagnostic:
    """A number, a character or a string that is misspelt."""
    return _error("literal", f"this is no literal: {why}", span, "cannot be read")


# Names


def name_too_long(span: Span, limit: int) -> Diagnostic:
    """A qualified name longer than the limit."""
    return _error("name-length", f"a name has more than {limit} characters", span, "too long")


def repeated_name(span: Span, full: str, kind: str, name: str, other: str, first: Span) -> Diagnostic:
    """Two declarations in a scope with one name."""
    alike = "" if full.rpartition("::")[2] == name else "Names that differ in case alone are the same."
    return _error(
        "repeated-name", f"`{full}` has two meanings", span, f"the second one, {_a(kind)}", alike, f"the {other} `{name}` is at {first}"
    )


def name_of_scope(span: Span, name: str, scope: str) -> Diagnostic:
    """A declaration with the name of the scope that it stands in."""
    return _error("repeated-name", f"`{name}` is the name of the scope around it", span, f"stands in `{scope}`")


def used_before(span: Span, name: str, other: str, used: Span) -> Diagnostic:
    """A declaration whose name meant something else in its scope before."""
    return _error(
        "used-name",
        f"`{name}` means `{other}` here already",
        span,
        "cannot get a second meaning",
        "Choose another name; those that differ in case alone are the same.",
        f"it is used at {used}",
    )


def unknown_name(span: Span, name: str, why: str) -> Diagnostic:
    """A name that is declared nowhere."""
    return _error(
        "unknown-name", f"there is no `{_short(name)}`", span, "unknown", why[:1].upper() + why[1:] + "." if why[0] != "`" else why + "."
    )


def other_case(span: Span, part: str, name: str, first: Span) -> Diagnostic:
    """A name that is declared in another case."""
    return _error("case", f"`{part}` is declared as `{name}`", span, "differs in case", f"Write `{name}`.", f"`{name}` is at {first}")


def wrong_kind(span: Span, full: str, kind: str, wanted: str) -> Diagnostic:
    """A name of something else than what is wanted."""
    return _error("wrong-kind", f"`{full}` is no {wanted}", span, f"this is {_a(kind)}")


def incomplete(span: Span, full: str, state: str) -> Diagnostic:
    """A struct or union that is used before all of it is known."""
    label = "within itself" if state == "open" else "declared, and not defined yet"
    return _error("incomplete", f"`{full}` is not known in full here", span, label, f"`sequence<{full}>` can be used already.")


def never_defined(span: Span, full: str) -> Diagnostic:
    """A struct or union that is declared ahead and never defined."""
    return _error("incomplete", f"`{full}` is declared and never defined", span, "has no members anywhere")


# Constants


def wrong_value(span: Span, wanted: str, got: str) -> Diagnostic:
    """A value of another kind than its type."""
    help_ = "Write it with a decimal point." if wanted in ("float", "double") and "integer" in got else ""
    return _error("value", f"{got} is no value of `{wanted}`", span, f"expected one of `{wanted}`", help_)


def out_of_range(span: Span, value: str, wanted: str) -> Diagnostic:
    """A number that its type cannot hold."""
    return _error("range", f"{value} does not fit into `{wanted}`", span, "out of range")


def too_long(span: Span, length: int, maximum: int) -> Diagnostic:
    """A string longer than its type allows."""
    return _error("range", f"the string has {length} characters", span, f"its type allows {maximum}")


def wrong_operand(span: Span, operator: str, got: str) -> Diagnostic:
    """An operator on values that it is not for."""
    return _error("operator", f"`{operator}` is not for {got}", span, "cannot be computed")


def division_by_zero(span: Span) -> Diagnostic:
    """`/ 0` or `% 0`."""
    return _error("operator", "nothing can be divided by zero", span, "is zero")


def shift(span: Span) -> Diagnostic:
    """A shift by less than 0 or more than 63 bits."""
    return _error("operator", "a shift goes over 0 to 63 bits", span, "too far")


def no_constant_type(span: Span) -> Diagnostic:
    """A constant of a type that has no constants."""
    return _error("value", "a constant cannot have this type", span, "expected a number, character, string, boolean or enum")


# Declarations


def bound(span: Span, value: int) -> Diagnostic:
    """The bound or dimension of an array, string or sequence that is not positive, or too large."""
    return _error("bound", f"{value} is no number of elements", span, "expected 1 to 4294967295")


def map_key(span: Span, word: str) -> Diagnostic:
    """Keys of a map that cannot be compared."""
    return _error("map", f"a map cannot have `{word}` as keys", span, "expected an integer, a string, a boolean or an enum")


def union_switch(span: Span, word: str) -> Diagnostic:
    """A union that is switched by something that is no ordinal."""
    return _error("union", f"a union cannot be switched by `{word}`", span, "expected an integer, a character, a boolean or an enum")


def repeated_label(span: Span, first: Span) -> Diagnostic:
    """Two cases with one label."""
    return _error("union", "two cases have the same label", span, "again", "", f"the first one is at {first}")


def needless_default(span: Span) -> Diagnostic:
    """`default` where every value has a case."""
    return _error("union", "every value has a case already", span, "can never be chosen", "Remove the default.")


def unsupported(span: Span | None, full: str, what: str) -> Diagnostic:
    """A declaration that needs something for which there is no model."""
    return _error("unsupported", f"`{full}` cannot be represented: it needs `{what}`", span, "not supported")


def too_many_members(span: Span, limit: int) -> Diagnostic:
    """Structs that inherit more members than may be."""
    return _error("inheritance", f"the structs of this file inherit more than {limit} members", span, "one struct too many")


# Annotations


def annotation(span: Span, name: str, why: str) -> Diagnostic:
    """An annotation that cannot mean anything."""
    return _error("annotation", f"`@{name}` {why}", span, "cannot be used like this")


def repeated_id(span: Span, number: int, first: str) -> Diagnostic:
    """Two members with one id."""
    return _error("member-id", f"two members have the id {number}", span, f"taken by `{first}`", "Choose one with `@id`.")


def repeated_ordinal(span: Span, number: int, first: str) -> Diagnostic:
    """Two enumerators with one value."""
    return _error("enum", f"two enumerators have the value {number}", span, f"taken by `{first}`")


def no_optionals(span: Span | None, name: str) -> Diagnostic:
    """An optional member in CORBA."""
    return Diagnostic("error", "optional-member", f"`{name}` is optional, which CORBA has no bytes for", span, help='choose encoding="cdr"')


def no_mutables(span: Span | None, name: str) -> Diagnostic:
    """A mutable struct in CORBA."""
    return Diagnostic("error", "mutable-struct", f"`{name}` is mutable, which CORBA has no bytes for", span, help='choose encoding="cdr"')


def recursive_parameter(span: Span | None, name: str) -> Diagnostic:
    """A recursive struct in an optional member in XCDR1, or in a member of a mutable struct."""
    what = f"`{name}` is recursive and has an id and a length before it, which rosetta_jit does not write"
    help_ = "make it a sequence in a struct that is not mutable"
    return Diagnostic("error", "recursive-parameter", what, span, help=help_)


def deep_recursion(span: Span | None, name: str, most: int) -> Diagnostic:
    """A recursive struct in structs that have their sizes before them, within another."""
    what = f"`{name}` has more than {most} sizes around a recursive struct, which cdr2 does not carry"
    return Diagnostic("error", "deep-recursion", what, span, help="make the structs between them final")


def nested_recursion(span: Span | None, name: str) -> Diagnostic:
    """A recursive struct within the elements of an array, which are something else."""
    what = f"the elements of `{name}` contain a recursive struct, and are not recursive themselves"
    return Diagnostic("error", "nested-recursion", what, span, help="make the recursive struct itself the element")


def no_such_scalar(span: Span | None, name: str) -> Diagnostic:
    """A type that CDR has no bytes for."""
    return Diagnostic("error", "no-encoding", f"CDR has no bytes for `{name}`", span)
