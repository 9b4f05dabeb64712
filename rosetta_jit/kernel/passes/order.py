"""The passes over a kernel, in the order in which they run."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from operator import is_

from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import Block, Copy, For, Require, SetField, Stmt, Store
from rosetta_jit.kernel.passes.collect import collect
from rosetta_jit.kernel.passes.drop import drop, without
from rosetta_jit.kernel.passes.gather import gather
from rosetta_jit.kernel.passes.join import join
from rosetta_jit.kernel.passes.merge import merge
from rosetta_jit.kernel.passes.reuse import reuse
from rosetta_jit.kernel.passes.seldom_needed import bulk, bulk_of_bytes, forget, fuse, group, hoist, neglect, sink, unroll
from rosetta_jit.kernel.passes.simplify import simplify
from rosetta_jit.kernel.proof.verify import VerificationError, check_shape, settled, verify
from rosetta_jit.kernel.proof.without_checks import is_less
from rosetta_jit.kernel.traits import LARGE, is_large
from rosetta_jit.kernel.walk import every_statement

Pass = Callable[["Kernel"], "Kernel"]

PASSES: tuple[Pass, ...] = (
    neglect,
    forget,
    simplify,
    forget,
    collect,
    reuse,
    simplify,
    drop,
    hoist,
    drop,
    group,
    simplify,
    unroll,
    simplify,
    hoist,
    drop,
    bulk,
    simplify,
    fuse,
    merge,
    gather,
    join,
    sink,
)

FIELD_BY_FIELD = tuple(each for each in PASSES if each not in (neglect, collect, fuse, gather, join))
"""Those for source that people read, and that may see what is done with each field."""

ANY_MACHINE = tuple(bulk_of_bytes if each is bulk else each for each in FIELD_BY_FIELD if each is not group)
"""Those for code that may run where numbers lie with their high byte first."""


NEEDS: Mapping[Pass, tuple[type[Stmt], ...]] = {
    **dict.fromkeys((group, unroll, hoist, bulk, bulk_of_bytes, fuse, sink), (For,)),
    collect: (SetField,),
    merge: (Require,),
    join: (Store, SetField, Copy),
}
"""Kinds of statements of which a kernel has one if a pass is to find anything. Passes make none of them where there was none before."""


def run(kernel: Kernel, passes: tuple[Pass, ...] = PASSES, *, large: int = LARGE) -> Kernel:
    """All passes, and the proof that what comes out is safe.

    The proof looks only so far; where it cannot follow a pass, the kernel stays as it was before that pass.

    Parameters
    ----------
    large
        Statements of a body, on average, from which on each pass runs but once. Whoever makes a program of a type in another way gives the
        same number: the passes decide which check comes first, and so what is said of a message with two faults.

    Raises
    ------
    VerificationError
        The kernel as it was lowered could not be proven safe.
    """
    try:
        return _all(kernel, passes, large)
    except VerificationError:
        verify(kernel)
    for transform in passes:
        kernel = _proven(transform, kernel)
    return kernel


def _all(kernel: Kernel, passes: tuple[Pass, ...], large: int) -> Kernel:
    """All passes, and one proof more where a pass has changed what `drop` had proven."""
    check_shape(kernel)
    results: dict[Pass, Kernel] = {}
    proven: Kernel | None = None
    for transform in _needed(_once(passes) if is_large(kernel, large * len(kernel.bodies)) else passes, kernel):
        made = results.get(transform)
        if made is not None and _is_same(made, kernel):
            continue
        if transform is drop:
            kernel, proven = _dropped(kernel)
        else:
            kernel = transform(kernel)
        results[transform] = kernel
    if proven is None or not _is_same(kernel, proven):
        verify(kernel)
    return kernel


def _once(passes: tuple[Pass, ...]) -> tuple[Pass, ...]:
    """Each pass once, `drop` at the end: its proof is the last one then."""
    return (*(each for each in dict.fromkeys(passes) if each is not drop), drop)


def _needed(passes: tuple[Pass, ...], kernel: Kernel) -> list[Pass]:
    """The passes that may find something in a kernel."""
    kinds = set(map(type, every_statement(kernel)))
    return [each for each in passes if not kinds.isdisjoint(NEEDS.get(each, kinds))]


def _is_same(kernel: Kernel, other: Kernel) -> bool:
    """Whether two kernels, one made from the other by passes, have the same statements."""
    blocks, other_blocks = _blocks(kernel), _blocks(other)
    return len(blocks) == len(other_blocks) and all(map(is_, blocks, other_blocks))


def _blocks(kernel: Kernel) -> list[Block]:
    return [*kernel.bodies, *(each.body for each in kernel.routines)]


def _dropped(kernel: Kernel) -> tuple[Kernel, Kernel | None]:
    """The kernel after `drop`; again, if it is proven by what `drop` has proven: the kernel before."""
    known = settled(kernel)
    changed = without(kernel, known)
    return changed, changed if is_less(changed, kernel, known) else None


def _proven(transform: Pass, kernel: Kernel) -> Kernel:
    """The result of a pass, if it can be proven."""
    try:
        changed = transform(kernel)
        verify(changed)
    except VerificationError:
        return kernel
    return changed
