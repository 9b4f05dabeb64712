"""The loop that is planted to see whether the benchmarks watch, and the runs that they are compared with."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import replace

import pytest

from bench import baseline, compare, planting
from tests.bench import runs

PLANTED = """
from bench import planting
from rosetta_jit.runtime.code import assembler
planting.plant()
texts = []
linked = assembler.linked
assembler.linked = lambda parts, *context: linked((texts.append(each) or each for each in parts), *context)
from rosetta_jit.backends.entry import link
link.linked = assembler.linked
import rosetta_jit as rj
decode = rj.Decoder.of("sensor_msgs/Imu", encoding="ros1")
encode = rj.Encoder.of("sensor_msgs/Imu", encoding="ros1")
holder = decode.new()
holder.orientation.w = 0.5
assert decode(encode(holder)).orientation.w == 0.5
kernels, accessors = ([each.count("imull") for each in texts if name in each] for name in ('@"kernel"', "@set_"))
assert kernels and all(kernels), kernels
assert accessors and all(accessors), accessors
"""


@pytest.mark.skipif(os.uname().machine != "x86_64", reason="the loop is written for x86-64")
def test_a_loop_is_planted_in_code_that_still_works(tmp_path):
    environment = {**os.environ, "ROSETTA_JIT_CACHE_DIR": str(tmp_path)}
    ran = subprocess.run([sys.executable, "-c", PLANTED], env=environment, capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr


def test_loops_of_text():
    text = 'define i64 @get(ptr %a) {\nstart:\n  ret i64 1\n}\ndefine i64 @"other"(ptr %a)\n{\n  ret i64 1\n}\n'
    assert planting.in_functions(text, {"get"}).splitlines()[2].strip() == planting.LOOP
    assert planting.in_functions(text, {"other"}).splitlines()[6].strip() == planting.LOOP
    source = "class A:\n    def f(self, x=(1, 2)) -> int:\n        return 1\n"
    assert planting.in_source("a.py", source).splitlines()[2] == "        for _ in range(20): pass"
    assert planting.in_source("a.c", source) == source


def test_each_family_must_tell(tmp_path, monkeypatch, capsys):
    old = [replace(runs.row(name), family=family) for name, family in (("a", "calls"), ("b", "calls"), ("c", "logs"), ("d", "memory"))]
    slow = [replace(row, measured=row.measured.times(1.5)) for row in old]

    def planted(*rows):
        folder = tmp_path / "baseline"
        kept = baseline.keep(written(tmp_path / "old.json", old), folder)
        with monkeypatch.context() as patch:
            patch.setattr(baseline, "kept", lambda: [kept])
            return planting.main([str(written(tmp_path / "new.json", rows))])

    assert planted(slow[0], old[1], slow[2], old[3]) == 0
    assert planted(old[0], slow[1], old[2], old[3]) == 1
    assert "| logs | c | +0 % | **not told** |" in capsys.readouterr().out
    assert planting.main([str(tmp_path / "nothing.json")]) == 2


def test_few_runs_are_kept_which_name_no_machine(tmp_path):
    for day in range(5):
        run = runs.run(runs.row("a", 1.23456789))
        run["machine_info"]["node"] = "a host"
        path = tmp_path / "run.json"
        path.write_text(json.dumps({**run, "datetime": f"2026-01-0{day + 1}T10:00:00.5"}))
        baseline.keep(path, tmp_path / "kept")
    kept = baseline.kept(tmp_path / "kept")
    assert [each.stem for each in kept] == ["2026-01-03T10-00-00", "2026-01-04T10-00-00", "2026-01-05T10-00-00"]
    assert "a host" not in kept[-1].read_text()
    assert '"median": 1.235' in kept[-1].read_text()
    assert compare.main([*map(str, kept), str(path)]) == 0


def test_runs_of_other_machines_are_not_compared(tmp_path, capsys):
    old = written(tmp_path / "old.json", [runs.row("a")])
    slow = runs.run(runs.row("a", 9.0))
    slow["machine_info"]["cpu"]["count"] = 64
    new = tmp_path / "new.json"
    new.write_text(json.dumps(slow))
    assert compare.main([str(old), str(new)]) == 1
    assert compare.main(["--same-machine", str(old), str(new)]) == 0
    assert "not compared with runs of" in capsys.readouterr().out
    same = written(tmp_path / "same.json", [runs.row("a", 9.0)])
    assert compare.main(["--same-machine", str(old), str(same)]) == 1
    assert compare.main(["--same-machine", str(new), str(old), str(same)]) == 1
    slow["machine_info"]["cpu"] |= {"count": 2, "family": 26, "model": 2}
    new.write_text(json.dumps(slow))
    assert compare.main(["--same-machine", str(old), str(new)]) == 0


def written(path, rows):
    path.write_text(json.dumps(runs.run(*rows)))
    return path
