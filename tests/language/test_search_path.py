"""The search path: its order, and what it refuses."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from rosetta_jit.errors import MappingError, SchemaError
from rosetta_jit.language.imports.search import Reading, SearchPath, shipped_folders
from rosetta_jit.language.limits import MAX_FILE_BYTES
from rosetta_jit.source import Source


def put(folder: Path, name: str, text: str) -> Path:
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    return path


def text_of(found: Source | None) -> str | None:
    return found.text if found else None


def test_order(tmp_path: Path) -> None:
    beside, mine, theirs = (tmp_path / name for name in ("beside", "mine", "theirs"))
    importer = Source(str(put(beside, "m.mapping", "")), "")
    environment = {"ROSETTA_JIT_PATH": os.pathsep.join(["", str(theirs)])}
    search = SearchPath.of([mine], environment=environment)
    expected = None
    for folder in (theirs, mine, beside):
        assert text_of(search.find("a/x.proto", importer)) == expected
        expected = folder.name
        put(folder, "a/x.proto", expected)
    memory = SearchPath.of([mine], files={"a/x.proto": "memory"}, environment=environment)
    assert text_of(memory.find("a/x.proto", importer)) == "memory"
    assert text_of(search.find("a/x.proto")) == "mine"


def test_shipped_folders_come_last() -> None:
    assert SearchPath.of(environment={}).folders == (*shipped_folders(), Path())


def test_the_current_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Imports find what lies there and nowhere else; what the user names may be a path of any form."""
    put(tmp_path, "x.proto", "here")
    put(tmp_path, "rst/vision/Image.proto", "here")
    monkeypatch.chdir(tmp_path)
    search = SearchPath.of(environment={})
    assert (
        text_of(search.find("x.proto")) == text_of(search.named("./x.proto")) == text_of(search.named(str(tmp_path / "x.proto"))) == "here"
    )
    assert text_of(search.find("rst/vision/Image.proto")) != "here"
    assert text_of(search.named("rst/vision/Image.proto")) == "here"
    assert search.named("../none.proto") is None
    with pytest.raises(SchemaError):
        search.find(str(tmp_path / "x.proto"))


@pytest.mark.parametrize("name", ["../x", "a/../../x", "/etc/passwd", "", "a\0b", "a\nb", "c:/x", "a\\b", "~/x", "."])
def test_refused_names(name: str, tmp_path: Path) -> None:
    put(tmp_path, "x", "")
    with pytest.raises(SchemaError):
        SearchPath((tmp_path / "a",)).find(name)


def test_refused_files(tmp_path: Path) -> None:
    (tmp_path / "large").write_bytes(b" " * (MAX_FILE_BYTES + 1))
    (tmp_path / "binary").write_bytes(b"\xff\xfe")
    (tmp_path / "folder").mkdir()
    os.mkfifo(tmp_path / "pipe")
    search = SearchPath((tmp_path,))
    for name in ("large", "binary"):
        with pytest.raises(SchemaError):
            search.find(name)
    for name in ("folder", "pipe", "n" * 5000):
        assert search.find(name) is None


def test_mapping_may_lie_anywhere(tmp_path: Path) -> None:
    path = put(tmp_path, "m.mapping", "here")
    assert SearchPath().open(path).text == "here"
    (tmp_path / "a").mkdir()
    assert SearchPath().open(tmp_path / "a" / ".." / "m.mapping").text == "here"
    assert SearchPath((tmp_path,)).open("m.mapping").text == "here"
    with pytest.raises(MappingError):
        SearchPath((tmp_path,)).open("none.mapping")


def test_reading_records_what_was_found(tmp_path: Path) -> None:
    path = put(tmp_path, "x.proto", "abc")
    reading = Reading()
    load = SearchPath((tmp_path,)).loader(reading, Source("m", ""))
    assert load("y.proto") is None
    assert load("x.proto") == Source(str(path), "abc")
    (lookup,) = reading.lookups
    assert (lookup.asked, lookup.importer, lookup.found) == ("x.proto", "m", str(path))
    assert lookup.digest.startswith("ba7816bf8f01cfea")
