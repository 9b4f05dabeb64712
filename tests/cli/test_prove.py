"""`rosetta-jit prove`: obligations, who proved them, and the second opinion."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from rosetta_jit.cli import main, prove
from rosetta_jit.kernel.proof import claims, symbolic

MAPPINGS = Path(__file__).resolve().parent.parent.parent / "mappings"
SHIPPED = sorted(str(path.relative_to(MAPPINGS)) for path in MAPPINGS.rglob("*.mapping"))
SAMPLE = ["yarp/icub/torso_state.mapping", "ros1/joint_state.mapping", "ros1/key_value.mapping"]


def summary(mapping, capsys, *options):
    assert main(["prove", mapping, "--second", "--summary", *options]) == 0
    return capsys.readouterr().out


@pytest.mark.parametrize("mapping", SAMPLE)
def test_z3_agrees_on_shipped_mappings(mapping, capsys):
    head, _, verdicts = summary(mapping, capsys).splitlines()[0].partition("; z3: ")
    assert head.startswith(f"{mapping}: proved - ")
    obligations = head.partition(" obligations")[0].rpartition(" ")[2]
    assert verdicts == f"{obligations} proved"


@pytest.mark.campaign
@pytest.mark.parametrize("mapping", SHIPPED)
def test_z3_agrees_on_every_shipped_mapping(mapping, capsys):
    assert "unknown" not in summary(mapping, capsys)


def test_obligations_stand_under_their_statements(capsys):
    assert main(["prove", "ros1/key_value.mapping", "--encoding", "ros1"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "ros1/key_value.mapping: decode, ros1"
    load = next(number for number, line in enumerate(lines) if line.startswith("  let count = "))
    assert any("bytes lie before the end of the message" in line and ".key" in line for line in lines[load : load + 4])
    kernels = [line.partition(": ")[2] for line in lines if line.endswith(", ros1")]
    assert kernels == ["decode, ros1", "encode, ros1", "size, ros1"]


def test_json(capsys):
    assert main(["prove", "ros1/key_value.mapping", "--json", "--second"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["proved"]
    owed = found["kernels"][0]["owed"]
    assert {each["opinion"]["verdict"] for each in owed} == {"proved"}
    assert {"part", "statement", "path", "claim", "procedure", "opinion"} == owed[0].keys()


def test_all_encodings_of_the_wire(capsys):
    text = summary("yarp/icub/torso_state.mapping", capsys)
    assert "left out: yarp: `yarp` reads several dialects" in text
    assert main(["prove", "yarp/icub/torso_state.mapping", "--summary", "--encoding", "yarp4"]) == 0
    assert ": proved - 3 kernels; " in capsys.readouterr().out


def test_what_cannot_be_proven_is_exit_code_1(monkeypatch, capsys):
    """A proof that demands what nothing gives: the kernel cannot be shown to be safe."""
    demanded = symbolic.oblige

    def stricter(scope, formula, claim):
        demanded(scope, formula if claim is not claims.AFTER_BEGIN else False, claim)

    monkeypatch.setattr(symbolic, "oblige", stricter)
    assert main(["prove", "ros1/key_value.mapping", "--summary"]) == 1
    out = capsys.readouterr().out
    assert "NOT PROVED" in out
    assert claims.AFTER_BEGIN.otherwise in out


def test_a_wrong_mapping_is_exit_code_1(tmp_path, capsys):
    path = tmp_path / "wrong.mapping"
    path.write_text("nonsense")
    assert main(["prove", str(path), "ros1/key_value.mapping", "--summary"]) == 1
    shown = capsys.readouterr()
    assert "wrong.mapping" in shown.err
    assert "ros1/key_value.mapping: proved" in shown.out


def test_without_z3_it_says_what_to_install(monkeypatch, capsys):
    monkeypatch.setattr(prove, "find_spec", lambda _: None)
    assert main(["prove", "ros1/key_value.mapping", "--second"]) == 1
    assert "pip install 'rosetta-jit[prove]'" in capsys.readouterr().err
