"""LCM's generated Python, as the lcm-gen of its package writes it."""

from __future__ import annotations

import importlib
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from bench.peers.base import Peer

if TYPE_CHECKING:
    from bench.subjects import Subject

IDL = Path(__file__).resolve().parents[2] / "idl" / "lcm"


def peers(subject: Subject) -> tuple[Peer, ...]:
    if subject.encoding != "lcm":
        return ()
    made = _generated(subject.type)
    return (Peer("lcm (lcm-gen's Python)", "an object, anew; a tuple of numbers", made.decode, made.encode),)


def lcm_gen() -> Path:
    """The program that the package brings."""
    import lcm

    return Path(lcm.__file__).parents[1] / "bin" / "lcm-gen"


def _generated(name: str) -> Any:
    package, _, type_ = name.partition(".")
    with TemporaryDirectory() as folder:
        subprocess.run([lcm_gen(), "-p", "--ppath", folder, IDL / package / f"{type_}.lcm"], check=True, capture_output=True)
        sys.path.insert(0, folder)
        try:
            return getattr(importlib.import_module(package), type_)
        finally:
            sys.path.remove(folder)
