"""The ROS definitions at hand, and the peers' own parsers where they are installed."""

from __future__ import annotations

import json
import sys
from functools import cache
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

import pytest

from rosetta_jit.frameworks.ros1 import idl as ros1
from rosetta_jit.frameworks.ros2 import idl as ros2
from rosetta_jit.parsing.search import SearchPath
from rosetta_jit.source import Source

TESTS = Path(__file__).parents[2]
IDL = TESTS.parent / "idl"
VECTORS = TESTS / "vectors" / "ros"
GOLDEN = TESTS / "golden"
DEBIAN = Path("/usr/lib/python3/dist-packages")
SHIPPED = SearchPath.of(environment={})
PARSE = {"ros1": ros1.parse, "ros1-2012": ros1.parse, "ros2": ros2.parse}


def files(folder):
    return sorted((IDL / folder).rglob("*.msg"))


def name_of(path):
    parts = path.relative_to(IDL).with_suffix("").parts
    return "/".join(parts[1:])


def load_shipped(source):
    return lambda name: SHIPPED.find(name, source)


@cache
def shipped(path):
    """The schema of a shipped file."""
    source = Source(str(path), path.read_text("utf-8"))
    return PARSE[path.relative_to(IDL).parts[0]](source, load_shipped(source))


def alone(text, name="pkg/Foo.msg", dialect="ros1", others=None):
    """The schema of a text; ``others`` are the files that it can load."""
    return PARSE[dialect](
        Source(name, text), lambda asked: Source(asked, others[asked]) if others is not None and asked in others else None
    )


@cache
def ros1_vectors():
    return json.loads((VECTORS / "ros1.json").read_text("utf-8"))


def debian(package, module):
    """A module of a Debian package, which need not be on the path of this Python."""
    place = DEBIAN / package
    if not place.is_dir():
        pytest.skip(f"Debian's {package} is not installed")
    if package not in sys.modules:
        for name, path in ((package, place / "__init__.py"), (f"{package}.{module}", place / f"{module}.py")):
            spec = spec_from_file_location(name, path, submodule_search_locations=[str(place)] if name == package else None)
            sys.modules[name] = module_from_spec(spec)
            spec.loader.exec_module(sys.modules[name])
    return sys.modules[f"{package}.{module}"]
