"""Logs on Ray and on Dask: each message in one task, whatever the number of tasks, and if a worker is killed in the middle.

The tests without a cluster run the tasks that the engines would run; those with real clusters are campaigns.
"""

from __future__ import annotations

import os
import pickle
import signal
import warnings
from pathlib import Path

import numpy as np
import pytest

import rosetta_jit as rj
from rosetta_jit.errors import LogError
from rosetta_jit.logs import shares
from rosetta_jit.logs.lcm import reader as lcm_reader
from rosetta_jit.logs.shares import Reading, paths_of, shares_of

from .made import LCM_TYPES, POINT, time_of, write_bag, write_lcm, write_mcap

COUNT = 120
DRIVE = Path(rj.__file__).parent / "demo" / "recordings" / "drive.bag"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("engines")
    write_mcap(folder / "one.mcap", COUNT, chunk_size=700)
    write_mcap(folder / "two.mcap", COUNT, chunk_size=700)
    write_bag(folder / "a.bag", COUNT)
    write_lcm(folder / "a.lcmlog", COUNT)
    (folder / "t.lcm").write_text(LCM_TYPES)
    return folder


@pytest.fixture(autouse=True)
def small(monkeypatch):
    monkeypatch.setattr(shares, "LEAST_BYTES", 1)
    monkeypatch.setattr(lcm_reader, "PIECE", 500)
    monkeypatch.setattr(lcm_reader, "WINDOW", 300)


def numbers(tables):
    return [value for each in tables for value in each["x"].to_pylist()]


WHOLE = [number / 4 for number in range(COUNT)]


@pytest.mark.parametrize("tasks", [1, 3, 7, 1000])
@pytest.mark.parametrize("name", ["one.mcap", "a.bag", "a.lcmlog"])
def test_each_message_is_in_one_share(folder, name, tasks):
    options = {"target": "t.point_t", "options": {"search_path": (str(folder),), "imports": ("t.lcm",)}} if "lcm" in name else {}
    reading, path = Reading("/a", **options), str(folder / name)
    found = [pickle.loads(pickle.dumps(each)) for each in shares_of([path], reading, tasks)]  # noqa: S301 - our own
    assert len(found) >= min(tasks, 4) or name == "a.bag"
    assert numbers(table for each in found for table in each.tables(reading)) == WHOLE
    schema = reading.schema([path])
    assert all(table.schema == schema for each in found for table in each.tables(reading))


STEPS = """import "t/msg/Point.msg"
import "t/msg/Step.msg"
state last: float64 = -0.25
data-holder: t/msg/Step
wire-schema: t/msg/Point
unpack-rules:
  ignore .name
  .x = .x - last
  state last = .x
"""


def test_a_log_is_whole_where_the_mapping_keeps_state(folder, tmp_path):
    """Each message comes behind the one before it; another reading begins anew."""
    (tmp_path / "t" / "msg").mkdir(parents=True)
    for name, text in (("t/msg/Point.msg", POINT), ("t/msg/Step.msg", "float64 x\n"), ("step.mapping", STEPS)):
        (tmp_path / name).write_text(text)
    reading = Reading("/a", "step.mapping", options={"search_path": (str(tmp_path),)})
    (share,) = shares_of([str(folder / "one.mcap")], reading, 7)
    assert share.pieces is None
    for _ in range(2):
        assert numbers(share.tables(reading)) == [0.25] * COUNT
    channel = rj.open(folder / "one.mcap", search_path=(str(tmp_path),))["/a", "step.mapping"]
    assert [channel.to_arrow()["x"].to_pylist() for _ in range(2)] == [[0.25] * COUNT] * 2


def test_the_count_of_a_log_that_is_one_share(folder, monkeypatch):
    monkeypatch.setattr(shares, "LEAST_BYTES", 1 << 20)
    (whole,) = shares_of([str(folder / "one.mcap")], Reading("/a"), 2)
    assert whole.rows == COUNT
    (some,) = shares_of([str(folder / "one.mcap")], Reading("/a", start_ns=time_of(3)), 2)
    assert some.rows is None


