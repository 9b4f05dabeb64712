"""The stages of a program, in their order: what each one makes, and how `stage` and `rosetta-jit dump` show it."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple, Protocol
from typing import Literal as OneOf

from rosetta_jit.backends.backend import Backend
from rosetta_jit.backends.installed import backend_named

if TYPE_CHECKING:
    from rosetta_jit.backends.entry.program import Options
    from rosetta_jit.kernel.entries import EntryName
    from rosetta_jit.kernel.ir import Kernel
    from rosetta_jit.pipeline.types import Types
    from rosetta_jit.wire.codec import Encoding

StageName = OneOf["model", "codec", "kernel", "python", "llvm", "asm"]


class Made(Protocol):
    """What stages make: see `rosetta_jit.pipeline.build.Build`."""

    @property
    def types(self) -> Types: ...
    @property
    def encoding(self) -> Encoding: ...
    @property
    def kernels(self) -> tuple[Kernel, ...]: ...
    @property
    def entry(self) -> EntryName: ...
    @property
    def backend(self) -> Backend: ...
    @property
    def compiled_with(self) -> Options: ...


class Stage(NamedTuple):
    """A stage: its name, the property of a `Build` that makes it, and its text."""

    name: StageName
    made: str
    show: Callable[[Made], str]


def _show_types(build: Made) -> str:
    from rosetta_jit.model.printer import show_types

    return show_types(build.types.schema, (build.types.holder, build.types.wire))


def _show_encoding(build: Made) -> str:
    from rosetta_jit.wire.printer import show_encoding

    return show_encoding(build.encoding)


def _show_kernels(build: Made) -> str:
    from rosetta_jit.kernel.printer import to_text

    return "\n".join(to_text(kernel) for kernel in build.kernels)


def _show_python(build: Made) -> str:
    from rosetta_jit.backends.python.function import python_text

    return "\n".join(python_text(kernel) for kernel in build.kernels)


def _show_llvm(build: Made) -> str:
    from rosetta_jit.backends.entry.link import llvm_text

    return llvm_text(build.kernels, build.entry, **build.compiled_with)


def _show_assembly(build: Made) -> str:
    from rosetta_jit.backends.entry.link import assembly

    return assembly(build.kernels, build.entry, **build.compiled_with)


STAGES = (
    Stage("model", "types", _show_types),  # texts are read: types by name, and the checked rules between two
    Stage("codec", "encoding", _show_encoding),  # the framework of the wire describes its bytes
    Stage("kernel", "kernels", _show_kernels),  # codec and rules are lowered, made better by passes, and proven
    Stage("python", "kernels", _show_python),  # a backend prints: as Python
    Stage("llvm", "kernels", _show_llvm),  # as LLVM's language, with the entry from CPython
    Stage("asm", "image", _show_assembly),  # as the code of this machine
)


def shown(build: Made, stage: str) -> str:
    """What a program became, as text; also the text of an installed backend, by its name."""
    found = next((each for each in STAGES if each.name == stage), None)
    if found is not None:
        return found.show(build)
    backend = backend_named(stage)
    if backend is None or not backend.text:
        raise ValueError(f"no stage `{stage}`; there are {', '.join(each.name for each in STAGES)}")
    from rosetta_jit.backends.backend import text_of

    return "\n".join(text_of(backend, kernel) for kernel in build.kernels)
