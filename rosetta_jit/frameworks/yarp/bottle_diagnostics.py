"""What can be wrong in a bottle schema, and in messages that one is drafted from."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.catalogue.spelling import closest
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.frameworks.yarp.limits import MAX_SHOWN

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from rosetta_jit.source import Span


def _error(code: str, message: str, span: Span | None, label: str, help_: str = "", *notes: str) -> Diagnostic:
    return Diagnostic("error", code, message, span, label, notes, help_)


def _cut(name: str) -> str:
    return name if len(name) <= MAX_SHOWN else f"{name[:MAX_SHOWN]}..."


def _nearest(name: str, known: Iterable[str]) -> str:
    found = closest(name, sorted(known))
    return f"did you mean `{found}`?" if found else ""


def unreadable(span: Span) -> Diagnostic:
    """A stray ``|``, or another character outside the language."""
    return _error("unreadable", "a character that no word can have", span, "here", "a vocab is written :|set|")


def unclosed_text(span: Span) -> Diagnostic:
    """A quotation mark without its partner."""
    return _error("unclosed-text", "a text does not end", span, "it starts here", 'close it with `"`')


def unclosed_parenthesis(span: Span) -> Diagnostic:
    """The innermost parenthesis that the end of the file leaves open."""
    return _error("unclosed-parenthesis", "a parenthesis is not closed", span, "opened here", "add `)`")


def stray_parenthesis(span: Span) -> Diagnostic:
    """A closing parenthesis too many."""
    return _error("stray-parenthesis", "nothing is open that this could close", span, "here", "remove it")


def nesting_too_deep(span: Span | None, limit: int) -> Diagnostic:
    """More levels than a message, or a text, may have."""
    return _error("nesting-too-deep", f"nested deeper than {limit} levels", span, "here", "declare flatter types")


def not_a_declaration(span: Span) -> Diagnostic:
    """Something at the top of a file that is neither a type nor an import."""
    return _error(
        "not-a-declaration",
        "a declaration or an import is expected",
        span,
        "not this",
        'write `"type.name" ( ("field" :int) ... )` or `(:import "path")`',
    )


def no_fields(span: Span, name: str) -> Diagnostic:
    """A type's name alone."""
    return _error("no-fields", f'"{_cut(name)}" has no list of fields', span, "of this type", f'write `"{_cut(name)}" ( ... )`')


def import_not_found(span: Span, path: str) -> Diagnostic:
    """A file that nobody has."""
    return _error("import-not-found", f'"{_cut(path)}" is nowhere on the search path', span, "imported here")


def invalid_name(span: Span | None, name: str) -> Diagnostic:
    """A name that no mapping could write down."""
    return _error(
        "invalid-name",
        f'"{_cut(name)}" cannot be a name',
        span,
        "here",
        "names have letters, digits and _, and start with no digit; those of types are joined by dots; 100 characters at most",
    )


def duplicate(span: Span, what: str, name: str, first: Span | None) -> Diagnostic:
    """A second type, field or option of one name."""
    notes = (f"the first is at {first}",) if first is not None else ()
    return _error(f"duplicate-{what}", f'there are two {what}s "{_cut(name)}"', span, "the second", "rename one", *notes)


def not_a_field(span: Span) -> Diagnostic:
    """Something among fields that is none."""
    return _error("not-a-field", "a field is expected", span, "not this", 'write `("name" TYPE)`')


def no_type(span: Span, name: str) -> Diagnostic:
    """A field's name alone."""
    return _error("no-type", f'the field "{_cut(name)}" has no type', span, "of this field", f'write `("{_cut(name)}" :double)`')


def unknown_type_word(span: Span, word: str, known: Iterable[str]) -> Diagnostic:
    """A type word that the language does not have."""
    known = sorted(known)
    hint = _nearest(word, known) or f"types are {', '.join(known)}"
    return _error("unknown-type", f"`{_cut(word)}` is no type", span, "here", hint)


