"""Where nothing is exported by default (STRICT), what is nested cannot be, but for the enums of a message that is their namespace.

https://protobuf.dev/editions/features/#symbol-vis
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.frameworks.protobuf import edition_diagnostics as say_edition
from rosetta_jit.frameworks.protobuf.proto.tree import LARGEST_FIELD_NUMBER

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.frameworks.protobuf.proto.declarations import Declarations, DeclaredMessage


def check_visibility(declared: Declarations) -> Iterator[Diagnostic]:
    """Every message with something nested."""
    for entry in declared.messages.values():
        if entry.features.default_symbol_visibility == "STRICT":
            enums = () if _is_namespace(entry, declared) else entry.message.enums
            for inner in (*entry.message.messages, *enums):
                if inner.visibility == "export":
                    yield say_edition.nested_export(inner.name)


def _is_namespace(entry: DeclaredMessage, declared: Declarations) -> bool:
    """Whether a message stands at the top, is not exported, and reserves all numbers."""
    nested = entry.full.rpartition(".")[0] in declared.messages
    reserved = {(each.first, each.last) for each in entry.message.reserved}
    return not nested and entry.message.visibility != "export" and (1, LARGEST_FIELD_NUMBER) in reserved
