"""The commands on logs: what they print and write, and their exit codes."""

from __future__ import annotations

import io
import json
import sys
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
from mcap.reader import make_reader
from mcap.writer import Writer
from rosbags.rosbag1 import Reader as BagReader

import rosetta_jit as rj
from rosetta_jit.cli import main

from .made import expected, values, write_bag, write_lcm, write_mcap

COUNT = 50


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("commands")
    write_bag(folder / "a.bag", COUNT)
    write_mcap(folder / "a.mcap", COUNT)
    write_lcm(folder / "a.lcmlog", COUNT)
    with (folder / "bad.mcap").open("wb") as file:
        writer = Writer(file)
        writer.start()
        channel = writer.register_channel("/x", "cdr", writer.register_schema("t/msg/X", "ros2msg", b"int32 x"))
        for number, data in enumerate([b"\0\1\0\0\1\0\0\0", b"\0\1\0\0\1", b"\0\1\0\0\3\0\0\0"]):
            writer.add_message(channel, log_time=7 - number, publish_time=number, data=data)
        writer.finish()
    return folder


@pytest.fixture
def command(folder, monkeypatch, capsys):
    monkeypatch.chdir(folder)

    def run(*arguments, code=0):
        assert main(arguments) == code, capsys.readouterr().err
        return capsys.readouterr()

    return run


def test_info(command):
    shown = command("info", "a.bag").out
    assert "format:      bag" in shown
    assert "/a           50  t/Point  ros1" in shown
    facts = json.loads(command("info", "a.mcap", "--json").out)
    assert facts["channels"][1] == {"topic": "/b", "type": "t/msg/Text", "encoding": "cdr", "schema_encoding": "ros2msg", "count": 10}


def test_cat(command):
    shown = command("cat", "a.bag", "--topic", "/b", "-n", "2", "--start", "1700000000.04").out
    assert shown.splitlines()[:2] == ["2023-11-14T22:13:20.050000001Z /b", 'data: "text 5"']
    first = json.loads(command("cat", "a.mcap", "--json", "-n", "1").out)
    assert first == {"time": 1_700_000_000 * 10**9, "topic": "/a", "message": {"x": 0.0, "name": "p0"}}
    assert "00 01 00 00" in command("cat", "a.mcap", "--raw", "-n", "1").out


@pytest.mark.parametrize("suffix", ["parquet", "arrow", "csv", "npz"])
def test_tables(command, folder, suffix):
    command("convert", "a.mcap", "--topic", "/a", "-o", f"a.{suffix}")
    path = folder / f"a.{suffix}"
    match suffix:
        case "parquet":
            assert pq.read_table(path)["x"].to_pylist() == [number / 4 for number in range(COUNT)]
        case "csv":
            assert path.read_text().splitlines()[2].endswith(',0.25,"p1"')
        case "npz":
            assert np.load(path)["name"].tolist() == [f"p{number}" for number in range(COUNT)]
    assert not list(folder.glob("*.part"))


def test_a_table_is_of_one_topic(command):
    assert "name one: --topic" in command("convert", "a.bag", "-o", "b.parquet", code=1).err
    assert "did you mean `/a`" in command("convert", "a.bag", "--topic", "a", "-o", "b.parquet", code=1).err


@pytest.mark.parametrize(
    ("output", "options"),
    [
        ("out.mcap", ["--every", "1h"]),
        ("out/", ["--to", "ros2"]),
        ("out.bag", ["--flatten", "--on-error", "skip"]),
        ("out.csv", ["--to", "ros2"]),
    ],
)
def test_options_that_would_do_nothing_are_refused(command, folder, output, options):
    err = command("convert", "a.bag", "-o", output, *options, code=2).err
    assert all(option in err for option in options if option.startswith("--"))
    assert not (folder / output).exists()


def test_bag_to_mcap_and_back(command, folder):
    """What we write, the real libraries read; and so do we."""
    command("convert", "a.bag", "-o", "from_bag.mcap")
    with (folder / "from_bag.mcap").open("rb") as file:
        read = [(message.log_time, channel.topic, schema.name) for schema, channel, message in make_reader(file).iter_messages()]
    assert read == [(time, topic, "t/Point" if topic == "/a" else "t/Text") for time, topic, _ in expected(COUNT)]
    command("convert", "from_bag.mcap", "-o", "back.bag", "--topic", "/a")
    with BagReader(folder / "back.bag") as bag:
        theirs = [(connection.topic, time, data) for connection, time, data in bag.messages()]
        assert [(each.msgtype, each.digest) for each in bag.connections] == [("t/msg/Point", own_sum())]
    assert theirs == [("/a", each.time, each.message) for each in rj.open(folder / "a.bag").messages(["/a"], raw=True)]
    assert values(rj.open(folder / "back.bag").messages()) == [each for each in expected(COUNT) if each[1] == "/a"]