def unknown_type(span: Span | None, name: str, known: Iterable[str]) -> Diagnostic:
    """A declared type that nobody declares."""
    hint = _nearest(name, known) or "declare it, or import the file that does"
    return _error("unknown-type", f'the type "{_cut(name)}" is declared nowhere', span, "used here", hint)


def malformed_type(span: Span, usage: str) -> Diagnostic:
    """A known type word in a form of another shape."""
    return _error("malformed-type", "a type is written otherwise", span, "this one", f"write `{usage}`")


def vocab_too_long(span: Span, text: str, limit: int) -> Diagnostic:
    """More characters than a vocab's bytes."""
    return _error(
        "vocab-too-long",
        f"a vocab of {limit} bytes cannot be `{_cut(text)}`",
        span,
        f"{len(text.encode())} bytes",
        "shorten it, or use :vocab64 (YARP 4)" if limit == 4 else "shorten it, or use :string",
    )


def wrong_constant(span: Span, expected: str) -> Diagnostic:
    """A constant or default of another type, or out of range."""
    return _error("wrong-constant", "a value that the field cannot have", span, f"{expected} is expected")


def second_constant(span: Span) -> Diagnostic:
    """Two constants that differ."""
    return _error("second-constant", "a field has one constant", span, "this is another", "remove one of them")


def unknown_option(span: Span, word: str, known: Iterable[str]) -> Diagnostic:
    """An option that the language does not have."""
    known = sorted(known)
    return _error(
        "unknown-option", f"`{_cut(word)}` is no option", span, "here", _nearest(word, known) or f"options are {', '.join(known)}"
    )


def malformed_option(span: Span, usage: str) -> Diagnostic:
    """A known option in a form of another shape."""
    return _error("malformed-option", "an option is written otherwise", span, "this one", f"write `{usage}`")


def misplaced_option(span: Span, word: str, where: str) -> Diagnostic:
    """An option of a field that it has no meaning for."""
    return _error("misplaced-option", f"`{_cut(word)}` says nothing here", span, "here", f"it belongs to {where}")


def unknown_operator(span: Span, word: str, known: Iterable[str]) -> Diagnostic:
    """An operator that the language does not have."""
    return _error("unknown-operator", f"`{_cut(word)}` computes nothing", span, "here", f"operators are {' '.join(known)}")


def malformed_expression(span: Span) -> Diagnostic:
    """Something in an expression that is none."""
    return _error(
        "malformed-expression",
        "an expression is a number, a field, or an operator with two operands",
        span,
        "not this",
        "write `(* geometry.height 8)`",
    )


def unknown_path(span: Span | None, path: str, known: Iterable[str]) -> Diagnostic:
    """A computed constant that reads a field that is not there."""
    return _error(
        "unknown-path",
        f"the message has no field `{_cut(path)}`",
        span,
        "here",
        _nearest(path.rpartition(".")[2], known) or "paths start at the message: `geometry.width`",
    )


def path_through_list(span: Span | None, path: str) -> Diagnostic:
    """A path that would need an index."""
    return _error("path-through-list", f"`{_cut(path)}` leads into a list", span, "here", "only fields outside lists can be used")


def path_not_integer(span: Span | None, path: str) -> Diagnostic:
    """A path to something that cannot be computed with."""
    return _error("path-not-integer", f"`{_cut(path)}` is no integer", span, "here", "compute with :int fields")


def path_not_counted(span: Span | None, path: str) -> Diagnostic:
    """The length of something that has none."""
    return _error("path-not-counted", f"`{_cut(path)}` has no length", span, "here", "lists, strings and blobs have one")


def computed_in_list(span: Span | None) -> Diagnostic:
    """A computed constant within the elements of a list."""
    return _error(
        "computed-in-list",
        "an element of a list cannot be computed from fields",
        span,
        "in this element",
        "paths start at the message and cannot say which element they mean",
    )