def test_with_as_many_logs_as_tasks_none_is_opened(folder, monkeypatch):
    monkeypatch.setattr(shares, "open_log", None)
    paths = [str(folder / "one.mcap"), str(folder / "two.mcap")]
    assert [(each.path, each.pieces) for each in shares_of(paths, Reading("/a"), 2)] == [(each, None) for each in paths]


def test_what_is_read_of_each(folder):
    path = str(folder / "one.mcap")
    late = Reading.of("/a", None, ["x"], ["log_time"], time_of(30), time_of(50))
    found = shares_of([path], late, 1000)
    assert len(found) < len(shares_of([path], Reading("/a"), 1000))
    assert numbers(table for each in found for table in each.tables(late)) == WHOLE[30:50]
    assert late.schema([path]).names == ["log_time", "x"]
    times = Reading.of("/a", None, [], ["publish_time"], None, None)
    assert [table.num_rows for each in shares_of([path], times, 1) for table in each.tables(times)] == [COUNT]
    with pytest.raises(LogError, match="no topic"):
        shares_of([path], Reading("/c"), 2)
    skipping = Reading("/c", on_missing="skip")
    assert not shares_of([path], skipping, 2)
    assert not list(shares_of([path], skipping, 1)[0].tables(skipping))
    with pytest.raises(LogError, match="no topic"):
        skipping.schema([path])


def test_paths(folder):
    assert paths_of(folder / "one.mcap") == [str(folder / "one.mcap")]
    assert paths_of(f"{folder}/*.mcap") == [str(folder / "one.mcap"), str(folder / "two.mcap")]
    assert paths_of([f"file://{folder}/*.mcap", folder / "a.bag"])[:2] == [f"file://{folder}/{name}.mcap" for name in ("one", "two")]
    with pytest.raises(FileNotFoundError, match="there are no logs"):
        paths_of(f"{folder}/*.xyz")


def test_programs_batches_and_logs_are_pickled_as_recipes():
    """A decoder, a mapping's decoder, a batch and a channel, in a few kilobytes, and each is itself again."""
    decode, mapped = rj.Decoder.of("t/msg/Point", encoding="cdr", schema=POINT), rj.Decoder("ros1/joint_positions.mapping")
    states = rj.open(DRIVE)["/joint_states", "ros1/joint_positions.mapping"]
    data = next(rj.open(DRIVE).messages(["/joint_states"], raw=True)).message
    for each in (decode, mapped, states):
        assert len(pickle.dumps(each)) < 2000
    again, channel = pickle.loads(pickle.dumps((mapped, states)))  # noqa: S301 - our own
    assert again(data) == mapped(data)
    assert channel.to_arrow().equals(states.to_arrow())
    batch = mapped.many([data, data])
    assert pickle.loads(pickle.dumps(batch)).to_arrow().equals(batch.to_arrow())  # noqa: S301 - our own


@pytest.fixture
def ray_source(folder):
    pytest.importorskip("ray")
    with warnings.catch_warnings(action="ignore"):
        from rosetta_jit.ray import LogDatasource
    return LogDatasource([str(folder / "one.mcap")], Reading("/a"))


def run(source, tasks=5):
    return [table for task in source.get_read_tasks(tasks) for table in pickle.loads(pickle.dumps(task.read_fn))()]  # noqa: S301 - our own


def test_tasks_of_ray(ray_source, folder):
    tasks = ray_source.get_read_tasks(5)
    assert len(tasks) > 3
    assert tasks[0].schema.names == ["log_time", "publish_time", "x", "name"]
    assert all(task.metadata.input_files == (str(folder / "one.mcap"),) for task in tasks)
    assert numbers(run(ray_source)) == WHOLE
    assert ray_source.estimate_inmemory_data_size() > 0


