"""The passes over a kernel, in the order in which they run."""

from __future__ import annotations

from collections.abc import Callable
from operator import is_
from typing import TYPE_CHECKING

from rosetta_jit.kernel.passes.bulk import bulk, bulk_of_bytes, group
from rosetta_jit.kernel.passes.drop import drop
from rosetta_jit.kernel.passes.forget import forget
from rosetta_jit.kernel.passes.hoist import hoist
from rosetta_jit.kernel.passes.join import join
from rosetta_jit.kernel.passes.merge import merge
from rosetta_jit.kernel.passes.reuse import reuse
from rosetta_jit.kernel.passes.simplify import simplify
from rosetta_jit.kernel.passes.sink import sink
from rosetta_jit.kernel.passes.unroll import unroll
from rosetta_jit.kernel.proof.verify import VerificationError, check_shape, verify
from rosetta_jit.kernel.shape import is_large

if TYPE_CHECKING:
    from rosetta_jit.kernel.ir import Kernel

Pass = Callable[["Kernel"], "Kernel"]

PASSES: tuple[Pass, ...] = (
    forget,
    simplify,
    forget,
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

FIELD_BY_FIELD = tuple(each for each in PASSES if each is not join)
"""Those for source that people read, and that may see what is done with each field."""

ANY_MACHINE = tuple(bulk_of_bytes if each is bulk else each for each in FIELD_BY_FIELD if each is not group)
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
    check_shape(kernel)
    results: dict[Pass, Kernel] = {}
    large = is_large(kernel)
    for transform in passes:
        made = results.get(transform)
        if made is None or (not large and not all(map(is_, made.bodies, kernel.bodies))):
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
