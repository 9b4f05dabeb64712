"""Calls of the language's functions: each record says what its calls become."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.language.function import functions

if TYPE_CHECKING:
    from rosetta_jit.language import typed
    from rosetta_jit.lowering.evaluation import Evaluation


def lowered(call: typed.Call, values: Evaluation) -> object:
    """The kernel expression of a number; of a text, where it lies; of the parts of a text, that text and what separates them."""
    return functions()[call.function].lower(call, values)
