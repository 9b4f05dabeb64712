"""Mistakes in what is asked of a mapping or a type as a whole."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from typing import TYPE_CHECKING

from rosetta_jit.catalogue.limits import MAX_NAMES
from rosetta_jit.catalogue.suggestions import closest, shorten
from rosetta_jit.diagnostics import Diagnostic, Mistake, error, note

if TYPE_CHECKING:
    from rosetta_jit.source import Span

SUFFIXES = (".msg", ".proto", ".idl", ".lcm", ".bottle-schema", ".srv", ".action", ".mapping")
"""How names of files end that declare types, or rules."""


def unknown_encoding(name: str, framework: str, known: Sequence[str], frameworks: Mapping[str, Collection[str]]) -> Diagnostic:
    message = f"{framework} has no encoding `{name}`"
    if name in frameworks and name != framework:
        message = f"`{name}` is the name of a framework, and no encoding"
        known = tuple(frameworks[name])
    return error("unknown-encoding", message, help_=f"choose one of {', '.join(known)}")


def no_encoding(name: str, known: Sequence[str]) -> Diagnostic:
    return error("unknown-encoding", f"there is no encoding `{name}`", help_=f"choose one of {', '.join(known)}")


def other_framework(mapping: str, framework: str) -> Diagnostic:
    message = f"{mapping} has no mistakes where the files that it imports are read as those of {framework}"
    help_ = (
        f"`--framework {framework}` checks it so; decoders take `framework=` or `encoding=`, and logs know the encoding of their messages"
    )
    return note("other-framework", message, help_=help_)


def ambiguous_encoding(name: str, known: Sequence[str]) -> Diagnostic:
    return error(
        "ambiguous-encoding",
        f"`{name}` reads several dialects, but only one can be written",
        help_=f"say which by encoding=, one of {', '.join(known)}",
        notes=("nothing on the wire tells a reader which one it is, so the writer must know what its peer reads",),
    )


def fixed_byte_order(name: str) -> Diagnostic:
    return error("fixed-byte-order", f"`{name}` has one byte order only", help_="leave out byte_order=")


def unknown_byte_order(name: str) -> Diagnostic:
    return error("unknown-byte-order", f"there is no byte order `{name}`", help_="it is little or big")


def changed_since(byte_order: str) -> Diagnostic:
    message = f"this is the first {byte_order}-endian message, and the files that its decoder was made from have changed since"
    return error("changed-since", message, help_="make the decoder anew")


def unknown_backend(name: str, known: Sequence[str]) -> Diagnostic:
    return error("unknown-backend", f"there is no backend `{name}`", help_=f"there are {', '.join(known)}")


def do_not_meet(filled: str, packed: str, span: Span | None, *, same_name: bool) -> Diagnostic:
    note = "they have one name, but not the same fields: each mapping has found another file" if same_name else ""
    return error(
        "no-bridge",
        f"what decodes fills `{filled}`, what encodes packs `{packed}`",
        span,
        "this one is packed",
        help_="a bridge is two mappings with the same data-holder, or one mapping and the data-holder's own encoding",
        notes=(note,) if note else (),
    )


def unlike(older: str, newer: str, path: str, why: str) -> Diagnostic:
    what = f"`{older}` and `{newer}` do not have the same fields: `{path}` {why}"
    return error("unlike-types", what, help_="write a mapping between the two")


def two_functions(name: str) -> Diagnostic:
    return error("two-functions", f"there are two functions `{name}`", help_="give one of them another name")


def half_a_bridge() -> Diagnostic:
    return error("half-a-bridge", "no side of the bridge has a mapping", help_="give a mapping, or use Bridge.of for a type")


def no_transcoding(source: str, target: str) -> Diagnostic:
    what = f"nothing turns any message of `{source}` into one of `{target}`"
    help_ = "messages that describe themselves are those of yarp3 and yarp4; between others give a type, or a mapping"
    return error("no-transcoding", what, help_=help_)


def unknown_leniency(name: str, encoding: str, known: Sequence[str]) -> Diagnostic:
    help_ = f"it can forgive {', '.join(known)}" if known else "leave out lenient="
    return error("unknown-leniency", f"`{encoding}` cannot be lenient about `{name}`", help_=help_)


def unknown_framework(name: str, known: Sequence[str]) -> Diagnostic:
    return error("unknown-framework", f"there is no framework `{name}`", help_=f"choose one of {', '.join(known)}")


def nameless_schema() -> Diagnostic:
    what = "nothing says in which language the schema is"
    return error("nameless-schema", what, help_='add encoding= or framework=, or give it a name: schema={"file.msg": text}')


def no_rules(span: Span | None, direction: str) -> Diagnostic:
    block = "unpack-rules" if direction == "decode" else "pack-rules"
    return error("no-rules", f"the mapping does not say how to {direction}", span, help_=f"add rules under `{block}:`")


def unknown_type(name: str, known: Sequence[str]) -> Diagnostic:
    """A type that no file declares; others of the name are in other packages. A file may lie where the name says, and declare another."""
    parts = _parts(name)
    others = [each for each in dict.fromkeys(known) if _parts(each) != parts]
    alike = [each for each in others if _parts(each.casefold())[-len(parts) :] == _parts(name.casefold())][:MAX_NAMES]
    meant = alike or [each for each in (closest(name, others),) if each is not None]
    if name.endswith(SUFFIXES):
        help_ = f'a file is imported, and a type in it is named: imports=["{shorten(name)}"]'
    else:
        help_ = f"did you mean {' or '.join(f'`{each}`' for each in meant)}?" if meant else "name the files that declare it: imports=[file]"
    return error("unknown-type", f"no file declares a message `{name}`", help_=help_)


def _parts(name: str) -> list[str]:
    """The parts of a qualified name."""
    return [each for each in re.split(r"[./:]", name) if each]


def unknown_suffix(name: str, known: Sequence[str]) -> Diagnostic:
    return error("unknown-suffix", f"no front end reads `{name}`", help_=f"IDL files end in {', '.join(known)}")


def no_such_file(name: str, folders: Sequence[str]) -> Diagnostic:
    notes = tuple(f"searched {folder}" for folder in folders)
    return error("no-such-file", f"`{name}` is not on the search path", help_="add its folder: search_path=[folder]", notes=notes)


def too_large(name: str, span: Span | None, why: str) -> Diagnostic:
    return error("too-large", f"`{name}` is too large for a holder: {why}", span, help_="split it, or bound what repeats")


def too_many_statements(span: Span | None, most: str) -> Diagnostic:
    title = f"the program that this becomes has more than {most} statements"
    return error("too-large", title, span, help_="map less at once: fewer fields, rules or cases in each of several mappings")


def too_deep() -> Diagnostic:
    return error("nesting", "this nests deeper than Python's stack has room for", help_="nest less, or call from less deep")


def unproven(span: Span | None, why: str) -> Diagnostic:
    title = "the program that this becomes could not be shown to read and write within its buffers, and is not compiled"
    return error("unproven", title, span, help_="nest less, or map less at once; report it if that is little", notes=tuple(why.split("\n")))


endless_copy = Mistake(
    "endless-copy",
    "this cannot be assigned as a whole",
    "it can hold messages of its own type, to any depth",
    help="say how deep with `via`, or assign its fields one by one",
)


def cannot_infer(encoding: str, known: Sequence[str], *, known_itself: bool) -> Diagnostic:
    listed = ", ".join(known)
    if not known_itself:
        return error("unknown-encoding", f"there is no encoding `{encoding}`", help_=f"schemas are drafted of {listed}")
    message = f"no schema can be drafted of messages in `{encoding}`: their bytes do not tell where a field begins"
    help_ = f"take the definition from where they come: a bag, a log, the package of the type. Schemas are drafted of {listed}"
    return error("no-draft", message, help_=help_)
