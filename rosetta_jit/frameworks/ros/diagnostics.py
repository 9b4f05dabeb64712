"""What can be wrong in a `.msg` file, or in the concatenated definitions of a bag."""

from __future__ import annotations

from collections.abc import Sequence

from rosetta_jit.catalogue.suggestions import closest
from rosetta_jit.diagnostics import Diagnostic, Mistake, error
from rosetta_jit.source import Span

SHOWN = 80
"""Characters of a word of the file that a report repeats."""

MEANT = {
    "int": "int32",
    "long": "int64",
    "float": "float32",
    "double": "float64",
    "boolean": "bool",
    "str": "string",
    "bytes": "uint8[]",
    "time": "builtin_interfaces/Time",
    "duration": "builtin_interfaces/Duration",
    "Header": "std_msgs/Header",
}
"""Words of other languages, and the nearest one of these."""


def _short(text: str) -> str:
    return text if len(text) <= SHOWN else f"{text[:SHOWN]}…"


not_a_declaration = Mistake("declaration", "this line declares nothing", "has no name", help="Write `type name` or `type NAME=value`.")
too_much = Mistake("declaration", "a field is a type and a name", "too much", help="A comment begins with `#`; ROS 1 has no defaults.")
tab = Mistake("blank", "ROS 1 does not see a tab as the end of a type", "has no space", help="Put a space there.")
indented = Mistake("blank", "a declaration of ROS 2 begins with its line", "is indented", help="Remove the blanks before it.")


def not_a_type(span: Span, text: str) -> Diagnostic:
    help_ = "Write `type`, `type[]` or `type[3]`, in ROS 2 also `string<=3` and `type[<=3]`."
    return error("type", f"`{_short(text)}` is not a type", span, "malformed", help_)


def not_a_type_name(span: Span, text: str, package: str, message: str) -> Diagnostic:
    notes = (f"a package's name is {package}", f"a message's name is {message}")
    near = MEANT.get(text) or (text.replace("/msg/", "/") if text.count("/") == 2 and "/msg/" in text else "")
    help_ = f"Did you mean `{_short(near)}`?" if near else ""
    return error("type", f"`{_short(text)}` is no name of a type", span, "malformed", help_, notes)


def not_a_length(span: Span, least: int) -> Diagnostic:
    return error("length", "a length or bound is a plain number", span, f"expected one from {least} to 4294967295")


def not_a_name(span: Span, text: str, what: str, rule: str) -> Diagnostic:
    return error("name", f"`{_short(text)}` cannot be the name of a {what}", span, f"a {what}'s name is {rule}")


def wrong_file_name(span: Span, name: str, rule: str) -> Diagnostic:
    return error("name", f"`{_short(name)}` cannot be the name of a message", span, f"the file's name must be {rule}")


def duplicate(span: Span, name: str, first: Span) -> Diagnostic:
    return error("duplicate", f"`{_short(name)}` is declared twice", span, "again here", notes=(f"first at {first}",))


def not_a_constant_type(span: Span, text: str, scalars: Sequence[str]) -> Diagnostic:
    help_ = f"Use one of {', '.join(scalars)}."
    return error("constant-type", f"`{_short(text)}` has no constants", span, "not a type of constants", help_)


def not_a_value(span: Span, type_: str, wanted: str) -> Diagnostic:
    return error("value", f"this is no value of `{_short(type_)}`", span, f"expected {wanted}")


default_of_message = Mistake("default", "a message has no default", "not possible", help="Give the fields of that message defaults.")


def annotation(span: Span, text: str, *, again: bool) -> Diagnostic:
    if again:
        return error("annotation", "the same field is made optional twice", span, "again here")
    return error("annotation", f"`{_short(text)}` is not known", span, "means nothing here", "The only one is `@optional`, in ROS 2.")


optional_nothing = Mistake("annotation", "there is nothing to be optional", "no field follows")


def no_section_name(span: Span, kinds: Sequence[str]) -> Diagnostic:
    help_ = f"Write {', '.join(f'`{kind}: package/Name`' for kind in kinds[:-1])} or `{kinds[-1]}: package/Name`."
    return error("section", "a definition does not say its name", span, "the line below this one must say it", help_)


def wrong_section_name(span: Span, text: str, kind: str) -> Diagnostic:
    what = {"MSG": "a message", "SRV": "a service", "ACTION": "an action"}.get(kind, "a file")
    return error("section", f"`{_short(text)}` is no qualified name of {what}", span, "not a name", f"Write `{kind}: package/Name`.")


def defined_twice(span: Span, name: str, first: Span) -> Diagnostic:
    notes = (f"first at {first}",)
    return error("defined-twice", f"`{_short(name)}` is defined in two ways", span, "differs from the first one", notes=notes)


def wrong_parts(span: Span, kind: str, found: int, wanted: int) -> Diagnostic:
    what = {"srv": "a request and a response", "action": "a goal, a result and feedback"}[kind]
    label = "one too many" if found > wanted else f"{found} of {wanted} lines of `---`"
    message = f"{'a service' if kind == 'srv' else 'an action'} has {what}, with `---` between them"
    return error("parts", message, span, label, "Write a line of `---` between the parts, also where one of them is empty.")


def unknown_message(span: Span, name: str, written: str, places: Sequence[str], scalars: Sequence[str]) -> Diagnostic:
    word = written.split("[", maxsplit=1)[0][:SHOWN]
    near = MEANT.get(word) or closest(word, scalars)
    help_ = f"Did you mean `{near}`?" if near else "Add its file's folder to the search path, or its definition to the text."
    notes = (f"looked for {', '.join(_short(place) for place in places)}",)
    return error("unknown-message", f"no definition of `{_short(name)}` is found", span, "unknown", help_, notes)


def too_many(span: Span, limit: int) -> Diagnostic:
    return error("too-many", f"more than {limit} messages are needed", span, "one too many")


def cycle(span: Span, names: Sequence[str]) -> Diagnostic:
    shown = [*names[:3], "…", names[-1]] if len(names) > 5 else list(names)
    return error("cycle", "a message contains itself", span, " → ".join(_short(name) for name in shown))


def too_deep(span: Span, name: str, depth: int, fields: int) -> Diagnostic:
    message = f"`{_short(name)}` nests more than {depth} deep or has more than {fields} fields in all"
    return error("nesting", message, span, "too large")


def no_literal(span: Span, value: str) -> Diagnostic:
    return error(
        "value", f"IDL cannot write `{value}`", span, "has this value", "Declare it, or what it is used with, in the other language."
    )


def no_type_hash(span: Span | None, name: str) -> Diagnostic:
    return error("type-hash", f"the type of `{_short(name)}` has no place in a ROS 2 type description", span, "cannot be hashed")
