"""A framework that comes with another package: its folder is all that it needs."""

from __future__ import annotations

import os
import subprocess
import sys

FOLDER = {
    "toy/__init__.py": """
from rosetta_jit.frameworks.base import Framework

TOY = Framework("toy", idl={".toy": "toy.idl:parse"}, encodings={"toy": "toy.encoding:encode_type"}, manners="toy.manners:MANNERS")
""",
    "toy/idl.py": """
from rosetta_jit.model.types import Field, Float, Schema, Struct
from rosetta_jit.source import Span


def parse(source, load):
    name, *fields = source.text.split()
    span = Span(source, 0, len(name))
    return Schema({name: Struct(name, tuple(Field(each, Float(64), span=span) for each in fields), span=span)}, (source.name,))
""",
    "toy/encoding.py": """
from rosetta_jit.wire.codec import Constant, Encoding, Number, Seq


def encode_type(struct, schema, name, choices):
    codec = Seq((Constant((), b"TOY"), *(Number((each.name,), "f64", ">") for each in struct.fields)))
    return Encoding(name, (codec,), codec)
""",
    "toy/manners.py": """
from dataclasses import replace

from rosetta_jit.runtime.holder import PLAIN, Holder


class Toy(Holder):
    __slots__ = ()

    def total(self):
        return sum(self.to_dict().values())


MANNERS = replace(PLAIN, base=Toy)
""",
    "toy-1.dist-info/METADATA": "Metadata-Version: 2.1\nName: toy\nVersion: 1\n",
    "toy-1.dist-info/entry_points.txt": "[rosetta_jit.frameworks]\ntoy = toy:TOY\n",
    "types/pair.toy": "toy.pair left right",
    "types/pair.proto": 'syntax = "proto2"; package toy; message Sum { required double total = 1; }',
    "types/pair.mapping": """import "pair.toy"
import "pair.proto"
data-holder: toy.Sum
wire-schema: toy.pair
unpack-rules:
  .total = .left + .right
""",
    "run.py": """
import rosetta_jit as rj

options = {"search_path": ["types"], "imports": ["pair.toy"]}
decode, encode = rj.Decoder.of("toy.pair", **options), rj.Encoder.of("toy.pair", **options)
holder = decode(b"TOY" + bytes.fromhex("3ff0000000000000 4000000000000000"))
assert (holder.left, holder.right, holder.total()) == (1.0, 2.0, 3.0)
assert encode(holder)[:3] == b"TOY"
assert rj.Decoder("types/pair.mapping", search_path=["types"])(encode(holder)).total == 3.0
""",
}


def test_nothing_outside_its_folder_is_touched(tmp_path):
    for name, text in FOLDER.items():
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
    environment = {**os.environ, "PYTHONPATH": str(tmp_path), "ROSETTA_JIT_CACHE_DIR": str(tmp_path / "cache")}
    run(["run.py"], tmp_path, environment)
    assert "toy\n  reads      .toy\n  encoding   toy" in run(["-m", "rosetta_jit", "frameworks", "toy"], tmp_path, environment)
    run(["-m", "rosetta_jit", "check", "types/pair.mapping"], tmp_path, environment)


def run(command, folder, environment):
    done = subprocess.run([sys.executable, *command], cwd=folder, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout
