"""Logs into folders of tables and into other logs: nothing is lost or doubled, also where the process is killed."""

from __future__ import annotations

import json
import os
import random
import signal
import subprocess
import sys
import time
from itertools import pairwise
from pathlib import Path

import lcm
import pyarrow.dataset as ds
import pyarrow.parquet as pq
import pytest
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from mcap.reader import make_reader
from mcap.writer import Writer

import rosetta_jit as rj
from rosetta_jit.cli import main
from rosetta_jit.logs.converting.folder import FolderConversion
from rosetta_jit.logs.folder_names import folder_names
from rosetta_jit.runtime.arrow import files

from .made import LCM_TYPES, START, expected, time_of, write_lcm, write_mcap

COUNT = 400
DUMPED = Path(__file__).parent / "yarpdatadumper"
DRIVE = Path(rj.__file__).parent / "demo" / "recordings" / "drive.bag"


@pytest.fixture(scope="module")
def mcap(tmp_path_factory):
    return write_mcap(tmp_path_factory.mktemp("logs") / "a.mcap", COUNT, chunk_size=700)


def rows_of(folder, topic):
    """Time and value of all rows below a topic's folder, in order of the time."""
    table = ds.dataset(folder / topic, partitioning="hive", format="parquet").to_table().sort_by("log_time")
    times = table["log_time"].cast("int64").to_pylist()
    return list(zip(times, table["data" if topic == "b" else "x"].to_pylist(), strict=True))


def wanted(topic):
    return [(moment, value[0] if topic == "a" else value) for moment, name, value in expected(COUNT) if name == f"/{topic}"]


def test_a_folder_by_topic_and_time(mcap, tmp_path):
    out = tmp_path / "out"
    assert main(["convert", str(mcap), "-o", f"{out}/", "--every", "1s"]) == 0
    for topic in ("a", "b"):
        assert rows_of(out, topic) == wanted(topic)
    stretches = sorted(each.name for each in (out / "a").iterdir())
    assert stretches == [f"start=20231114T2213{20 + second}" for second in range(4)]
    (first,) = (out / "a" / stretches[0]).iterdir()
    assert pq.read_table(first)["x"].to_pylist() == [number / 4 for number in range(100)]
    assert pq.read_schema(first).names[:2] == ["log_time", "publish_time"]
    assert main(["convert", str(mcap), "-o", f"{out}/"]) == 1  # it is there already
    assert main(["convert", str(mcap), "-o", f"{out}/", "--every", "1s", "--resume"]) == 0  # and complete
    assert main(["convert", str(mcap), "-o", f"{out}/", "--every", "2s", "--resume"]) == 1  # it is another one


def test_groups_of_rows_that_readers_can_skip(mcap, tmp_path, monkeypatch):
    monkeypatch.setattr(files, "ROWS", 50)
    out = tmp_path / "out"
    monkeypatch.setattr("rosetta_jit.logs.decoded_parts.MESSAGES", 50)
    log = rj.open(mcap)
    FolderConversion(log, [log["/a"]], out).run()
    (path,) = out.glob("a/*/*.parquet")
    found = pq.ParquetFile(path).metadata
    spans = [(each.min, each.max) for each in (found.row_group(group).column(0).statistics for group in range(found.num_row_groups))]
    assert len(spans) == COUNT // 50
    assert all(one[1] < next_[0] for one, next_ in pairwise(spans))
    assert found.row_group(0).column(0).has_offset_index


def test_few_files_of_a_topic_are_open(tmp_path, monkeypatch):
    """Whatever the order of the times: what comes for a file that is closed goes into another one."""
    from rosetta_jit.logs.converting import parts

    path, out, add = tmp_path / "x.mcap", tmp_path / "out", parts.Parts.add
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        channel = writer.register_channel("/x", "cdr", writer.register_schema("t/msg/X", "ros2msg", b"int32 x"))
        for number in range(200):
            moment = START + number % 50 // 5 * 10**9
            writer.add_message(channel, log_time=moment, publish_time=moment, data=b"\0\1\0\0" + number.to_bytes(4, "little"))
        writer.finish()

    def adding(unfinished, *arguments):
        add(unfinished, *arguments)
        assert len(unfinished._open) <= parts.STRETCHES_OPEN == 4

    monkeypatch.setattr("rosetta_jit.logs.decoded_parts.MESSAGES", 5)
    monkeypatch.setattr(parts.Parts, "add", adding)
    log = rj.open(path)
    FolderConversion(log, [log["/x"]], out, every_ns=10**9).run()
    assert sorted(ds.dataset(out / "x").to_table()["x"].to_pylist()) == list(range(200))
    names = [each.name for each in (out / "x" / "start=20231114T221321").iterdir()]
    assert sorted(names) == ["000000.1.parquet", "000000.2.parquet", "000000.3.parquet", "000000.parquet"]


