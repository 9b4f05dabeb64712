"""Mistakes in what is asked of a mapping or a type as a whole."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from rosetta_jit.catalogue.spelling import closest
from rosetta_jit.diagnostics import Diagnostic

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

    from rosetta_jit.source import Span


def unknown_encoding(name: str, framework: str, known: Sequence[str], frameworks: Mapping[str, Collection[str]]) -> Diagnostic:
    """An encoding that the framework of the wire's type does not have. The name of a framework is taken for one sometimes."""
    message = f"{framework} has no encoding `{name}`"
    if name in frameworks and name != framework:
        message = f"`{name}` is the name of a framework, and no encoding"
        known = tuple(frameworks[name])
    return Diagnostic("error", "unknown-encoding", message, help=f"choose one of {', '.join(known)}")


def no_encoding(name: str, known: Sequence[str]) -> Diagnostic:
    """An encoding that no framework has."""
    return Diagnostic("error", "unknown-encoding", f"there is no encoding `{name}`", help=f"choose one of {', '.join(known)}")


def other_framework(mapping: str, framework: str) -> Diagnostic:
    """A mapping with mistakes, and without them if its files are those of another framework."""
    message = f"{mapping} has no mistakes where the files that it imports are read as those of {framework}"
    help_ = (
        f"`--framework {framework}` checks it so; decoders take `framework=` or `encoding=`, and logs know the encoding of their messages"
    )
    return Diagnostic("note", "other-framework", message, help=help_)


def ambiguous_encoding(name: str, known: Sequence[str]) -> Diagnostic:
    """An encoding that stands for several, where one must be written."""
    return Diagnostic(
        "error",
        "ambiguous-encoding",
        f"`{name}` reads several dialects, but only one can be written",
        notes=("nothing on the wire tells a reader which one it is, so the writer must know what its peer reads",),
        help=f"say which: encoding= one of {', '.join(known)}",
    )


def fixed_byte_order(name: str) -> Diagnostic:
    """A byte order for an encoding that has but one."""
    return Diagnostic("error", "fixed-byte-order", f"`{name}` has one byte order only", help="leave out byte_order=")


def unknown_byte_order(name: str) -> Diagnostic:
    """A byte order that does not exist."""
    return Diagnostic("error", "unknown-byte-order", f"there is no byte order `{name}`", help="it is little or big")


def changed_since(byte_order: str) -> Diagnostic:
    """A program is to be compiled for the first message of another byte order, and files have changed since the decoder was made."""
    message = f"this is the first {byte_order}-endian message, and the files that its decoder was made from have changed since"
    return Diagnostic("error", "changed-since", message, help="make the decoder anew")


def unknown_backend(name: str, known: Sequence[str]) -> Diagnostic:
    """A backend that does not exist."""
    return Diagnostic("error", "unknown-backend", f"there is no backend `{name}`", help=f"there are {', '.join(known)}")


def do_not_meet(filled: str, packed: str, span: Span | None, *, same_name: bool) -> Diagnostic:
    """Two halves of a bridge that are not of one type."""
    note = "they have one name, but not the same fields: each mapping has found another file" if same_name else ""
    return Diagnostic(
        "error",
        "no-bridge",
        f"what decodes fills `{filled}`, what encodes packs `{packed}`",
        span=span,
        label="this one is packed",
        notes=(note,) if note else (),
        help="a bridge is two mappings with the same data-holder, or one mapping and the data-holder's own encoding",
    )


def unlike(older: str, newer: str, path: str, why: str) -> Diagnostic:
    """Types of a framework and of the one that followed it that do not have the same fields."""
    what = f"`{older}` and `{newer}` do not have the same fields: `{path}` {why}"
    return Diagnostic("error", "unlike-types", what, help="write a mapping between the two")


def two_functions(name: str) -> Diagnostic:
    """Both halves of a bridge were given a function of the same name, and not the same one."""
    return Diagnostic("error", "two-functions", f"there are two functions `{name}`", help="give one of them another name")


def half_a_bridge() -> Diagnostic:
    """A bridge of which nothing says what it is between."""
    return Diagnostic("error", "half-a-bridge", "no side of the bridge has a mapping", help="give a mapping, or use Bridge.of for a type")


def no_transcoding(source: str, target: str) -> Diagnostic:
    """Two encodings between which messages cannot go without a type."""
    what = f"nothing turns any message of `{source}` into one of `{target}`"
    help_ = "messages that describe themselves are those of yarp3 and yarp4; between others give a type, or a mapping"
    return Diagnostic("error", "no-transcoding", what, help=help_)


