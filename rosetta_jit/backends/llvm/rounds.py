"""Rounds of a switch: where a case knows the next one, it jumps there.

    while goes_on: goes_on = false; …; switch case: { … guess = constant }; … if …: case = guess; goes_on = true

What follows the switch is printed behind each case once more, with its constant, and the round that it starts as well, up to the
switch: whoever decodes the fields of a message in the order in which they were written never asks the table.
"""

from __future__ import annotations

from collections.abc import Callable, Container
from typing import TYPE_CHECKING

from llvmlite import ir

from rosetta_jit.backends.llvm.expr import expression
from rosetta_jit.backends.llvm.frame import Frame, Variable
from rosetta_jit.backends.llvm.values import I64, forgotten
from rosetta_jit.backends.printing import statements
from rosetta_jit.kernel.nodes import Assign, Block, Const, Expect, If, Local, Switch, Var, While
from rosetta_jit.startup.dataclass import dataclass
from rosetta_jit.startup.late import Late

if TYPE_CHECKING:
    from rosetta_jit.backends.llvm import series

    Printer = Callable[[Frame, Block], None]
else:
    series = Late("rosetta_jit.backends.llvm.series")


@dataclass(frozen=True, slots=True)
class Rounds:
    """A loop around a switch: the statements before and behind it, and the locals that say how it goes on."""

    start: Block
    switch: Switch
    end: Block
    case: str
    guess: str


@dataclass(frozen=True, slots=True)
class Ways:
    """Where it goes on behind a case: at another one, at the end that cases share, or where there are no more rounds."""

    cases: dict[int, ir.Block]
    end: ir.Block
    over: ir.Block


def rounds_of(loop: While) -> Rounds | None:
    """What a loop is, if it is one of rounds."""
    switches = [number for number, each in enumerate(loop.body) if isinstance(each, Switch)]
    match loop.condition, loop.body[: switches[0] + 1] if switches else ():
        case Local("bool", flag), (Assign(first, Const(_, False)), *_, Switch(Local("i64", case)) as switch) if first == flag:
            start, end = loop.body[: switches[0]], loop.body[switches[0] + 1 :]
            guess = _guess(end, flag, case)
            # Printed several times: what binds names for the cases cannot be, nor what makes the case another one.
            is_plain = all(isinstance(each, Assign | Expect) for each in start) and case not in _assigned(start)
            is_sure = guess not in _assigned(end) and _assigned(loop.body).count(flag) == 2
            return Rounds(start, switch, end, case, guess) if guess is not None and is_plain and is_sure else None
        case _:
            return None


def _guess(end: Block, flag: str, case: str) -> str | None:
    """The local that becomes the next case, if the end of a round starts another one in its very last statements."""
    match end[-1:]:
        case (If(_, then, ()),):
            return _guess(then, flag, case)
        case _:
            pass
    match end[-2:]:
        case (Assign(to, Local("i64", guess)), Assign(last, Const(_, True))) if (to, last) == (case, flag):
            return guess
        case _:
            return None


def _assigned(part: Block) -> list[str]:
    return [each.name for each in statements(part) if isinstance(each, Assign)]


def print_switch(frame: Frame, rounds: Rounds, end: ir.Block, over: ir.Block, block: Printer) -> None:
    """Print the statements before the switch, and the switch."""
    builder = frame.builder
    block(frame, rounds.start)
    other, ways = frame.block("default"), Ways({number: frame.block(f"case{number}") for number, _ in rounds.switch.cases}, end, over)
    value = builder.load(_variable(frame, rounds.case).slot, typ=I64)
    switch = builder.switch(value, other)
    alike: Container[int] = ()
    if frame.alike.cases(rounds.switch):
        alike = series.print_cases(frame, rounds.switch, switch, block, lambda body: _leave(frame, rounds, body, ways, block), ways.cases)
    for number, body in rounds.switch.cases:
        if number in alike:
            continue
        switch.add_case(ir.Constant(value.type, number), ways.cases[number])
        builder.position_at_end(ways.cases[number])
        block(frame, body)
        if not builder.block.is_terminated:
            _leave(frame, rounds, body, ways, block)
    builder.position_at_end(other)
    block(frame, rounds.switch.default)
    if not builder.block.is_terminated:
        builder.branch(end)


def _leave(frame: Frame, rounds: Rounds, body: Block, ways: Ways, block: Printer) -> None:
    """Behind a case: the end of the round and a jump, if the case knows the next one."""
    match body[-1:]:
        case (Assign(rounds.guess, Const(_, int(number))),) if number in ways.cases:
            variable, frame.locals[rounds.guess] = _variable(frame, rounds.guess), ir.Constant(I64, number)
            _end(frame, rounds.end, ways.over, block)
            frame.locals[rounds.guess] = variable
            block(frame, rounds.start)
            _forget(frame, (*rounds.start, *body))
            frame.builder.branch(ways.cases[number])
        case _:
            frame.builder.branch(ways.end)


def _end(frame: Frame, part: Block, over: ir.Block, block: Printer) -> None:
    """The end of a round, up to where it has started another one; else all are over."""
    match part[-1]:
        case If(condition, then, _):
            block(frame, part[:-1])
            yes = frame.block("then")
            frame.builder.cbranch(expression(frame, condition), yes, over)
            frame.builder.position_at_end(yes)
            _end(frame, then, over, block)
        case _:
            block(frame, part)


def _forget(frame: Frame, part: Block) -> None:
    """Let LLVM know nothing of variables that change: of a hundred cases it would work out what each of them knows from all before it.

    Variables of the part itself end with it. To read them here would keep them, and their registers, alive in all other cases.
    """
    every = tuple(statements(part))
    changed = {each.name for each in every if isinstance(each, Assign) and not isinstance(each.value, Const)}
    for name in sorted(changed - {each.name for each in every if isinstance(each, Var)}):
        variable = frame.locals.get(name)
        if isinstance(variable, Variable) and variable.type == I64:
            value = frame.builder.load(variable.slot, typ=I64)
            frame.builder.store(forgotten(frame.builder, value), variable.slot)


def _variable(frame: Frame, name: str) -> Variable:
    variable = frame.locals[name]
    assert isinstance(variable, Variable)
    return variable
