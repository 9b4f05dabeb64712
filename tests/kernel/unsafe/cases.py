"""What the unsafe kernels are made of, and where they are kept."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import Advance, Binary, Const, Convert, Let, Load, Place, Reserve, Return, SetField, Used, Var
from rosetta_jit.kernel.terms import BEGIN, add, index
from tests.kernel.kernels import compare, expect, i64, kernel, need

DONE = Return(index(0))


@dataclass
class Cases:
    """Kernels that the proof must refuse, with the words of the refusal, and, by the same names, twins that are safe by a hair."""

    refused: dict[str, tuple[str, Kernel]] = field(default_factory=dict)
    accepted: dict[str, Kernel] = field(default_factory=dict)

    def add(self, name, words, unsafe, safe=None, routines=(), safe_routines=None, **options):
        """A kernel that is refused with these words, and its twin. Each ends with a Return, unless the last statement is None."""
        assert name not in self.refused, name
        self.refused[name] = words, with_routines(kernel(_ended(unsafe), **options), routines)
        if safe is not None:
            self.accept(name, safe, routines if safe_routines is None else safe_routines, **options)

    def accept(self, name, safe, routines=(), **options):
        assert name not in self.accepted, name
        self.accepted[name] = with_routines(kernel(_ended(safe), **options), routines)


def with_routines(kernel, routines):
    return replace(kernel, routines=tuple(routines))


def _ended(body):
    return tuple(body[:-1]) if body and body[-1] is None else (*body, DONE)


def sub(left, right):
    return Binary("sub", left, index(right) if isinstance(right, int) else right)


def plus(left, right):
    """Not folded, as `terms.add` would."""
    return Binary("add", left, index(right) if isinstance(right, int) else right)


def times(left, right):
    return Binary("mul", left, index(right) if isinstance(right, int) else right)


def both(*conditions):
    first, *others = conditions
    for each in others:
        first = Binary("and", first, each)
    return first


def between(name, low, high):
    """A number of the message, found to lie between two bounds."""
    return need(BEGIN, 8), Let(name, Load("i64", BEGIN)), expect(both(compare("ge", i64(name), low), compare("le", i64(name), high)))


def rows(count, name="c"):
    """Rows of lane 1, reserved and in use; the first of them has the name."""
    return Reserve(1, index(count)), Let(name, Used(1)), Advance(1, index(count))


def put(row, first="c"):
    """A value into a row behind the first of some."""
    return SetField(Place(1, plus(i64(first), row)), index(1))


BYTE = need(BEGIN, 1), Let("n", Convert("i64", Load("u8", BEGIN)))
WORD = need(BEGIN, 8), Let("n", Load("i64", BEGIN))
N, M, AT, C = i64("n"), i64("m"), i64("at"), i64("c")
TRUE, FALSE = Const("bool", value=True), Const("bool", value=False)
X = Let("x", Load("i64", BEGIN))
START = Var("at", BEGIN)
TWO = need(BEGIN, 16), Let("n", Load("i64", BEGIN)), Let("m", Load("i64", add(BEGIN, 8)))
BRANCH = compare("gt", N, 7)