def test_several_topics_through_mappings_of_their_own(tmp_path):
    """One pass over a bag: one topic through a mapping, the other as it is, into a folder and into a log."""
    states = "/joint_states=ros1/joint_positions.mapping"
    out, log = tmp_path / "out", tmp_path / "out.mcap"
    assert main(["convert", str(DRIVE), "--mapping", states, "-o", f"{out}/"]) == 0
    direct = rj.open(DRIVE)
    table = ds.dataset(out / "joint_states", partitioning="hive").to_table().drop_columns(["start"])
    assert table.equals(direct["/joint_states", "ros1/joint_positions.mapping"].to_arrow())
    assert ds.dataset(out / "imu").to_table().num_rows == 400
    assert main(["convert", str(DRIVE), "--mapping", states, "-o", str(log)]) == 0
    with log.open("rb") as file:
        read = [(channel, schema, message) for schema, channel, message in make_reader(file).iter_messages()]
    assert [each.log_time for _, _, each in read] == [each.time for each in direct.messages(raw=True)]
    mapped = [each for each in read if each[0].topic == "/joint_states"]
    assert {(channel.message_encoding, schema.encoding, schema.name) for channel, schema, _ in mapped} == {
        ("protobuf", "protobuf", "rst.kinematics.JointPositionState")
    }
    pool = descriptor_pool.DescriptorPool()
    for each in descriptor_pb2.FileDescriptorSet.FromString(mapped[0][1].data).file:
        pool.Add(each)
    theirs = message_factory.GetMessageClass(pool.FindMessageTypeByName("rst.kinematics.JointPositionState"))
    states = [theirs.FromString(message.data) for _, _, message in mapped]
    assert [each.joints[0].value for each in states] == [
        each.joints[0].value for each in direct["/joint_states", "ros1/joint_positions.mapping"]
    ]
    assert rj.open(log)["/joint_states"].to_arrow().equals(direct["/joint_states", "ros1/joint_positions.mapping"].to_arrow())
    assert {channel.message_encoding for channel, _, _ in read} == {"protobuf", "ros1"}


def test_options_for_topics(mcap, tmp_path, capsys):
    convert = ["convert", str(mcap), "-o", str(tmp_path / "a.parquet")]
    assert main([*convert, "--type", "/c=t/msg/Point"]) == 1
    assert "no topic `/c`" in capsys.readouterr().err
    assert main([*convert, "--type", "/a=t/msg/Point"]) == 0
    assert pq.read_table(tmp_path / "a.parquet").num_rows == COUNT
    with pytest.raises(SystemExit):
        main(["convert", str(mcap), "-o", f"{tmp_path}/x/", "--every", "soon"])
    assert "10min" in capsys.readouterr().err


def bad_log(path):
    """A topic of int32 in which every tenth message is too short, and another that is whole."""
    with path.open("wb") as file:
        writer = Writer(file, chunk_size=200)
        writer.start()
        schema = writer.register_schema("t/msg/X", "ros2msg", b"int32 x")
        channels = [writer.register_channel(topic, "cdr", schema) for topic in ("/x", "/y")]
        for number in range(60):
            data = b"\0\1\0\0" + number.to_bytes(4, "little")
            cut = 3 if number % 10 == 5 else 0
            writer.add_message(channels[0], log_time=START + number, publish_time=number, data=data[: len(data) - cut])
            writer.add_message(channels[1], log_time=START + number, publish_time=number, data=data)
        writer.finish()
    return path


def test_bad_messages_of_a_folder(tmp_path, capsys):
    path, out = bad_log(tmp_path / "bad.mcap"), tmp_path / "out"
    assert main(["convert", str(path), "-o", f"{out}/"]) == 1
    assert "truncated" in capsys.readouterr().err
    assert main(["convert", str(path), "-o", f"{out}/", "--resume", "--on-error", "quarantine"]) == 1
    assert "6 messages of /x could not be decoded" in capsys.readouterr().err
    lines = [json.loads(line) for line in (out / "_quarantine.jsonl").read_text().splitlines()]
    assert [(each["topic"], each["message"], each["log_time"]) for each in lines] == [("/x", n, START + n) for n in range(5, 60, 10)]
    assert all("truncated" in each["error"] for each in lines)
    table = ds.dataset(out / "x").to_table()
    assert table["x"].to_pylist() == [number for number in range(60) if number % 10 != 5]
    assert ds.dataset(out / "y").to_table()["x"].to_pylist() == list(range(60))


