"""What the proof and the passes say of kernels and of theorems: all that a mutant may not change.

A probe is a name and a result as text. The results are held by `unsafe`, for passes and theorems by a golden file, and for what kernels
do by the interpreter.
"""

from __future__ import annotations

import pickle
from dataclasses import replace
from hashlib import sha256
from itertools import product
from random import Random
from typing import TYPE_CHECKING

import numpy as np

from rosetta_jit.kernel.nodes import If, Return
from rosetta_jit.kernel.passes import order as passes
from rosetta_jit.kernel.passes.drop import drop, without
from rosetta_jit.kernel.printer import to_text
from rosetta_jit.kernel.proof import symbolic
from rosetta_jit.kernel.proof.formula import All, Any, negated
from rosetta_jit.kernel.proof.linear import Linear, plus, shifted, times
from rosetta_jit.kernel.proof.prove import Facts
from rosetta_jit.kernel.proof.record import Record
from rosetta_jit.kernel.proof.verify import VerificationError, settled, verify
from rosetta_jit.kernel.proof.without_checks import is_less
from rosetta_jit.kernel.terms import BEGIN, index
from tests.kernel import kernels
from tests.kernel.unsafe import ACCEPTED, REFUSED

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from rosetta_jit.kernel.ir import Kernel
    from rosetta_jit.kernel.proof.record import Premise

THEOREMS, PRODUCTS, ATOMS, LEAST, MOST = 200, 60, 3, -3, 3
Probe = tuple[str, str]


def digest(text: str) -> str:
    return sha256(text.encode()).hexdigest()[:16]


def refusals() -> Iterator[Probe]:
    """What the proof says of each kernel by hand."""
    for name, (words, kernel) in REFUSED.items():
        yield f"unsafe: {name}", words if _verdict(kernel).endswith(words) else "another verdict"
    for name, kernel in ACCEPTED.items():
        yield f"safe: {name}", _verdict(kernel)


def _verdict(kernel) -> str:
    try:
        verify(kernel)
    except VerificationError as error:
        return str(error).splitlines()[0]
    return "accepted"


def expected_refusals() -> dict[str, str]:
    return {f"unsafe: {name}": words for name, (words, _) in REFUSED.items()} | {f"safe: {name}": "accepted" for name in ACCEPTED}


# --- theorems ----------------------------------------------------------------------------------------------------------


def theorems() -> Iterator[Probe]:
    """Whether random formulas are proven of numbers from -3 to 3; those that are proven must be true of all of them."""
    values = np.array(list(product(range(LEAST, MOST + 1), repeat=ATOMS)), dtype=np.int64)
    for seed in range(THEOREMS):
        random = Random(seed)
        facts = Facts()
        atoms = [facts.fresh(LEAST, MOST) for _ in range(ATOMS)]
        true = np.ones(len(values), dtype=bool)
        for _ in range(random.randint(1, 5)):
            given = _formula(random, atoms, 2)
            mark = facts.mark()
            facts.assume(given)
            if random.random() < 0.2:
                facts.rollback(mark)
            else:
                true &= _truth(given, values)
        goals = [_formula(random, atoms, 2) for _ in range(4)]
        said = []
        for goal in goals:
            proven = facts.proves_thoroughly(goal), facts.shows(goal), facts.proves(negated(goal))
            wrong = (any(proven[:2]) and not _truth(goal, values)[true].all()) or (proven[2] and _truth(goal, values)[true].any())
            said.append("unsound" if wrong else f"{facts.procedure(goal)}{''.join(map(str, map(int, proven)))}")
        bounds = [(facts.lower(atom), facts.upper(atom)) for atom in atoms]
        found = values[true]
        for k, (low, high) in enumerate(bounds):
            if len(found) and not (low <= found[:, k].min() and found[:, k].max() <= high):
                said.append("unsound bounds")
        yield f"theorem {seed}", " ".join((*said, str(bounds), "impossible" if facts.impossible else ""))


