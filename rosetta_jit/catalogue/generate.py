"""What cannot be generated."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.diagnostics import Diagnostic

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rosetta_jit.source import Span


def unknown_language(name: str, known: Sequence[str]) -> Diagnostic:
    """A language that is not installed."""
    return Diagnostic("error", "unknown-language", f"nothing prints `{name}`", help=f"choose one of {', '.join(known)}")


def unknown_holder(name: str, known: Sequence[tuple[str, str]]) -> Diagnostic:
    """Classes that nothing is known of."""
    help_ = "choose " + ", ".join(f"{each} ({summary})" for each, summary in known)
    return Diagnostic("error", "unknown-holder", f"`{name}` are no classes that can be filled", help=help_)


def no_numpy(language: str, known: Sequence[str]) -> Diagnostic:
    """A language whose arrays are its own."""
    message = f"source in `{language}` has no arrays of numpy"
    return Diagnostic("error", "no-numpy", message, help=f"leave out --arrays numpy, or choose --language {' or '.join(known)}")


def no_manner(holder: str, kind: str, where: str) -> Diagnostic:
    """A field of a kind that the framework's classes do not have."""
    message = f"classes of `{holder}` have no fields as `{where}` ({kind.split(maxsplit=1)[0]})"
    return Diagnostic("error", "not-in-holder", message, help="choose another --holder, as own")


def unusable_name(name: str) -> Diagnostic:
    """A name that files and identifiers cannot begin with."""
    help_ = "letters, digits and underscores, of which a letter comes first, up to 40; and not the name of a header of C"
    message = f"`{name}` cannot begin the names of functions"
    return Diagnostic("error", "unusable-name", message, help=help_)


def needs_library(name: str, what: str) -> Diagnostic:
    """A function of this library's that source in another language does not have."""
    return Diagnostic(
        "error",
        "not-generated",
        f"{name} {what} images, which generated source cannot",
        help="leave the image as it is, or compress it where there is Python",
    )


def not_in_language(name: str, what: str, language: str) -> Diagnostic:
    """What a kernel does and generated source in that language cannot."""
    return Diagnostic("error", "not-generated", f"{name} needs {what}, which source in `{language}` cannot have", help="generate C or C++")


def needs_c_library(name: str, what: str) -> Diagnostic:
    """Freestanding source that needs what a C library has."""
    return Diagnostic("error", "not-freestanding", f"{name} needs {what} of the C library", help="generate it without --freestanding")


def no_target(triple: str, why: str) -> Diagnostic:
    """A machine for which no object can be made."""
    help_ = "name it as LLVM does, as thumbv7em-none-eabihf; source in C runs on any"
    return Diagnostic("error", "no-target", f"there are no objects for `{triple}`: {why}", help=help_)


def not_in_object(function: str) -> Diagnostic:
    """A mapping that calls a function of its user's, whose code an object cannot have."""
    return Diagnostic(
        "error", "not-in-object", f"the mapping calls `{function}`, which an object does not have", help="generate source instead"
    )


def no_object(language: str) -> Diagnostic:
    """A language without headers for objects."""
    return Diagnostic("error", "no-object", f"objects have no header in `{language}`", help="use --language c")


def not_of_wires(span: Span | None) -> Diagnostic:
    """Decoders of several wires in a language that has none, with bytes left in a message, or in an object file."""
    help_ = "decoders are made as source, by `--directions decode`; encoders, of one wire each, by `--directions encode --wire NAME`"
    return Diagnostic("error", "not-generated", "such source cannot join messages of several wires", span, help=help_)


def wires_around(holder: str, span: Span | None = None) -> Diagnostic:
    """A class that reads messages of one type around decoders of several wires."""
    text = f"a class for `--holder {holder}` reads messages of one type, and the mapping has several wires"
    return Diagnostic("error", "not-generated", text, span, help="choose another `--holder`, as own")


def one_way_around(holder: str, lacking: str) -> Diagnostic:
    """A class that reads and writes around a codec that does one of both."""
    text = f"a class for `--holder {holder}` reads and writes messages, and `{lacking}` is not among the directions"
    return Diagnostic("error", "not-generated", text, help="choose `--directions decode,encode`, or another `--holder`, as own")


def needless(option: str, emit: str) -> Diagnostic:
    """An option of the command line that changes nothing of what is made."""
    return Diagnostic(
        "error", "needless-option", f"`{option}` says nothing about `--emit {emit}`", help="leave it out, or choose the other `--emit`"
    )
