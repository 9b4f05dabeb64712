"""What can be wrong with the names and types in the rules of a mapping."""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence

from rosetta_jit.catalogue.habits import for_function, for_name, is_index, path_before
from rosetta_jit.catalogue.limits import MAX_NAMES, MAX_QUOTED
from rosetta_jit.catalogue.mapping import shorten
from rosetta_jit.catalogue.suggestions import did_you_mean, there_are
from rosetta_jit.diagnostics import Diagnostic, Mistake, error, note, warning
from rosetta_jit.source import Span


def unknown_type(span: Span | None, name: str, known: Collection[str]) -> Diagnostic:
    return error(
        "unknown-type",
        f"no import declares a type `{shorten(name)}`",
        span,
        "not declared",
        notes=there_are("declared", known, name),
        help_=did_you_mean(name, known) or "import the file that declares it",
    )


def not_a_message(span: Span | None, name: str) -> Diagnostic:
    return error("not-a-message", f"`{shorten(name)}` is an enum, not a message", span, help_="name a message type")


key_to_set = Mistake(
    "key-to-set",
    "a key of an element that is set must be known when the mapping is compiled",
    "here",
    help="write the key down, or set the elements by their numbers, each with its key",
)
keys_of_list = Mistake(
    "key-to-set",
    "an array has the keys of one list, in its order, and no others",
    "here",
    help="put all keys of the array into one list, or write them all down",
)


def key_twice(span: Span | None, key: str) -> Diagnostic:
    return error(
        "key-twice", f"the list has {shorten(key)} twice, and each key tells one element", span, "here", help_="remove one of them"
    )


no_number_of = Mistake("arguments", "`index` takes an element that a key tells", "this is none", help='write `index(.a[.key = "x"])`')


def length_not_settable(span: Span | None, found: str) -> Diagnostic:
    return error("length-fixed", f"the length of {found} cannot be set", span, "here", help_="assign it as a whole, or remove the rule")


def unknown_name(
    span: Span | None, name: str, known: Collection[str], members: Collection[str] = (), *, owner: str = "", loops: Sequence[str] = ()
) -> Diagnostic:
    """A name that is no loop variable and no constant.

    What it ends with may be one of the ``members`` of the message, or a constant of the type ``owner``; ``loops`` are the variables of the
    loops around.
    """
    last = re.split(r"[./:]", name)[-1]
    if last in members and last not in known:
        message = f"there is no loop variable or constant `{shorten(name)}`, but a field `{shorten(last)}`"
        help_ = f"a path begins at the message itself: `.{shorten(last)}`"
        return error("unknown-name", message, span, "not known here", help_=help_)
    return error(
        "unknown-name",
        f"there is no loop variable or constant `{shorten(name)}`",
        span,
        "not known here",
        notes=there_are("known", known, name),
        help_=for_name(name, known)
        or _as_declared(name, known, owner)
        or _of_loops(name, loops)
        or did_you_mean(name, known)
        or _how_named(name),
    )


def is_compared(span: Span | None) -> bool:
    """Whether a name is compared with something: then it is probably a constant of the message that is read."""
    text = "" if span is None else span.source.text
    if span is None:
        return False
    before, behind = text[max(0, span.start - 10) : span.start], text[span.end : span.end + 10]
    return re.search(r"[=!]=\s*$", before) is not None or re.match(r"\s*[=!]=", behind) is not None


def _of_loops(name: str, loops: Sequence[str]) -> str:
    """The variable of the loop that a short name may stand for."""
    return f"the variable of this loop is `{loops[-1]}`" if loops and len(name) == 1 else ""


def _as_declared(name: str, known: Collection[str], owner: str = "") -> str | None:
    """How a constant of that name is written: that of the message, or of a type within it, before others."""
    ends = tuple(f"{mark}{name}" for mark in (".", "::"))
    declared = next((each for each in sorted(known, key=lambda each: (not each.startswith(owner), each)) if each.endswith(ends)), None)
    return None if declared is None else f"a constant is written with the type that declares it: `{declared}`"


