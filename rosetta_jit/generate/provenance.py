"""What generated files say they were made from, in the comments that they begin with, and how that is read again.

The second line is ``decode: lab/Arm, ros1`` where a type is generated, ``encode: yarp.Torso, yarp3 <- rst.JointAngles, by torso.mapping``
where a mapping is.
"""

from __future__ import annotations

import re

from rosetta_jit.generate.unit import MADE, Role

OF_MAPPING = re.compile(r"\w+: .+, [^,]+ (?:->|<-) (.+?)(?: \*/)?$")
OF_TYPE = re.compile(r"\w+: (.+), [^,]+$")


def line_of_type(role: Role, type_: str, encoding: str) -> str:
    """Says which messages a kernel reads or writes."""
    return f"{role}: {type_}, {encoding}"


def line_of_mapping(role: Role, wire: str, encoding: str, holder: str, file: str) -> str:
    """The same, and by which mapping they become objects, or objects become them."""
    return f"{line_of_type(role, wire, encoding)} {'<-' if role == 'encode' else '->'} {holder}, by {file}"


def is_made(text: str) -> bool:
    """Whether a file says that it was generated."""
    return MADE in text.partition("\n")[0]


def subject_of(text: str) -> str:
    """The type that a generated file is of, or the holder's type and the mapping: the same in each direction and encoding."""
    line = text.split("\n", 2)[1] if "\n" in text else ""
    found = OF_MAPPING.search(line) or OF_TYPE.search(line)
    return found.group(1) if found else line.strip()
