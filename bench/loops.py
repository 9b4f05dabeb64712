"""Statements as loops over messages: what a user's program does with each message, without the call of a function around it.

A body is the text of statements about one message, `m`. In it `read(x)` marks what is read: a loop that is timed evaluates `x` and drops
it, and `found` collects it, so that contenders are compared before they are timed.
"""

from __future__ import annotations

import re
from textwrap import dedent, indent
from typing import TYPE_CHECKING, Any

import numpy as np

from bench.contest import Contender

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from bench.figures import Role
    from bench.turns import Effort

READ = re.compile(r"read\(((?:[^()]|\([^()]*\))*)\)")
MESSAGE = re.compile(r"\bm\b")
TIMES = 8
"""How often short statements stand in a loop, so that the loop itself does not count."""


def over(body: str, **given: Any) -> Callable[[Sequence[Any]], None]:
    """A function that runs statements for each of its messages.

    It is code of its own each time: CPython adapts code to the types that run through it. ``given`` are local variables.
    """
    lines = indent(dedent(body).strip("\n"), " " * 8)
    parameters = "".join(f", {name}={name}" for name in given)
    scope = dict(given)
    exec(f"def run(messages{parameters}):\n    for m in messages:\n{lines}\n", scope)  # noqa: S102 - the bench's own text
    return scope["run"]


def loop(effort: Effort, body: str, messages: Sequence[Any], *, times: int = 1, each: int = 1, **given: Any) -> Callable[[], float]:
    """What times a body, so many times for each message; ``each`` is how many things one run of it deals with."""
    run, idle = over("\n".join([READ.sub(r"\1", dedent(body))] * times), **given), over("pass")
    different = len(messages) if MESSAGE.search(body) else None
    return effort.call(run, messages, messages=len(messages) * times * each, idle=idle, different=different)


def found(body: str, messages: Sequence[Any], **given: Any) -> list[Any]:
    """What a body reads of the messages. Arrays are copied: a holder that is used again shows the next message's in the same place."""
    values: list[Any] = []

    def read(value: Any) -> None:
        values.append(value.copy() if isinstance(value, np.ndarray) else value)

    over(body, **given, read=read)(messages)
    return values


def same(one: Sequence[Any], other: Sequence[Any]) -> bool:
    """Whether two have read the same, arrays compared by their elements."""
    return len(one) == len(other) and all(np.array_equal(a, b) for a, b in zip(one, other, strict=True))


def contender(effort: Effort, who: str, role: Role, makes: str, body: str, messages: Sequence[Any], **given: Any) -> Contender:
    """A contender that runs a body for each message; ``given`` as of `loop`."""
    return Contender(who, role, makes, loop(effort, body, messages, **given))
