"""What was read a moment ago is remembered as long as nothing has changed."""

import struct

import pytest

import rosetta_jit as rj
from rosetta_jit.language.check import mapping as checking
from rosetta_jit.pipeline import mapped
from rosetta_jit.pipeline.limits import MAX_RECENT

TYPE = "float64 v\n"
MAPPING = """import "a/msg/Here.msg"
import "a/msg/There.msg"

data-holder: a/msg/Here
wire-schema: a/msg/There

rules:
  .v <-> .v * {}
"""


@pytest.fixture
def checks(monkeypatch):
    """The mappings that were checked."""
    checked = []

    def check(mapping, *arguments):
        checked.append(mapping)
        return checking.check(mapping, *arguments)

    monkeypatch.setattr(mapped, "check", check)
    return checked


@pytest.fixture
def mapping(tmp_path):
    for name in ("Here", "There"):
        write(tmp_path / f"a/msg/{name}.msg", TYPE)
    return write(tmp_path / "a.mapping", MAPPING.format(2))


def write(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    return path


def decoded(mapping, **options):
    decode = rj.Decoder(mapping, encoding="cdr", backend="interpreter", **options)
    return decode(b"\0\1\0\0" + struct.pack("<d", 1)).v


def test_both_directions_are_checked_once(mapping, checks):
    assert decoded(mapping) == 2
    assert rj.Encoder(mapping, encoding="cdr", backend="interpreter") is not None
    assert rj.Decoder(mapping, encoding="cdr", backend="python", borrow=True) is not None
    assert len(checks) == 1


def test_what_changed_is_read_again(mapping, tmp_path, checks):
    assert decoded(mapping) == 2
    write(mapping, MAPPING.format(3))
    assert decoded(mapping) == 3
    write(tmp_path / "a/msg/There.msg", "float32 v\n")
    with pytest.raises(rj.DecodeError):  # four bytes too many
        decoded(mapping)
    assert len(checks) == 3


def test_a_file_that_would_be_found_first(mapping, tmp_path, checks):
    """Though all that was read is as it was."""
    elsewhere = mapping.rename(tmp_path / "elsewhere.mapping")
    mapping = write(tmp_path / "other/a.mapping", elsewhere.read_text())
    assert decoded(mapping, search_path=[tmp_path]) == 2
    write(tmp_path / "other/a/msg/There.msg", "float32 v\n")
    with pytest.raises(rj.DecodeError):
        decoded(mapping, search_path=[tmp_path])
    assert len(checks) == 2


def test_mistakes_are_found_each_time(mapping, checks):
    write(mapping, MAPPING.format("nothing"))
    for _ in range(2):
        with pytest.raises(rj.MappingError, match="nothing"):
            decoded(mapping)
    assert len(checks) == 2


def test_other_parameters_are_another_check(tmp_path, mapping, checks):
    write(mapping, MAPPING.format("factor").replace("data-holder", "parameter factor: float64\n\ndata-holder"))
    assert [decoded(mapping, parameters={"factor": each}) for each in (2.0, 5.0, 2.0)] == [2, 5, 2]
    assert len(checks) == 2


def test_no_more_than_a_few_are_remembered(mapping, checks):
    for factor in range(2, 3 + MAX_RECENT):
        assert decoded(write(mapping.with_name(f"{factor}.mapping"), MAPPING.format(factor))) == factor
    assert decoded(mapping.with_name("2.mapping")) == 2
    assert len(checks) == 2 + MAX_RECENT


def test_a_file_that_was_missing(tmp_path):
    """A user's file is taken where protobuf's own was."""
    text = 'syntax = "proto3";\npackage google.protobuf;\nmessage Timestamp { int64 seconds = %d; int32 nanos = 2; }\n'
    main = 'syntax = "proto3";\nimport "google/protobuf/timestamp.proto";\nmessage A { google.protobuf.Timestamp t = 1; }\n'
    write(tmp_path / "a.proto", main)

    def seconds():
        decode = rj.Decoder.of("A", imports=["a.proto"], search_path=[tmp_path], backend="interpreter")
        return decode(b"\x0a\x02\x08\x05").t.seconds

    assert seconds() == 5
    write(tmp_path / "google/protobuf/timestamp.proto", text % 3)
    assert seconds() == 0
