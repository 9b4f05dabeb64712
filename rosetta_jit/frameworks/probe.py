"""Probes: small texts that each need a feature of an IDL."""

from __future__ import annotations

from collections.abc import Mapping

from rosetta_jit.startup.dataclass import dataclass, field


@dataclass(frozen=True, slots=True)
class Probe:
    """A text in some IDL. ``files`` are what it imports; ``file`` is what it is called; ``declares`` is the last part of the type's name.

    ``without`` are the encodings of the framework that have nothing of the kind, and rightly refuse it.
    """

    text: str
    files: Mapping[str, str] = field(default_factory=dict[str, str])
    file: str = ""
    without: tuple[str, ...] = ()
    declares: str = "Probe"


Probes = Mapping[str, Mapping[str, str | Probe]]
"""For each suffix of an IDL, and each of its features, a probe."""
