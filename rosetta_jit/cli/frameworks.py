"""`rosetta-jit frameworks`: what is read, what is written, and what each framework can describe."""

from __future__ import annotations

import argparse
import json
from typing import TYPE_CHECKING

from rosetta_jit.cli.arguments import Commands, add_command

if TYPE_CHECKING:
    from rosetta_jit.frameworks.base import Framework
    from rosetta_jit.frameworks.features import Table

SIGNS = {"yes": "yes", "read": "read", "gap": "gap", "none": "-"}
LEGEND = "yes: both ways   read: not written   gap: the framework has it, we do not   -: the framework does not have it"

NAMED = 6
"""So many features are named before a reason; more are counted."""


def add(commands: Commands) -> None:
    """Declare the arguments."""
    command = add_command(commands, "frameworks", "List the frameworks, their IDLs, encodings and leniencies.", run)
    command.add_argument("names", metavar="NAME", nargs="*", help="these alone")
    command.add_argument("--features", action="store_true", help="the features of data description, found out by trying each")
    command.add_argument("--json", action="store_true", help="one JSON object")


def run(arguments: argparse.Namespace) -> int:
    """Gaps are no failure: they are what is asked for."""
    from rosetta_jit.frameworks.installed import installed

    every = installed()
    unknown = [name for name in arguments.names if name not in every]
    if unknown:
        raise OSError(f"there is no framework {unknown[0]}; there are {', '.join(every)}")
    chosen = [every[name] for name in arguments.names or every]
    if arguments.features:
        _features(chosen, as_json=arguments.json)
    elif arguments.json:
        print(json.dumps({each.name: _plain(each) for each in chosen}, indent=2))
    else:
        print("\n\n".join(_described(each) for each in chosen))
    return 0


def _plain(framework: Framework) -> dict[str, object]:
    return {
        "idl": list(framework.idl),
        "manners": _manners(framework),
        "encodings": {
            name: {"byte_order": name in framework.byte_orders, "lenient": dict(framework.leniencies.get(name, {}))}
            for name in framework.encodings
        },
    }


def _described(framework: Framework) -> str:
    lines = [framework.name, f"  reads      {' '.join(framework.idl)}"]
    for name in framework.encodings:
        order = "  byte_order=little|big" if name in framework.byte_orders else ""
        lines.append(f"  encoding   {name}{order}")
        lines += [f"    lenient  {each}: {why}" for each, why in framework.leniencies.get(name, {}).items()]
    return "\n".join([*lines, f"  holders    {_manners(framework)}"])


def _manners(framework: Framework) -> str:
    """Whose holders they are like."""
    return framework.manners.rpartition(":")[2].lower().replace("_", "-") or "plain"


def _features(frameworks: list[Framework], *, as_json: bool) -> None:
    from rosetta_jit.frameworks.features import findings

    tables = {each.name: findings(each) for each in frameworks}
    if as_json:
        print(json.dumps({name: _plain_table(table) for name, table in tables.items()}, indent=2))
    else:
        print("\n\n".join([*(_table(name, table) for name, table in tables.items() if _shown(table)), LEGEND]))


def _plain_table(table: Table) -> dict[str, dict[str, dict[str, str]]]:
    return {
        feature: {column: {"state": each.state, **({"note": each.note} if each.note else {})} for column, each in row.items()}
        for feature, row in table.items()
    }


def _shown(table: Table) -> Table:
    """Only features that the framework has."""
    return {feature: row for feature, row in table.items() if any(each.state != "none" for each in row.values())}


def _table(name: str, table: Table) -> str:
    """What stands in the way is below: one line for what is the same in several columns."""
    shown = _shown(table)
    columns = list(next(iter(table.values())))
    first = max(map(len, (name, *shown)))
    lines = [name.ljust(first) + "".join(f"  {column.ljust(4)}" for column in columns)]
    for feature, row in shown.items():
        lines.append(feature.ljust(first) + "".join(f"  {SIGNS[row[column].state].ljust(max(4, len(column)))}" for column in columns))
    lines += (f"  {SIGNS[state]}: {what}: {note}" for (state, note), what in _notes(shown).items())
    return "\n".join(line.rstrip() for line in lines)


def _notes(shown: Table) -> dict[tuple[str, str], str]:
    """For each reason the features that it is about, or how many they are."""
    reasons: dict[tuple[str, str], dict[str, None]] = {}
    for feature, row in shown.items():
        for each in row.values():
            if each.note:
                reasons.setdefault((each.state, each.note), {})[feature] = None
    return {reason: "; ".join(about) if len(about) <= NAMED else f"{len(about)} features" for reason, about in reasons.items()}
