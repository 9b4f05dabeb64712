"""The search path: its order, and what it refuses."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

import rosetta_jit as rj
from rosetta_jit.errors import MappingError, SchemaError
from rosetta_jit.parsing.limits import MAX_FILE_BYTES
from rosetta_jit.parsing.search import Reading, SearchPath
from rosetta_jit.source import Source, shipped_folders


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
    assert text_of(search.find(str(tmp_path / "x.proto"))) == text_of(search.named("x.proto")), "an absolute path in the current folder"
    with pytest.raises(SchemaError, match="outside of the search path"):
        search.find(str(tmp_path.parent / "x.proto"))
    with pytest.raises(SchemaError, match="leaves the search path"):
        search.find(f"{tmp_path}/../x.proto")


def test_types_are_names_of_their_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    put(tmp_path / "lab" / "msg", "Spot.msg", "float64 x\n")
    put(tmp_path, "point.proto", 'syntax = "proto2"; message Point { required double x = 1; }')
    head = "data-holder: Point\nwire-schema: lab/msg/Spot\nrules:\n  .x <-> .x\n"
    monkeypatch.chdir(tmp_path)
    for number, names in enumerate([("lab/msg/Spot", "point.proto"), ("lab/Spot", str(tmp_path / "point.proto"))]):
        put(tmp_path, f"m{number}.mapping", "".join(f'import "{name}"\n' for name in names) + head)
        decode, encode = (kind(f"m{number}.mapping", encoding="cdr", backend="interpreter") for kind in (rj.Decoder, rj.Encoder))
        assert decode(encode(encode.holder_type.from_dict({"x": 0.5}))).x == 0.5
    for name in ("lab/msg/Spot", "lab/msg/Spot.msg", str(tmp_path / "lab/msg/Spot.msg")):
        write = rj.Encoder.of("lab/msg/Spot", imports=[name], encoding="cdr", backend="interpreter")
        assert write(write.holder_type.from_dict({"x": 0.5}))
    shipped = rj.Encoder.of("sensor_msgs/msg/Imu", imports=["sensor_msgs/msg/Imu"], encoding="cdr", backend="interpreter")
    assert shipped.holder_type.__name__ == "Imu"
    with pytest.raises(SchemaError, match="lab/msg/Spots"):
        rj.Encoder.of("lab/msg/Spot", imports=["lab/msg/Spots"], encoding="cdr")


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


@pytest.mark.parametrize("name", ["x" * 300 + "/A.msg", "a/" * 3000 + "A.msg", "x" * 5000, "p/" + "é" * 200 + ".mapping"])
def test_names_that_no_file_can_have_are_not_found(name: str) -> None:
    """Neither is a folder of such a name searched for files that are called alike."""
    mapping = f'import "{name}"\ndata-holder: A\nwire-schema: B\nrules:\n  .a <-> .b\n'
    for make in (lambda: rj.Decoder(name), lambda: rj.Decoder("m.mapping", schema={"m.mapping": mapping})):
        with pytest.raises(MappingError) as caught:
            make()
        assert {each.code for each in caught.value.diagnostics} <= {"mapping-not-found", "import-not-found", "no-such-mapping"}


def test_reading_records_what_was_found(tmp_path: Path) -> None:
    path = put(tmp_path, "x.proto", "abc")
    reading = Reading()
    load = SearchPath((tmp_path,)).loader(reading, Source("m", ""))
    assert load("y.proto") is None
    assert load("x.proto") == Source(str(path), "abc")
    missing, lookup = reading.lookups
    assert (missing.name, missing.importer, missing.found) == ("y.proto", "m", None)
    assert (lookup.name, lookup.importer, lookup.found) == ("x.proto", "m", str(path))
    assert lookup.digest.startswith("ba7816bf8f01cfea")
