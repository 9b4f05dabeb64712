"""What can be wrong in a C++ header or a typelib registry, and what OROCOS cannot write."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.diagnostics import Diagnostic, Mistake, error

if TYPE_CHECKING:
    from rosetta_jit.source import Span

REFUSED = {
    "pointer": ("a pointer means nothing to another process", "Use std::vector, std::array or the object itself."),
    "reference": ("a reference means nothing to another process", "Hold the object itself."),
    "flexible": ("an array without a length has no place in a message", "Use std::vector."),
    "union": ("nothing tells which member of a union is set", "Use a struct of all of them, and an enum."),
    "template": ("of templates only std::vector, std::array and std::string are known", "Write the struct out."),
    "wide": ("text of wide characters is not supported", "Use std::string."),
    "incomplete": ("the type is declared but not defined", "Include the header that defines it."),
    "nesting": ("the type is written too deep inside others", "Declare the inner types by name."),
    "unnamed": ("the type has no name", "Give the type or its member a name."),
    "other": ("no message can carry this type", "Use bool, char, an integer of at most 64 bits, float or double."),
}
"""Why a type is refused, and what helps."""


no_libclang = Mistake("libclang", "C++ headers are read by libclang, which is not installed", help="Install `rosetta-jit[orocos]`.")


def compile_error(span: Span, text: str) -> Diagnostic:
    return error("c++", "this is no C++ that can be read", span, text[:200])


def missing_file(span: Span, path: str) -> Diagnostic:
    return error(
        "missing-file",
        f"there is no file `{path[:80]}`",
        span,
        "not found on the search path",
        "Add the folder that the path starts in to the search path; of the standard library only data types are known.",
    )


def too_many_files(span: Span, files: int, characters: int) -> Diagnostic:
    return error("too-many-files", f"a header may include {files} files of {characters} characters together", span, "too much")


too_much_work = Mistake("limit", "this header takes the compiler too much time or memory", "reading it was given up")


def refused_type(span: Span, member: str, reason: str, word: str) -> Diagnostic:
    why, help_ = REFUSED[reason]
    label = f"`{word[:60]}`" if word else "of such a type"
    return error(reason, f"`{member}` cannot be part of a message: {why}", span, label, help_)


def bit_field(span: Span, member: str) -> Diagnostic:
    return error("bit-field", f"`{member}` is a bit field", span, "not a number of whole bytes", "Use an integer.")


def hidden_member(span: Span, member: str) -> Diagnostic:
    return error("private", f"`{member}` is private, so no other type can stand for it", span, "not public", "Make it public.")


def unnamed_member(span: Span, record: str) -> Diagnostic:
    return error("unnamed", f"a member of `{record}` has no name", span, "needs one")


def repeated_member(span: Span, record: str, member: str) -> Diagnostic:
    return error("repeated-member", f"`{record}` has two members `{member}`", span, "a second one", "Members of bases count as its own.")


def virtual_class(span: Span, record: str) -> Diagnostic:
    return error("virtual", f"`{record}` is no plain data: it has virtual functions or bases", span, "holds hidden pointers")


def unusable_base(span: Span, record: str) -> Diagnostic:
    return error("base", f"the base of `{record}` cannot be part of a message", span, "expected a public struct")


def repeated_name(span: Span | None, name: str) -> Diagnostic:
    return error("repeated-name", f"`{name}` is declared twice", span, "a second one")


def large_enumerator(span: Span, name: str) -> Diagnostic:
    return error("enum", f"`{name}` needs more than 32 bits, signed", span, "too large", "Use an integer and constants.")


def empty_array(span: Span, member: str) -> Diagnostic:
    return error("empty-array", f"`{member}` is an array of no elements", span, "needs one at least")


def too_large(span: Span | None, name: str, limit: int) -> Diagnostic:
    return error("size", f"`{name}` takes more than {limit} bytes", span, "too large")


def strange_layout(span: Span | None, name: str) -> Diagnostic:
    return error("layout", f"the bytes of `{name}` are not where they can be", span, "overlaps, or leaves a large gap")


def nested_too_deep(span: Span | None, name: str, limit: int) -> Diagnostic:
    return error("nesting", f"`{name}` has structs inside each other more than {limit} deep", span, "too deep")


def contains_itself(span: Span | None, name: str) -> Diagnostic:
    return error("recursion", f"`{name}` is part of itself", span, "would have no end", "Put a std::vector between.")


def not_xml(span: Span, why: str) -> Diagnostic:
    return error("xml", "this is no well-formed XML", span, why)


document_type = Mistake("doctype", "a registry has no document type", "not allowed", help="Remove it; entities cannot be declared.")


def unexpected_element(span: Span, element: str, expected: str) -> Diagnostic:
    return error("element", f"`<{element[:40]}>` cannot stand here", span, f"expected {expected}")


def missing_attribute(span: Span, element: str, attribute: str) -> Diagnostic:
    return error("attribute", f"`<{element}>` has no `{attribute}`", span, f"expected {attribute}=")


def wrong_attribute(span: Span, value: str, expected: str) -> Diagnostic:
    return error("attribute", f"`{value[:60]}` cannot stand here", span, f"expected {expected}")


def unknown_type(span: Span, name: str) -> Diagnostic:
    return error("unknown-type", f"there is no type `{name[:80]}`", span, "not declared in this file")


def unusable_type(span: Span, name: str, kind: str) -> Diagnostic:
    return error("unusable-type", f"`{name[:80]}` is of a kind that has no values: {kind}", span, "cannot be part of a message")


def foreign_container(span: Span, name: str, size: int, expected: int) -> Diagnostic:
    return error("platform", f"`{name[:80]}` takes {size} bytes", span, f"takes {expected} on x86-64", "Export the registry there.")


def not_plain_memory(span: Span | None, member: str) -> Diagnostic:
    return error(
        "container",
        f"`{member}` lies elsewhere: the memory of the struct holds a pointer to it",
        span,
        "of variable length",
        "Use the encoding `rtt-mqueue` or `typelib`.",
    )


def not_in_typelib(span: Span | None, member: str, what: str) -> Diagnostic:
    return error("typelib", f"typelib cannot write `{member}`", span, what, "Use the encoding `rtt-mqueue`.")


def unfolds(span: Span | None, name: str, limit: int) -> Diagnostic:
    return error("size", f"`{name}` unfolds to more than {limit} fields", span, "too large")
