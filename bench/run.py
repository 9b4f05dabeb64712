"""A run that was kept: pytest-benchmark's JSON file, what the benchmarks found in it, and what it was made on and with."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, cast

from bench.figures import from_json

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from bench.figures import Report

OURS = "rosetta_jit"
"""Under this name the file has what is ours."""


class RunError(Exception):
    """A file that is no run of these benchmarks, or is broken."""


@dataclass(frozen=True, slots=True)
class Run:
    """What was found, and what it was found on: names to texts."""

    report: Report
    about: Mapping[str, str]


def read(path: Path) -> Run:
    """The run in a file.

    Raises
    ------
    RunError
        There is no such file, it is no JSON, or it is not what these benchmarks write.
    """
    try:
        return of(json.loads(path.read_text("utf-8")))
    except OSError as error:
        raise RunError(f"{path}: {error.strerror}") from error
    except ValueError as error:
        raise RunError(f"{path}: is no JSON: {error}") from error
    except RunError as error:
        raise RunError(f"{path}: {error}") from error


def of(data: Any) -> Run:
    """The run that a file's content describes."""
    if not isinstance(data, dict) or OURS not in data:
        raise RunError(f"is no run of these benchmarks: it has no {OURS!r}")
    run = cast("dict[str, Any]", data)
    try:
        return Run(from_json(run[OURS]), surroundings(run))
    except KeyError as error:
        raise RunError(f"was written by another version of these benchmarks: it has no {error}") from error
    except (TypeError, AttributeError, ValueError) as error:
        raise RunError(f"was written by another version of these benchmarks, or by hand: {error}") from error


def surroundings(run: Mapping[str, Any]) -> dict[str, str]:
    """The machine, the time, the versions."""
    machine, ours = run["machine_info"], run[OURS]
    cpu = machine.get("cpu", {})
    return {
        "when": run["datetime"],
        "commit": str(run["commit_info"].get("id", "unknown")) + (" and changes" if run["commit_info"].get("dirty") else ""),
        "run": "quick: few and short rounds" if ours["quick"] else "full",
        "machine": _machine(cpu, machine.get("processor", "")),
        "system": f"{machine['system']} {machine['release']}",
        "Python": f"{machine['python_implementation']} {machine['python_version']}",
        **ours["versions"],
    }


def _machine(cpu: Mapping[str, Any], name: str) -> str:
    """The kind of processor: of one brand there are several."""
    generation = f" (family {cpu['family']}, model {cpu['model']})" if cpu.get("family") is not None else ""
    return f"{cpu.get('brand_raw', name)}{generation}, {cpu.get('count', '?')} processors"
