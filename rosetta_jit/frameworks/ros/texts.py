"""Which file a text would be that comes without a name: bags and MCAP files keep a message, a service, an action or IDL by the type alone.

rosbag2 keeps the text of a service for its events, with the type `example_interfaces/srv/AddTwoInts_Event`, and with or without a header
`SRV: example_interfaces/srv/AddTwoInts` before it.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from rosetta_jit.frameworks.ros.sections import HEADER, SEPARATOR
from rosetta_jit.model.types import name_parts

if TYPE_CHECKING:
    from rosetta_jit.frameworks.base import Framework

DASHES = re.compile(r"^---", re.MULTILINE)
OF_DASHES = {1: "srv", 2: "action"}
IDL = re.compile(r"^[ \t]*(?:@\w+(?:\([^)\n]*\))?[ \t]*)*(?:module|struct|union|enum)[ \t]+\w", re.MULTILINE)
"""How a declaration of IDL begins; nothing in a `.msg` file looks like it, since all its types but those words begin otherwise."""


def file_of(framework: Framework, type_: str, text: str) -> str:
    """The name of the file: `p/srv/S.srv` for the text of a service, whichever of its messages is asked for."""
    kind, first = _first(text)
    parts = name_parts(type_)
    dashes = len(DASHES.findall(first))
    if kind == "idl" or (".idl" in framework.idl and not dashes and IDL.search(first)):
        return "/".join(parts) + ".idl"
    ending = next((each for each in (kind, *parts[:-1]) if each in OF_DASHES.values()), OF_DASHES.get(dashes, ""))
    if not dashes or f".{ending}" not in framework.several:
        return "/".join(parts) + ".msg"
    return next(framework.files_of_kind(parts, f".{ending}"))


def _first(text: str) -> tuple[str, str]:
    """The first definition of a text: its kind, where a header says it, and its own text."""
    before, *more = SEPARATOR.split(text, maxsplit=2)
    if before.strip() or not more:
        return "", before
    header = HEADER.match(more[0])
    return ("", more[0]) if header is None else (header[1].lower(), more[0][header.end() :])
