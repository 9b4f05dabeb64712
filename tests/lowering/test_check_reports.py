"""Every wrong mapping in tests/golden/mapping gives the report beside it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from rosetta_jit.errors import MappingError
from rosetta_jit.frameworks.base import Readers, installed
from rosetta_jit.frontend.mapping import parse
from rosetta_jit.frontend.search import SearchPath
from rosetta_jit.lowering.check import check
from rosetta_jit.source import Source
from tests.golden import GOLDEN, check_golden

if TYPE_CHECKING:
    from pathlib import Path


FOLDER = GOLDEN / "mapping"
FRONT_ENDS = Readers({name: installed()[name] for name in ("yarp", "protobuf")})
FILES = {path.name: path.read_text() for path in FOLDER.iterdir() if path.suffix in {".proto", ".bottle-schema", ".txt", ".units"}}


@pytest.mark.parametrize("path", sorted(FOLDER.glob("*.mapping")), ids=lambda path: path.stem)
def test_report(path: Path) -> None:
    with pytest.raises(MappingError) as caught:
        check(parse(Source(path.name, path.read_text())), FRONT_ENDS, SearchPath(files=tuple(FILES.items())))
    check_golden(path.with_suffix(".err"), f"{caught.value}\n")
    assert all(problem.code for problem in caught.value.diagnostics)
