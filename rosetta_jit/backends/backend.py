"""What a backend is: how kernels become something that runs. It only prints: what a kernel means and that it is safe is decided before."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, cast

from rosetta_jit.startup.dataclass import dataclass
from rosetta_jit.startup.garbage import object_at

if TYPE_CHECKING:
    from rosetta_jit.kernel.host import Functions
    from rosetta_jit.kernel.ir import Kernel

    Runner = Callable[[Kernel, Functions], Callable[..., int]]
    """From a kernel, and the host's functions, to the kernel as `kernel.interpret.run` without its first parameter."""


@dataclass(frozen=True, slots=True)
class Backend:
    """A backend. What it names is found as `module:name`, and imported when it is used.

    Attributes
    ----------
    name
        As users write it: ``backend="python"``.
    runner
        A `Runner`; empty where kernels become object code, which the cache keeps.
    text
        A function from a kernel to its text, which `Decoder.stage` shows by the backend's name; empty where there is none.
    types_kernels
        Of object code: whether numba types the first kernel on its way.
    """

    name: str
    runner: str = ""
    text: str = ""
    types_kernels: bool = False


def runner_of(backend: Backend) -> Runner:
    """What makes kernels callable."""
    return cast("Runner", object_at(backend.runner))


def text_of(backend: Backend, kernel: Kernel) -> str:
    """A kernel as the backend's text."""
    return cast("Callable[[Kernel], str]", object_at(backend.text))(kernel)
