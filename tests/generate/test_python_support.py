"""A generated module has the definitions and imports that it uses, and no others."""

from __future__ import annotations

import ast
import builtins
import dis
from collections.abc import Iterator
from types import CodeType
from typing import Any

import pytest

from rosetta_jit.api.options import request_of, type_request
from rosetta_jit.generate.build import NO_WISHES, Wishes
from tests.generate.corpora import numbers_in_texts
from tests.generate.python import BOTH, module, protobuf, source_of
from tests.generate.test_c import CALLING, SUBJECTS

LISTS = protobuf("message M {" + "".join(f"repeated M m{n} = {n};" for n in range(1, 20)) + "}")
JOINTS = SUBJECTS["joints"][0]
ALWAYS = {"DecodeError", "EncodeError", "annotations"}
ASKED: dict[str, Any] = {
    **{name: (request, BOTH, NO_WISHES) for name, (request, _) in SUBJECTS.items()},
    "numpy": (JOINTS, BOTH, Wishes(numpy=True)),
    "many lists": (type_request("decode", "t.M", LISTS), BOTH, NO_WISHES),
    "decimals": (numbers_in_texts()[0], BOTH, NO_WISHES),
    "functions": (request_of("decode", {"schema": {"m.mapping": CALLING}, "encoding": "yarp3"}, mapping="m.mapping"), BOTH[:1], NO_WISHES),
    "nothing": (type_request("decode", "std_msgs/Empty", {"encoding": "ros1"}), BOTH, NO_WISHES),
}


@pytest.fixture(params=ASKED)
def asked(request):
    return ASKED[request.param]


def bound(statement: ast.stmt) -> list[str]:
    """The names that a statement of a module binds."""
    match statement:
        case ast.Import(names) | ast.ImportFrom(_, names):
            return [each.asname or each.name for each in names]
        case ast.FunctionDef(name) | ast.ClassDef(name):
            return [name]
        case _:
            return [each.id for each in ast.walk(statement) if isinstance(each, ast.Name) and isinstance(each.ctx, ast.Store)]


def global_names(code: CodeType) -> Iterator[str]:
    yield from (each.argval for each in dis.get_instructions(code) if each.opname == "LOAD_GLOBAL")
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from global_names(constant)


def test_what_it_does_not_use_is_not_there(asked):
    """Imports and private names: the others are there for who uses the module."""
    tree = ast.parse(source_of(*asked))
    used = {each.id for each in ast.walk(tree) if isinstance(each, ast.Name) and isinstance(each.ctx, ast.Load)} | ALWAYS
    imports = [each for each in tree.body if isinstance(each, ast.Import | ast.ImportFrom)]
    assert {name for each in imports for name in bound(each)} <= used
    assert {name for each in tree.body for name in bound(each) if name.startswith("_")} <= used


def test_what_it_uses_is_there(asked):
    unit, code = module(*asked), compile(source_of(*asked), "unit.py", "exec")
    assert {*global_names(code)} <= {*vars(unit), *dir(builtins)}
    assert issubclass(unit.DecodeError, unit.MessageError)
    assert issubclass(unit.EncodeError, unit.MessageError)
