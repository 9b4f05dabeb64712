"""Discriminators and cases of elements, set in any order: each comes out as it is said, or the mapping is refused."""

from __future__ import annotations

import random
from typing import Any

import pytest

import rosetta_jit as rj
from tests.language.test_unions import made

CASES = {1: ("a", 3), 5: ("n", 1.5), 0: ("s", "text")}
"""Labels with what their cases get; 0 selects the case that an element is born with."""


def told(number: int, at: str, value: str) -> str:
    return f".us[{at}]._d = {value}"


def filled(number: int, at: str, label: int) -> str:
    name, value = CASES[label]
    return f'.us[{at}].{name} = "{value}"' if name == "s" else f".us[{at}].{name} = {value}"


class Drawn:
    """Rules for three elements, each with two: one sets its discriminator, computed or not, and one its case."""

    def __init__(self, seed: int) -> None:
        self.draw = random.Random(seed)
        self.labels = [self.draw.choice(list(CASES)) for _ in range(3)]
        parts = [(number, what) for number in range(3) for what in ("tell", "fill")]
        self.draw.shuffle(parts)
        cuts = sorted(self.draw.sample(range(1, 6), self.draw.randint(0, 3)))
        groups = [parts[start:stop] for start, stop in zip([0, *cuts], [*cuts, 6], strict=True)]
        self.rules = "\n".join(["len(.us) = 3", *(self.group(group) for group in groups)])
        self.wanted = [{"_d": label, CASES[label][0]: CASES[label][1]} for label in self.labels]

    def group(self, parts: list[tuple[int, str]]) -> str:
        """Rules as they are, in a loop of one round, or in both blocks of a `when`."""
        match self.draw.choice(["flat", "loop", "when"]):
            case "loop":
                start = self.draw.randrange(3)
                body = [self.rule(part, f"i + {part[0] - start}" if part[0] >= start else f"i - {start - part[0]}") for part in parts]
                return "\n".join([f"for i from {start} to {start + 1}", *body, "end"])
            case "when":
                blocks = [[self.rule(part, str(part[0])) for part in self.draw.sample(parts, len(parts))] for _ in range(2)]
                return "\n".join(["when .x > 3", *blocks[0], "else", *blocks[1], "end"])
            case _:
                return "\n".join(self.rule(part, str(part[0])) for part in parts)

    def rule(self, part: tuple[int, str], at: str) -> str:
        number, what = part
        label = self.labels[number]
        value = self.draw.choice([str(label), f"int32(.y + {label})"])
        return told(number, at, value) if what == "tell" else filled(number, at, label)


def outcome(drawn: Drawn, block: str, backend: str, x: int) -> list[dict[str, Any]] | None:
    """The elements; None if the mapping is refused for its order."""
    rules = drawn.rules + "".join(f"\nignore .{name}" for name in "xy" if f".{name} " not in drawn.rules)
    try:
        return made(rules, block, backend, "m::Many", x=x, y=0)["us"]
    except rj.MappingError as error:
        if {each.code for each in error.diagnostics} <= {"other-case", "uneven-rounds"}:
            return None
        raise


@pytest.mark.parametrize("first", range(0, 90, 15))
def test_elements_come_out_as_said(first):
    accepted = 0
    for seed in range(first, first + 15):
        drawn = Drawn(seed)
        found = outcome(drawn, "unpack", "interpreter", x=seed % 7)
        assert found in (None, drawn.wanted), f"{seed}: {drawn.rules}"
        accepted += found is not None
    assert accepted >= 5


@pytest.mark.parametrize("backend", ["llvm", "python"])
@pytest.mark.parametrize("block", ["unpack", "pack"])
@pytest.mark.parametrize("seed", [0, 1])
def test_elements_come_out_as_said_in_each_backend(seed, block, backend):
    drawn = Drawn(seed)
    assert outcome(drawn, block, backend, x=5) in (None, drawn.wanted)


IN_ORDER = [
    "for i from 0 to 2\n.us[i].n = .x\n.us[i]._d = 5\nend",
    "for i from 0 to 2\n.us[i].n = .x\nend\nfor j from 0 to 2\n.us[j]._d = 5\nend",
    "for i from 0 to 2\n.us[i].n = .x\nend\nfor j from 0 to 2\n.us[1 - j]._d = 5\nend",
    "when .x > 3\n.us[0]._d = 5\n.us[1].n = 4.0\nelse\n.us[0]._d = 2\n.us[1].n = 4.0\nend\n.us[1]._d = 5\n.us[0].n = .x",
]
OUT_OF_ORDER = [
    "for i from 0 to 1\n.us[i]._d = 5\n.us[i + 1].n = .x\nend\nfor i from 1 to 2\n.us[i]._d = .x\n.us[i - 1].n = .x\nend",
    "for i from 0 to 2\n.us[i]._d = 5\n.us[1 - i].n = .x\nend",
    "\n".join(f"when .x > 3\n.us[{a}]._d = 5\n.us[{b}].n = .x\nelse\n.us[{b}]._d = 5\n.us[{a}].n = .x\nend" for a, b in ((0, 1), (1, 0))),
]


@pytest.mark.parametrize("rules", IN_ORDER)
def test_an_order_is_found(rules):
    found = made(f"len(.us) = 2\n{rules}\nignore .y", "unpack", "interpreter", "m::Many", x=5, y=0)
    assert [(each["_d"], each["n"]) for each in found["us"]] in ([(5, 5.0), (5, 5.0)], [(5, 5.0), (5, 4.0)])


@pytest.mark.parametrize("label", ["1", "int32(.y + 1)"])
def test_a_case_waits_for_its_discriminator_alone(label):
    """Of the rules behind both that fail, too, none comes before it."""
    rules = f"len(.us) = 2\n.us[0].a = uint8(.x * 1000)\n.us[0]._d = {label}\n.us[1]._d = int32(10 / .y)"
    with pytest.raises(rj.MessageError) as error:
        made(rules, "unpack", "interpreter", "m::Many", x=5, y=0)
    assert error.value.path == ".us[0].a"


@pytest.mark.parametrize("rules", OUT_OF_ORDER)
def test_no_order_is_told(rules):
    with pytest.raises(rj.MappingError) as error:
        made(f"len(.us) = 2\n{rules}\nignore .y", "unpack", "interpreter", "m::Many", x=5, y=0)
    assert "`.us._d` is set after cases that it selects" in [each.message for each in error.value.diagnostics]