def _how_named(name: str) -> str:
    """How what may be meant is written."""
    if "/" in name:
        return "a constant is written as `package/msg/Type.NAME`; to divide, put blanks around `/`"
    return f"a field begins with a dot: `.{shorten(name)}`; a constant is written with the type that declares it: `Type.NAME`"


def bare_function(span: Span | None, name: str) -> Diagnostic:
    """The name of a function where a value is wanted."""
    takes_none = name in ("now", "counter", "index")
    help_ = f"call it: `{name}()`" if takes_none else f"what it takes stands in its brackets: `{name}(.x)`"
    return error("unknown-name", f"`{name}` is a function", span, "its brackets are missing", help_=help_)


def ambiguous_name(span: Span | None, name: str, several: Sequence[str]) -> Diagnostic:
    shown = ", ".join(f"`{shorten(each)}`" for each in several[:MAX_NAMES])
    message = f"`{shorten(name)}` is the name of several constants"
    help_ = f"write `{shorten(several[0])}`, or another of them"
    return error("ambiguous-name", message, span, "which one?", notes=(f"they are: {shown}",), help_=help_)


def unknown_function(span: Span | None, name: str, known: Collection[str]) -> Diagnostic:
    if name in known:
        help_ = "there is one in a rule with `[]`, in a reduction and behind `where`; in a loop it is the loop's variable"
        return error("unknown-function", f"`{name}()` is the number of an element, and there is none here", span, help_=help_)
    return error(
        "unknown-function",
        f"there is no function `{shorten(name)}`",
        span,
        notes=there_are("functions", known, name),
        help_=for_function(name) or _as_type(name, known) or did_you_mean(name, known),
    )


def _as_type(name: str, known: Collection[str]) -> str:
    """How a conversion to an enum of that name is written; empty where there is none."""
    declared = next((each for each in sorted(known) if each.endswith((f".{name}", f"::{name}", f"/{name}"))), None)
    return "" if declared is None else f"an enum is written with what declares it: `{declared}(...)`"


def arguments(span: Span | None, function: str, expected: str, found: int) -> Diagnostic:
    return error("arguments", f"`{function}` takes {expected}, not {found}", span, help_="docs/language.md shows each function")


def conversion_rule(span: Span | None, function: str, allowed: Collection[str]) -> Diagnostic:
    names = ", ".join(f"`{name}`" for name in sorted(allowed)) or "none"
    return error(
        "conversion-rule", f"`{function}` has no such rule here", span, "not a rule", help_=f"write one of {names}, or leave it out"
    )


def shadowed(span: Span | None, name: str) -> Diagnostic:
    return error("shadowed", f"an outer loop already counts with `{name}`", span, help_="choose another variable")


def needs_word(span: Span | None, source: str, target: str, how: str) -> Diagnostic:
    return error(
        "lossy-conversion",
        f"{source} does not always fit {target}",
        span,
        f"this is {source}",
        help_=f"say how: {how.replace('...', written_at(span))}",
    )


def quotient(span: Span | None, source: str, target: str, how: str) -> Diagnostic:
    kept = "`/` of integers drops the remainder, which stays with a float: `.a / 127.0`"
    help_ = f"{kept}; else say how: {how.replace('...', written_at(span))}"
    return error("lossy-conversion", f"{source} does not always fit {target}", span, "a quotient of integers", help_=help_)


def many_defaults(span: Span | None, most: int) -> Diagnostic:
    message = f"this has more than {most:,} fields that must be set, those of the messages within it included"
    return error("many-defaults", message, span, help_="set the fields that matter, or use a mapping for the messages: `via`")


def unlike_names(span: Span | None, name: str, wire: str, holder: str, line: str) -> Diagnostic:
    help_ = f"write a rule for it: `{shorten(line)}`" if line else f"write `same names except {shorten(name)}`, and a rule for it"
    message = f"`{shorten(name)}` is {wire} on the wire and {holder} in the holder: its name alone does not say how it is mapped"
    return error("unlike-names", message, span, help_=help_)


def no_number(span: Span | None, source: str, target: str, how: str) -> Diagnostic:
    help_ = f"say that its number is meant: {how.replace('...', written_at(span))}"
    return error("lossy-conversion", f"{source} is no {target} by itself", span, f"this is {source}", help_=help_)


