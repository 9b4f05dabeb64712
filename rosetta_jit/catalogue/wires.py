"""What can be wrong with the wires of a mapping that has several."""

from __future__ import annotations

from collections.abc import Sequence

from rosetta_jit.catalogue.mapping import shorten
from rosetta_jit.catalogue.suggestions import nearest
from rosetta_jit.diagnostics import Diagnostic, Mistake, error
from rosetta_jit.source import Span

nameless = Mistake(
    "wire-name", "of several wires each has a name", "no name", help="give each wire a name: `wire-schema velocity: geometry_msgs/Twist`"
)


def unfit(span: Span | None, name: str) -> Diagnostic:
    help_ = "paths begin with it: use letters, digits and underscores, and no digit first"
    return error("wire-name", f"`{shorten(name)}` cannot be the name of a wire", span, help_=help_)


def repeated(span: Span | None, name: str) -> Diagnostic:
    return error("wire-name", f"there is a wire `{shorten(name)}` already", span, "again here", help_="choose another name")


def many(span: Span | None, most: int) -> Diagnostic:
    return error(
        "wire-name", f"a mapping has at most {most} wires", span, "one too many", help_="join some of them by a mapping of their own"
    )


def alone(span: Span | None, name: str) -> Diagnostic:
    help_ = f"write `wire-schema:`, and paths without `.{shorten(name)}`; or name the other wires, too"
    return error("wire-name", "a single wire has no name", span, help_=help_)


def apart(span: Span | None, names: Sequence[str]) -> Diagnostic:
    title = f"this needs messages of {_listed(names)} at once, and each of them comes alone"
    help_ = "of all wires but one it can read numbers and bools, which are kept; not texts, and not the elements of an array one by one"
    return error("wires-apart", title, span, "here", help_=help_)


def set_by_several(span: Span | None, path: str, names: Sequence[str], first: Span | None, *, is_array: bool) -> Diagnostic:
    where = "" if first is None else f"{first.source.name}:{first.source.line_column(first.start)[0]}"
    notes = (f"`{names[0]}` sets it at {where}",) if where else ()
    help_ = f"let one wire set it, or one rule that reads all of them: `{path} = a if condition else b`"
    arrays = (
        "let one wire set it. Only an array of numbers or of texts can have elements of several wires: one of fixed length, "
        f"or with a length that no wire tells, as `len({path}) = 14`"
    )
    message = f"`{path}` is set by messages of {_listed(names)}"
    return error("wires-overlap", message, span, "and here", notes=notes, help_=arrays if is_array else help_)


def unsaid(span: Span | None, names: Sequence[str]) -> Diagnostic:
    help_ = f'`rj.Decoders(...)` and `rj.Encoders(...)` make programs of all wires; `wire="{names[0]}"`, `--wire {names[0]}` that of one'
    title = f"the mapping has several wires, {_listed(names)}: it is not said which one is meant"
    return error("wire-unsaid", title, span, help_=help_)


single = Mistake("wire-single", "the mapping has one wire, which has no name", help="make it by `rj.Decoder` or `rj.Encoder`")


def unknown(span: Span | None, name: str, names: Sequence[str]) -> Diagnostic:
    if not names:
        title = f"there is no wire `{shorten(name)}`: there is one, which has no name"
        return error("unknown-wire", title, span, help_="leave the name out")
    found = nearest(name, names)
    help_ = f"did you mean `{found}`?" if found else f"name {_listed(names, 'or')}"
    return error("unknown-wire", f"the mapping has no wire `{shorten(name)}`", span, notes=(f"wires: {', '.join(names)}",), help_=help_)


cannot_borrow = Mistake(
    "wires-borrow",
    "a holder that messages of several wires fill cannot borrow bytes from one of them",
    help="leave `borrow` out: bytes are copied into the holder then",
)


def not_here(span: Span | None, what: str) -> Diagnostic:
    help_ = "use a mapping of one wire there, or `rj.Decoders` in Python"
    return error("wires-here", f"{what} cannot join messages of several wires", span, help_=help_)


def _listed(names: Sequence[str], word: str = "and") -> str:
    shown = [f"`{shorten(each)}`" for each in names]
    return f"{', '.join(shown[:-1])} {word} {shown[-1]}" if len(shown) > 1 else "".join(shown)


arrival_to_pack = Mistake(
    "wire-arrival",
    "whether a message of a wire has arrived is known where messages are unpacked",
    "in rules to pack",
    help="write the rule in `unpack-rules:`, and in `pack-rules:` what is packed",
)
