"""What can be wrong in a `.proto` file, and with messages of which one is drafted."""

from __future__ import annotations

from collections.abc import Collection
from typing import TYPE_CHECKING, Literal, Protocol

from rosetta_jit.diagnostics import Diagnostic, Mistake, error

if TYPE_CHECKING:
    from rosetta_jit.source import Span


class Name(Protocol):
    """A name as it was written, and where."""

    @property
    def text(self) -> str: ...
    @property
    def span(self) -> Span | None: ...


class Range(Protocol):
    """Numbers ``first`` to ``last``."""

    @property
    def first(self) -> int: ...
    @property
    def last(self) -> int: ...


def repeated_name(name: Name, full: str, kind: str, first: Span | None) -> Diagnostic:
    notes = () if first is None else (f"the {kind} `{full}` is at {first}",)
    help_ = "The values of an enum stand beside it: they share their names with its neighbours." if kind == "value" else ""
    return error("repeated-name", f"`{full}` has two meanings", name.span, "a second one", help_=help_, notes=notes)


def unknown_name(name: Name, kinds: Collection[str], other: str | None) -> Diagnostic:
    help_ = f"Is `{other}` meant?" if other else "Declare it, or import the file that does."
    return error("unknown-name", f"there is no {_kinds(kinds)} `{name.text}`", name.span, "unknown", help_)


def hidden_name(name: Name, full: str) -> Diagnostic:
    return error(
        "hidden-name",
        f"`{name.text}` is looked up as `{full}`, and that does not exist",
        name.span,
        "the innermost scope that knows its first part decides",
        f"Write `.{name.text}` to start from the outermost scope.",
    )


def not_imported(name: Name, full: str, file: str) -> Diagnostic:
    return error(
        "not-imported", f"`{full}` is declared in a file that is not imported", name.span, "not visible", f'Write `import "{file}";`.'
    )


def wrong_kind(name: Name, full: str, kind: str, kinds: Collection[str]) -> Diagnostic:
    return error("wrong-kind", f"`{full}` is no {_kinds(kinds)}", name.span, f"this is a {kind}")


def _kinds(kinds: Collection[str]) -> str:
    return " or ".join(sorted(kinds, reverse=True))


def number_out_of_range(span: Span | None, number: int, limit: int) -> Diagnostic:
    return error("number-range", f"no field has the number {number}", span, f"expected 1 to {limit}")


def number_of_protobuf(span: Span | None, number: int) -> Diagnostic:
    return error("number-range", f"{number} belongs to protobuf itself", span, "numbers from 19000 to 19999 are taken")


def repeated_number(span: Span | None, number: int, first: Name, full: str) -> Diagnostic:
    return error("repeated-number", f"`{full}` has two fields with the number {number}", span, f"taken by `{first.text}`")


def reserved_number(span: Span | None, number: int, full: str) -> Diagnostic:
    return error("reserved", f"`{full}` reserves the number {number}", span, "reserved")


def reserved_name(name: Name, full: str) -> Diagnostic:
    return error("reserved", f"`{full}` reserves the name `{name.text}`", name.span, "reserved")


def reserved_twice(name: Name) -> Diagnostic:
    return error("reserved", f"the name `{name.text}` is reserved twice", name.span, "again")


def extension_number(span: Span | None, number: int, full: str) -> Diagnostic:
    return error("extension-number", f"`{full}` leaves the number {number} to extensions", span, "in an extension range")


def empty_range(span: Span | None, first: int, last: int) -> Diagnostic:
    return error("range", f"a range from {first} to {last} holds nothing", span, "ends before it starts")


def range_out_of_range(span: Span | None, low: int, high: int) -> Diagnostic:
    return error("range", "a range has impossible numbers", span, f"expected {low} to {high}")


def overlap(span: Span | None, range_: Range, other: Range) -> Diagnostic:
    message = f"{range_.first} to {range_.last} overlaps with {other.first} to {other.last}"
    return error("range", message, span, "partly taken by another range")


def missing_label(name: Name) -> Diagnostic:
    return error(
        "label",
        f"the field `{name.text}` has no label",
        name.span,
        "needs one in proto2",
        "Write `optional`, `required` or `repeated` before its type.",
    )


required_in_proto3 = Mistake("label", "proto3 has no required fields", "not in proto3", help="Leave the label out, or write `optional`.")


def label_in_oneof(span: Span | None, label: str) -> Diagnostic:
    return error("label", f"a field in a oneof cannot be {label}", span, "no label here")


label_on_map = Mistake("label", "a map has no label", "no label here")
map_in_oneof = Mistake("map", "a oneof cannot hold a map", "not here", help="Put the map in a message of its own.")
map_extension = Mistake("map", "an extension cannot be a map", "not here", help="Put the map in a message of its own.")


def map_key(key: Name) -> Diagnostic:
    text = key.text.removeprefix(".")
    return error("map", f"a map cannot have `{text}` as keys", key.span, "expected an integer type, `bool` or `string`")


