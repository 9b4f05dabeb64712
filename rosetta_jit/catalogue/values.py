"""What can be wrong with the values that `rosetta-jit encode` is given."""

from __future__ import annotations

from rosetta_jit.diagnostics import Diagnostic, error


def no_json(place: str, reason: str) -> Diagnostic:
    return error("values-json", f"{place}: not a JSON object: {reason}", help_="`rosetta-jit decode --json` prints what is expected here")


def several_messages(count: int) -> Diagnostic:
    return error("values-count", f"{count} messages do not make one file", help_="name a recording as output: -o OUT.rec or -o OUT.rec.xz")