def test_columns_and_filters_are_pushed_into_the_tasks_of_ray(ray_source):
    from ray.data.expressions import col, lit

    few = ray_source.apply_projection({"x": "x"})
    assert {tuple(table.column_names) for table in run(few)} == {("x",)}
    assert numbers(run(few)) == WHOLE
    assert sum(table.num_rows for table in run(ray_source.apply_projection({}))) == COUNT
    moment = lit(np.datetime64(time_of(50), "ns"))
    late = few.apply_predicate((col("log_time") >= moment) & (col("name") != "p60"))
    assert len(late.get_read_tasks(1000)) < len(few.get_read_tasks(1000))
    assert numbers(run(late)) == [each for each in WHOLE[50:] if each != 15.0]
    for predicate, wanted in (
        (col("log_time") > moment, WHOLE[51:]),
        (moment > col("log_time"), WHOLE[:50]),
        (col("log_time") <= moment, WHOLE[:51]),
        ((col("log_time") > moment) | (col("x") < 1.0), WHOLE[:4] + WHOLE[51:]),
    ):
        assert numbers(run(few.apply_predicate(predicate))) == wanted


def test_partitions_of_dask(folder):
    pytest.importorskip("dask.dataframe")
    from rosetta_jit.dask import read_log

    frame = read_log([folder / "one.mcap", folder / "two.mcap"], "/a", npartitions=6)
    assert frame.npartitions >= 6
    assert list(frame.columns) == ["log_time", "publish_time", "x", "name"]
    assert frame["x"].compute(scheduler="synchronous").tolist() == WHOLE + WHOLE
    imu = read_log(DRIVE, "/imu", columns=["angular_velocity"], npartitions=2)
    assert list(imu.columns) == ["log_time", "publish_time", *(f"angular_velocity.{axis}" for axis in "xyz")]
    assert imu["angular_velocity.z"].max().compute(scheduler="synchronous") == 0.5


def test_a_missing_engine_is_named(monkeypatch):
    import sys

    for module, engine in (("rosetta_jit.ray", "ray.data"), ("rosetta_jit.dask", "dask.dataframe")):
        monkeypatch.delitem(sys.modules, module, raising=False)
        monkeypatch.setitem(sys.modules, engine, None)
        with pytest.raises(rj.MissingPackage, match=r"pip install 'rosetta-jit\["):
            __import__(module)


class Deadly:
    """Kills the process that it is called in, the n-th time that any process calls it; only once."""

    def __init__(self, folder, after):
        self.folder, self.after = folder, after

    def __call__(self, batch):
        calls = len(list(self.folder.iterdir()))
        (self.folder / f"{os.getpid()}-{calls}").touch()
        if calls == self.after:
            os.kill(os.getpid(), signal.SIGKILL)
        return batch


@pytest.fixture(scope="module")
def large(tmp_path_factory):
    return write_mcap(tmp_path_factory.mktemp("large") / "a.mcap", 50_000, chunk_size=20_000)


@pytest.mark.campaign
@pytest.mark.parametrize("after", [0, 5, 20])
def test_a_worker_of_ray_is_killed(large, tmp_path, after):
    ray = pytest.importorskip("ray")
    with warnings.catch_warnings(action="ignore"):
        from rosetta_jit.ray import read_log

        ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False)
        try:
            dataset = read_log(str(large), "/a", override_num_blocks=12).map_batches(Deadly(tmp_path, after), batch_size=1000)
            assert sorted(each["x"] for each in dataset.select_columns(["x"]).iter_rows()) == [number / 4 for number in range(50_000)]
            assert read_log(str(large), "/a").count() == 50_000
            workers = {each.name.partition("-")[0] for each in tmp_path.iterdir()}
            assert len(workers) >= 2
        finally:
            ray.shutdown()


@pytest.mark.campaign
@pytest.mark.parametrize("after", [0, 3, 8])
def test_a_worker_of_dask_is_killed(large, tmp_path, after):
    distributed = pytest.importorskip("distributed")
    with warnings.catch_warnings(action="ignore"):
        from rosetta_jit.dask import read_log

        with distributed.LocalCluster(2, threads_per_worker=1, dashboard_address=None) as cluster, distributed.Client(cluster):
            frame = read_log(large, "/a", npartitions=12)
            found = frame.map_partitions(Deadly(tmp_path, after), meta=frame._meta)["x"].compute()
            assert found.tolist() == [number / 4 for number in range(50_000)]
            workers = {each.name.partition("-")[0] for each in tmp_path.iterdir()}
            assert len(workers) >= 2
