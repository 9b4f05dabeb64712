"""A framework that comes with another package: its folder is all that it needs."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import rosetta_jit
from rosetta_jit.frameworks.installed import shipped

FOLDER = {
    "toy/__init__.py": """
from rosetta_jit.frameworks.base import Framework

TOY = Framework(
    "toy",
    idl={".toy": "toy.idl:parse"},
    encodings={"toy": "toy.encoding:encode_type"},
    manners="toy.manners:TOYS",
    leniencies={"toy": {"magic": "any three bytes may come first (older toys)"}},
    byte_orders=("toy",),
    features="toy.features:PROBES",
)
""",
    "toy/idl.py": """
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.errors import SchemaError
from rosetta_jit.model.types import Field, Float, Schema, Struct
from rosetta_jit.source import Span


def parse(source, load):
    name, *fields = source.text.split()
    span = Span(source, 0, len(name))
    if not name.startswith("toy."):
        raise SchemaError((Diagnostic("error", "toy", "this is no toy", span, label="begins with `toy.`"),))
    return Schema({name: Struct(name, tuple(Field(each, Float(64), span=span) for each in fields), span=span)}, (source.name,))
""",
    "toy/encoding.py": """
from rosetta_jit.wire.codec import Constant, Encoding, Number, Padding, Seq


def encode_type(struct, schema, name, choices):
    order = "<" if choices.byte_order == "little" else ">"
    first = (Padding("u8", ord(each)) for each in "TOY") if "magic" in choices.lenient else (Constant((), b"TOY"),)
    codec = Seq((*first, *(Number((each.name,), "f64", order) for each in struct.fields)))
    return Encoding(name, (codec,), codec)
""",
    "toy/manners.py": """
from dataclasses import replace

from rosetta_jit.runtime.holder import PLAIN, Holder


class Toy(Holder):
    __slots__ = ()

    def total(self):
        return sum(self.to_dict().values())


TOYS = replace(PLAIN, base=Toy)
""",
    "toy/features.py": """
PROBES = {".toy": {"float64": "toy.Probe x", "namespace": "toy.Probe x", "map": "map.Probe x"}}
""",
    "toy-1.dist-info/METADATA": "Metadata-Version: 2.1\nName: toy\nVersion: 1\n",
    "toy-1.dist-info/entry_points.txt": "[rosetta_jit.frameworks]\ntoy = toy:TOY\n",
}

USE = {
    "pair.toy": "toy.pair left right",
    "wrong.toy": "game.pair left right",
    "pair.proto": 'syntax = "proto2"; package toy; message Sum { required double total = 1; }',
    "pair.mapping": """import "pair.toy"
import "pair.proto"
data-holder: toy.Sum
wire-schema: toy.pair
unpack-rules:
  .total = .left + .right
pack-rules:
  .left = .total - 1
  .right = 1
""",
    "pair.json": '{"total": 3.0}',
    "use.py": """
import rosetta_jit as rj

options = {"imports": ["pair.toy"], "search_path": ["."]}
decode, encode = rj.Decoder.of("toy.pair", **options), rj.Encoder.of("toy.pair", **options)
message = b"TOY" + bytes.fromhex("3ff0000000000000 4000000000000000")
holder = decode(message)
assert (holder.left, holder.right, holder.total()) == (1.0, 2.0, 3.0)
assert encode(holder) == message

little = rj.Encoder.of("toy.pair", byte_order="little", **options)
assert little(holder) == b"TOY" + bytes.fromhex("000000000000f03f 0000000000000040")

assert rj.Decoder("pair.mapping")(message).total == 3.0
to_pair = rj.Encoder("pair.mapping")
total = to_pair.holder_type.from_dict({"total": 3.0})
assert to_pair(total) == b"TOY" + bytes.fromhex("4000000000000000 3ff0000000000000")

assert rj.Decoder.of("toy.pair", lenient=["magic"], **options)(b"???" + bytes(16)).total() == 0
try:
    decode(b"???" + bytes(16))
except rj.DecodeError as error:
    assert error.kind == "constant"