def own_sum():
    return rj.Decoder.of("t/Point", encoding="ros1", schema="float64 x\nstring name\n").holder_type._md5sum


def test_lcm_to_lcm(command, folder):
    import lcm

    command("convert", "a.lcmlog", "-o", "b.lcmlog", "--topic", "/b")
    events = [(each.channel, each.timestamp * 1000, each.data) for each in lcm.EventLog(str(folder / "b.lcmlog"), "r")]
    assert events == [(each.topic, each.time, each.message) for each in rj.open(folder / "a.lcmlog").messages(["/b"], raw=True)]
    assert "hold messages of LCM alone" in command("convert", "a.bag", "-o", "c.lcmlog", code=1).err
    assert not (folder / "c.lcmlog.part").exists()


@pytest.mark.parametrize("on_error", ["stop", "skip", "quarantine"])
def test_messages_that_cannot_be_decoded(command, folder, on_error):
    output = folder / f"{on_error}.parquet"
    said = command("convert", "bad.mcap", "-o", output.name, "--on-error", on_error, code=1)
    if on_error == "stop":
        assert "truncated" in said.err
        assert not output.exists()
        return
    assert pq.read_table(output)["x"].to_pylist() == [1, 3]
    assert "1 messages of /x could not be decoded" in said.err
    rejected = folder / f"{output.name}.quarantine.jsonl"
    assert rejected.exists() == (on_error == "quarantine")
    if rejected.exists():
        line = json.loads(rejected.read_text())
        assert (line["message"], line["base64"]) == (1, "AAEAAAE=")


def test_doctor(command):
    assert "60 messages read, no problems" in command("doctor", "a.bag").out
    found = json.loads(command("doctor", "bad.mcap", "--json", code=1).out)
    assert [each["code"] for each in found["problems"]] == ["log-order", "log-message"]
    assert found["messages"] == 3
    assert "does not say of which type" in command("doctor", "a.lcmlog", code=1).out


def test_doctor_of_a_log_cut_within_a_chunk(command, folder):
    """There is no index, so none can lie."""
    (folder / "cut.mcap").write_bytes((folder / "a.mcap").read_bytes()[:200])
    found = json.loads(command("doctor", "cut.mcap", "--json", code=1).out)
    assert [each["code"] for each in found["problems"]] == ["log-unfinished", "log-cut", "log-chunk"]


def write_points(path, *schemas):
    """An MCAP file with a message of each schema on `/x`: a name, and a definition, which may be empty."""
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        for name, text in schemas:
            channel = writer.register_channel("/x", "cdr", writer.register_schema(name, "ros2msg" if text else "", text))
            writer.add_message(channel, log_time=1, publish_time=1, data=b"\0\1\0\0\7\0\0\0")
        writer.finish()


def test_doctor_of_a_topic_with_several_types(command, folder):
    write_points(folder / "two.mcap", ("t/msg/A", b"int32 x"), ("t/msg/B", b"uint32 y"))
    (found,) = json.loads(command("doctor", "two.mcap", "--json", code=1).out)["problems"]
    assert (found["code"], found["severity"]) == ("log-types", "warning")
    assert "`/x` has messages of several types: `t/msg/A`, `t/msg/B`" in found["message"]


def test_a_folder_of_a_topic_with_several_types(command, folder):
    """Each type has tables of its own, and each of several definitions of one."""
    write_points(folder / "two.mcap", ("t/msg/A", b"int32 x"), ("t/msg/B", b"uint32 y"), ("t/msg/A", b"uint32 z"))
    command("convert", "two.mcap", "-o", "out/")
    read = {
        each.parent.parent.name: pq.read_table(each).drop_columns(["log_time", "publish_time"]) for each in folder.glob("out/*/*/*.parquet")
    }
    assert {name: table.to_pylist() for name, table in read.items()} == {
        "x.t.msg.A": [{"x": 7}],
        "x.t.msg.A.2": [{"z": 7}],
        "x.t.msg.B": [{"y": 7}],
    }
    command("convert", "two.mcap", "-o", "out/", "--resume")


