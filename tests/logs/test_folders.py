"""Logs that are folders: rosbag2's, written by rosbags, and yarpdatadumper's, written by YARP."""

from __future__ import annotations

import json
import shutil
import sqlite3
import struct
import sys
from pathlib import Path

import numpy as np
import pytest
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

import rosetta_jit as rj
from rosetta_jit.errors import LogError
from rosetta_jit.logs.yarp import reader as yarp_reader

from .made import POINT, TEXT, encoders, expected, time_of, values

COUNT = 50
DUMPED = Path(__file__).parent / "yarpdatadumper"
MODES = {"none": CompressionMode.NONE, "file": CompressionMode.FILE, "message": CompressionMode.MESSAGE}


def write_rosbag2(path, storage=StoragePlugin.SQLITE3, mode=CompressionMode.NONE, version=9):
    encode, types = encoders("cdr"), get_typestore(Stores.EMPTY)
    types.register(get_types_from_msg(POINT, "t/msg/Point") | get_types_from_msg(TEXT, "t/msg/Text"))
    writer = Writer(path, version=version, storage_plugin=storage)
    if mode is not CompressionMode.NONE:
        writer.set_compression(mode, CompressionFormat.ZSTD)
    with writer:
        connections = {
            topic: writer.add_connection(topic, name, typestore=types) for topic, name in (("/a", "t/msg/Point"), ("/b", "t/msg/Text"))
        }
        for time, topic, value in expected(COUNT):
            writer.write(connections[topic], time, encode(topic, value))
    return path


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("storage", StoragePlugin)
def test_rosbag2(tmp_path, storage, mode):
    log = rj.open(write_rosbag2(tmp_path / "a", storage, MODES[mode]))
    assert values(log.messages()) == list(expected(COUNT))
    assert [(each.topic, each.type, each.count) for each in log.channels] == [("/a", "t/msg/Point", COUNT), ("/b", "t/msg/Text", 10)]
    assert log["/a"]["x"].tolist() == [number / 4 for number in range(COUNT)]
    found = log.messages(["/a"], start=time_of(10), end=time_of(20), raw=True)
    assert [each.time for each in found] == [time_of(number) for number in range(10, 20)]


def test_a_single_file_of_a_rosbag2(tmp_path):
    (file,) = write_rosbag2(tmp_path / "a").glob("*.db3")
    assert values(rj.open(file).messages()) == list(expected(COUNT))


def test_split_files_and_damaged_metadata(tmp_path):
    folder = write_rosbag2(tmp_path / "a")
    (file,) = folder.glob("*.db3")
    shutil.copy(file, folder / "b.db3")
    found = []
    log = rj.open(folder, on_problem=found.append)
    assert [each.code for each in found] == ["log-file"]
    assert [each.time for each in log.messages(["/a"])] == 2 * [time_of(number) for number in range(COUNT)]
    assert log["/a"].count == 2 * COUNT
    (folder / "metadata.yaml").write_text("rosbag2_bagfile_information: [1, 2")
    (folder / "b.db3").write_bytes(file.read_bytes()[:5000])
    found.clear()
    log = rj.open(folder, on_problem=found.append)
    assert values(log.messages()) == list(expected(COUNT))
    assert [each.code for each in found] == ["log-index", "log-unreadable"]


@pytest.mark.parametrize("listed", ["7", "true", "1.5", "{a: 1}", "[7]", "[[a.db3]]", "[.nan]", "a.db3", "&a [*a]"])
def test_metadata_that_lists_no_names_is_not_used(tmp_path, listed):
    folder, found = write_rosbag2(tmp_path / "a"), []
    (folder / "metadata.yaml").write_text(f"rosbag2_bagfile_information: {{relative_file_paths: {listed}, compression_mode: {listed}}}")
    assert values(rj.open(folder, on_problem=found.append).messages()) == list(expected(COUNT))
    assert [each.code for each in found] == ["log-index"]


def test_lists_within_each_other_in_metadata_are_not_written_out(tmp_path):
    folder = write_rosbag2(tmp_path / "a")
    doubled = "".join(f"a{number}: &a{number} [*a{number - 1}, *a{number - 1}]\n" for number in range(1, 40))
    (folder / "metadata.yaml").write_text(
        f"a0: &a0 [x, x]\n{doubled}rosbag2_bagfile_information: {{relative_file_paths: *a39, compression_mode: *a39}}"
    )
    assert values(rj.open(folder, on_problem=[].append).messages()) == list(expected(COUNT))


