"""The passes that look at loops. Most kernels have none, and none of these is imported for them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.startup.late import late

if TYPE_CHECKING:
    from rosetta_jit.kernel.passes import bulk as bulk_passes
    from rosetta_jit.kernel.passes import hoist as hoisting
    from rosetta_jit.kernel.passes import sink as sinking
    from rosetta_jit.kernel.passes import unroll as unrolling
else:
    bulk_passes, hoisting, sinking, unrolling = late("rosetta_jit.kernel.passes", "bulk", "hoist", "sink", "unroll")


def group(kernel: Kernel) -> Kernel:
    """`rosetta_jit.kernel.passes.bulk.group`."""
    return bulk_passes.group(kernel)


def bulk(kernel: Kernel) -> Kernel:
    """`rosetta_jit.kernel.passes.bulk.bulk`."""
    return bulk_passes.bulk(kernel)


def bulk_of_bytes(kernel: Kernel) -> Kernel:
    """`rosetta_jit.kernel.passes.bulk.bulk_of_bytes`."""
    return bulk_passes.bulk_of_bytes(kernel)


def hoist(kernel: Kernel) -> Kernel:
    """`rosetta_jit.kernel.passes.hoist.hoist`."""
    return hoisting.hoist(kernel)


def unroll(kernel: Kernel) -> Kernel:
    """`rosetta_jit.kernel.passes.unroll.unroll`."""
    return unrolling.unroll(kernel)


def sink(kernel: Kernel) -> Kernel:
    """`rosetta_jit.kernel.passes.sink.sink`."""
    return sinking.sink(kernel)
