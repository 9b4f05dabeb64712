"""`.idl` files one after another in a text, as MCAP's schema encoding ros2idl has them: in any order, and not all with their `#include`s.

https://mcap.dev/spec/registry#ros2idl
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from rosetta_jit.frameworks.ros.sections import HEADER, SEPARATOR

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

NO_NAMES = re.compile(r"//[^\n]*|/\*.*?(?:\*/|\Z)|\"(?:[^\"\\]|\\.)*(?:\"|\Z)", re.DOTALL)
"""Comments and strings, of which the last may have no end."""
WORD = re.compile(r"\w+")


def is_concatenated(text: str) -> bool:
    """Whether a text begins with a line of `=` and one that names what follows."""
    line = SEPARATOR.search(text)
    return line is not None and not text[: line.start()].strip() and HEADER.match(text, line.end()) is not None


def in_order(files: Mapping[str, str]) -> Iterator[tuple[str, str]]:
    """The files, each behind those whose types it mentions: IDL knows a name once it is declared."""
    declaring: dict[str, list[str]] = {}
    for name in files:
        declaring.setdefault(name.removesuffix(".idl").rpartition("/")[2], []).append(name)
    whole: dict[str, bool] = {}
    for name in files:
        waiting = [name]
        while waiting:
            current = waiting[-1]
            if current not in whole:
                whole[current] = False
                mentioned = dict.fromkeys(WORD.findall(NO_NAMES.sub(" ", files[current])))
                waiting += [each for word in mentioned for each in declaring.get(word, ()) if each not in whole]
                continue
            waiting.pop()
            if not whole[current]:
                whole[current] = True
                yield current, files[current]