def unknown_leniency(name: str, encoding: str, known: Sequence[str]) -> Diagnostic:
    """Something that an encoding cannot be asked to forgive."""
    help_ = f"it can forgive {', '.join(known)}" if known else "leave out lenient="
    return Diagnostic("error", "unknown-leniency", f"`{encoding}` cannot be lenient about `{name}`", help=help_)


def unknown_framework(name: str, known: Sequence[str]) -> Diagnostic:
    """A framework that is not installed."""
    return Diagnostic("error", "unknown-framework", f"there is no framework `{name}`", help=f"choose one of {', '.join(known)}")


def nameless_schema() -> Diagnostic:
    """A schema that came as one text, and nothing that says in which language."""
    what = "nothing says in which language the schema is"
    return Diagnostic("error", "nameless-schema", what, help='add encoding= or framework=, or give it a name: schema={"file.msg": text}')


def no_rules(span: Span | None, direction: str) -> Diagnostic:
    """A direction for which the mapping has no rules."""
    block = "unpack-rules" if direction == "decode" else "pack-rules"
    return Diagnostic("error", "no-rules", f"the mapping does not say how to {direction}", span, help=f"add rules under `{block}:`")


def unknown_type(name: str, known: Sequence[str]) -> Diagnostic:
    """A type that no file declares."""
    near = closest(name, known) or next((each for each in known if re.split(r"[./:]", each)[-1].casefold() == name.casefold()), None)
    help_ = f"did you mean `{near}`?" if near else "name the files that declare it: imports=[…]"
    return Diagnostic("error", "unknown-type", f"no file declares a message `{name}`", help=help_)


def unknown_suffix(name: str, known: Sequence[str]) -> Diagnostic:
    """A file that no front end reads."""
    return Diagnostic("error", "unknown-suffix", f"no front end reads `{name}`", help=f"IDL files end in {', '.join(known)}")


def no_such_file(name: str, folders: Sequence[str]) -> Diagnostic:
    """A file that is nowhere on the search path."""
    notes = tuple(f"searched {folder}" for folder in folders)
    return Diagnostic("error", "no-such-file", f"`{name}` is not on the search path", notes=notes, help="add its folder: search_path=[…]")


def too_large(name: str, span: Span | None, why: str) -> Diagnostic:
    """A type whose holder would be absurd."""
    return Diagnostic("error", "too-large", f"`{name}` is too large for a holder: {why}", span, help="split it, or bound what repeats")


def too_many_statements(span: Span | None, most: str) -> Diagnostic:
    """A program that would take minutes and much memory to compile."""
    title = f"the program that this becomes has more than {most} statements"
    return Diagnostic("error", "too-large", title, span, help="map less at once: fewer fields, rules or cases in each of several mappings")


def too_deep() -> Diagnostic:
    """Types within types, or texts within texts, that Python's stack does not take."""
    return Diagnostic("error", "nesting", "this nests deeper than Python's stack has room for", help="nest less, or call from less deep")


def unproven(span: Span | None, why: str) -> Diagnostic:
    """A kernel that the proof refuses: deeper than it looks, or a fault of ours."""
    title = "the program that this becomes could not be shown to read and write within its buffers, and is not compiled"
    return Diagnostic(
        "error", "unproven", title, span, notes=tuple(why.split("\n")), help="nest less, or map less at once; report it if that is little"
    )


def endless_copy(span: Span | None) -> Diagnostic:
    """A message that can hold others of its own type, assigned as a whole."""
    label = "it can hold messages of its own type, to any depth"
    help_ = "say how deep with `via`, or assign its fields one by one"
    return Diagnostic("error", "endless-copy", "this cannot be assigned as a whole", span, label, help=help_)


def cannot_infer(encoding: str, known: Sequence[str], *, known_itself: bool) -> Diagnostic:
    """An encoding whose messages do not say what they are of."""
    listed = ", ".join(known)
    if not known_itself:
        return Diagnostic("error", "unknown-encoding", f"there is no encoding `{encoding}`", help=f"schemas are drafted of {listed}")
    message = f"no schema can be drafted of messages in `{encoding}`: their bytes do not tell where a field begins"
    help_ = f"take the definition from where they come: a bag, a log, the package of the type. Schemas are drafted of {listed}"
    return Diagnostic("error", "no-draft", message, help=help_)