def test_names_of_folders():
    topics = ["/a/b", "/a.b", "..", "/", "_x", "x" * 300, "/ü b", "/A/C", "/a/c"]
    names = folder_names(topics)
    assert len({each.lower() for each in names.values()}) == len(topics)
    assert names["/ü b"] == "%C3%BC b"
    for name in names.values():
        assert "/" not in name
        assert not name.startswith((".", "_"))
        assert len(name) < 255


class KilledError(BaseException):
    """Nothing is cleaned up behind it."""


@pytest.mark.parametrize("step", [1, 2000, 1 << 40])
def test_a_conversion_that_is_stopped_anywhere_goes_on(mcap, tmp_path, monkeypatch, step):
    """Stopped at each place at which something was just written to the disk, with everything left as it is then."""
    from rosetta_jit.logs.converting import journal, parts

    def close(unfinished):
        for each in unfinished._open.values():
            each.file.abandon()

    monkeypatch.setattr(parts.Parts, "abandon", close)
    dice, out = random.Random(step), tmp_path / "out"

    def convert(lives):
        left = [lives]

        def spend(function):
            def spending(*arguments, **options):
                if left[0] == 0:
                    raise KilledError
                left[0] -= 1
                return function(*arguments, **options)

            return spending

        with monkeypatch.context() as patch:
            patch.setattr(parts, "STRETCHES_OPEN", 2)
            patch.setattr(files.TableFile, "close", spend(files.TableFile.close))
            patch.setattr(journal.Journal, "write", spend(journal.Journal.write))
            patch.setattr(Path, "replace", spend(Path.replace))
            log = rj.open(mcap)
            FolderConversion(log, list(log.channels), out, every_ns=10**9, resume=True, step_bytes=dice.choice((step, 5000))).run()

    stops = 0
    while True:
        try:
            convert(stops if stops < 10 else dice.randint(1, 40))
            break
        except KilledError:
            stops += 1
    assert stops > 5
    for topic in ("a", "b"):
        assert rows_of(out, topic) == wanted(topic)
    assert not list(out.rglob("*.part"))


SCRIPT = """
import sys, rosetta_jit as rj
from rosetta_jit.logs.converting.folder import FolderConversion
log = rj.open(sys.argv[1])
FolderConversion(log, list(log.channels), __import__("pathlib").Path(sys.argv[2]), every_ns=10**9, resume=True,
                 on_error="quarantine", step_bytes=int(sys.argv[3])).run()
"""


def killed_and_resumed(path, out, step, kills, dice):
    """Convert in processes of which some are killed at random times; how often that was."""
    command = [sys.executable, "-c", SCRIPT, str(path), str(out), str(step)]
    done = 0
    while True:
        process = subprocess.Popen(command)
        try:
            code = process.wait(dice.uniform(0.3, 1.2) if done < kills else None)
        except subprocess.TimeoutExpired:
            os.kill(process.pid, signal.SIGKILL)
            process.wait()
            done += 1
            continue
        assert code == 0
        return done


def test_a_process_that_is_killed(mcap, tmp_path):
    killed_and_resumed(mcap, tmp_path / "out", 500, 2, random.Random(1))
    for topic in ("a", "b"):
        assert rows_of(tmp_path / "out", topic) == wanted(topic)


@pytest.mark.campaign
def test_processes_that_are_killed_at_random(tmp_path):
    """Killed in the middle of the work, some hundred times: no row is lost, none is there twice, nor in the quarantine."""
    path = bad_log(tmp_path / "bad.mcap")
    dice, kills, begin = random.Random(2), 0, time.monotonic()
    for turn in range(40):
        out = tmp_path / f"out{turn}"
        kills += killed_and_resumed(path, out, dice.choice((1, 40, 300)), 6, dice)
        assert sorted(ds.dataset(out / "x").to_table()["x"].to_pylist()) == [number for number in range(60) if number % 10 != 5]
        assert sorted(ds.dataset(out / "y").to_table()["x"].to_pylist()) == list(range(60))
        lines = [json.loads(line) for line in (out / "_quarantine.jsonl").read_text().splitlines()]
        assert [each["message"] for each in lines] == list(range(5, 60, 10))
    print(f"{kills} kills in {time.monotonic() - begin:.0f} s")