@pytest.mark.parametrize("name", ["x" * 300 + ".db3", "a\0.db3", "a/" * 3000, "../a.db3", "/dev/zero", "."])
def test_metadata_that_names_what_is_no_file_of_the_folder(tmp_path, name):
    folder, found = write_rosbag2(tmp_path / "a"), []
    (folder / "metadata.yaml").write_text(json.dumps({"rosbag2_bagfile_information": {"relative_file_paths": [name]}}))
    assert values(rj.open(folder, on_problem=found.append).messages()) == list(expected(COUNT))
    assert [each.code for each in found] == ["log-file", "log-file"]


def test_old_files_have_no_definitions(tmp_path):
    log = rj.open(write_rosbag2(tmp_path / "a", version=8))
    (file,) = (tmp_path / "a").glob("*.db3")
    with sqlite3.connect(file) as database:
        database.execute("DROP TABLE IF EXISTS message_definitions")
    database.close()
    log = rj.open(file)
    with pytest.raises(LogError, match=r"a\.db3 has no definition of `t/msg/Point`, the type of the messages of `/a`"):
        log["/a"].to_arrow()
    (tmp_path / "t" / "msg").mkdir(parents=True)
    (tmp_path / "t" / "msg" / "Point.msg").write_text(POINT)
    assert rj.open(file, search_path=[tmp_path])["/a"]["x"].shape == (COUNT,)


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("storage", [StoragePlugin.SQLITE3, StoragePlugin.MCAP])
def test_a_folder_whose_recorder_was_killed(storage, mode, tmp_path):
    """There is no metadata.yaml: the files are read as they are, and messages that are compressed one by one are told by their begin."""
    folder = write_rosbag2(tmp_path / "drive", storage, MODES[mode])
    (folder / "metadata.yaml").unlink()
    (file,) = folder.iterdir()
    file.rename(folder / file.name.replace("drive.", "drive_0."))  # as rosbag2 itself calls it
    found = []
    log = rj.open(folder, on_problem=found.append)
    assert log.format == "rosbag2"
    assert values(log.messages()) == list(expected(COUNT))
    assert [each.message for each in found] == [f"{folder} has no file metadata.yaml"]


def test_a_database_that_is_a_program(tmp_path):
    """A view that never ends is not asked."""
    path = tmp_path / "a.db3"
    with sqlite3.connect(path) as database:
        database.execute("CREATE TABLE topics (id, name, type, serialization_format)")
        database.execute(
            "CREATE VIEW messages AS WITH RECURSIVE n(id) AS (SELECT 1 UNION ALL SELECT id FROM n)"
            " SELECT id, 1 AS topic_id, 1 AS timestamp, x'00' AS data FROM n"
        )
    database.close()
    with pytest.raises(LogError, match="it has no tables"):
        rj.open(path)


def sent(name):
    return json.loads((DUMPED / name / "sent.json").read_text())["sent"]


@pytest.mark.parametrize("name", ["bottle_default", "bottle_tx_noenv", "bottle_txrx_noenv"])
def test_bottles_that_yarp_kept(name):
    """The messages are those that were sent, as far as text can say them."""
    from rosetta_jit.frameworks.yarp.bottle import read
    from rosetta_jit.frameworks.yarp.tags import YARP3

    log = rj.open(DUMPED / name)
    messages = list(log.messages(raw=True))
    assert [each.topic for each in messages] == [f"/{name}"] * len(messages)
    assert [plain(read(each.message, YARP3)) for each in messages] == [plain_sent(each["tree"]) for each in sent(name)[-len(messages) :]]
    assert len(messages) == log[f"/{name}"].count >= 20
    times = [each.time for each in messages]
    assert times == sorted(times)
    if name == "bottle_default":
        assert times[0] == 1_700_000_003 * 10**9


def plain(item):
    """An item of a bottle without its width."""
    from rosetta_jit.frameworks.yarp.tree import List

    if isinstance(item, List):
        return [plain(each) for each in item.items]
    return item.value


def plain_sent(tree):
    found = []
    for each in tree:
        match each:
            case ["list", _, items]:
                found.append(plain_sent(items))
            case ["float64", text, *_]:
                found.append(float.fromhex(text))
            case ["string" | "blob", octets, *_]:
                found.append(bytes.fromhex(octets))
            case [_, number, *_]:
                found.append(int(number))
    return found


