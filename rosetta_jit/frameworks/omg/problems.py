"""What goes wrong where a name or a value is looked up, on its way to the declaration that reports it."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rosetta_jit.diagnostics import Diagnostic


class LookupProblem(Exception):  # noqa: N818  it is caught by the declaration around it, and is no error of ours
    """A name does not mean what is wanted; ``problem`` says why."""

    def __init__(self, problem: Diagnostic) -> None:
        super().__init__(problem.message)
        self.problem = problem
