"""The nine operations of the paper's table 2, each told from rules that use it and from rules that do not."""

from __future__ import annotations

import json

import pytest

from rosetta_jit.cli import main
from rosetta_jit.explain.operations import OPERATIONS, operations

FILES = {
    "a.bottle-schema": """"a" (("x" :double) ("n" :int) ("s" :string) ("b" :blob) ("l" (:list :double)) ("time" :int64)
  ("in" (:bottle ("y" :int))))""",
    "h.proto": """syntax = "proto2"; package h;
message Inner { optional int32 y = 1; }
message H { optional double x = 1; optional int32 n = 2; optional string s = 3; optional bytes b = 4; repeated double l = 5;
  optional int64 secs = 6; optional Inner inner = 7; }""",
}
HEAD = 'import "a.bottle-schema"\nimport "h.proto"\ndata-holder: h.H\nwire-schema: a\nunpack-rules:\n'


@pytest.fixture
def used(tmp_path):
    def find(rules):
        rules += "" if ".l" in rules else "len(.l) = 0\n"
        for name, content in {**FILES, "m.mapping": HEAD + rules}.items():
            (tmp_path / name).write_text(content)
        return set(operations(str(tmp_path / "m.mapping")))

    return find


@pytest.mark.parametrize(
    ("rules", "expected"),
    [
        (".n = .n", set()),
        (".x = .x", {"arithmetic"}),
        (".n = int32(.n * 2)", {"arithmetic", "rejection"}),
        (".n = int32(.x, round)", {"arithmetic"}),
        ("len(.l) = 2 .l[0] = .l[1] .l[1] = .l[0]", {"arithmetic", "array reorder"}),
        ("len(.l) = len(.l) for i from 0 to len(.l) .l[i] = .l[i] end", {"arithmetic", "subtype loops"}),
        (".s = .s", set()),
        (".b = .s", {"string manipulation"}),
        ('.n = 1 if .s == "a" else 2', {"string manipulation", "predicate assignment"}),
        ('.s = table(.n) { 1 = "a", otherwise "b" }', {"string manipulation", "predicate assignment"}),
        (".n = table(.n) { 1 = 2 }", {"predicate assignment", "rejection"}),
        ("when .n > 0 .n = 1 end", {"predicate assignment"}),
        ('reject "no" when .n < 0', {"rejection"}),
        (".n = 3", {"generators"}),
        ("default .n", {"generators"}),
        (".secs = .time", set()),
        (".secs = .time / 1000000", {"arithmetic", "date manipulation"}),
        (".inner.y = .in.y", {"subtype loops"}),
    ],
)
def test_operations(used, rules, expected):
    assert used(f"  {rules}\n") == expected


def test_the_table(capsys):
    mappings = ["ros1/image.mapping", "ros1/time_reference.mapping", "yarp/icub/torso_state.mapping"]
    assert main(["operations", *mappings]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[2].split() == ["ros1/image.mapping", "both", "both", "both", "-", "both", "both", "both", "pack", "-"]
    assert lines[5].split() == ["of", "3", "3", "2", "1", "0", "1", "1", "3", "2", "1"]


def test_as_json(capsys):
    assert main(["operations", "--json", "ros1/time_reference.mapping"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["mappings"]["ros1/time_reference.mapping"]["date manipulation"] == ["unpack", "pack"]
    assert list(found["counts"]) == list(OPERATIONS)


def test_a_wrong_mapping_is_reported_and_the_others_are_told(capsys):
    assert main(["operations", "no/such.mapping", "ros1/image.mapping"]) == 1
    captured = capsys.readouterr()
    assert "error[mapping-not-found]" in captured.err
    assert "of 1" in captured.out
