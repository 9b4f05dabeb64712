"""Readers of formats that installed packages offer, and that nobody pays for them where none does."""

from __future__ import annotations

import os
import subprocess
import sys

from .made import write_mcap

TOY = """
import numpy as np
from rosetta_jit.logs.base import Connection, Extent, Format, Piece
from rosetta_jit.logs.reading.blocks import blocks_of

FORMAT = Format("toy", (".toy",), "toy_logs:ToyReader", b"TOY ")

class ToyReader:
    def __init__(self, storage, tell, *, check):
        self._data = storage.read(4, storage.size)
        self.connections = {0: Connection(0, "/x", "std_msgs/UInt8", "ros1", count=len(self._data))}
        self.extent, self.facts, self.pieces = Extent(0, len(self._data) - 1), {}, (Piece(storage.size),)

    def blocks(self, wanted):
        return blocks_of((0, number, number, bytes([each])) for number, each in enumerate(self._data))
"""


def run(program, *arguments, path=""):
    surroundings = os.environ | {"PYTHONPATH": f"{path}{os.pathsep}{os.environ.get('PYTHONPATH', '')}"}
    return subprocess.run([sys.executable, "-c", program, *arguments], env=surroundings, check=True, capture_output=True, text=True).stdout


def test_a_package_offers_a_reader(tmp_path):
    (tmp_path / "toy_logs.py").write_text(TOY)
    (tmp_path / "toy_logs-1.0.dist-info").mkdir()
    (tmp_path / "toy_logs-1.0.dist-info" / "METADATA").write_text("Metadata-Version: 2.1\nName: toy_logs\nVersion: 1.0\n")
    (tmp_path / "toy_logs-1.0.dist-info" / "entry_points.txt").write_text("[rosetta_jit.logs]\ntoy = toy_logs:FORMAT\n")
    (tmp_path / "a.toy").write_bytes(b"TOY \x01\x02\x03")
    program = "import sys, rosetta_jit as rj; log = rj.open(sys.argv[1]); print(log.format, log['/x'].count, log['/x']['data'].tolist())"
    assert run(program, str(tmp_path / "a.toy"), path=str(tmp_path)) == "toy 3 [1, 2, 3]\n"


def test_where_no_package_offers_a_reader_none_is_looked_for(tmp_path):
    """`importlib.metadata` would bring `email`, `zipfile` and `socket` with it."""
    path = write_mcap(tmp_path / "a.mcap", 3)
    program = "import sys, rosetta_jit as rj; print(rj.open(sys.argv[1]).topics, 'importlib.metadata' in sys.modules)"
    assert run(program, str(path)) == "('/a', '/b') False\n"
