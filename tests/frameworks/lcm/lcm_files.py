"""Finding `.lcm` files for tests, and asking lcm-gen about them."""

from __future__ import annotations

import importlib
import re
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import lcm

from rosetta_jit.source import Source

if TYPE_CHECKING:
    from rosetta_jit.parsing.idl import Load

TESTS = Path(__file__).parents[2]
IDL = TESTS.parent / "idl"
VECTORS = TESTS / "vectors" / "lcm"
WRONG = TESTS / "golden" / "lcm"
STRICTER = WRONG / "stricter"
"""What lcm-gen takes, though its code would not compile or its messages never end."""

LCM_GEN = Path(lcm.__file__).parents[1] / "bin" / "lcm-gen"


def load_from(*folders: Path) -> Load:
    def load(path: str) -> Source | None:
        found = (folder / path for folder in folders)
        return next((Source(str(file), file.read_text("utf-8")) for file in found if file.is_file()), None)

    return load


def nothing(_path: str) -> Source | None:
    return None


def refused(*files: Path) -> bool:
    """Whether lcm-gen cannot read the files."""
    return subprocess.run([LCM_GEN, "-d", *files], capture_output=True, check=False).returncode != 0


def own_hashes(*files: Path) -> dict[str, int]:
    """The hashes of the structs' own fields, as lcm-gen prints them."""
    out = subprocess.run([LCM_GEN, "-d", *files], capture_output=True, check=True, text=True).stdout
    return {name: int(digits, 16) for name, digits in re.findall(r"^struct (\S+) \[hash=0x *([0-9a-f]+)\]", out, re.MULTILINE)}


class Generated:
    """The classes that lcm-gen writes for some files, by the qualified names of their types; those without a package are left out."""

    def __init__(self, folder: Path, *files: Path) -> None:
        subprocess.run([LCM_GEN, "-p", "--ppath", folder, *files], capture_output=True, check=True)
        self.packages = sorted({path.parent.relative_to(folder).parts[0] for path in folder.rglob("*.py") if path.parent != folder})
        self.folder = folder

    def __enter__(self):
        self._forget()
        sys.path.insert(0, str(self.folder))
        importlib.invalidate_caches()
        return self

    def __exit__(self, *_problem):
        sys.path.remove(str(self.folder))
        self._forget()

    def __getitem__(self, name: str):
        package, _, short = name.rpartition(".")
        return getattr(importlib.import_module(package), short)

    def _forget(self) -> None:
        for name in [name for name in sys.modules if name.split(".")[0] in self.packages]:
            del sys.modules[name]