def written_at(span: Span | None) -> str:
    """The text of an expression, where it is short enough to be shown again."""
    text = "" if span is None else span.source.text[span.start : span.end]
    return text if 0 < len(text) <= MAX_QUOTED and text.isprintable() else "..."


def type_clash(span: Span | None, source: str, target: str, how: str = "") -> Diagnostic:
    value = written_at(span)
    help_ = how.replace("(...)", f"({value})", 1)
    if not help_ and value.startswith(".") and source == f"an array of {target}" and _sets_each(span):
        help_ = f"each element is written with `[]`: `{value}[]`"
    help_ = help_ or _of_elements(value, source, target)
    return error("type-clash", f"{source} cannot become {target}", span, f"this is {source}", help_=help_)


def _sets_each(span: Span | None) -> bool:
    """Whether the rule in whose line a value stands is one for each element."""
    before = "" if span is None else span.source.text[: span.start].rpartition("\n")[2]
    place, sign, _ = before.partition("<->" if "<->" in before else "=")
    return bool(sign) and place.rstrip().endswith("[]")


NUMBERS = ("int", "uint", "float")
"""What the types of numbers begin with."""


def each_element(function: str, span: Span | None) -> str:
    """How all numbers of an array are converted, where a conversion is given the array."""
    value = written_at(span)
    return (
        f"of each element: `.a[] = {function}({value}[])`, in `rules:` `.a[] <-> {function}({value}[])`; of one, `{function}({value}[0])`"
    )


def _of_elements(value: str, source: str, target: str) -> str:
    """How an array and a single value can be made of each other."""
    if value.startswith(".") and source.startswith("an array of") and not target.startswith("an array"):
        is_number = source.removeprefix("an array of ").startswith(NUMBERS) and target.startswith(NUMBERS)
        return f"name one of its elements, `{value}[0]`{f', or make one number of them, `mean({value}[])`' if is_number else ''}"
    if target == f"an array of {source}":
        return f"`[{value}]` is an array of this one element"
    if source == "bool" and target.startswith("float"):
        return f"`int8({value})` is its number, 0 or 1"
    return "assign another field, or compute what is meant from it"


def constant_range(span: Span | None, value: str, target: str) -> Diagnostic:
    help_ = f"write a value that {target} holds, or take a wider type"
    return error("constant-range", f"{shorten(value)} does not fit {target}", span, "known to be out of range", help_=help_)


OF_FLOATS = {
    "modulo": "of floats, `x % y` is what remains, with the sign of `x`; with that of `y` it is `x - floor(x / y) * y`",
    "floor_divide": "of floats, it is `floor(x / y)`",
    "^": "`^` is the exclusive or of bits; a square is `x * x`",
}
"""What does for floats what a function does for integers alone."""


def operand(span: Span | None, operator: str, found: str) -> Diagnostic:
    convertible = found.startswith(("uint", "float", "enum", "bool"))
    hint = f"convert it first: `int64({written_at(span)})`" if convertible else "only numbers can be computed with"
    if found.startswith("float"):
        hint = OF_FLOATS.get(operator, hint)
    if found == "int64":  # which is refused where a float is needed
        hint = f"say that it may be rounded: `float64({written_at(span)})`"
    if found == "text":
        hint = f"`number({written_at(span)})` is the number that a text spells"
    if found.startswith("an array of") and found.removeprefix("an array of ").startswith(NUMBERS):
        hint = f"`{written_at(span)}[]` is each of its elements; a rule that computes with them sets `.place[]`"
    return error("operand", f"`{operator}` cannot take {found}", span, f"this is {found}", help_=hint)


def integer_needed(span: Span | None, what: str, found: str) -> Diagnostic:
    hint = f"convert it: `int64({written_at(span)})`" if found in {"uint64", "float32", "float64"} else ""
    if found == "text" and is_index(span):
        key, array = written_at(span), path_before(span)
        hint = f"`{array}[.key = {key}]` is the element with that key, `{array}[.keys[] = {key}]` one of an array with its keys beside"
    elif found == "text":
        hint = f"`integer({written_at(span)})` is the integer that a text spells"
    return error("integer-needed", f"{what} is an integer, not {found}", span, f"this is {found}", help_=hint)


