"""What can be wrong with the values that `rosetta-jit encode` is given."""

from __future__ import annotations

from rosetta_jit.diagnostics import Diagnostic


def no_json(place: str, reason: str) -> Diagnostic:
    """A document that is not a JSON object."""
    return Diagnostic(
        "error", "values-json", f"{place}: not a JSON object: {reason}", help="`rosetta-jit decode --json` prints what is expected here"
    )


def several_messages(count: int) -> Diagnostic:
    """A plain file holds exactly one message."""
    return Diagnostic(
        "error",
        "values-count",
        f"{count} messages do not make one file",
        help="name a recording as output: -o OUT.rec or -o OUT.rec.xz",
    )