else:
    raise AssertionError
""",
}


@pytest.fixture(scope="module")
def toys(tmp_path_factory):
    folder = tmp_path_factory.mktemp("toys")
    for name, text in {**{f"site/{each}": text for each, text in FOLDER.items()}, **USE}.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return folder


def run(folder, *command, fails=False, path=None):
    package = str(Path(rosetta_jit.__file__).parents[1])
    found = os.pathsep.join((str(path or folder / "site"), package))
    environment = {**os.environ, "PYTHONPATH": found, "ROSETTA_JIT_CACHE_DIR": str(folder / "cache")}
    done = subprocess.run([sys.executable, *command], cwd=folder, env=environment, capture_output=True, text=False, check=False)
    assert bool(done.returncode) == fails, done.stderr.decode()
    return done.stderr.decode() if fails else done.stdout


def test_decodes_and_encodes(toys):
    run(toys, "use.py")


DECODE = """
import rosetta_jit as rj

decode = rj.Decoder.of("toy.pair", imports=["pair.toy"], search_path=["."])
print(decode(b"TOY" + bytes.fromhex("3ff0000000000000 4000000000000000")).left)
"""


def test_a_program_of_another_version_is_not_used(toys, tmp_path):
    """The cache has no answer for a package whose files have changed, be it in a module beside the first, or that lies elsewhere now."""
    (toys / "decode.py").write_text(DECODE)
    encoding = toys / "site" / "toy" / "encoding.py"
    usual = encoding.read_text()
    try:
        assert run(toys, "decode.py") == b"1.0\n"
        encoding.write_text(usual.replace("struct.fields))", "reversed(struct.fields)))"))
        assert run(toys, "decode.py") == b"2.0\n"
    finally:
        encoding.write_text(usual)
    assert run(toys, "decode.py") == b"1.0\n"
    for name, text in FOLDER.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text.replace("struct.fields))", "reversed(struct.fields)))"))
    assert run(toys, "decode.py", path=tmp_path) == b"2.0\n"


def test_commands(toys):
    command = ("-m", "rosetta_jit")
    assert run(toys, *command, "check", "pair.mapping") == b""
    (toys / "pair.bin").write_bytes(run(toys, *command, "encode", "pair.mapping", "pair.json"))
    assert json.loads(run(toys, *command, "decode", "pair.mapping", "pair.bin", "--json")) == {"total": 3.0}


def test_mistakes_are_reported_at_their_place(toys):
    (toys / "wrong.mapping").write_text((toys / "pair.mapping").read_text().replace("pair.toy", "wrong.toy"))
    report = run(toys, "-m", "rosetta_jit", "check", "wrong.mapping", fails=True)
    assert "this is no toy" in report
    assert "wrong.toy:1:1" in report


def test_is_listed_with_what_it_can_describe(toys):
    listed = run(toys, "-m", "rosetta_jit", "frameworks", "toy").decode()
    assert "  encoding   toy  byte_order=little|big\n    lenient  magic: any three bytes" in listed
    table = json.loads(run(toys, "-m", "rosetta_jit", "frameworks", "toy", "--features", "--json"))["toy"]
    assert table["float64"] == {".toy": {"state": "yes"}, "toy": {"state": "yes"}}
    assert table["map"][".toy"] == {"state": "gap", "note": "this is no toy"}
    assert table["enum, open"] == {".toy": {"state": "none"}, "toy": {"state": "none"}}


def test_each_of_our_frameworks_is_declared_in_its_folder():
    folders = {path.parent.name for path in (Path(rosetta_jit.__file__).parent / "frameworks").glob("*/framework.py")}
    assert folders == {each.name for each in shipped()}


def test_nobody_else_knows_it():
    """Not one of our frameworks, and not a word about it outside its folder."""
    assert "toy" not in {each.name for each in shipped()}
    package = Path(rosetta_jit.__file__).parent
    assert not [path for path in package.rglob("*.py") if "toy" in path.read_text(encoding="utf-8").lower().split()]