def products() -> Iterator[Probe]:
    """Which bounds are proven of a product of sums, of which more is known than of their parts; those that are proven must be true."""
    values = np.array(list(product(range(LEAST, MOST + 1), repeat=ATOMS)), dtype=np.int64)
    for seed in range(PRODUCTS):
        random, facts = Random(f"product {seed}"), Facts()
        atoms = [facts.fresh(LEAST, MOST) for _ in range(ATOMS)]
        left, right = (_sum(random, random.sample(atoms, count)) for count in (random.randint(2, 3), random.randint(1, 3)))
        least = random.randint(-4, 2)
        known = All((shifted(left, -least), shifted(times(left, -1), least + random.randint(0, 3))))
        facts.assume(known)
        made = symbolic._product(facts, "i8", left, right)
        there = (_value(left, values) * _value(right, values))[_truth(known, values)]
        said = []
        for bound in range(-30, 31, 3):
            above, below = facts.proves_thoroughly(shifted(made, -bound)), facts.proves_thoroughly(shifted(times(made, -1), bound))
            wrong = (above and (there < bound).any()) or (below and (there > bound).any())
            said.append("unsound" if wrong else f"{above:d}{below:d}")
        yield f"product {seed}", " ".join(said)


def _sum(random, atoms):
    total = Linear(random.randint(-2, 2))
    for atom in atoms:
        total = plus(total, times(atom, random.choice((-2, -1, -1, 1, 1, 2))))
    return total


def _value(total, values):
    return total.constant + sum((c * values[:, a] for a, c in total.terms), np.zeros(len(values), np.int64))


def _formula(random, atoms, depth):
    kind = random.choice(("sum", "sum", "sum", "all", "any", "not")) if depth else "sum"
    if kind == "sum":
        total = Linear(random.randint(-6, 6))
        for atom in random.sample(atoms, random.randint(1, len(atoms))):
            total = plus(total, times(atom, random.choice((-3, -2, -1, 1, 1, 2, 3))))
        return total
    parts = tuple(_formula(random, atoms, depth - 1) for _ in range(random.randint(1, 3)))
    return {"all": All(parts), "any": Any(parts), "not": negated(parts[0])}[kind]


def _truth(formula, values):
    match formula:
        case Linear():
            return _value(formula, values) >= 0
        case All(parts):
            return np.all([_truth(part, values) for part in parts], axis=0)
        case Any(parts):
            return np.any([_truth(part, values) for part in parts], axis=0)


def owed(safe: Mapping[str, Kernel]) -> Iterator[Probe]:
    """What safe kernels owe, from which premises, and who proves it; and what the unknowns in that stand for."""
    for name, kernel in safe.items():
        record = Record()
        verify(kernel, record)
        known: dict[int, str] = {}
        said = [
            f"{each.claim.holds} {each.formula} {each.procedure} {each.path} {each.claimed_atoms} {_premises(each.premises, known)}"
            for each in record.obligations
        ]
        facts = {id(each.facts): each.facts for each in record.obligations}
        stands_for = [f"{each.meanings} {each.choices}" for each in facts.values()]
        yield f"owed: {name}", digest("\n".join((*said, *stands_for)))


def _premises(premise: Premise | None, known: dict[int, str]) -> str:
    """A digest of a premise and of all before it; those of premises met before are known by their ids."""
    waiting = []
    while premise is not None and id(premise) not in known:
        waiting.append(premise)
        premise = premise.before
    said = "" if premise is None else known[id(premise)]
    for each in reversed(waiting):
        said = known[id(each)] = digest(f"{said} {each.formula}")
    return said


# --- passes ------------------------------------------------------------------------------------------------------------


def texts() -> Iterator[Probe]:
    """What each pass makes of small kernels."""
    from tests.kernel.pass_kernels import PASSED
    from tests.kernel.random_kernels import random_kernel
    from tests.kernel.sized_kernels import SIZED

    made = {
        **kernels.ALL,
        **PASSED,
        **SIZED,
        **{f"random {seed}": random_kernel(seed) for seed in range(30)},
        "unsafe": REFUSED["load without a check"][1],
    }
    for name, kernel in made.items():
        try:
            current, said = kernel, []
            for transform in passes.PASSES:
                current = transform(current)
                said.append(to_text(current))
            last = to_text(passes.run(kernel))
        except VerificationError:
            last, said = "refused", []
        yield f"passes: {name}", digest("\n".join((*said, last)))
    for name, kernel in {**kernels.ALL, **PASSED}.items():
        yield f"passes for any machine: {name}", digest(to_text(passes.run(kernel, passes.ANY_MACHINE)))


