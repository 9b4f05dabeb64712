"""The header of a unit in C++: the class `codec`, and functions of it that stand there whole."""

from __future__ import annotations

import re
from pathlib import Path
from string import Template
from typing import TYPE_CHECKING

from rosetta_jit.generate.c.header import made
from rosetta_jit.generate.c.state import MEMBERS
from rosetta_jit.generate.c.texts import literal
from rosetta_jit.generate.c.words import C_TYPES
from rosetta_jit.generate.cpp.decoding.at_once import is_called
from rosetta_jit.generate.cpp.encoding.reading import writes_apart
from rosetta_jit.generate.cpp.objects.classes import classes
from rosetta_jit.generate.unit import Unit, wires_of
from rosetta_jit.kernel.traits import asks_host
from rosetta_jit.model.types import Struct
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.generate.cpp.objects.manners import Manners

FOLDER = Path(__file__).parent
ASKED = {
    "clock": "#include <chrono>\n",
    "begins": "        codec_.now = nanoseconds();\n",
    "ends": "        ++codec_.number;\n",
    "nanoseconds": """
    /* Since 1970. */
    static std::int64_t nanoseconds()
    {
        return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch()).count();
    }
""",
}
"""What classes around a codec have besides, where the mapping asks for the time, or for the number of a message."""
RESET = (
    "    /* Forgets all messages: state is what the mapping says that it is at first. */",
    "    void reset() { kept = state(); }",
)


@dataclass(frozen=True, slots=True)
class AtOnce:
    """The statements that read a message in the header, or an empty one, and those that write one, or such; empty where it cannot be.

    ``reads_lengths`` is how many texts, arrays and lists are set by those that read one. ``puts_each`` are the functions for elements of
    lists that those which write call: the name, the parameters besides the shared ones, and the statements of each.
    """

    reads: str = ""
    reads_lengths: int = 0
    reads_empty: str = ""
    puts: str = ""
    puts_empty: str = ""
    puts_each: tuple[tuple[str, str, str], ...] = ()

    @property
    def is_called(self) -> bool:
        """Whether the statements that read a message are those of a function that is called."""
        return is_called(self.reads_lengths, self.reads_empty)


def header(unit: Unit, manners: Manners, there: AtOnce) -> str:
    """The text of the header; ``there`` is what stands in it of the codec's functions."""
    root = unit.schema.types[unit.type]
    assert isinstance(root, Struct)
    own = classes(unit) if manners.type is None else ""
    named = class_of(unit, manners)
    includes = ["<cstddef>", "<cstdint>", "<memory>"]
    if manners.type is None:
        includes += ["<array>", "<limits>", "<map>", "<optional>", "<string>", "<variant>", "<vector>"]
    lines = [f"#include {each}" for each in sorted(includes)] + ["", "#include <rosetta_jit/rosetta_jit.hpp>"]
    if manners.header is not None:
        lines += [f"#include <{unit.include or manners.header(root)}>"]
    around, lines_around = _around(unit, manners)
    lines += lines_around
    return filled_in(
        "header.hpp",
        made=made(unit),
        name=unit.name,
        guard=f"{unit.name.upper()}_HPP",
        includes="\n".join(lines),
        classes=f"{own}\n/* What is filled and read. */\nusing holder = {named};\n",
        declarations="\n".join(_declared(unit, there)),
        hidden=_hidden(unit, there),
        state=_state(unit),
        written="    std::unique_ptr<memory> written_;\n" if writes_apart(unit) else "",
        functions="".join(_function(unit, each.name, each.parameters, each.result) for each in unit.functions),
        around=around,
    )


def _hidden(unit: Unit, there: AtOnce) -> str:
    """The codec's functions that are its own."""
    known = _declarations()
    each = Template(known["put_each_private"])
    loops = [each.substitute(name=name, parameters=more, statements=text.rstrip()) for name, more, text in there.puts_each]
    parts = (
        ("read_empty_at_once", there.reads_empty),
        ("read_at_once", "" if there.is_called else there.reads),
        ("read_at_once_called", there.reads if there.is_called else ""),
        ("decode_any", "any" if "borrow" in unit.kernels else ""),
        ("put_empty_at_once", there.puts_empty),
        ("put_at_once", there.puts),
        ("encode_any", "any" if "encode" in unit.kernels else ""),
    )
    return "".join([*loops, *(Template(known[f"{name}_private"]).substitute(statements=text.rstrip()) for name, text in parts if text)])


