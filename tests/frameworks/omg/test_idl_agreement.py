"""omniidl and we read the same out of a file."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from rosetta_jit.frameworks.omg.idl import parse
from rosetta_jit.source import Source
from tests.frameworks.omg.as_ast import ours, theirs
from tests.frameworks.omg.idl_files import AGREED, IDL, OPENRTM, RECORDS, RJ, names, needs_omniidl, omniidl, source
from tests.frameworks.omg.idl_files import load_from as load


def test_the_tree_of_the_vectors():
    text = RJ + '\n#include "InterfaceDataTypes.idl"\n'
    schema = parse(Source("rj.idl", text), load(IDL))
    assert ours(schema) == theirs(RECORDS["ast"])


def test_shipped_files_find_each_other():
    for folder in (IDL, OPENRTM):
        schema = parse(source(OPENRTM, "InterfaceDataTypes.idl"), load(folder))
        assert {"RTC::RangeData", "RTC::TimedPose3D", "RTC::TimedLong"} <= schema.types.keys()
        assert len(schema.sources) == 3


def their_tree(path, *folders):
    here = str(__file__).rpartition("/")[0]
    done = omniidl(f"-p{here}", "-bdump_ast", *(f"-I{folder}" for folder in folders), path)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@needs_omniidl
@pytest.mark.parametrize("name", sorted(path.name for path in OPENRTM.glob("*.idl")))
def test_openrtm(name):
    assert ours(parse(source(OPENRTM, name), load(OPENRTM))) == theirs(their_tree(OPENRTM / name, OPENRTM))


@needs_omniidl
@pytest.mark.parametrize("name", names(AGREED))
def test_small_files(name):
    assert ours(parse(source(AGREED, name), load())) == theirs(their_tree(AGREED / name))


STANDARD = Path("/usr/share/idl/omniORB")


@needs_omniidl
@pytest.mark.skipif(not STANDARD.exists(), reason="omniorb-idl is not installed")
@pytest.mark.parametrize("name", ["CosNaming.idl", "ir.idl", "COS/CosTransactions.idl", "COS/CosQuery.idl"])
def test_files_of_omniorb(name):
    """What neither has a model for is left out by us alone."""
    path = next(each for each in (STANDARD / name, STANDARD / "COS" / name) if each.exists())
    mine = ours(parse(Source(name, path.read_text("latin-1")), load(STANDARD, STANDARD / "COS")))
    theirs_too = theirs(their_tree(path, STANDARD, STANDARD / "COS"))
    common = mine.keys() & theirs_too.keys()
    assert common
    assert {key: mine[key] for key in common} == {key: theirs_too[key] for key in common}
