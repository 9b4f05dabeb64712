"""Finding `.idl` files for tests, and asking omniidl about them."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path

import pytest

from rosetta_jit.source import Source

TESTS = Path(__file__).parents[2]
IDL = TESTS.parent / "idl"
OPENRTM = IDL / "openrtm"
WRONG = TESTS / "golden" / "idl"
AGREED = TESTS / "vectors" / "idl"
ROSIDL = TESTS / "vectors" / "rosidl"
RECORDS = json.loads((TESTS / "vectors" / "corba" / "records.json").read_text("utf-8"))
RJ = RECORDS["definitions"]["rj.idl"]

needs_omniidl = pytest.mark.skipif(shutil.which("omniidl") is None, reason="omniidl is not installed")


def load_from(*folders, **texts):
    def load(path):
        if path in texts:
            return Source(path, texts[path])
        found = (folder / path for folder in folders)
        return next((Source(path, file.read_text("utf-8")) for file in found if file.is_file()), None)

    return load


def names(folder):
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*.idl"))


def source(folder, name):
    return Source(name, (folder / name).read_text("utf-8"))


def omniidl(*arguments):
    return subprocess.run(["omniidl", *map(str, arguments)], capture_output=True, text=True, timeout=60, check=False)
