"""Which messages and enums other files can use: since edition 2024 each is exported, or local to its file.

https://protobuf.dev/editions/features/#symbol-vis
"""

from __future__ import annotations

from typing import TYPE_CHECKING, assert_never

if TYPE_CHECKING:
    from rosetta_jit.frameworks.protobuf.proto.features import Features
    from rosetta_jit.frameworks.protobuf.proto.tree import Visibility


def is_exported(visibility: Visibility | None, features: Features, *, nested: bool) -> bool:
    """Whether a declaration can be used in other files, given what stands before it and the features of its file."""
    if visibility is not None:
        return visibility == "export"
    match features.default_symbol_visibility:
        case "EXPORT_ALL":
            return True
        case "EXPORT_TOP_LEVEL":
            return not nested
        case "LOCAL_ALL" | "STRICT":
            return False
        case _:
            assert_never(features.default_symbol_visibility)