def computed_cycle(span: Span | None, names: Iterable[str]) -> Diagnostic:
    """Computed constants of which none can be computed first."""
    return _error("computed-cycle", "constants that need each other", span, "one of them", "", "in turn: " + ", ".join(names))


def too_many_terms(span: Span | None, limit: int) -> Diagnostic:
    """A computed value that unfolds to a huge expression."""
    return _error(
        "too-many-terms", f"a value is computed from more than {limit} terms in all", span, "this one", "compute from plain fields"
    )


def rest_not_last(span: Span | None, name: str) -> Diagnostic:
    """A field after one that takes all remaining elements."""
    return _error("rest-not-last", f'nothing can follow "{_cut(name)}", which takes the rest', span, "here", "move it to the end")


def recursive_type(span: Span | None, names: Iterable[str]) -> Diagnostic:
    """A type that would need unbounded nesting."""
    return _error("recursive-type", "a type contains itself", span, "here", "messages have bounded nesting", " > ".join(names))


def too_many_fields(span: Span | None, name: str, limit: int) -> Diagnostic:
    """Declarations that multiply one another."""
    return _error("too-many-fields", f'"{_cut(name)}" has more than {limit} fields in all', span, "this type", "use lists")


def unlike_messages(number: int, path: str, first: str, second: str) -> Diagnostic:
    """Captured messages that no one schema describes."""
    return _error(
        "unlike-messages",
        f"message {number} is not of the type of those before it",
        None,
        "",
        "draft a schema from messages of one type alone",
        f"at `{path or '.'}`: {first} and {second}",
    )


def undescribable_message(number: int, path: str, first: str, second: str) -> Diagnostic:
    """A message with a dict for which the language has no type."""
    return _error(
        "undescribable-message",
        f"message {number} has a dict that no schema describes",
        None,
        "",
        "a dict has (key value) elements, with printable keys that differ or values of one type; read this one without a schema",
        f"at `{path or '.'}`: {first} and {second}",
    )


def no_messages() -> Diagnostic:
    """Nothing to infer from."""
    return _error("no-messages", "there is no message to draft a schema from", None, "")


def unknown_dialect(name: str, known: Sequence[str]) -> Diagnostic:
    """An encoding that bottles do not have."""
    return _error("unknown-dialect", f"there is no dialect `{name}`", None, "", help_=f"there are {', '.join(known)}")


def no_such_tag(span: Span | None, unit: str, dialect: str) -> Diagnostic:
    """A type that came later than the dialect, or went before it."""
    return _error(
        "no-such-tag", f"{dialect} has no {unit}", span, "no tag for this type", "choose a type that the dialect has, or another dialect"
    )


def packed_element(span: Span | None, name: str) -> Diagnostic:
    """A packed struct where every element must say its type."""
    return _error(
        "packed-element",
        f'"{_cut(name)}" is packed and has no code of its own',
        span,
        "in a bottle",
        "put it into `(:blob ...)`, or say the code of its list: `(:code :double)`",
    )


def blob_of_any_size(span: Span | None, name: str) -> Diagnostic:
    """A typed blob with strings or lists in it."""
    return _error("blob-of-any-size", f'the content of the blob "{_cut(name)}" has no fixed size', span, "this one", "use numbers alone")


def not_spread(span: Span | None, name: str) -> Diagnostic:
    """A list marked `:spread` whose elements are no plain structs."""
    why = "elements of a :spread list are bottles of plain fields"
    return _error("not-spread", f'the elements of "{_cut(name)}" cannot lie in the list around', span, "this one", why)


def misplaced_union(span: Span | None, name: str) -> Diagnostic:
    """A union whose case would decide about what follows it."""
    return _error(
        "misplaced-union", f'the union "{_cut(name)}" is not the last field of a bottle', span, "this one", "give it a bottle of its own"
    )


def like_cases(span: Span | None, name: str) -> Diagnostic:
    """Cases of a union that the wire cannot tell apart."""
    return _error(
        "like-cases", f'two cases of "{_cut(name)}" have one code', span, "in this union", "the code of an element tells its case"
    )
