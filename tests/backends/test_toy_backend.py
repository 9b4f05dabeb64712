"""A backend of another package: one value, found by an entry point. It only prints; what it prints runs."""

from __future__ import annotations

import os
import subprocess
import sys

TOY = """
from rosetta_jit.backends.backend import Backend
from rosetta_jit.kernel.interpret import run
from rosetta_jit.kernel.printer import to_text

RAN = []


def shout(kernel):
    return to_text(kernel).upper()


def echoing(kernel, functions):
    def call(*arguments):
        RAN.append(kernel.name)
        return run(kernel, *arguments, functions=functions)

    return call


ECHO = Backend("echo", runner="echoes:echoing", text="echoes:shout")
"""

FILES = {
    "site/echoes.py": TOY,
    "site/echoes-1.dist-info/METADATA": "Metadata-Version: 2.1\nName: echoes\nVersion: 1\n",
    "site/echoes-1.dist-info/entry_points.txt": "[rosetta_jit.backends]\necho = echoes:ECHO\n",
    "w.bottle-schema": '"w" (("x" :int) ("y" :double))',
    "use.py": """
import echoes
import rosetta_jit as rj

options = {"imports": ["w.bottle-schema"], "search_path": ["."], "encoding": "yarp4"}
decode, encode = (make.of("w", backend="echo", **options) for make in (rj.Decoder, rj.Encoder))
message = encode(encode.holder_type.from_dict({"x": 3, "y": 0.5}))
assert message == rj.Encoder.of("w", backend="interpreter", **options)(decode(message))
assert len(echoes.RAN) >= 3
assert "REQUIRE" in decode.stage("echo")
try:
    rj.Decoder.of("w", backend="echos", **options)
except rj.SchemaError as error:
    assert "there are echo, numba, llvm, python, interpreter" in str(error), error
else:
    raise AssertionError
try:
    decode.stage("interpreter")
except ValueError as error:
    assert "no stage `interpreter`" in str(error)
else:
    raise AssertionError
""",
}


def test_a_backend_of_another_package(tmp_path):
    for name, text in FILES.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    environment = {**os.environ, "PYTHONPATH": str(tmp_path / "site"), "ROSETTA_JIT_CACHE_DIR": str(tmp_path / "cache")}
    done = subprocess.run([sys.executable, "use.py"], cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert not done.returncode, done.stderr