def test_images_that_yarp_kept():
    log = rj.open(DUMPED)
    assert "/image_mono" in log.topics
    for name, depth in (("image_mono", 1), ("image_png", 3)):
        for each, image in zip(log[f"/{name}"], sent(name), strict=True):
            geometry = each.geometry
            assert (geometry.width, geometry.height, geometry.depth) == (image["image"]["width"], image["image"]["height"], depth)
            assert bytes(each.pixels) == padded(image["image"]["formula"], geometry)
    first = next(iter(log["/depth_compressed"]))
    pixels = struct.unpack(f"<{20 * 16}f", bytes(first.pixels))
    assert pixels == tuple(0.25 * x + y + 3 for y in range(16) for x in range(20))


@pytest.mark.parametrize("time", ["9223372037.5", "-9999999999", "1e9", "12345678901", "x", ""])
def test_a_time_that_is_none(time, tmp_path):
    (tmp_path / "info.log").write_text("Type: Bottle;\nStamp: tx;\n")
    (tmp_path / "data.log").write_text(f"1 1.5 7\n2 {time} 8\n3 9223372036.5 9\n")
    found = []
    log = rj.open(tmp_path, on_problem=found.append)
    assert [each.time for each in log.messages(raw=True)] == [1_500_000_000, 9_223_372_036_500_000_000]
    assert [each.message.rpartition(": ")[2] for each in found] == [f"{time.encode()!r} is no time"]


def test_opening_a_folder_of_yarp_reads_no_images(tmp_path, monkeypatch):
    """The lines tell types, counts and times; the files may be many gigabytes."""
    shutil.copytree(DUMPED / "image_mono", tmp_path / "p")
    with monkeypatch.context() as patched:
        patched.setattr(yarp_reader, "image_message", None)
        log = rj.open(tmp_path / "p")
        assert (log["/p"].type, log["/p"].count) == ("yarp.sig.ImageOfPixelMono", 12)
    late = list(log.messages(start=log.end))
    assert [each.time for each in late] == [log.end]
    (tmp_path / "p" / "00000003.pgm").write_bytes(b"P5")
    found = []
    log = rj.open(tmp_path / "p", on_problem=found.append)
    assert len(list(log["/p"])) == log["/p"].count == 11  # what could not be read is not counted any more
    assert [each.code for each in found] == ["log-message"]


def write_video(folder, suffix, *, without=0):
    """A folder as `yarpdatadumper --type video` writes it, by OpenCV as there; the first lines came before the video was begun."""
    cv = pytest.importorskip("cv2")
    folder.mkdir()
    video = cv.VideoWriter(str(folder / f"video.{suffix}"), cv.VideoWriter.fourcc(*"HFYU"), 10, (24, 16), True)
    frames = [np.random.default_rng(number).integers(0, 256, (16, 24, 3), np.uint8) for number in range(5)]
    for each in frames:
        video.write(each[:, :, ::-1])
    video.release()
    (folder / "info.log").write_text(f"Type: Image; Video:{suffix}(huffyuv);\nStamp: tx;\n")
    lines = [f"{number} {1_700_000_000 + number}.000000 frame_{number:08d}\n" for number in range(without + 5)]
    (folder / "data.log").write_text("".join(lines))
    (folder / "timecodes.log").write_text("# timecode format v2\n" + "".join(f"{number * 1000}\n" for number in range(5)))
    return frames


@pytest.mark.parametrize("without", [0, 2])
@pytest.mark.parametrize("suffix", ["mkv", "avi"])
def test_videos_of_yarp(suffix, without, tmp_path):
    frames, found = write_video(tmp_path / "v", suffix, without=without), []
    log = rj.open(tmp_path / "v", on_problem=found.append)
    assert (log["/v"].type, log["/v"].count) == ("yarp.sig.ImageOfPixelRgb", 5 + without)
    for _ in range(2):
        assert [bytes(each.pixels) for each in log["/v"]] == [each.tobytes() for each in frames]
    assert [each.message.rpartition(": ")[2] for each in found] == ["the video begins with frame 2"] * without
    late = log.messages(start=log.start + (3 + without) * 10**9)
    assert [bytes(each.message.pixels) for each in late] == [each.tobytes() for each in frames[3:]]


