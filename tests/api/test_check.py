"""`rj.check` of files given in memory: what it says is what programs of the same files say."""

from __future__ import annotations

import pytest

import rosetta_jit as rj

FILES = {
    "lab/Part.msg": "float64 x\nstring note\n",
    "lab/Whole.msg": "lab/Part[] parts\nuint32 id\n",
    "h.proto": """syntax = "proto2"; package lab;
message P { required double x = 1; optional string memo = 2; }
message W { repeated P parts = 1; required uint32 id = 2; }""",
    "part.mapping": """import "lab/Part.msg"
import "h.proto"
data-holder: lab.P
wire-schema: lab/Part
rules:
  .x <-> .x
  ignore .note
""",
    "whole.mapping": """import "lab/Whole.msg"
import "h.proto"
parameter offset: uint32 = 1
data-holder: lab.W
wire-schema: lab/Whole
rules:
  .parts <-> .parts via "part.mapping"
  .id <-> uint32(.id + offset)
""",
}


def test_files_are_given_as_to_a_decoder() -> None:
    found = rj.check("whole.mapping", schema=FILES)
    assert [each.message for each in found] == ["no rule sets `.parts[].memo`", "no rule reads `.parts[].memo`: its value is lost"]
    laws = rj.Decoder("whole.mapping", schema=FILES, backend="interpreter").mapping.laws
    assert found.laws is not None
    assert str(found.laws.messages) == str(laws.messages)
    assert next(loss.place for loss in found.laws.messages.losses) == ".parts[].note"


def test_all_that_is_wrong_has_its_file_and_place() -> None:
    files = FILES | {"part.mapping": FILES["part.mapping"].replace(".x <-> .x", ".x <-> .y")}
    with pytest.raises(rj.MappingError) as caught:
        rj.check("whole.mapping", schema=files)
    assert "part.mapping:6" in str(caught.value)
    with pytest.raises(rj.ReportError, match=r"lost\.mapping"):
        rj.check("lost.mapping", schema=FILES)


def test_texts_come_before_folders(tmp_path) -> None:
    (tmp_path / "whole.mapping").write_text("nothing that can be read")
    for name in ("h.proto", "part.mapping"):
        (tmp_path / name).write_text(FILES[name])
    given = {name: text for name, text in FILES.items() if not (tmp_path / name).exists() or name == "whole.mapping"}
    assert rj.check("whole.mapping", schema=given, search_path=[str(tmp_path)]).laws is not None


def test_whose_a_file_is_and_parameters() -> None:
    files = {
        "lab/A.msg": "uint32 stamp\n",
        "a.proto": 'syntax = "proto3"; message A { uint32 stamp = 1; }',
        "a.mapping": 'import "lab/A.msg"\nimport "a.proto"\nparameter more: uint32\ndata-holder: A\nwire-schema: lab/A\n'
        "rules:\n  .stamp <-> uint32(.stamp + more)\n",
    }
    for framework in ("ros1", "ros2"):
        assert rj.check("a.mapping", schema=files, framework=framework, parameters={"more": 3}).laws is not None
    with pytest.raises(rj.MappingError, match="more"):
        rj.check("a.mapping", schema=files, framework="ros1", parameters={"more": "three"})