def map_enum(value: Name, enum: str) -> Diagnostic:
    return error("map", f"the first value of the enum `{enum}` is not 0", value.span, "a map needs 0 as a default")


def empty_oneof(name: Name) -> Diagnostic:
    return error("oneof", f"the oneof `{name.text}` has no fields", name.span, "needs one at least")


def group_in_proto3(name: Name) -> Diagnostic:
    return error("group", "proto3 has no groups", name.span, "not in proto3", "Declare a message and a field of its type.")


def lower_case_group(name: Name) -> Diagnostic:
    return error("group", "the name of a group starts with a capital letter", name.span, "it names a message too")


def closed_enum(name: Name, enum: str) -> Diagnostic:
    return error(
        "closed-enum",
        f"a proto3 message cannot hold the closed enum `{enum}`",
        name.span,
        "its enum knows no other values",
        "Declare the enum in a proto3 file, or in an edition.",
    )


def same_json_name(name: Name, first: Name, json: str) -> Diagnostic:
    message = f"`{name.text}` and `{first.text}` are both `{json[:60]}` in JSON"
    return error("json-name", message, name.span, "JSON cannot tell them apart", "Choose another name with `json_name`.")


json_name_of_extension = Mistake("json-name", "an extension has no other name in JSON", "not here")


def cannot_pack(name: Name) -> Diagnostic:
    return error("packed", f"`{name.text}` cannot be packed", name.span, "only repeated numbers, bools and enums can")


default_in_proto3 = Mistake("default", "proto3 has no defaults", "not in proto3")
default_of_many = Mistake("default", "a repeated field has no default", "it is empty where it is not set")
default_of_message = Mistake("default", "a message has no default", "its fields have theirs")


def wrong_default(span: Span | None, wanted: str, value: str) -> Diagnostic:
    return error("default", f"{value[:60]} is no default of this type", span, f"expected {wanted}")


def empty_enum(name: Name) -> Diagnostic:
    return error("enum", f"the enum `{name.text}` has no values", name.span, "needs one at least")


def first_not_zero(span: Span | None, number: int) -> Diagnostic:
    return error("enum", f"the first value of an open enum is 0, not {number}", span, "must be 0")


def value_out_of_range(span: Span | None, number: int) -> Diagnostic:
    return error("enum", f"{number} does not fit into 32 bits", span, "expected -2147483648 to 2147483647")


def alias(span: Span | None, number: int, first: Name) -> Diagnostic:
    return error(
        "enum",
        f"two values have the number {number}",
        span,
        f"taken by `{first.text}`",
        "If both are meant, write `option allow_alias = true;`.",
    )


empty_extend = Mistake("extend", "an extend block has no fields", "needs one at least")


def no_extension_number(span: Span | None, number: int, full: str) -> Diagnostic:
    return error("extension-number", f"`{full}` does not leave the number {number} to extensions", span, "in none of its ranges")


def repeated_extension(span: Span | None, number: int, full: str, first: str) -> Diagnostic:
    return error("repeated-number", f"`{full}` has two extensions with the number {number}", span, f"taken by `{first}`")


required_extension = Mistake("label", "an extension cannot be required", "write `optional`")
extensions_in_proto3 = Mistake("extension-range", "proto3 has no extension ranges", "not in proto3")


def extension_in_proto3(extendee: Name) -> Diagnostic:
    return error("extension-range", "proto3 extends options and nothing else", extendee.span, "not an options message")


def message_set_field(name: Name) -> Diagnostic:
    return error("message-set", f"`{name.text}` is a message set and has fields", name.span, "takes extensions alone")


def message_set_item(name: Name) -> Diagnostic:
    return error("message-set", f"`{name.text}` cannot extend a message set", name.span, "expected an optional message")


def unknown_option(span: Span | None, name: str, holder: str) -> Diagnostic:
    shown = name.replace("(.", "(")
    help_ = "Import the file that declares it." if "(" in name else "An option of your own is written in parentheses."
    return error("option", f"`{shown}` is no option here", span, f"unknown to {holder}", help_)


def repeated_option(span: Span | None, name: str) -> Diagnostic:
    return error("option", f"the option `{name}` is set twice", span, "again")


def wrong_option(span: Span | None, name: str, wanted: str, value: str) -> Diagnostic:
    return error("option", f"`{name.replace('(.', '(')}` cannot be {value[:60]}", span, f"expected {wanted}")


Kind = Literal["tag", "varint", "truncated"]


def invalid_name(name: str) -> Diagnostic:
    return error("invalid-name", f"`{name[:100]}` is no name of a message", help_="write words with dots between them: lab.Pose")


def no_messages() -> Diagnostic:
    return error("no-messages", "there is no message to draft a schema from", None)


def unlike(number: int, field: int, first: str, second: str) -> Diagnostic:
    message = f"message {number} has field {field} as {second}, where it was {first} before"
    return error("unlike-messages", message, help_="draft a schema of messages of one type alone")


def too_many_fields(most: int) -> Diagnostic:
    return error("too-many", f"the messages have more than {most} fields", help_="are they messages of protobuf?")
