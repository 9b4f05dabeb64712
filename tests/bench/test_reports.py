"""Reports of a run: the page, the table, the README, and the comparison of two runs."""

from __future__ import annotations

import json
import re
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

from bench import compare
from bench.figures import Comparison, Figure, from_json
from bench.report import __main__ as reports
from bench.report import plot, tables
from bench.report.readme import BEGIN, END, HEADLINES, PICTURE, TABLE, write_in
from bench.run import of
from tests.bench import runs

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def written(tmp_path):
    reports.write(of(runs.run(runs.row("fast"), runs.row("slow", 3.0), runs.row("reported", at_most=None))), tmp_path)
    return tmp_path


def test_the_table_marks_what_was_missed(written):
    text = (written / "report.md").read_text("utf-8")
    assert "| fast | 1.5 (1.4 to 1.6) x len() | 2 x len() | met - 25 ns |" in text
    assert "| slow | 3 (2.9 to 3.1) x len() | 2 x len() | **missed** - 25 ns |" in text
    assert "| reported | 1.5 (1.4 to 1.6) x len() |  | 25 ns |" in text


def test_the_table_says_what_peers_make_and_how_we_stand_to_them(written):
    lines = (written / "report.md").read_text("utf-8").splitlines()
    assert "| len() | a number | 10 ns (10 to 10) | 3 (2.5 to 3.5) |" in lines
    (peer,) = [line for line in lines if "alert" in line and "anew" in line]
    assert peer.endswith("| an object, anew | 400 ns (300 to 500) | 0.1 (0.075 to 0.1) |")


def test_each_of_ours_is_compared_with_each_peer_and_limits_among_themselves():
    figures = [Figure(who, "ours", "", (ns,)) for who, ns in (("used again", 10.0), ("anew", 40.0))]
    peer, limit, other = Figure("peer", "peer", "", (80.0,)), Figure("len()", "limit", "", (20.0,)), Figure("empty", "limit", "", (10.0,))
    head, lines = tables.contenders(Comparison("", "", (*figures, peer)))
    assert head[3:] == ("used again, as a multiple", "anew, as a multiple")
    ratios = [tuple(cell.partition(" ")[0] for cell in line[3:]) for line in lines]
    assert ratios == [("", ""), ("", ""), ("0.125", "0.5")]
    head, lines = tables.contenders(Comparison("", "", (limit, other)))
    assert head[3:] == ("as a multiple of len()",)
    assert [line[3].partition(" ")[0] for line in lines] == ["", "0.5"]


def test_curves_in_parts_have_a_slope_of_the_whole():
    *_, stacked = runs.report().curves
    *_, (who, reach, *_) = tables.growth(stacked)
    assert (who, reach) == ("the whole", "1 to 10 fields: 4 to 8 ms")


def test_shares_are_told_in_both_reports(written):
    assert "| share of | 1 fields | 10 fields |" in (text := (written / "report.md").read_text("utf-8"))
    assert "| parse | 25 % | 25 % |" in text
    assert "| the whole | 4 ms | 8 ms |" in text
    assert "<td>parse</td><td>25 %</td><td>25 %</td>" in (written / "report.html").read_text("utf-8")


@pytest.mark.parametrize(
    ("low", "high", "ticks"),
    [(150, 400, [200.0, 500.0, 1000.0]), (9, 12, [10.0, 20.0, 50.0, 100.0]), (1, 10**4, [1.0, 10.0, 100.0, 1000.0, 10_000.0])],
)
def test_axes_have_ticks_that_can_be_read(low, high, ticks):
    assert plot.Scale.over([low, high], 0, 100).ticks() == ticks


def test_slopes_are_stated_and_superlinear_ones_are_flagged(written):
    lines = [line for line in (written / "report.md").read_text("utf-8").splitlines() if line.startswith("| size")]
    assert [("x^2.00" in line, "steeper" in line) for line in lines] == [(True, True), (False, False)]


def test_the_page_needs_nothing_beside_itself(written):
    page = (written / "report.html").read_text("utf-8")
    assert not re.search(r"(src|href)=|@import|url\(", page)
    assert "<script" not in page
    assert "&lt;script&gt;" in page


def test_plots_are_well_formed_and_within_their_pictures(written):
    page = (written / "report.html").read_text("utf-8")
    pictures = [ET.fromstring(each) for each in re.findall(r"<svg.*?</svg>", page, re.DOTALL)]  # noqa: S314 - written by us
    assert len(pictures) == 1 + 3
    for picture in pictures:
        _, _, width, height = map(float, picture.get("viewBox").split())
        for mark in picture.iter("circle"):
            assert 0 <= float(mark.get("cx")) <= width
            assert 0 <= float(mark.get("cy")) <= height


def test_shares_add_up_to_the_whole(written):
    page = (written / "report.html").read_text("utf-8")
    assert "parse: 1 ms, 25 %" in page
    assert ">8 ms</text>" in page


def test_the_readme_shows_the_first_rows_and_a_page_all_of_them(tmp_path):
    (tmp_path / "docs").mkdir()
    pages = tmp_path / "README.md", tmp_path / TABLE
    for page in pages:
        page.write_text(f"before\n{BEGIN}old\n{END}\nafter\n")
    write_in(tmp_path, [runs.row("fast"), runs.row(HEADLINES[0])])
    texts = [page.read_text("utf-8") for page in pages]
    for text in texts:
        assert text.startswith(f"before\n{BEGIN}| what |")
        assert text.endswith(f"met - 25 ns |\n{END}\nafter\n")
        assert "old" not in text
    assert ["| fast |" in text for text in texts] == [False, True]
    picture = ET.fromstring((tmp_path / PICTURE).read_text("utf-8"))  # noqa: S314 - written by us
    assert len(list(picture.iter("{http://www.w3.org/2000/svg}circle"))) == 1