def test_a_type_whose_definition_is_nowhere(command, folder):
    """Which type of which topic is missing, and where it is looked for."""
    write_points(folder / "bare.mcap", ("t/msg/A", b""))
    for arguments in (["doctor"], ["cat"], ["convert", "-o", "x.parquet"], ["convert", "-o", "x/"], ["plot", "/x.x"]):
        said = command(arguments[0], "bare.mcap", *arguments[1:], code=1)
        assert "bare.mcap has no definition of `t/msg/A`, the type of the messages of `/x`" in said.out + said.err
        assert "--search-path" in said.out + said.err
    (folder / "own" / "t" / "msg").mkdir(parents=True)
    (folder / "own" / "t" / "msg" / "A.msg").write_text("int32 x\n")
    assert "t.msg.A(x=7)" in command("cat", "bare.mcap", "--search-path", "own").out


def test_decode_takes_logs_types_and_standard_input(command, folder, monkeypatch):
    assert 'data: "text 5"' in command("decode", "std_msgs/String", "a.bag", "--topic", "/b", "--encoding", "ros1").out
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(Path("a.bag").read_bytes())))
    assert json.loads(command("decode", "std_msgs/String", "-", "--topic", "/b", "--encoding", "ros1", "--json").out.splitlines()[1]) == {
        "data": "text 5"
    }
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(b"\2\0\0\0hi")))
    assert command("decode", "std_msgs/String", "-", "--encoding", "ros1").out == 'data: "hi"\n'
    assert "kernel" in command("dump", "std_msgs/String", "--encoding", "ros1").out
    assert "several topics" in command("decode", "std_msgs/String", "a.bag", "--encoding", "ros1", code=1).err
    assert command("decode", "t/Point", "a.bag", "--topic", "/a").out.startswith('x: 0.0\nname: "p0"\n')  # as the log defines it
    assert "struct t/Point" in command("dump", "t/Point", "a.bag", "--topic", "/a", "--stage", "model").out
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(Path("a.bag").read_bytes())))
    assert "'t/Point': encode" in command("dump", "t/Point", "-", "--topic", "/a", "--direction", "encode").out
    assert "no log that is known" in command("dump", "t/Point", __file__, code=1).err


def test_infer_of_a_log_takes_its_encoding(command, monkeypatch):
    assert "no schema can be drafted of messages in `cdr`" in command("infer", "a.mcap", "--topic", "/a", code=1).err
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(Path("a.bag").read_bytes())))
    assert "in `ros1`" in command("infer", "-", "--topic", "/b", code=1).err


def test_a_moment_in_nanoseconds_is_refused(command, capsys):
    """Taken as seconds it would be a time that never comes, and all messages would be read."""
    with pytest.raises(SystemExit):
        command("cat", "a.bag", "--end", "1700000000000000000")
    assert "seconds since 1970 are meant" in capsys.readouterr().err
    with pytest.raises(SystemExit):
        command("cat", "a.bag", "--end", "soon")
    assert "'soon' is neither seconds since 1970 nor ISO 8601" in capsys.readouterr().err


def test_ctrl_c_ends_a_command_without_a_traceback(command, folder, monkeypatch):
    """In the middle of a conversion: what is not whole is removed."""

    def pressed(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("rosetta_jit.runtime.arrow.files.TableFile.write", pressed)
    assert command("convert", "a.mcap", "--topic", "/a", "-o", "interrupted.parquet", code=130).err.endswith("interrupted\n")
    assert not list(folder.glob("interrupted*"))


def test_a_name_that_does_not_say_what_to_write(folder, tmp_path, capsys):
    for name in ("out", "out.parket"):
        assert main(["convert", str(folder / "a.mcap"), "--on-error", "skip", "-o", str(tmp_path / name)]) == 1
        said = capsys.readouterr().err
        assert "the name does not say what to write" in said
        assert "a folder of tables with `/`" in said
    assert not list(tmp_path.iterdir())


def test_a_log_without_topics(command, tmp_path):
    with (tmp_path / "empty.mcap").open("wb") as file:
        writer = Writer(file)
        writer.start()
        writer.finish()
    path = str(tmp_path / "empty.mcap")
    assert "empty.mcap has no topics" in command("convert", path, "-o", str(tmp_path / "x.parquet"), code=1).err
    assert "0 messages read" in command("doctor", path).out
