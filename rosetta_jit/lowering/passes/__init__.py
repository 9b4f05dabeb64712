"""The passes over a kernel, in the order in which they run."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.kernel.verify import verify

if TYPE_CHECKING:
    from rosetta_jit.kernel.ir import Kernel


def run(kernel: Kernel) -> Kernel:
    """All passes, and the proof that what comes out is safe."""
    verify(kernel)
    return kernel
