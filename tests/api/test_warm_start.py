"""A process that finds its kernel in the cache imports neither numba nor a parser nor the compiler."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

PROGRAM = """
import struct, sys, warnings
warnings.simplefilter("error" if sys.argv[1] == "quiet" else "always")
import rosetta_jit as rj
decode = rj.Decoder("yarp/icub/torso_state.mapping", encoding="yarp3")
angles = decode(struct.pack("<ii3d", 266, 3, 180, 0, 0)).angles
assert abs(angles[0] - 3.14159) < 1e-4, angles
heavy = ("numba", "lark", "rosetta_jit.pipeline.build", "rosetta_jit.model.expr", "rosetta_jit.lowering.lower", "google.protobuf")
print(*[name for name in heavy if name in sys.modules])
print("llvmlite.binding" in sys.modules, file=sys.stderr)
"""


OWN = (
    'import "rst/kinematics/JointAngles.proto"\nimport "yarp/icub/torso_state.bottle-schema"\n'
    "data-holder: rst.kinematics.JointAngles\nwire-schema: yarp.icub.torso.state\n"
    "unpack-rules:\n  len(.angles) = 1\n  .angles[0] = float32(radians(.yaw))\n"
)


def start(folder, mode="quiet"):
    environment = {**os.environ, "ROSETTA_JIT_CACHE_DIR": str(folder)}
    return subprocess.run([sys.executable, "-c", PROGRAM, mode], env=environment, check=True, capture_output=True, text=True)


def test_the_second_process_compiles_nothing(tmp_path):
    assert "rosetta_jit.lowering.lower" in start(tmp_path / "cache").stdout
    assert start(tmp_path / "cache").stdout.split() == []


@pytest.mark.skipif(sys.platform != "linux" or os.uname().machine != "x86_64", reason="other systems have no prelinked code")
def test_the_second_process_needs_no_llvm(tmp_path):
    assert start(tmp_path / "cache").stderr.split() == ["True"]
    assert start(tmp_path / "cache").stderr.split() == ["False"]


DECODES = """
import struct, sys
import rosetta_jit as rj
rj.Decoder("yarp/icub/torso_state.mapping", encoding="yarp3")(struct.pack("<ii3d", 266, 3, 180, 0, 0))
late = ["batch", "columns", *(f"holder.{name}" for name in ("access", "arena", "coerce", "grid", "merge", "paths", "undo", "values"))]
print(*[name for name in late if f"rosetta_jit.runtime.{name}" in sys.modules])
"""


def test_the_second_process_imports_nothing_that_compiled_code_replaces(tmp_path):
    environment = {**os.environ, "ROSETTA_JIT_CACHE_DIR": str(tmp_path / "cache")}
    start(tmp_path / "cache")
    ran = subprocess.run([sys.executable, "-c", DECODES], env=environment, check=True, capture_output=True, text=True)
    assert ran.stdout.split() == []


BARE = """
import sys
import numpy
before = set(sys.modules)
import rosetta_jit as rj
rj.Decoder("yarp/icub/torso_state.mapping", encoding="yarp3")
unused = ["copy", "dataclasses", "fnmatch", "json", "mmap"]
protobuf = [f"frameworks.protobuf.{name}" for name in ("introspection", "objects", "repeated")]
holder = [f"runtime.holder.{name}" for name in ("dictionary", "sequence", "objects.foreign")]
rooms = ["api.cacheable", "frameworks.base", "runtime.message_spans", "runtime.on_demand", *protobuf, *holder]
print(*sorted({*unused, *(f"rosetta_jit.{name}" for name in rooms)} & (set(sys.modules) - before)))
"""


@pytest.mark.skipif(sys.platform != "linux" or os.uname().machine != "x86_64", reason="other systems have no prelinked code")
def test_the_second_process_imports_nothing_that_its_type_has_no_use_for(tmp_path):
    environment = {**os.environ, "ROSETTA_JIT_CACHE_DIR": str(tmp_path / "cache")}
    start(tmp_path / "cache")
    ran = subprocess.run([sys.executable, "-c", BARE], env=environment, check=True, capture_output=True, text=True)
    assert ran.stdout.split() == []


MANNERS = """
import sys
import rosetta_jit.frameworks.corba.manners, rosetta_jit.frameworks.lcm.manners, rosetta_jit.frameworks.protobuf.manners
import rosetta_jit.frameworks.ros1.manners, rosetta_jit.frameworks.ros2.manners, rosetta_jit.frameworks.yarp.manners
print(*[name for name in sys.modules if name.startswith("rosetta_jit.") and name.endswith((".idl", ".reading", ".encoding", ".parse"))])
"""


def test_holders_need_no_front_end():
    ran = subprocess.run([sys.executable, "-c", MANNERS], check=True, capture_output=True, text=True)
    assert ran.stdout.split() == []


def test_no_process_imports_numba_unless_it_is_asked_for(tmp_path):
    assert "numba" not in start(tmp_path / "cache").stdout.split()


@pytest.mark.parametrize("harm", ["cut", "altered", "open to others"])
def test_a_harmed_cache_costs_a_warning(tmp_path, harm):
    folder = tmp_path / "cache"
    start(folder)
    for kernel in folder.glob("*.kernel"):
        data = kernel.read_bytes()
        match harm:
            case "cut":
                kernel.write_bytes(data[: len(data) // 2])
            case "altered":
                kernel.write_bytes(data[:-100] + bytes(100))
            case _:
                folder.chmod(0o777)
    ran = start(folder, "loud")
    assert "CacheWarning" in ran.stderr
    assert "rosetta_jit.lowering.lower" in ran.stdout


def test_a_changed_mapping_is_compiled_again(tmp_path):
    program = PROGRAM.replace('"yarp/icub/torso_state.mapping"', '"own.mapping"')
    text = OWN
    environment = {**os.environ, "ROSETTA_JIT_CACHE_DIR": str(tmp_path / "cache")}

    def run():
        return subprocess.run(
            [sys.executable, "-c", program, "quiet"], env=environment, cwd=tmp_path, capture_output=True, text=True, check=False
        )

    (tmp_path / "own.mapping").write_text(text)
    assert run().returncode == 0
    assert run().stdout.split() == []
    (tmp_path / "own.mapping").write_text(text.replace(".yaw", ".roll"))
    assert "array([0.]" in run().stderr or "AssertionError" in run().stderr


UNUSED = """
import sys
import numpy, llvmlite.binding
before = set(sys.modules)
import rosetta_jit as rj
rj.Decoder("own.mapping", encoding="yarp3")
codec = (f"lowering.codec.{name}" for name in ("tagged", "recursion_write", "descent", "xcdr2_members"))
rules = (f"lowering.rules.{name}" for name in ("filters", "putting", "reductions", "shares"))
resolve = (f"language.resolve.{name}" for name in ("coerced_values", "key_search", "rest", "same_names"))
words = ("frameworks.protobuf.diagnostics", "frameworks.yarp.bottle_diagnostics", "catalogue.pipeline")
rooms = ("language.both_ways.packing", "language.laws.guarantees", "language.parse.unit_file", *codec, *rules, *resolve, *words)
unused = {"lark", "numba", "difflib", "fractions", "pint", "PIL", *(f"rosetta_jit.{name}" for name in rooms)}
print(*sorted(unused & (set(sys.modules) - before)))
"""


def test_a_compile_imports_of_the_compiler_what_the_mapping_needs(tmp_path):
    (tmp_path / "own.mapping").write_text(OWN)
    environment = {**os.environ, "ROSETTA_JIT_CACHE": "off"}
    ran = subprocess.run([sys.executable, "-c", UNUSED], env=environment, cwd=tmp_path, capture_output=True, text=True, check=True)
    assert ran.stdout.split() == []


TYPES = """
import sys
import rosetta_jit as rj
encoding, type, name, text = sys.argv[1:]
for make in (rj.Decoder, rj.Encoder):
    make.of(type, encoding=encoding, schema={name: text})
