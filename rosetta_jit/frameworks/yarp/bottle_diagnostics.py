"""What can be wrong in a bottle schema, and in messages that one is drafted from."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from rosetta_jit.catalogue.suggestions import closest
from rosetta_jit.diagnostics import Diagnostic, Mistake, error
from rosetta_jit.frameworks.yarp.limits import MAX_SHOWN

if TYPE_CHECKING:
    from rosetta_jit.source import Span


def _cut(name: str) -> str:
    return name if len(name) <= MAX_SHOWN else f"{name[:MAX_SHOWN]}..."


def _nearest(name: str, known: Iterable[str]) -> str:
    found = closest(name, sorted(known))
    return f"did you mean `{found}`?" if found else ""


unreadable = Mistake("unreadable", "a character that no word can have", "here", help="a vocab is written :|set|")
unclosed_text = Mistake("unclosed-text", "a text does not end", "it starts here", help='close it with `"`')
unclosed_parenthesis = Mistake("unclosed-parenthesis", "a parenthesis is not closed", "opened here", help="add `)`")
stray_parenthesis = Mistake("stray-parenthesis", "nothing is open that this could close", "here", help="remove it")


def nesting_too_deep(span: Span | None, limit: int) -> Diagnostic:
    return error("nesting-too-deep", f"nested deeper than {limit} levels", span, "here", "declare flatter types")


not_a_declaration = Mistake(
    "not-a-declaration",
    "a declaration or an import is expected",
    "not this",
    help='write `"type.name" ( ("field" :int) ... )` or `(:import "path")`',
)


def no_fields(span: Span, name: str) -> Diagnostic:
    return error("no-fields", f'"{_cut(name)}" has no list of fields', span, "of this type", f'write `"{_cut(name)}" ( ... )`')


def import_not_found(span: Span, path: str) -> Diagnostic:
    return error("import-not-found", f'"{_cut(path)}" is nowhere on the search path', span, "imported here")


def invalid_name(span: Span | None, name: str) -> Diagnostic:
    return error(
        "invalid-name",
        f'"{_cut(name)}" cannot be a name',
        span,
        "here",
        "names have letters, digits and _, and start with no digit; those of types are joined by dots; 100 characters at most",
    )


def duplicate(span: Span, what: str, name: str, first: Span | None) -> Diagnostic:
    notes = (f"the first is at {first}",) if first is not None else ()
    return error(f"duplicate-{what}", f'there are two {what}s "{_cut(name)}"', span, "the second", "rename one", notes)


not_a_field = Mistake("not-a-field", "a field is expected", "not this", help='write `("name" TYPE)`')


def no_type(span: Span, name: str) -> Diagnostic:
    return error("no-type", f'the field "{_cut(name)}" has no type', span, "of this field", f'write `("{_cut(name)}" :double)`')


def unknown_type_word(span: Span, word: str, known: Iterable[str]) -> Diagnostic:
    known = sorted(known)
    hint = _nearest(word, known) or f"types are {', '.join(known)}"
    return error("unknown-type", f"`{_cut(word)}` is no type", span, "here", hint)


def unknown_type(span: Span | None, name: str, known: Iterable[str]) -> Diagnostic:
    hint = _nearest(name, known) or "declare it, or import the file that does"
    return error("unknown-type", f'the type "{_cut(name)}" is declared nowhere', span, "used here", hint)


def malformed_type(span: Span, usage: str) -> Diagnostic:
    return error("malformed-type", "a type is written otherwise", span, "this one", f"write `{usage}`")


def vocab_too_long(span: Span, text: str, limit: int) -> Diagnostic:
    return error(
        "vocab-too-long",
        f"a vocab of {limit} bytes cannot be `{_cut(text)}`",
        span,
        f"{len(text.encode())} bytes",
        "shorten it, or use :vocab64 (YARP 4)" if limit == 4 else "shorten it, or use :string",
    )


def wrong_constant(span: Span, expected: str) -> Diagnostic:
    return error("wrong-constant", "a value that the field cannot have", span, f"{expected} is expected")


second_constant = Mistake("second-constant", "a field has one constant", "this is another", help="remove one of them")


def unknown_option(span: Span, word: str, known: Iterable[str]) -> Diagnostic:
    known = sorted(known)
    return error("unknown-option", f"`{_cut(word)}` is no option", span, "here", _nearest(word, known) or f"options are {', '.join(known)}")


def malformed_option(span: Span, usage: str) -> Diagnostic:
    return error("malformed-option", "an option is written otherwise", span, "this one", f"write `{usage}`")


def misplaced_option(span: Span, word: str, where: str) -> Diagnostic:
    return error("misplaced-option", f"`{_cut(word)}` says nothing here", span, "here", f"it belongs to {where}")


def unknown_operator(span: Span, word: str, known: Iterable[str]) -> Diagnostic:
    return error("unknown-operator", f"`{_cut(word)}` computes nothing", span, "here", f"operators are {' '.join(known)}")


malformed_expression = Mistake(
    "malformed-expression",
    "an expression is a number, a field, or an operator with two operands",
    "not this",
    help="write `(* geometry.height 8)`",
)


def unknown_path(span: Span | None, path: str, known: Iterable[str]) -> Diagnostic:
    return error(
        "unknown-path",
        f"the message has no field `{_cut(path)}`",
        span,
        "here",
        _nearest(path.rpartition(".")[2], known) or "paths start at the message: `geometry.width`",
    )


def path_through_list(span: Span | None, path: str) -> Diagnostic:
    return error("path-through-list", f"`{_cut(path)}` leads into a list", span, "here", "only fields outside lists can be used")


def path_not_integer(span: Span | None, path: str) -> Diagnostic:
    return error("path-not-integer", f"`{_cut(path)}` is no integer", span, "here", "compute with :int fields")


def path_not_counted(span: Span | None, path: str) -> Diagnostic:
    return error("path-not-counted", f"`{_cut(path)}` has no length", span, "here", "lists, strings and blobs have one")


computed_in_list = Mistake(
    "computed-in-list",
    "an element of a list cannot be computed from fields",
    "in this element",
    help="paths start at the message and cannot say which element they mean",
)


def computed_cycle(span: Span | None, names: Iterable[str]) -> Diagnostic:
    return error("computed-cycle", "constants that need each other", span, "one of them", "", ("in turn: " + ", ".join(names),))


def too_many_terms(span: Span | None, limit: int) -> Diagnostic:
    return error(
        "too-many-terms", f"a value is computed from more than {limit} terms in all", span, "this one", "compute from plain fields"
    )


def rest_not_last(span: Span | None, name: str) -> Diagnostic:
    return error("rest-not-last", f'nothing can follow "{_cut(name)}", which takes the rest', span, "here", "move it to the end")


def recursive_type(span: Span | None, names: Iterable[str]) -> Diagnostic:
    return error("recursive-type", "a type contains itself", span, "here", "messages have bounded nesting", (" > ".join(names),))


def too_many_fields(span: Span | None, name: str, limit: int) -> Diagnostic:
    return error("too-many-fields", f'"{_cut(name)}" has more than {limit} fields in all', span, "this type", "use lists")


def unlike_messages(number: int, path: str, first: str, second: str) -> Diagnostic:
    return error(
        "unlike-messages",
        f"message {number} is not of the type of those before it",
        None,
        "",
        "draft a schema from messages of one type alone",
        (f"at `{path or '.'}`: {first} and {second}",),
    )


def undescribable_message(number: int, path: str, first: str, second: str) -> Diagnostic:
    return error(
        "undescribable-message",
        f"message {number} has a dict that no schema describes",
        None,
        "",
        "a dict has (key value) elements, with printable keys that differ or values of one type; read this one without a schema",
        (f"at `{path or '.'}`: {first} and {second}",),
    )


def no_messages() -> Diagnostic:
    return error("no-messages", "there is no message to draft a schema from", None, "")


def unknown_dialect(name: str, known: Sequence[str]) -> Diagnostic:
    return error("unknown-dialect", f"there is no dialect `{name}`", None, "", help_=f"there are {', '.join(known)}")


def no_such_tag(span: Span | None, unit: str, dialect: str) -> Diagnostic:
    return error(
        "no-such-tag", f"{dialect} has no {unit}", span, "no tag for this type", "choose a type that the dialect has, or another dialect"
    )


def packed_element(span: Span | None, name: str) -> Diagnostic:
    return error(
        "packed-element",
        f'"{_cut(name)}" is packed and has no code of its own',
        span,
        "in a bottle",
        "put it into `(:blob ...)`, or say the code of its list: `(:code :double)`",
    )


def blob_of_any_size(span: Span | None, name: str) -> Diagnostic:
    return error("blob-of-any-size", f'the content of the blob "{_cut(name)}" has no fixed size', span, "this one", "use numbers alone")


def not_spread(span: Span | None, name: str) -> Diagnostic:
    why = "elements of a :spread list are bottles of plain fields"
    return error("not-spread", f'the elements of "{_cut(name)}" cannot lie in the list around', span, "this one", why)


def misplaced_union(span: Span | None, name: str) -> Diagnostic:
    return error(
        "misplaced-union", f'the union "{_cut(name)}" is not the last field of a bottle', span, "this one", "give it a bottle of its own"
    )


def like_cases(span: Span | None, name: str) -> Diagnostic:
    return error("like-cases", f'two cases of "{_cut(name)}" have one code', span, "in this union", "the code of an element tells its case")
