"""`rosetta-jit compile`: programs compiled ahead are in the cache for the processes that come after."""

from __future__ import annotations

import json
from concurrent.futures.process import BrokenProcessPool

import pytest

from rosetta_jit.api.decoder import Decoder
from rosetta_jit.api.encoder import Encoder
from rosetta_jit.api.warm import programs_of, warm
from rosetta_jit.cli import main
from rosetta_jit.errors import CacheWarning
from rosetta_jit.runtime.attributes.code import ALL
from rosetta_jit.runtime.cache.texts import known

KEY_VALUE = "ros1/key_value.mapping"
BOOL = "std_msgs/msg/Bool"


def test_names_become_programs(tmp_path):
    for name in ("b", "a"):
        (tmp_path / f"{name}.mapping").write_text("")
    (tmp_path / "other.txt").write_text("")
    found = programs_of([str(tmp_path), BOOL, BOOL])
    assert [(each.mapping or each.type, each.direction) for each in found] == [
        (name, direction) for name in (str(tmp_path / "a.mapping"), str(tmp_path / "b.mapping"), BOOL) for direction in ("decode", "encode")
    ]


def test_later_processes_find_them(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("ROSETTA_JIT_CACHE_DIR", str(tmp_path))
    assert main(["cache", "warm", KEY_VALUE, BOOL, "--jobs", "2", "--json"]) == 0
    made = {(each["name"], each["direction"]) for each in map(json.loads, capsys.readouterr().out.splitlines())}
    assert made == {(name, direction) for name in (KEY_VALUE, BOOL) for direction in ("decode", "encode")}
    kept = {path.name for path in tmp_path.rglob("*") if path.is_file()}
    Decoder(KEY_VALUE), Encoder(KEY_VALUE), Decoder.of(BOOL), Encoder.of(BOOL)
    assert {path.name for path in tmp_path.rglob("*") if path.is_file()} == kept
    assert main(["compile", BOOL, "--direction", "decode"]) == 0
    program, whole = capsys.readouterr().out.splitlines()
    assert program.startswith(f"[1/1] {BOOL}: decode, ")
    assert whole.startswith("1 ready, 0 wrong, in ")


def test_files_declare_types(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("ROSETTA_JIT_CACHE_DIR", str(tmp_path / "cache"))
    schema = tmp_path / "lab.proto"
    schema.write_text('syntax = "proto3"; package lab; message Arm { uint32 joints = 1; }')
    assert main(["cache", "warm", "lab.Arm", "--import", str(schema)]) == 0
    assert "2 ready, 0 wrong" in capsys.readouterr().out
    kept = {path.name for path in tmp_path.rglob("*") if path.is_file()}
    Decoder.of("lab.Arm", imports=[str(schema)]), Encoder.of("lab.Arm", imports=[str(schema)])
    assert {path.name for path in tmp_path.rglob("*") if path.is_file()} == kept


def test_many_are_compiled_in_several_processes(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("ROSETTA_JIT_CACHE_DIR", str(tmp_path))
    types = [f"std_msgs/msg/{name}" for name in ("Bool", "Byte", "Char", "Empty", "Float32", "Float64", "Int8", "Nothing")]
    assert main(["compile", *types, "--direction", "decode", "--jobs", "2"]) == 1
    out, err = capsys.readouterr()
    assert "7 ready, 1 wrong" in out
    assert "no file declares a message `std_msgs/msg/Nothing`" in err
    kept = {path.name for path in tmp_path.rglob("*") if path.is_file()}
    assert known(ALL) is not None  # all accessors of messages
    assert all(Decoder.of(name) for name in types[:-1])
    assert {path.name for path in tmp_path.rglob("*") if path.is_file()} == kept


def test_a_process_that_is_gone_is_told(monkeypatch, capsys):
    def broken(*_, **__):
        raise BrokenProcessPool
        yield

    monkeypatch.setattr("rosetta_jit.api.warm.warm", broken)
    assert main(["compile", BOOL]) == 1
    assert "was ended from outside" in capsys.readouterr().err


def test_what_is_wrong_is_told_and_the_others_are_made(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("ROSETTA_JIT_CACHE_DIR", str(tmp_path))
    assert main(["compile", "std_msgs/msg/Bol", BOOL]) == 1
    out, err = capsys.readouterr()
    assert "2 ready, 2 wrong" in out
    assert "no file declares" in err


def test_it_fails_where_nothing_can_be_kept(tmp_path, monkeypatch, capsys):
    folder = tmp_path / "open"
    folder.mkdir()
    folder.chmod(0o777)
    monkeypatch.setenv("ROSETTA_JIT_CACHE_DIR", str(folder))
    with pytest.warns(CacheWarning, match="can be written by others"):
        assert main(["compile", BOOL]) == 1
    assert "error: the cache cannot keep what was compiled" in capsys.readouterr().err


@pytest.mark.parametrize("jobs", ["0", "-3", "many", "2.5"])
def test_jobs_are_one_or_more(jobs, capsys):
    with pytest.raises(SystemExit, match="2"):
        main(["cache", "warm", "std_msgs/Bool", "--jobs", jobs])
    assert f"argument --jobs: '{jobs}' is no whole number from 1 on" in capsys.readouterr().err


def test_it_fails_where_the_cache_is_off(monkeypatch):
    monkeypatch.setenv("ROSETTA_JIT_CACHE", "off")
    assert main(["compile", BOOL]) == 1


def test_a_writer_of_several_dialects_is_made_for_each():
    (programs,) = warm(programs_of(["yarp/icub/torso_command.mapping"], directions=["encode"]), jobs=1)
    assert sorted(each.request.encoding or "" for each in programs) == ["yarp2012", "yarp3", "yarp4"]


def test_a_direction_without_rules_is_left_out(tmp_path):
    text = 'import "ros1/std_msgs/Bool.msg"\ndata-holder: std_msgs/Bool\nwire-schema: std_msgs/Bool\nunpack-rules:\n  .data = .data\n'
    (tmp_path / "one_way.mapping").write_text(text)
    made = [each for several in warm(programs_of([str(tmp_path)]), jobs=1) for each in several]
    assert [(each.request.direction, each.error) for each in made] == [("decode", None)]


@pytest.mark.parametrize("arguments", [["cache", "warm"], ["cache", "info", BOOL]])
def test_names_belong_to_warm(arguments, capsys):
    assert main(arguments) == 2
    assert "error: " in capsys.readouterr().err