def test_the_repository_has_the_marks_that_a_run_writes_between():
    for name in ("README.md", TABLE):
        text = (ROOT / name).read_text("utf-8")
        assert text.index(BEGIN) < text.index(END)


def compared(tmp_path, *rows):
    """Runs of these rows, the last of them the new one."""
    paths = [tmp_path / f"{number}.json" for number in range(len(rows))]
    for path, each in zip(paths, rows, strict=True):
        path.write_text(json.dumps(runs.run(*each)))
    return compare.main([str(path) for path in paths])


def test_a_regression_fails(tmp_path, capsys):
    assert compared(tmp_path, [runs.row("a"), runs.row("b")], [runs.row("a", 1.5 * 1.2), runs.row("b")]) == 1
    out = capsys.readouterr().out
    assert "| a | 1.5 (1.4 to 1.6) | 1.8 (1.7 to 1.9) x len() | +20 % | **regression** |" in out
    assert "| b" not in out


@pytest.mark.parametrize(
    ("new", "why"),
    [
        (runs.row("a", 1.5 * 1.14), "not enough"),
        (runs.row("a", 1.0), "better"),
        (runs.row("a", 3.0, at_most=None), "no target"),
        (runs.row("b", 9.0), "nothing to compare with"),
    ],
)
def test_other_changes_do_not_fail(tmp_path, new, why):
    assert compared(tmp_path, [runs.row("a")], [new]) == 0, why


def test_noise_is_not_shown(tmp_path, capsys):
    assert compared(tmp_path, [runs.row("a", width=0.3)], [runs.row("a", 1.6, width=0.3)]) == 0
    assert capsys.readouterr().out == "nothing changed beyond the noise\n"


def test_changes_that_nobody_can_measure_are_not_shown(tmp_path, capsys):
    assert compared(tmp_path, [runs.row("a", width=0.0)], [runs.row("a", 1.51, width=0.0)]) == 0
    assert capsys.readouterr().out == "nothing changed beyond the noise\n"


def test_several_old_runs_tell_how_much_runs_vary(tmp_path):
    """Quartiles are narrow within a process; the second old run was as slow as the new one is."""
    low, high = [runs.row("a", width=0.01)], [runs.row("a", 1.9, width=0.01)]
    assert compared(tmp_path, low, high) == 1
    assert compared(tmp_path, low, low, high, high) == 0


def test_a_row_that_was_nothing_is_not_divided_by(tmp_path):
    assert compared(tmp_path, [runs.row("a", 0.0)], [runs.row("a", 1.0)]) == 0


def test_rows_of_one_run_alone_are_told(tmp_path, capsys):
    compared(tmp_path, [runs.row("a"), runs.row("b"), runs.row("c", at_most=None)], [runs.row("a"), runs.row("d")])
    told = capsys.readouterr().out.splitlines()[1:]
    assert told == ["not measured any more: b, which has a target", "not measured any more: c", "new: d: 1.5 (1.4 to 1.6) x len()"]


def test_ratios_to_something_else_are_not_compared(tmp_path, capsys):
    """YARP in one run, the faster model of it in the other."""
    assert compared(tmp_path, [runs.row("a", against="YARP")], [runs.row("a", 3.0, against="model")]) == 0
    assert "not compared, a ratio to something else: a: YARP -> model" in capsys.readouterr().out
    assert compared(tmp_path, [runs.row("a")], [runs.row("a", 3.0, against="model")]) == 1


def test_runs_of_other_surroundings_are_told(tmp_path, capsys):
    old, new = tmp_path / "old.json", tmp_path / "new.json"
    old.write_text(json.dumps(runs.run()))
    other = runs.run()
    other["rosetta_jit"].update(quick=False, versions={"numpy": "3"})
    new.write_text(json.dumps(other))
    assert compare.main([str(old), str(new)]) == 0
    assert capsys.readouterr().out.splitlines()[1:] == [
        "the runs differ in numpy: 2 -> 3",
        "the runs differ in run: quick: few and short rounds -> full",
    ]


def without(name):
    run = runs.run()
    del run["rosetta_jit"][name]
    return run


@pytest.mark.parametrize(
    ("content", "told"),
    [
        ("{", "is no JSON"),
        ("[]", "is no run of these benchmarks"),
        ("{}", "is no run of these benchmarks: it has no 'rosetta_jit'"),
        (json.dumps(without("curves")), "another version of these benchmarks: it has no 'curves'"),
        (json.dumps({"rosetta_jit": 5}), "another version of these benchmarks, or by hand"),
        (None, "No such file"),
    ],
)
@pytest.mark.parametrize("program", [compare, reports])
def test_files_that_are_no_runs_end_with_2(tmp_path, capsys, content, told, program):
    good, bad = tmp_path / "good.json", tmp_path / "bad.json"
    good.write_text(json.dumps(runs.run()))
    if content is not None:
        bad.write_text(content)
    assert program.main([str(bad)] if program is reports else [str(bad), str(good)]) == 2
    assert f"{bad}: " in (error := capsys.readouterr().err)
    assert told in error


def test_reports_are_made_from_the_json_alone(tmp_path, capsys):
    run = tmp_path / "run.json"
    run.write_text(json.dumps(runs.run()))
    assert reports.main([str(run), "--output", str(tmp_path / "out")]) == 0
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"report.md", "report.html"}
    assert "report.html" in capsys.readouterr().out
    assert from_json(json.loads(run.read_text())["rosetta_jit"]) == runs.report()
