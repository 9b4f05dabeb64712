"""How things are named, where a file wants that to be enforced: since edition 2024 all do that do not say otherwise.

https://protobuf.dev/programming-guides/style/
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from rosetta_jit.frameworks.protobuf import edition_diagnostics as say_edition
from rosetta_jit.frameworks.protobuf.proto.declarations import fields_in, file_features
from rosetta_jit.frameworks.protobuf.proto.features import choose
from rosetta_jit.frameworks.protobuf.proto.tree import Oneof

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.frameworks.protobuf.proto.declarations import Declarations, DeclaredEnum, DeclaredMessage
    from rosetta_jit.frameworks.protobuf.proto.features import Features
    from rosetta_jit.frameworks.protobuf.proto.tree import File, Name

TITLE = re.compile(r"[A-Z][A-Za-z0-9]*")
LOWER = re.compile(r"[a-z][a-z0-9]*(?:_[a-z][a-z0-9]*)*")
UPPER = re.compile(r"[A-Z][A-Z0-9]*(?:_[A-Z][A-Z0-9]*)*")
PACKAGE = re.compile(r"[a-z][a-z0-9.]*(?:_[a-z][a-z0-9.]*)*")
EXAMPLES = {TITLE: "JointState", LOWER: "joint_state", UPPER: "JOINT_STATE", PACKAGE: "arm.joint_state"}


def check_style(declared: Declarations) -> Iterator[Diagnostic]:
    """Every name that a file declares."""
    for name, wanted, features in _names(declared):
        if features.enforce_naming_style != "STYLE_LEGACY" and not wanted.fullmatch(name.text):
            yield say_edition.style(name, EXAMPLES[wanted])


Named = tuple["Name", re.Pattern[str], "Features"]


def _names(declared: Declarations) -> Iterator[Named]:
    for file in declared.files:
        yield from _file(file)
    for message in declared.messages.values():
        yield from _message(message)
    for enum in declared.enums.values():
        yield from _enum(enum)
    for extension in declared.extensions.values():
        yield extension.field.name, LOWER, extension.entry.features


def _file(file: File) -> Iterator[Named]:
    features = file_features(file)
    if file.package:
        yield file.package, PACKAGE, features
    for service in file.services:
        inner = choose(features, service.options)
        yield service.name, TITLE, inner
        for method in service.methods:
            yield method.name, TITLE, choose(inner, method.options)


def _message(entry: DeclaredMessage) -> Iterator[Named]:
    yield entry.message.name, TITLE, entry.features
    for member in entry.message.members:
        if isinstance(member, Oneof):
            yield member.name, LOWER, choose(entry.features, member.options)
    for field in fields_in(entry):
        yield field.field.name, LOWER, field.features


def _enum(entry: DeclaredEnum) -> Iterator[Named]:
    yield entry.enum.name, TITLE, entry.features
    for value in entry.enum.values:
        yield value.name, UPPER, choose(entry.features, value.options)