def test_lcm_with_schemas(tmp_path):
    (tmp_path / "t.lcm").write_text(LCM_TYPES)
    log, out = write_lcm(tmp_path / "a.lcmlog", 50), tmp_path / "a.mcap"
    assert main(["convert", str(log), "-o", str(out), "--search-path", str(tmp_path)]) == 0
    with out.open("rb") as file:
        schemas = {(schema.name, schema.encoding, schema.data.decode()) for schema, _, _ in make_reader(file).iter_messages()}
    assert schemas == {(f"t.{name}", "lcm", LCM_TYPES) for name in ("point_t", "text_t")}
    again = rj.open(out)
    assert again["/a"]["x"].tolist() == [number / 4 for number in range(50)]
    assert [each.message for each in again.messages(raw=True)] == [each.message for each in rj.open(log).messages(raw=True)]
    assert main(["convert", str(out), "-o", str(tmp_path / "back.lcmlog")]) == 0
    assert [each.data for each in lcm.EventLog(str(tmp_path / "back.lcmlog"))] == [each.data for each in lcm.EventLog(str(log))]


def test_a_log_without_definitions_says_so(tmp_path, capsys):
    log = write_lcm(tmp_path / "a.lcmlog", 5)
    assert main(["convert", str(log), "-o", str(tmp_path / "a.mcap")]) == 0
    assert "--type /a=package.type" in capsys.readouterr().err


def test_yarp_to_mcap_and_back(tmp_path):
    """What the real yarpdatadumper wrote, into MCAP, and out again as it writes it."""
    out, back = tmp_path / "a.mcap", tmp_path / "back"
    assert main(["convert", str(DUMPED), "-o", str(out)]) == 0
    original, made = rj.open(DUMPED), rj.open(out)
    assert made.topics == original.topics
    assert (made["/image_mono"].type, made["/image_mono"].schema_encoding) == ("yarp.sig.ImageOfPixelMono", "bottle-schema")
    assert made["/image_mono"].to_arrow().equals(original["/image_mono"].to_arrow())
    assert main(["convert", str(out), "-o", str(back), "--as", "yarpdatadumper"]) == 0
    again = rj.open(back)
    for topic in original.topics:
        name = topic[1:]
        theirs, ours = (list(each.messages([topic], raw=True)) for each in (original, again))
        if name == "depth_compressed":
            assert (
                original[topic]
                .to_arrow()
                .drop_columns(["log_time", "publish_time"])
                .equals(again[topic].to_arrow().drop_columns(["log_time", "publish_time"]))
            )
            continue
        assert [(each.time, each.message) for each in ours] == [(each.time, each.message) for each in theirs]
    lines = [(DUMPED / "bottle_txrx_noenv" / "data.log").read_bytes(), (back / "bottle_txrx_noenv" / "data.log").read_bytes()]
    theirs, ours = ([line.split(b" ", 3)[3] for line in text.splitlines()] for text in lines)
    assert ours == theirs
    pixels = [(folder / "image_mono" / "00000003.pgm").read_bytes() for folder in (DUMPED, back)]
    assert pixels[0] == pixels[1]
    assert main(["convert", str(out), "-o", str(back), "--as", "yarpdatadumper"]) == 1  # it is there
    assert main(["convert", str(DRIVE), "-o", str(tmp_path / "no"), "--as", "yarpdatadumper"]) == 1
    assert not (tmp_path / "no").exists()


def test_mapped_messages_that_cannot_be_decoded(tmp_path, capsys):
    """Into a log, through a mapping: those that are broken are left out, and kept with reasons."""
    states, path, out = rj.open(DRIVE)["/joint_states"], tmp_path / "a.mcap", tmp_path / "out.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        channel = writer.register_channel("/s", "ros1", writer.register_schema(states.type, "ros1msg", states.schema.encode()))
        for number, each in enumerate(rj.open(DRIVE).messages(["/joint_states"], raw=True)):
            writer.add_message(channel, each.time, each.message[: -3 if number % 100 == 7 else None], each.time)
        writer.finish()
    convert = ["convert", str(path), "--mapping", "ros1/joint_positions.mapping", "-o", str(out)]
    assert main(convert) == 1
    assert "logged 20" in capsys.readouterr().err
    assert not out.exists()
    assert main([*convert, "--on-error", "quarantine"]) == 1
    lines = [json.loads(line) for line in (tmp_path / "out.mcap.quarantine.jsonl").read_text().splitlines()]
    assert [each["message"] for each in lines] == list(range(7, states.count, 100))
    assert rj.open(out)["/s"].count == states.count - len(lines)


def test_publish_times_are_kept(mcap, tmp_path):
    assert main(["convert", str(mcap), "-o", str(tmp_path / "b.mcap"), "--topic", "/a"]) == 0
    assert rj.open(tmp_path / "b.mcap")["/a"]["publish_time"].astype(int).tolist() == [time_of(n) - 7 for n in range(COUNT)]