zero_division = Mistake("zero-division", "division by zero", "this is zero", help="divide by something else")


def rounded(span: Span | None, number: float, single: float) -> Diagnostic:
    help_ = f"write `float32({number!r})` to say that it is meant"
    return warning("rounded", f"no float32 is {number!r}: {single!r} is the nearest", span, "rounded to it", help_=help_)


def rounded_by_unit(span: Span | None, found: str, source: str, target: str) -> Diagnostic:
    message = f"a {found} in {source} becomes a float32 in {target}, rounded"
    return warning("rounded", message, span, "rounded", help_="write `float32(...)` to say that it is meant")


def fraction(span: Span | None, number: int, divisor: int) -> Diagnostic:
    message = f"{number} / {divisor} is no integer"
    help_ = f"write `{number}.0 / {divisor}` for the float, or `floor_divide({number}, {divisor})` for the integer below it"
    return error("fraction", message, span, "both are integers", help_=help_)


def shift_range(span: Span | None, bits: int, most: int) -> Diagnostic:
    return error("shift-range", f"a shift by {bits} bits", span, f"0 to {most} can be", help_="correct the number of bits")


def loop_range(span: Span | None, start: int, stop: int) -> Diagnostic:
    return error("loop-range", f"the loop ends at {stop}, below its start {start}", span, help_="`to` is exclusive and not below `from`")


def condition_needed(span: Span | None, found: str) -> Diagnostic:
    value, is_array = written_at(span), found.startswith("an array of ")
    kind = found.removeprefix("an array of ")
    with_sign = f"compare it: `{value}{'[]' * is_array}" + (' == "..."`' if kind == "text" else " != 0`")
    hint = with_sign if kind.startswith(("text", *NUMBERS)) else f"say what is to hold of it, as `len({value}) > 0`"
    return error("condition", f"a condition is true or false, this is {found}", span, f"this is {found}", help_=hint)


def not_comparable(span: Span | None, operator: str, left: str, right: str, constant: str = "") -> Diagnostic:
    """Two values that no comparison relates; ``constant`` is one whose name is the text."""
    hint = "texts are compared with a text in quotes, by `==` or `!=`" if "text" in {left, right} else "convert one of them first"
    operands = {left, right} - {"text"}
    if len(operands) == 1 and operands.pop().startswith(("int", "uint", "float")):
        hint = "make both of them texts, `text(x)`, or both numbers, `number(x)`"
    if constant:
        hint = f"`{constant}` is the constant of this name"
    if operator == "==" and left.startswith("an array of") and span is not None and span.source.text[: span.start].rstrip().endswith("["):
        hint = f"an element is told by its key with one `=`: `[{written_at(span).replace('==', '=', 1)}]`"
    return error("not-comparable", f"`{operator}` does not compare {left} with {right}", span, help_=hint)


def long_text(span: Span | None, most: int) -> Diagnostic:
    return error("long-text", f"a field is compared with at most {most} bytes of text", span, help_="compare a part that tells it apart")


def mixed_choice(span: Span | None, kinds: Collection[str]) -> Diagnostic:
    listed = ", ".join(kinds)
    return error("mixed-choice", "the values of a choice have no type in common", span, help_=f"convert them to one of: {listed}")


rules_behind_reject = Mistake(
    "unreachable", "what follows a `reject` without `when` is never reached", help='write `reject "text" when condition`'
)


def overridden(span: Span | None, place: str, first: Span | None) -> Diagnostic:
    message = f"`{shorten(place)}` is set before, too: this rule counts"
    help_ = "leave the other rule out in a mapping of today"
    return note("overridden", message, span, "the later one", notes=(f"set before at {first}",) if first else (), help_=help_)


def rounded_silently(span: Span | None) -> Diagnostic:
    help_ = f"write `float32({written_at(span)})` in a mapping of today"
    return note("rounded", "a float64 becomes a float32", span, "rounded to the nearest", help_=help_)


def many_cases(span: Span | None, most: int) -> Diagnostic:
    return error("many-cases", f"a choice here has at most {most} cases", span, help_="compute the value, or split the table with `when`")
