"""`python -m bench.report RUN.json [--output FOLDER]`: writes report.md and report.html from a run's JSON."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bench.figures import from_json
from bench.report import html, markdown

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence


def main(words: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(prog="bench.report", description="Write report.md and report.html from a run's JSON.")
    parser.add_argument("run", type=Path)
    parser.add_argument("--output", type=Path, help="folder; that of the run by default")
    asked = parser.parse_args(words)
    folder: Path = asked.output or asked.run.parent
    write(json.loads(asked.run.read_text("utf-8")), folder)
    print(f"{folder / 'report.html'}\n{folder / 'report.md'}")


def write(run: Mapping[str, Any], folder: Path) -> None:
    """Both reports of a run, into a folder."""
    report, about = from_json(run["rosetta_jit"]), surroundings(run)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "report.md").write_text(markdown.page(report, about), "utf-8")
    (folder / "report.html").write_text(html.page(report, about), "utf-8")


def surroundings(run: Mapping[str, Any]) -> dict[str, str]:
    """The machine, the time, the versions."""
    machine, ours = run["machine_info"], run["rosetta_jit"]
    cpu = machine.get("cpu", {})
    return {
        "when": run["datetime"],
        "commit": str(run["commit_info"].get("id", "unknown")) + (" and changes" if run["commit_info"].get("dirty") else ""),
        "run": "quick: few and short rounds" if ours["quick"] else "full",
        "machine": f"{cpu.get('brand_raw', machine.get('processor', ''))}, {cpu.get('count', '?')} processors",
        "system": f"{machine['system']} {machine['release']}",
        "Python": f"{machine['python_implementation']} {machine['python_version']}",
        **ours["versions"],
    }


if __name__ == "__main__":
    main()
