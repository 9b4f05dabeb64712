"""Programs that import generated Python are checked by their types, strictly; the modules give type checkers no cause to complain."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from rosetta_jit.api.options import type_request
from rosetta_jit.generate.build import generated
from tests.generate.python import BOTH

CHECKER = shutil.which("basedpyright", path=str(Path(sys.executable).parent))

HAND = """syntax = "proto3"; package h; message Pad { repeated float taxels = 1; }
message Hand { map<string, Pad> pads = 1; oneof last { string hot = 2; Pad touched = 3; } repeated sint32 ticks = 4; Hand other = 5; }"""

PROGRAM = """import hand
from hand import DecodeError, Hand, Pad


def taxels(data: bytes) -> list[float]:
    try:
        pads: dict[str, Pad] = hand.decode(data).pads
    except DecodeError as error:
        where: tuple[str, int | None] = (error.path, error.offset)
        print(where)
        return []
    return [taxel for pad in pads.values() for taxel in pad.taxels]


data: bytes = hand.encode(Hand(last=("hot", "left"), ticks=[1, 2], other=Hand()))
Hand(ticks="many")
hand.decode(data).other.ticks
"""


@pytest.mark.campaign
@pytest.mark.skipif(CHECKER is None, reason="basedpyright is not installed")
def test_types_are_there_for_who_imports_a_module(tmp_path):
    """Two lines of the program are wrong: a text that is no list, and a message that may be absent."""
    assert CHECKER is not None
    request = type_request("decode", "h.Hand", {"encoding": "protobuf", "schema": {"h.proto": HAND}})
    (tmp_path / "hand.py").write_text(generated(request, "python", BOTH, "hand")["hand.py"])
    (tmp_path / "program.py").write_text(PROGRAM)
    (tmp_path / "pyrightconfig.json").write_text('{"typeCheckingMode": "strict"}')
    command = [CHECKER, "--outputjson", "--pythonpath", sys.executable]
    found = json.loads(subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False).stdout)
    said = {(Path(each["file"]).name, PROGRAM.splitlines()[each["range"]["start"]["line"]]) for each in found["generalDiagnostics"]}
    assert said == {("program.py", 'Hand(ticks="many")'), ("program.py", "hand.decode(data).other.ticks")}
