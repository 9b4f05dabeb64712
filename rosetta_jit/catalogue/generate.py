"""What cannot be generated."""

from __future__ import annotations

from collections.abc import Sequence

from rosetta_jit.diagnostics import Diagnostic, Mistake, error


def unknown_language(name: str, known: Sequence[str]) -> Diagnostic:
    return error("unknown-language", f"nothing prints `{name}`", help_=f"choose one of {', '.join(known)}")


def unknown_holder(name: str, known: Sequence[tuple[str, str]]) -> Diagnostic:
    help_ = "choose " + ", ".join(f"{each} ({summary})" for each, summary in known)
    return error("unknown-holder", f"`{name}` are no classes that can be filled", help_=help_)


def no_numpy(language: str, known: Sequence[str]) -> Diagnostic:
    message = f"source in `{language}` has no arrays of numpy"
    return error("no-numpy", message, help_=f"leave out --arrays numpy, or choose --language {' or '.join(known)}")


def needless_in(option: str, language: str, known: Sequence[str]) -> Diagnostic:
    help_ = f"leave it out, or choose --language {' or '.join(known)}"
    return error("needless-option", f"`{option}` says nothing about source in `{language}`", help_=help_)


def needless_header(holder: str) -> Diagnostic:
    message = f"`--include` says nothing about `--holder {holder}`, whose classes are generated"
    return error("needless-option", message, help_="leave it out, or choose the --holder that has such classes, as protobuf")


def unusable_header(name: str) -> Diagnostic:
    return error(
        "unusable-header", f"`{name}` cannot be included", help_="name the header as between < and >: rst/kinematics/JointAngles.pb.h"
    )


def no_manner(holder: str, kind: str, where: str) -> Diagnostic:
    message = f"classes of `{holder}` have no fields as `{where}` ({kind.split(maxsplit=1)[0]})"
    return error("not-in-holder", message, help_="choose another --holder, as own")


def of_another_framework(holder: str, type_: str, framework: str, known: Sequence[str]) -> Diagnostic:
    help_ = f"choose another --holder, as {' or '.join(known)}, or name the header of such a class: --include HEADER"
    return error("not-in-holder", f"`{type_}`, a type of {framework}, has no class of `{holder}`", help_=help_)


def unusable_name(name: str, also: str) -> Diagnostic:
    kinds = f"letters, digits, underscores and `{also}`" if also else "letters, digits and underscores"
    rule = f"{kinds}, of which a letter comes first, up to 40; no header of C, and no word of the language"
    help_ = f"choose another --name: {rule}"
    message = f"`{name}` cannot begin the names of functions"
    return error("unusable-name", message, help_=help_)


def somebody_elses(path: str) -> Diagnostic:
    return _not_replaced(f"`{path}` was not made by this command, and would be lost")


def of_another_subject(path: str, subject: str) -> Diagnostic:
    return _not_replaced(f"`{path}` was made from `{subject}`, and would be lost")


def _not_replaced(message: str) -> Diagnostic:
    return error("not-replaced", message, help_="name the files otherwise (--name), put them into another folder (-o), or remove it first")


def name_of_a_class(name: str) -> Diagnostic:
    message = f"no namespace can be called as the class `::{name}`"
    return error("unusable-name", message, help_=f"name the files otherwise, as --name {name[:34]}_codec")


def needs_library(name: str, what: str) -> Diagnostic:
    return error(
        "not-generated",
        f"{name} {what} images, which generated source cannot",
        help_="leave the image as it is, or compress it where there is Python",
    )


def needs_c_library(name: str, what: str) -> Diagnostic:
    return error("not-freestanding", f"{name} needs {what} of the C library", help_="generate it without --freestanding")


def no_target(triple: str, why: str) -> Diagnostic:
    help_ = "name it as LLVM does, as thumbv7em-none-eabihf; source in C runs on any"
    return error("no-target", f"there are no objects for `{triple}`: {why}", help_=help_)


def not_in_object(function: str) -> Diagnostic:
    return error("not-in-object", f"the mapping calls `{function}`, which an object does not have", help_="generate source instead")


def no_object(language: str) -> Diagnostic:
    return error("no-object", f"objects have no header in `{language}`", help_="use --language c")


not_of_wires = Mistake(
    "not-generated",
    "such source cannot join messages of several wires",
    help="decoders are made as source, by `--directions decode`; encoders, of one wire each, by `--directions encode --wire NAME`",
)


def wires_around(holder: str) -> Diagnostic:
    text = f"a class for `--holder {holder}` reads messages of one type, and the mapping has several wires"
    return error("not-generated", text, help_="choose another `--holder`, as own")


def one_way_around(holder: str, lacking: str) -> Diagnostic:
    text = f"a class for `--holder {holder}` reads and writes messages, and `{lacking}` is not among the directions"
    return error("not-generated", text, help_="choose `--directions decode,encode`, or another `--holder`, as own")


def needless_import() -> Diagnostic:
    return error("needless-option", "`--import` says nothing about a mapping", help_="leave it out: a mapping imports files itself")


def needless(option: str, emit: str) -> Diagnostic:
    return error("needless-option", f"`{option}` says nothing about `--emit {emit}`", help_="leave it out, or choose the other `--emit`")
