"""The passes that look at loops, at hidden lanes, or at kernels that measure: most kernels do without, and import none of them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.startup.late import late

if TYPE_CHECKING:
    from rosetta_jit.kernel.passes import bulk as bulk_passes
    from rosetta_jit.kernel.passes import forget as forgetting
    from rosetta_jit.kernel.passes import fuse as fusing
    from rosetta_jit.kernel.passes import hoist as hoisting
    from rosetta_jit.kernel.passes import neglect as neglecting
    from rosetta_jit.kernel.passes import sink as sinking
    from rosetta_jit.kernel.passes import unroll as unrolling
else:
    bulk_passes, hoisting, sinking, unrolling = late("rosetta_jit.kernel.passes", "bulk", "hoist", "sink", "unroll")
    forgetting, fusing, neglecting = late("rosetta_jit.kernel.passes", "forget", "fuse", "neglect")


def group(kernel: Kernel) -> Kernel:
    """`rosetta_jit.kernel.passes.bulk.group`."""
    return bulk_passes.group(kernel)


def bulk(kernel: Kernel) -> Kernel:
    """`rosetta_jit.kernel.passes.bulk.bulk`."""
    return bulk_passes.bulk(kernel)


def bulk_of_bytes(kernel: Kernel) -> Kernel:
    """`rosetta_jit.kernel.passes.bulk.bulk_of_bytes`."""
    return bulk_passes.bulk_of_bytes(kernel)


def fuse(kernel: Kernel) -> Kernel:
    """`rosetta_jit.kernel.passes.fuse.fuse`."""
    return fusing.fuse(kernel)


def hoist(kernel: Kernel) -> Kernel:
    """`rosetta_jit.kernel.passes.hoist.hoist`."""
    return hoisting.hoist(kernel)


def unroll(kernel: Kernel) -> Kernel:
    """`rosetta_jit.kernel.passes.unroll.unroll`."""
    return unrolling.unroll(kernel)


def sink(kernel: Kernel) -> Kernel:
    """`rosetta_jit.kernel.passes.sink.sink`."""
    return sinking.sink(kernel)


def forget(kernel: Kernel) -> Kernel:
    """`rosetta_jit.kernel.passes.forget.forget`."""
    return forgetting.forget(kernel) if kernel.hidden else kernel


def neglect(kernel: Kernel) -> Kernel:
    """`rosetta_jit.kernel.passes.neglect.neglect`."""
    return neglecting.neglect(kernel) if kernel.direction == "size" else kernel