def less() -> Iterator[Probe]:
    """Which kernels need no proof because of another's, and which do."""
    from tests.kernel import test_without_checks as cases

    for number, proven in enumerate((cases.TWICE, cases.INSIDE)):
        known = settled(proven)
        made = without(proven, known)
        first, second, *rest = made.bodies[0]
        bodies = [(), (first,), (second, *rest), (first, *rest), (first, second, *rest, *rest), (second, first, *rest), made.bodies[0]]
        others = [replace(made, bodies=(body,)) for body in bodies]
        others += [replace(made, bodies=made.bodies * 2), replace(made, strides=(*made.strides, 8)), proven]
        others += [replace(made, bodies=((first, replace(second, name="j"), *rest),))] if number == 0 else []
        yield f"less {number}", str([(is_less(each, proven, known), is_less(each, proven, frozenset())) for each in others])
    first, let, end = cases.of(cases.need(BEGIN, 16)).bodies[0]
    proven = kernels.kernel((first, let, end))
    yield "less: a value", str(is_less(kernels.kernel((first, end)), proven, frozenset({id(let)})))
    for way in (cases.need(BEGIN, 24), Return(BEGIN)):
        proven = cases.of(cases.need(BEGIN, 16), If(cases.compare("ge", index(1), 0), (way,)))
        known = frozenset({id(proven.bodies[0][1])})
        yield f"less: {type(way).__name__}", str([is_less(each, proven, known) for each in (without(proven, known), proven)])
        first, branch, *_ = proven.bodies[0]
        yield f"less: nothing behind {type(way).__name__}", str(is_less(kernels.kernel((first,)), proven, frozenset({id(branch)})))
    yield "less: nothing behind a value", str(is_less(kernels.kernel((first,)), kernels.kernel((first, let, end)), frozenset({id(let)})))
    two = replace(cases.TWICE, bodies=(cases.TWICE.bodies[0], cases.INSIDE.bodies[0]))
    known = settled(two)
    first, second = without(two, known).bodies
    others = [(first, second), (first, second[1:]), (first[1:], second), (second, first)]
    yield "less: two bodies", str([is_less(replace(two, bodies=each), two, known) for each in others])


def orders() -> Iterator[Probe]:
    """What is made by passes some of which spoil a kernel, and how often it is proven for that."""
    from tests.kernel import test_without_checks as cases

    tried = {
        "nothing": (cases.TWICE, ()),
        "drop": (cases.TWICE, (drop,)),
        "spoiled behind drop": (cases.TWICE, (drop, cases.spoiled)),
        "spoiled before drop": (cases.TWICE, (cases.spoiled, drop)),
        "drop that spoils": (cases.TWICE, (drop,)),
        "not sound": (cases.UNSOUND["a name that is bound twice"], (drop,)),
        "large": (cases.many(1500), passes.PASSES),
    }
    for name, (kernel, transforms) in tried.items():
        changed = {"without": lambda made, _: cases.spoiled(made)} if name == "drop that spoils" else {}
        yield f"order: {name}", digest(str(_proofs(kernel, transforms, changed)))


def _proofs(kernel, transforms, changed) -> tuple[str, int]:
    """What passes make, and how many proofs they take; with some of their functions ``changed``."""
    kept, proofs = dict(vars(passes)), []
    for name in ("settled", "verify"):
        changed[name] = lambda made, function=kept[name]: (proofs.append(made), function(made))[1]
    vars(passes).update(changed)
    try:
        return to_text(passes.run(kernel, transforms)), len(proofs)
    except VerificationError:
        return "refused", len(proofs)
    finally:
        vars(passes).update(kept)


def outcomes() -> Iterator[Probe]:
    """What kernels do when all passes are over, against what they did before."""
    from tests.kernel.random_kernels import random_kernel

    try:
        passes.run(REFUSED["row at the capacity"][1])
    except VerificationError:
        pass
    else:
        yield "passes refuse what is unsafe", "differs"
    for seed in range(12):
        kernel, random = random_kernel(seed), Random(seed)
        optimised = passes.run(kernel)
        for _ in range(6):
            message = random.randbytes(random.randint(0, 80))
            same = kernels.outcome(kernel, message, rows=64) == kernels.outcome(optimised, message, rows=64)
            if not same:
                yield f"outcome {seed}", "differs"
        yield f"outcome {seed}", "same"


def corpus(pickled: bytes) -> Iterator[Probe]:
    """What the passes make of kernels of shipped mappings, each proven."""
    for name, kernel in pickle.loads(pickled).items():  # noqa: S301 - made by the campaign itself
        yield f"corpus: {name}", digest(to_text(passes.run(kernel)))


def golden_text() -> str:
    """The probes of which a golden file holds the results."""
    return "".join(f"{name}: {result}\n" for name, result in (*theorems(), *products(), *owed(kernels.ALL), *texts()))
