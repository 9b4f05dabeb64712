"""The table of features is found out by trying; these are the findings, and they may only get better."""

from __future__ import annotations

import json

import pytest

from rosetta_jit.cli import main
from rosetta_jit.frameworks.base import installed
from rosetta_jit.frameworks.features import FEATURES, findings
from tests.golden import GOLDEN, check_golden

NAMES = [name for name in installed() if name != "toy"]


@pytest.mark.parametrize("name", NAMES)
def test_table(name, capsys):
    assert main(["frameworks", "--features", name]) == 0
    check_golden(GOLDEN / "features" / f"{name}.txt", capsys.readouterr().out)


@pytest.mark.parametrize("name", NAMES)
def test_every_probe_is_of_a_feature(name):
    assert {feature for probes in installed()[name].probes().values() for feature in probes} <= FEATURES.keys()


def test_gaps_say_why():
    for name in NAMES:
        table = findings(installed()[name], installed()[name].probes())
        assert all(each.note for row in table.values() for each in row.values() if each.state == "gap")


def test_lists(capsys):
    assert main(["frameworks"]) == 0
    check_golden(GOLDEN / "features" / "frameworks.txt", capsys.readouterr().out)
    assert main(["frameworks", "--json", "ros2"]) == 0
    assert json.loads(capsys.readouterr().out)["ros2"]["encodings"]["cdr"]["byte_order"] is True


def test_unknown_names_are_refused(capsys):
    assert main(["frameworks", "ros3"]) == 1
    assert "there is no framework ros3" in capsys.readouterr().err
