"""Each wrong file has a report of its own, and protoc refuses it too."""

from __future__ import annotations

import pytest

from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.protobuf.idl import parse
from tests.frameworks.protobuf.proto_files import WRONG, load_from, names, protoc, source
from tests.golden import check_golden

EVERY = [name for name in names(WRONG) if not name.startswith("lib/")]
LEFT = [
    "edition_options2024.proto",
    "edition_reserved.proto",
    "edition_too_early.proto",
    "edition_visibility.proto",
    "enum_idle_alias.proto",
    "enum_prefix.proto",
    "reserved_name_syntax.proto",
]
"""Files with mistakes that change no byte: protoc tells them."""
FILES = [name for name in EVERY if name not in LEFT]


@pytest.mark.parametrize("name", FILES)
def test_report(name):
    with pytest.raises(SchemaError) as caught:
        parse(source(WRONG, name), load_from(WRONG))
    check_golden((WRONG / name).with_suffix(".err"), f"{caught.value}\n")


@pytest.mark.parametrize("name", LEFT)
def test_what_changes_no_byte_is_left_to_protoc(name):
    assert parse(source(WRONG, name), load_from(WRONG)).types


@pytest.mark.parametrize("name", EVERY)
def test_protoc_refuses_it_too(name, tmp_path, capfd):
    assert protoc(WRONG, name, tmp_path / "set") is None
    assert capfd.readouterr().err


def test_every_diagnostic_points_at_its_place():
    for name in FILES:
        with pytest.raises(SchemaError) as caught:
            parse(source(WRONG, name), load_from(WRONG))
        assert all(problem.span and problem.label for problem in caught.value.diagnostics)
