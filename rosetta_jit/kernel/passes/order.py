"""The passes over a kernel, in the order in which they run."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from rosetta_jit.kernel.passes.bulk import bulk, bulk_of_bytes, group
from rosetta_jit.kernel.passes.drop import drop
from rosetta_jit.kernel.passes.hoist import hoist
from rosetta_jit.kernel.passes.join import join
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
    join,
    sink,
)

ANY_MACHINE = tuple(bulk_of_bytes if each is bulk else each for each in PASSES if each not in {group, join})
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
    results: dict[Pass, Kernel] = {}
    large = is_large(kernel)
    for transform in passes:
        # What a pass has made, and no pass has changed since, it would not change again. In large kernels later rounds find little.
        if results.get(transform) is not kernel and not (large and transform in results):
            kernel = results[transform] = transform(kernel)
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
