"""The passes over a kernel, in the order in which they run."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from rosetta_jit.kernel.passes.bulk import bulk, bulk_of_bytes, group
from rosetta_jit.kernel.passes.drop import drop
from rosetta_jit.kernel.passes.hoist import hoist
from rosetta_jit.kernel.passes.merge import merge
from rosetta_jit.kernel.passes.reuse import reuse
from rosetta_jit.kernel.passes.simplify import simplify
from rosetta_jit.kernel.passes.sink import sink
from rosetta_jit.kernel.passes.unroll import unroll
from rosetta_jit.kernel.proof.verify import VerificationError, verify
from rosetta_jit.kernel.shape import is_large

if TYPE_CHECKING:
    from rosetta_jit.kernel.ir import Kernel

Pass = Callable[["Kernel"], "Kernel"]

PASSES: tuple[Pass, ...] = (
    simplify,
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
    merge,
    sink,
)

FINDS_MORE_AFTER: dict[Pass, tuple[Pass, ...]] = {drop: (hoist, unroll)}
"""Passes that find more in a kernel only where one of these has changed it since they ran. Any other pass may where anything has; what
nothing has changed no pass changes again, and in large kernels later rounds find little."""

ANY_MACHINE = tuple(bulk_of_bytes if each is bulk else each for each in PASSES if each is not group)
"""Those for code that may run where numbers lie with their high byte first."""


def run(kernel: Kernel, passes: tuple[Pass, ...] = PASSES) -> Kernel:
    """All passes, and the proof that what comes out is safe.

    The proof looks only so far; where it cannot follow a pass, the kernel stays as it was before that pass.

    Raises
    ------
    VerificationError
        The kernel as it was lowered could not be proven safe.
    """
    try:
        return _all(kernel, passes)
    except VerificationError:
        verify(kernel)
    for transform in passes:
        kernel = _proven(transform, kernel)
    return kernel


def _all(kernel: Kernel, passes: tuple[Pass, ...]) -> Kernel:
    changed: dict[Pass, set[Pass]] = {}  # for each pass that has run: those that have changed the kernel since
    large = is_large(kernel)
    for transform in passes:
        if transform in changed and (large or changed[transform].isdisjoint(FINDS_MORE_AFTER.get(transform, passes))):
            continue
        before, kernel = kernel, transform(kernel)
        if kernel is not before:
            for since in changed.values():
                since.add(transform)
        changed[transform] = set()
    verify(kernel)
    return kernel


def _proven(transform: Pass, kernel: Kernel) -> Kernel:
    """The result of a pass, if it can be proven."""
    try:
        changed = transform(kernel)
        verify(changed)
    except VerificationError:
        return kernel
    return changed
