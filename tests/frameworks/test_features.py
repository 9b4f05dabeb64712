"""The table of features is found out by trying; these are the findings, and they may only get better."""

from __future__ import annotations

import json
from functools import cache

import pytest

import rosetta_jit as rj
from rosetta_jit.cli import main
from rosetta_jit.frameworks import features
from rosetta_jit.frameworks.base import Framework
from rosetta_jit.frameworks.feature_list import FEATURES
from rosetta_jit.frameworks.features import Finding, findings
from rosetta_jit.frameworks.installed import installed, shipped
from rosetta_jit.frameworks.probe import Probe
from rosetta_jit.model.types import Field, Int, Schema, Struct, name_parts
from rosetta_jit.source import Source
from tests.golden import GOLDEN, check_golden

NAMES = [each.name for each in shipped()]


@cache
def table(name):
    return findings(installed()[name])


@pytest.fixture(autouse=True)
def found_once(monkeypatch):
    """The command shows what this file has found out already."""
    monkeypatch.setattr(features, "findings", lambda framework: table(framework.name))


def probes(name, suffix):
    for feature, probe in installed()[name].probes().get(suffix, {}).items():
        yield feature, probe if isinstance(probe, Probe) else Probe(probe)


@pytest.mark.parametrize("name", NAMES)
def test_table(name, capsys):
    assert main(["frameworks", "--features", name]) == 0
    check_golden(GOLDEN / "features" / f"{name}.txt", capsys.readouterr().out)


@pytest.mark.parametrize("name", NAMES)
def test_every_probe_is_of_a_feature(name):
    framework = installed()[name]
    assert set(framework.probes()) == set(framework.idl)
    for suffix in framework.idl:
        for feature, probe in probes(name, suffix):
            assert feature in FEATURES
            assert set(probe.without) <= set(framework.encodings)


@pytest.mark.parametrize("name", NAMES)
def test_whatever_is_less_than_yes_says_why(name):
    for row in table(name).values():
        for finding in row.values():
            assert bool(finding.note) == (finding.state in ("gap", "read")) or finding.state == "none"


@pytest.mark.parametrize("name", NAMES)
def test_yes_is_a_decoder_and_an_encoder(name):
    """What an encoding is said to carry goes there and back in programs that a user gets; the Python backend compiles nothing."""
    framework, failures, tried = installed()[name], [], set()
    for suffix in reversed(framework.idl):
        for feature, probe in probes(name, suffix):
            row = table(name)[feature]
            carried = [each for each in framework.encodings if row[suffix].state == "yes" and row[each].state in ("yes", "read")]
            for encoding in set(carried) - set(probe.without) - {each for done, each in tried if done == feature}:
                tried.add((feature, encoding))
                failures += there_and_back(framework, suffix, feature, probe, encoding, writes=row[encoding].state == "yes")
    assert failures == []


FILLED = {
    (".proto", "required"): 7,
    (".bottle-schema", "string, fixed"): "sixteen letters.",
    (".bottle-schema", "blob, fixed"): bytes(16),
}
"""What a holder must be given before it is a message."""


def there_and_back(framework, suffix, feature, probe, encoding, *, writes):
    file = probe.file or f"probe/Probe{suffix}"
    options = {"schema": {file: probe.text, **probe.files}, "imports": [file], "framework": framework.name, "encoding": encoding}
    type_ = declared(framework, file, probe)
    try:
        decode = rj.Decoder.of(type_, backend="python", **options)
        if writes:
            encode = rj.Encoder.of(type_, backend="python", **options)
            holder = decode.new()
            if (suffix, feature) in FILLED:
                holder.x = FILLED[suffix, feature]
            message = encode(holder)
            assert encode(decode(message)) == message
    except (rj.RosettaError, AssertionError) as error:
        return [f"{feature} in {suffix}, {encoding}: {error}"]
    return []


def declared(framework, file, probe):
    files = {path: Source(path, text) for path, text in probe.files.items()}
    schema = framework.front_end(file)(Source(file, probe.text), files.get)
    return next(each for each in schema.types if name_parts(each)[-1] == probe.declares)


def test_what_is_lost_on_the_way_is_no_yes():
    """A front end that reads a default and forgets it has a gap there."""
    forgetful = Framework("forgetful", idl={".forget": f"{__name__}:forget"}, encodings={}, features=f"{__name__}:FORGETFUL")
    table = findings(forgetful)
    assert table["int32"][".forget"] == Finding("yes")
    assert table["default"][".forget"].state == "gap"
    assert table["service"][".forget"] == Finding("gap", "no front end reads `.call` files")
    assert table["map"][".forget"] == Finding("none")


FORGETFUL = {".forget": {"int32": "x", "default": "x=5", "service": Probe("x", file="Probe.call")}}


def forget(source, load):
    del load
    return Schema({"Probe": Struct("Probe", (Field(source.text.partition("=")[0], Int(32)),))})


def test_lists(capsys):
    assert main(["frameworks"]) == 0
    check_golden(GOLDEN / "features" / "frameworks.txt", capsys.readouterr().out)


def test_lists_as_json(capsys):
    assert main(["frameworks", "--json"]) == 0
    text = capsys.readouterr().out
    assert json.loads(text)["ros2"]["encodings"]["cdr"]["byte_order"] is True
    check_golden(GOLDEN / "features" / "frameworks.json", text)


def test_table_as_json(capsys):
    assert main(["frameworks", "--features", "--json", "lcm", "corba"]) == 0
    text = capsys.readouterr().out
    assert set(json.loads(text)["lcm"]) == set(FEATURES)
    check_golden(GOLDEN / "features" / "features.json", text)


def test_unknown_names_are_refused(capsys):
    assert main(["frameworks", "ros3"]) == 1
    assert "there is no framework ros3" in capsys.readouterr().err