rooms = ("language", "lowering.mapped", "lowering.rules", "functions")
loaded = [name.removeprefix("rosetta_jit.") for name in sys.modules if name.startswith("rosetta_jit.")]
print(*[name for name in loaded if name.startswith(tuple(f"{room}." for room in rooms)) or name in rooms])
"""


@pytest.mark.parametrize(
    ("encoding", "type_", "name", "text"),
    [
        ("ros1", "a/One", "a/msg/One.msg", "float64 x\nstring[] names\n"),
        ("cdr", "a/msg/One", "a/msg/One.msg", "float64 x\nstring[] names\n"),
        ("lcm", "a.One", "a.lcm", "package a; struct One { double x; string name; }"),
        ("protobuf", "a.One", "a.proto", 'syntax = "proto3"; package a; message One { double x = 1; repeated string names = 2; }'),
        ("yarp4", "one", "one.bottle-schema", '"one" (("x" :double) ("name" :string))'),
    ],
)
def test_a_type_without_a_mapping_imports_no_language(encoding, type_, name, text):
    """A third of what a first program takes would be the import of that."""
    environment = {**os.environ, "ROSETTA_JIT_CACHE": "off"}
    command = [sys.executable, "-c", TYPES, encoding, type_, name, text]
    ran = subprocess.run(command, env=environment, check=True, capture_output=True, text=True)
    assert ran.stdout.split() == []


NAMELESS = """
import rosetta_jit as rj
from rosetta_jit.runtime.cache import names
def refuse(): raise AssertionError("nobody needs a name")
names._package_digest = refuse
rj.Decoder("yarp/icub/torso_state.mapping", encoding="yarp3")
rj.Decoder.of("geometry_msgs/Point", encoding="ros1")
rj.Encoder.of("rst.kinematics.JointAngles", encoding="protobuf")
"""


def test_where_nothing_is_kept_the_files_of_the_package_are_not_looked_at():
    environment = {**os.environ, "ROSETTA_JIT_CACHE": "off"}
    subprocess.run([sys.executable, "-c", NAMELESS], env=environment, check=True)
