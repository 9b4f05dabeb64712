"""The rows of the last runs, which the repository keeps: `make bench-check` fails where one got worse, long before its target is missed.

A row's target leaves room for other machines; what this one measured does not. Several runs are kept, because a process keeps its luck
with memory, so that runs of the same code differ by more than their quartiles say.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from bench.run import OURS

FOLDER = Path(__file__).resolve().parent / "baseline"
KEPT = 3
"""How many runs there are at most; the oldest goes."""

CPU = ("brand_raw", "family", "model", "count")
MACHINE = ("system", "python_implementation", "python_version")
ROW = ("what", "at_most", "unit", "against")


def keep(run: Path, folder: Path = FOLDER) -> Path:
    """Keep what a run's JSON says of its rows, and of the kind of its machine; nothing that names the machine."""
    data = json.loads(run.read_text("utf-8"))
    folder.mkdir(exist_ok=True)
    for oldest in kept(folder)[: 1 - KEPT]:
        oldest.unlink()
    made = folder / f"{data['datetime'][:19].replace(':', '-')}.json"
    made.write_text(_a_row_a_line(_short(data)), "utf-8")
    return made


def kept(folder: Path = FOLDER) -> list[Path]:
    """The runs that are kept, the oldest first: their names are their times."""
    return sorted(folder.glob("*.json"))


def _short(data: dict[str, Any]) -> dict[str, Any]:
    machine, ours = data["machine_info"], data[OURS]
    about = {"release": "", **{name: machine[name] for name in MACHINE}}
    return {
        "datetime": data["datetime"],
        "commit_info": {name: data["commit_info"].get(name) for name in ("id", "dirty")},
        "machine_info": {**about, "cpu": {name: machine.get("cpu", {}).get(name) for name in CPU}},
        OURS: {
            "rows": [_row(row) for row in ours["rows"]],
            "comparisons": [],
            "curves": [],
            "quick": ours["quick"],
            "versions": ours["versions"],
        },
    }


def _row(row: dict[str, Any]) -> dict[str, Any]:
    measured = {name: float(f"{row['measured'][name]:.4g}") for name in ("median", "low", "high")}
    return {**{name: row[name] for name in ROW}, "measured": measured, "detail": ""}


def _a_row_a_line(data: dict[str, Any]) -> str:
    """JSON of which a change shows the rows that changed."""
    rows = data[OURS].pop("rows")
    head = json.dumps({**data, OURS: {**data[OURS], "rows": "ROWS"}}, indent=1)
    return head.replace('"ROWS"', "[\n" + ",\n".join(map(json.dumps, rows)) + "\n]") + "\n"
