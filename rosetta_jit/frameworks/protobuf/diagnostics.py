"""What can be wrong in a `.proto` file, and with messages of which one is drafted."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, Protocol

from rosetta_jit.diagnostics import Diagnostic

if TYPE_CHECKING:
    from collections.abc import Collection

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


def problem(code: str, message: str, span: Span | None, label: str, help_: str = "") -> Diagnostic:
    """A mistake at a place."""
    return Diagnostic("error", code, message, span, label=label, help=help_)


def repeated_name(name: Name, full: str, kind: str, first: Span | None) -> Diagnostic:
    """Two declarations with one name."""
    notes = () if first is None else (f"the {kind} `{full}` is at {first}",)
    help_ = "The values of an enum stand beside it: they share their names with its neighbours." if kind == "value" else ""
    return Diagnostic("error", "repeated-name", f"`{full}` has two meanings", name.span, label="a second one", notes=notes, help=help_)


def unknown_name(name: Name, kinds: Collection[str], other: str | None) -> Diagnostic:
    """A name that is declared nowhere."""
    help_ = f"Is `{other}` meant?" if other else "Declare it, or import the file that does."
    return problem("unknown-name", f"there is no {_kinds(kinds)} `{name.text}`", name.span, "unknown", help_)


def hidden_name(name: Name, full: str) -> Diagnostic:
    """A name whose first part means something else in an inner scope."""
    return problem(
        "hidden-name",
        f"`{name.text}` is looked up as `{full}`, and that does not exist",
        name.span,
        "the innermost scope that knows its first part decides",
        f"Write `.{name.text}` to start from the outermost scope.",
    )


def not_imported(name: Name, full: str, file: str) -> Diagnostic:
    """A name that exists, in a file that is not visible."""
    return problem(
        "not-imported", f"`{full}` is declared in a file that is not imported", name.span, "not visible", f'Write `import "{file}";`.'
    )


def wrong_kind(name: Name, full: str, kind: str, kinds: Collection[str]) -> Diagnostic:
    """A name of something else than what is wanted."""
    return problem("wrong-kind", f"`{full}` is no {_kinds(kinds)}", name.span, f"this is a {kind}")


def _kinds(kinds: Collection[str]) -> str:
    return " or ".join(sorted(kinds, reverse=True))


def number_out_of_range(span: Span | None, number: int, limit: int) -> Diagnostic:
    """The number of a field that the wire cannot carry."""
    return problem("number-range", f"no field has the number {number}", span, f"expected 1 to {limit}")


def number_of_protobuf(span: Span | None, number: int) -> Diagnostic:
    """A number from 19000 to 19999."""
    return problem("number-range", f"{number} belongs to protobuf itself", span, "numbers from 19000 to 19999 are taken")


def repeated_number(span: Span | None, number: int, first: Name, full: str) -> Diagnostic:
    """Two fields of a message with one number."""
    return problem("repeated-number", f"`{full}` has two fields with the number {number}", span, f"taken by `{first.text}`")


def reserved_number(span: Span | None, number: int, full: str) -> Diagnostic:
    """A number that the message or enum reserves."""
    return problem("reserved", f"`{full}` reserves the number {number}", span, "reserved")


def reserved_name(name: Name, full: str) -> Diagnostic:
    """A name that the message or enum reserves."""
    return problem("reserved", f"`{full}` reserves the name `{name.text}`", name.span, "reserved")


def reserved_twice(name: Name) -> Diagnostic:
    """A reserved name that stands twice."""
    return problem("reserved", f"the name `{name.text}` is reserved twice", name.span, "again")


def extension_number(span: Span | None, number: int, full: str) -> Diagnostic:
    """A field in an extension range of its own message."""
    return problem("extension-number", f"`{full}` leaves the number {number} to extensions", span, "in an extension range")


def empty_range(span: Span | None, first: int, last: int) -> Diagnostic:
    """A range whose end lies before its start."""
    return problem("range", f"a range from {first} to {last} holds nothing", span, "ends before it starts")


def range_out_of_range(span: Span | None, low: int, high: int) -> Diagnostic:
    """A range with numbers that no field or value can have."""
    return problem("range", "a range has impossible numbers", span, f"expected {low} to {high}")


def overlap(span: Span | None, range_: Range, other: Range) -> Diagnostic:
    """Two ranges that share numbers."""
    message = f"{range_.first} to {range_.last} overlaps with {other.first} to {other.last}"
    return problem("range", message, span, "partly taken by another range")


def missing_label(name: Name) -> Diagnostic:
    """A proto2 field without a label."""
    return problem(
        "label",
        f"the field `{name.text}` has no label",
        name.span,
        "needs one in proto2",
        "Write `optional`, `required` or `repeated` before its type.",
    )


def required_in_proto3(span: Span | None) -> Diagnostic:
    """`required` in proto3."""
    return problem("label", "proto3 has no required fields", span, "not in proto3", "Leave the label out, or write `optional`.")


def label_in_oneof(span: Span | None, label: str) -> Diagnostic:
    """A label on a field of a oneof."""
    return problem("label", f"a field in a oneof cannot be {label}", span, "no label here")


def label_on_map(span: Span | None) -> Diagnostic:
    """A label on a map."""
    return problem("label", "a map has no label", span, "no label here")


def map_in_oneof(span: Span | None) -> Diagnostic:
    """A map in a oneof."""
    return problem("map", "a oneof cannot hold a map", span, "not here", "Put the map in a message of its own.")


def map_extension(span: Span | None) -> Diagnostic:
    """An extension that is a map."""
    return problem("map", "an extension cannot be a map", span, "not here", "Put the map in a message of its own.")


def map_key(key: Name) -> Diagnostic:
    """Keys of a map that cannot be compared by value."""
    text = key.text.removeprefix(".")
    return problem("map", f"a map cannot have `{text}` as keys", key.span, "expected an integer type, `bool` or `string`")


def map_enum(value: Name, enum: str) -> Diagnostic:
    """An enum as the value of a map that has no 0 to start from."""
    return problem("map", f"the first value of the enum `{enum}` is not 0", value.span, "a map needs 0 as a default")


def empty_oneof(name: Name) -> Diagnostic:
    """A oneof without fields."""
    return problem("oneof", f"the oneof `{name.text}` has no fields", name.span, "needs one at least")


def group_in_proto3(name: Name) -> Diagnostic:
    """A group in proto3."""
    return problem("group", "proto3 has no groups", name.span, "not in proto3", "Declare a message and a field of its type.")


def lower_case_group(name: Name) -> Diagnostic:
    """A group whose name does not start with a capital letter."""
    return problem("group", "the name of a group starts with a capital letter", name.span, "it names a message too")


def closed_enum(name: Name, enum: str) -> Diagnostic:
    """A closed enum in a message of proto3."""
    return problem(
        "closed-enum",
        f"a proto3 message cannot hold the closed enum `{enum}`",
        name.span,
        "its enum knows no other values",
        "Declare the enum in a proto3 file, or in an edition.",
    )


def same_json_name(name: Name, first: Name, json: str) -> Diagnostic:
    """Two fields of a message with one name in JSON."""
    message = f"`{name.text}` and `{first.text}` are both `{json[:60]}` in JSON"
    return problem("json-name", message, name.span, "JSON cannot tell them apart", "Choose another name with `json_name`.")


def json_name_of_extension(span: Span | None) -> Diagnostic:
    """An extension that chooses a name in JSON."""
    return problem("json-name", "an extension has no other name in JSON", span, "not here")


def cannot_pack(name: Name) -> Diagnostic:
    """`packed` on a field that is not repeated numbers."""
    return problem("packed", f"`{name.text}` cannot be packed", name.span, "only repeated numbers, bools and enums can")


def default_in_proto3(span: Span | None) -> Diagnostic:
    """A default in proto3."""
    return problem("default", "proto3 has no defaults", span, "not in proto3")


def default_of_many(span: Span | None) -> Diagnostic:
    """A default of a repeated field or a map."""
    return problem("default", "a repeated field has no default", span, "it is empty where it is not set")


def default_of_message(span: Span | None) -> Diagnostic:
    """A default of a message."""
    return problem("default", "a message has no default", span, "its fields have theirs")


def wrong_default(span: Span | None, wanted: str, value: str) -> Diagnostic:
    """A default that its type cannot hold."""
    return problem("default", f"{value[:60]} is no default of this type", span, f"expected {wanted}")


def empty_enum(name: Name) -> Diagnostic:
    """An enum without values."""
    return problem("enum", f"the enum `{name.text}` has no values", name.span, "needs one at least")


def first_not_zero(span: Span | None, number: int) -> Diagnostic:
    """An open enum that does not start with 0."""
    return problem("enum", f"the first value of an open enum is 0, not {number}", span, "must be 0")


def value_out_of_range(span: Span | None, number: int) -> Diagnostic:
    """A value that needs more than 32 bits."""
    return problem("enum", f"{number} does not fit into 32 bits", span, "expected -2147483648 to 2147483647")


def alias(span: Span | None, number: int, first: Name) -> Diagnostic:
    """Two values of an enum with one number."""
    return problem(
        "enum",
        f"two values have the number {number}",
        span,
        f"taken by `{first.text}`",
        "If both are meant, write `option allow_alias = true;`.",
    )


def empty_extend(span: Span) -> Diagnostic:
    """An extend block without fields."""
    return problem("extend", "an extend block has no fields", span, "needs one at least")


def no_extension_number(span: Span | None, number: int, full: str) -> Diagnostic:
    """An extension whose number the message does not leave to extensions."""
    return problem("extension-number", f"`{full}` does not leave the number {number} to extensions", span, "in none of its ranges")


def repeated_extension(span: Span | None, number: int, full: str, first: str) -> Diagnostic:
    """Two extensions of a message with one number."""
    return problem("repeated-number", f"`{full}` has two extensions with the number {number}", span, f"taken by `{first}`")


def required_extension(span: Span | None) -> Diagnostic:
    """An extension that is required."""
    return problem("label", "an extension cannot be required", span, "write `optional`")


def extensions_in_proto3(span: Span | None) -> Diagnostic:
    """An extension range in proto3."""
    return problem("extension-range", "proto3 has no extension ranges", span, "not in proto3")


def extension_in_proto3(extendee: Name) -> Diagnostic:
    """A proto3 extension of something else than options."""
    return problem("extension-range", "proto3 extends options and nothing else", extendee.span, "not an options message")


def message_set_field(name: Name) -> Diagnostic:
    """A field in a MessageSet."""
    return problem("message-set", f"`{name.text}` is a message set and has fields", name.span, "takes extensions alone")


def message_set_item(name: Name) -> Diagnostic:
    """An extension of a MessageSet that is no optional message."""
    return problem("message-set", f"`{name.text}` cannot extend a message set", name.span, "expected an optional message")


def unknown_option(span: Span | None, name: str, holder: str) -> Diagnostic:
    """An option that does not exist where it stands."""
    shown = name.replace("(.", "(")
    help_ = "Import the file that declares it." if "(" in name else "An option of your own is written in parentheses."
    return problem("option", f"`{shown}` is no option here", span, f"unknown to {holder}", help_)


def repeated_option(span: Span | None, name: str) -> Diagnostic:
    """An option that is set twice."""
    return problem("option", f"the option `{name}` is set twice", span, "again")


def wrong_option(span: Span | None, name: str, wanted: str, value: str) -> Diagnostic:
    """The value of an option that its type cannot hold."""
    return problem("option", f"`{name.replace('(.', '(')}` cannot be {value[:60]}", span, f"expected {wanted}")


Kind = Literal["tag", "varint", "truncated"]


def invalid_name(name: str) -> Diagnostic:
    """A name that no message can have."""
    return Diagnostic(
        "error", "invalid-name", f"`{name[:100]}` is no name of a message", help="write words with dots between them: lab.Pose"
    )


def no_messages() -> Diagnostic:
    """Nothing to infer from."""
    return Diagnostic("error", "no-messages", "there is no message to draft a schema from")


def unlike(number: int, field: int, first: str, second: str) -> Diagnostic:
    """A field that messages have with several wire types."""
    message = f"message {number} has field {field} as {second}, where it was {first} before"
    return Diagnostic("error", "unlike-messages", message, help="draft a schema of messages of one type alone")


def too_many_fields(most: int) -> Diagnostic:
    """More fields than any message type has."""
    return Diagnostic("error", "too-many", f"the messages have more than {most} fields", help="are they messages of protobuf?")