def _state(unit: Unit) -> str:
    """What a codec keeps from one message to the next, where the mapping declares state."""
    if not unit.state:
        return ""
    names, words = (", ".join(map(str, some)) for some in zip(*((name, _word(word)) for name, word in unit.state), strict=True))
    members = (f"        std::int64_t {member}[{len(unit.state)}] = {{{words}}};" for member in dict.fromkeys(MEMBERS.values()))
    head = f"    /* What the mapping keeps from one message to the next, for each direction: {names}; floats by their bits. */"
    reset = (RESET[0], "    void reset();") if wires_of(unit) else RESET
    return "\n".join([head, "    struct state {", *members, "    };", "    state kept;", *reset])


def _word(word: int) -> str:
    return "INT64_MIN" if word == -(2**63) else f"INT64_C({word})"


def class_of(unit: Unit, manners: Manners) -> str:
    """The class of the holder, as C++ names it."""
    root = unit.schema.types[unit.type]
    assert isinstance(root, Struct)
    if manners.type is None:
        return f"::{unit.name}::{root_class(unit)}"
    return manners.type(root)


def root_class(unit: Unit) -> str:
    """The name of our own class for the message."""
    from rosetta_jit.generate.cpp.objects.classes import names_of

    return names_of(unit)[unit.type]


def _function(unit: Unit, name: str, parameters: tuple[str, ...], result: str) -> str:
    numbers = "".join(f"{C_TYPES[each]} number_{number}, " for number, each in enumerate(parameters, 1))
    return (
        "/* You write this function, which the mapping calls: false refuses the message. */\n"
        f"bool {unit.name}_{name}({numbers}{C_TYPES[result]} *result);\n"
    )


def _declarations() -> dict[str, str]:
    text = (FOLDER / "declarations.hpp").read_text("utf-8")
    _, *parts = re.split(r"^/\* == (\w+) == \*/\n", text, flags=re.MULTILINE)
    return dict(zip(parts[::2], parts[1::2], strict=True))


def _declared(unit: Unit, there: AtOnce) -> list[str]:
    """The codec's functions."""
    known = _declarations()
    is_there = " || ".join(
        f"{name}(static_cast<const unsigned char *>(bytes), static_cast<std::int64_t>(size), target)"
        for name, text in (("is_read_empty", there.reads_empty), ("is_read", there.reads))
        if text
    )
    reads = Template(known["reads"]).substitute(read=is_there).rstrip() if is_there else ""
    found = [Template(known["decode"]).substitute(reads=reads)] if "borrow" in unit.kernels else []
    for wire in wires_of(unit):
        every, last = unit.arrivals[wire]
        found.append(Template(known["wire"]).substitute(wire=wire, every=every, last=last))
    parts = (("puts_empty", there.puts_empty), ("puts", there.puts))
    puts = "\n".join(known[name].rstrip() for name, text in parts if text)
    encode = [Template(known["encode"]).substitute(puts=puts)] if "encode" in unit.kernels else []
    return [re.sub(r"\{\n\n+", "{\n", text) for text in (*found, *encode)]


def _around(unit: Unit, manners: Manners) -> tuple[str, list[str]]:
    """The classes around the codec, and the lines that include what they need."""
    words = {"wire": literal(unit.announced)} | (ASKED if asks_host(unit.kernels.values()) else dict.fromkeys(ASKED, ""))
    parts = [_section(Template((FOLDER / "around" / f"{each}.hpp").read_text("utf-8")).substitute(words)) for each in manners.around]
    return "\n".join(text for _, text in parts), [line for before, _ in parts for line in before.splitlines()]


def _section(text: str) -> tuple[str, str]:
    """The includes of a text, and the rest."""
    includes = [line for line in text.splitlines() if line.startswith("#include")]
    return "\n".join(includes), "\n".join(line for line in text.splitlines() if line not in includes).strip() + "\n"


def filled_in(file: str, **values: str) -> str:
    """A template of the folder, filled in."""
    return re.sub(r"\n{3,}", "\n\n", Template((FOLDER / file).read_text("utf-8")).substitute(values))