@pytest.mark.parametrize(
    ("damage", "said"),
    [
        (lambda path: path.unlink(), "there is no video.mkv or video.avi"),
        (lambda path: path.write_bytes(path.read_bytes()[:-4000]), "the video has no frame"),
        (lambda path: path.write_bytes(b"#EXTM3U\nhttp://127.0.0.1:9/a.ts\n"), "no Matroska or AVI file"),
        (lambda path: path.write_bytes(path.read_bytes()[:8]), "has no frames"),
    ],
    ids=["missing", "cut", "addresses", "begin"],
)
def test_damaged_videos_of_yarp(damage, said, tmp_path):
    """What lies before is read, and it is said once what is wrong."""
    frames, found = write_video(tmp_path / "v", "mkv"), []
    damage(tmp_path / "v" / "video.mkv")
    read = [bytes(each.pixels) for each in rj.open(tmp_path / "v", on_problem=found.append)["/v"]]
    assert read == [each.tobytes() for each in frames[: len(read)]]
    (problem,) = found
    assert problem.code == "log-damaged"
    assert said in problem.message


@pytest.mark.parametrize(("package", "name", "extra"), [("cv2", "frame_00000000", "videos"), ("PIL.Image", "00000000.png [rgb]", "images")])
def test_a_package_that_images_need(package, name, extra, tmp_path, monkeypatch):
    """It is named once, not for each image; other ports are read without it."""
    shutil.copytree(DUMPED / "image_png", tmp_path / "d" / "p")
    (tmp_path / "d" / "p" / "data.log").write_text("".join(f"{number} {number}.5 {name}\n" for number in range(3)))
    (tmp_path / "d" / "p" / "video.mkv").write_bytes(b"\x1a\x45\xdf\xa3" + bytes(20))
    shutil.copytree(DUMPED / "bottle_default", tmp_path / "d" / "b")
    monkeypatch.setitem(sys.modules, package, None)
    log = rj.open(tmp_path / "d")
    assert len(list(log.messages(["/b"], raw=True))) == 40
    with pytest.raises(LogError, match=rf"pip install 'rosetta-jit\[{extra}\]'"):
        list(log.messages(["/p"], raw=True))


def padded(formula, geometry):
    """The rows that a formula of x and y gives, padded to 8 bytes."""
    formulas = [each.rpartition("=")[2] for each in formula.split()]
    rows = []
    for y in range(geometry.height):
        row = bytes(eval(each, {"x": x, "y": y}) for x in range(geometry.width) for each in formulas)  # noqa: S307 - our own file
        rows.append(row + bytes(-len(row) % 8))
    return b"".join(rows)


def test_damaged_folders_of_yarp(tmp_path):
    folder = tmp_path / "p"
    shutil.copytree(DUMPED / "bottle_default", folder)
    data = (folder / "data.log").read_bytes()
    whole = len(list(rj.open(folder).messages(raw=True)))
    (folder / "data.log").write_bytes(b"no line\n" + data[:-3])
    found = []
    assert len(list(rj.open(folder, on_problem=found.append).messages(raw=True))) == whole - 1
    assert [each.code for each in found] == ["log-message", "log-cut"]
    (folder / "data.log").write_bytes(b"1 1.5 ../../secret.ppm [rgb]\n1 1.5 gone.ppm [rgb]\n")
    (folder / "info.log").write_text("Type: Image;\nStamp: tx;\n")
    found.clear()
    assert not list(rj.open(folder, on_problem=found.append).messages(raw=True))
    assert [each.code for each in found] == ["log-message"] * 2


def test_a_wal_elsewhere_has_rows_that_count(tmp_path):
    """Where a file must be copied to be read, the rows are read that are in its WAL alone."""
    import fsspec

    (file,) = write_rosbag2(tmp_path / "a").glob("*.db3")
    database = sqlite3.connect(file)
    rows = database.execute("SELECT topic_id, timestamp, data FROM messages ORDER BY id DESC LIMIT 7").fetchall()
    database.execute("DELETE FROM messages WHERE id > (SELECT MAX(id) - 7 FROM messages)")
    database.commit()
    database.execute("PRAGMA journal_mode = WAL")
    database.executemany("INSERT INTO messages (topic_id, timestamp, data) VALUES (?, ?, ?)", reversed(rows))
    database.commit()
    memory = fsspec.filesystem("memory")
    memory.pipe("/wal/alone.db3", file.read_bytes())
    for end in ("", "-wal"):
        memory.pipe(f"/wal/a.db3{end}", Path(f"{file}{end}").read_bytes())
    database.close()
    assert values(rj.open("memory://wal/a.db3").messages()) == list(expected(COUNT))
    assert values(rj.open("memory://wal/alone.db3").messages()) == list(expected(COUNT))[:-7]
