"""Each function of the language is one record: none of its parts is missing, and a record from outside is a function like ours."""

from __future__ import annotations

import os
import subprocess
import sys
from importlib import import_module

import pytest

from rosetta_jit.language.function import SEVERAL, Affine, NotFollowed, Numbers, Texts, Undone
from rosetta_jit.language.installed import GROUPS, OURS, functions, shipped

RECORDS = pytest.mark.parametrize("function", shipped(), ids=lambda each: each.name)


@RECORDS
def test_no_part_is_missing(function):
    assert isinstance(function.signature, Numbers | Texts) or callable(function.signature)
    assert callable(function.lower)
    assert isinstance(function.law, Affine | Undone | NotFollowed)
    assert function.rows
    assert all(row.forms and len(row.cells) == 2 and any(row.cells) for row in function.rows)


@RECORDS
def test_its_row_names_it(function):
    forms = " ".join(row.forms for row in function.rows)
    within = (
        "int8_at"
        if function.name.endswith("_at") and "int" in function.name
        else "=="
        if function.name == "<=>"
        else function.name.partition(".")[0]
    )
    assert within in forms


@RECORDS
def test_has_an_inverse_or_says_why_not(function):
    """What can be turned round is followed: else nothing could be said of what comes back."""
    if isinstance(function.inverse, str):
        assert function.inverse == SEVERAL
    else:
        assert isinstance(function.law, Affine) or (isinstance(function.law, Undone) and function.law.by)


@RECORDS
def test_what_it_names_is_there(function):
    if isinstance(function.law, Undone):
        assert set(function.law.by) <= functions().keys()
    if function.whole is not None:
        assert function.whole.rest in functions()


@pytest.mark.parametrize("family", OURS)
def test_the_table_says_which_module_has_which_functions(family):
    module = import_module(f"rosetta_jit.functions.{family}")
    groups = module.GROUP_FUNCTIONS if family in GROUPS else ()
    names = {each.name.partition(".")[0] for each in (*module.FUNCTIONS, *groups)}
    assert names == set(OURS[family])
    assert all(functions()[each.name] is each for each in module.FUNCTIONS)


def test_a_family_is_imported_when_one_of_its_functions_is_looked_up():
    program = """
import sys
from rosetta_jit.language.installed import functions, written
def imported():
    return {name.rpartition(".")[2] for name in sys.modules if name.startswith("rosetta_jit.functions.")}
assert written("sine") is None and "nothing" not in functions() and not imported()
assert written("crc").name == "crc" and "checksums" in imported() and not {"utm", "angles"} & imported()
assert "euler.roll" in functions() and "euler.rol" not in functions() and "rotations" in imported()
assert len(functions()) == len(list(functions())) and "utm" in imported()
"""
    subprocess.run([sys.executable, "-c", program], check=True)


def test_no_two_have_one_name():
    assert len({each.name for each in shipped()}) == len(shipped())


TOY = """
from dataclasses import replace

from rosetta_jit.kernel.terms import index
from rosetta_jit.language.affine_steps import rounded, scaled, shifted
from rosetta_jit.language.function import Affine, Function, Numbers, Row
from rosetta_jit.language.typed import INT64
from rosetta_jit.lowering.arithmetic import binary
from rosetta_jit.model.expr import Call


def lower(call, values):
    return binary(values.writer, "-", index(100), values.of(call.arguments[0]), values.where, values.line)


def inverse(call, value):
    return call.arguments[0], Call("mirrored", (value,), call.span)


def follow(call, value):
    return rounded(replace(shifted(scaled(value, -1), 100), type=call.type), 1)


MIRRORED = Function(
    "mirrored",
    Numbers((INT64,), fold=lambda numbers: 100 - numbers[0]),
    lower,
    inverse,
    Affine(follow, exact=True),
    (Row("numbers", "`mirrored(x)`", ("an integer", "int64: `100 - x`")),),
)
"""

FILES = {
    "site/mirrors.py": TOY,
    "site/mirrors-1.dist-info/METADATA": "Metadata-Version: 2.1\nName: mirrors\nVersion: 1\n",
    "site/mirrors-1.dist-info/entry_points.txt": "[rosetta_jit.functions]\nmirrored = mirrors:MIRRORED\n",
    "w.bottle-schema": '"w" (("x" :int))',
    "h.proto": 'syntax = "proto2"; message H { required int64 a = 1; required int64 b = 2; }',
    "m.mapping": 'import "w.bottle-schema"\nimport "h.proto"\ndata-holder: H\nwire-schema: w\n'
    "rules:\n  .a <-> mirrored(.x) + 1\n  .b <-> mirrored(97)\n",
    "wrong.mapping": 'import "w.bottle-schema"\nimport "h.proto"\ndata-holder: H\nwire-schema: w\nrules:\n  .a <-> mirored(.x)\n',
    "use.py": """
import rosetta_jit as rj

plain = {"imports": ["w.bottle-schema"], "search_path": ["."], "encoding": "yarp4", "backend": "interpreter"}
laws = rj.check("m.mapping").laws
assert (laws.messages.kind, laws.holders.kind) == ("exact", "exact"), laws
for backend in ("llvm", "numba", "python", "interpreter"):
    decode = rj.Decoder("m.mapping", encoding="yarp4", backend=backend)
    encode = rj.Encoder("m.mapping", encoding="yarp4", backend=backend)
    message = encode(encode.holder_type.from_dict({"a": 59, "b": 3}))
    assert decode(message).to_dict() == {"a": 59, "b": 3}
    assert rj.Decoder.of("w", **plain)(message).x == 42
try:
    rj.check("wrong.mapping")
except rj.MappingError as error:
    assert "did you mean `mirrored`" in str(error)
else:
    raise AssertionError
""",
}


def test_a_function_of_another_package(tmp_path):
    """One record, in one file: its inverse, its law, and code in every backend."""
    for name, text in FILES.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    environment = {**os.environ, "PYTHONPATH": str(tmp_path / "site"), "ROSETTA_JIT_CACHE_DIR": str(tmp_path / "cache")}
    done = subprocess.run([sys.executable, "use.py"], cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert not done.returncode, done.stderr
