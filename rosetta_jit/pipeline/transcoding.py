"""Bridges between dialects of a wire whose messages describe themselves: no schema, no mapping."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rosetta_jit.backends.backend import Backend
from rosetta_jit.backends.installed import backend_named
from rosetta_jit.backends.installed import installed as installed_backends
from rosetta_jit.catalogue import pipeline as words
from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.installed import GROUP as FRAMEWORKS
from rosetta_jit.frameworks.installed import installed
from rosetta_jit.kernel.host import UserFunction
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import Direction
from rosetta_jit.kernel.passes import order as passes
from rosetta_jit.kernel.printer import to_text
from rosetta_jit.lowering.codec.transcoding import MESSAGES, transcoding_kernel
from rosetta_jit.lowering.writer import References
from rosetta_jit.model.layout import layout
from rosetta_jit.model.serial import to_plain
from rosetta_jit.model.types import Ref
from rosetta_jit.pipeline.build import plain_site
from rosetta_jit.pipeline.kept_state import kept_of
from rosetta_jit.pipeline.request import BridgeRequest, GivenFunction
from rosetta_jit.runtime.cache.kernels import digest_file
from rosetta_jit.runtime.run import GRACE_BYTES
from rosetta_jit.startup.cached import cached_property
from rosetta_jit.startup.entry_points import files_of_offered
from rosetta_jit.startup.garbage import imported

if TYPE_CHECKING:
    from rosetta_jit.wire.self_describing import Tree

DIRECTIONS: tuple[Direction, ...] = ("decode", "size", "encode")


class TranscodingBuild:
    """Such a bridge in the making: what `rosetta_jit.pipeline.bridge.BridgeBuild` is for mappings."""

    functions: tuple[UserFunction, ...] = ()
    called: tuple[GivenFunction, ...] = ()

    def __init__(self, request: BridgeRequest) -> None:
        self.request = request
        self._references = References()

    @cached_property
    def tree(self) -> Tree:
        """Which codes become which. SchemaError where messages of such encodings do not describe themselves."""
        source, target = self.request.decode.encoding or "", self.request.encode.encoding or ""
        frameworks = [each for each in installed().values() if each.transcoding]
        for framework in frameworks:
            found = framework.tree(source, target)
            if found is not None:
                return found
        raise SchemaError((words.no_transcoding(source, target),))

    @cached_property
    def kernels(self) -> tuple[Kernel, ...]:
        """Proven kernels: what walks through a message, what measures, what writes the other one."""
        within = layout(Ref("message"), MESSAGES)
        return tuple(passes.run(transcoding_kernel(self.tree, within, direction, self._references)) for direction in DIRECTIONS)

    @property
    def backend(self) -> Backend:
        name = self.request.decode.backend
        found = backend_named(name)
        if found is None:
            raise SchemaError((words.unknown_backend(name or "", tuple(installed_backends())),))
        return found

    @cached_property
    def references(self) -> tuple[int, ...]:
        """As of a `BridgeBuild`."""
        assert self.kernels
        return tuple(sorted(self._references.found))

    @cached_property
    def text(self) -> str:
        """As of a `BridgeBuild`."""
        return "\n".join([self.backend.name, "transcoding", *map(to_text, self.kernels)])

    @cached_property
    def header(self) -> dict[str, Any]:
        """As of a `BridgeBuild`."""
        return {
            "type": to_plain(Ref("message"), MESSAGES),
            "entry": "bridge",
            "references": list(self.references),
            "sites": [[plain_site(site) for site in kernel.sites] for kernel in self.kernels],
            "asks_host": False,
            "state": kept_of((), {}),
            "host": [],
            "limit": GRACE_BYTES,
        }

    def check_functions(self) -> tuple[str, ...]:
        return ()

    @property
    def offered(self) -> tuple[str, ...]:
        """As of a `Build`."""
        return files_of_offered(FRAMEWORKS)

    def image(self) -> bytes:
        """The object code."""
        imported("rosetta_jit.backends.entry.link")
        from rosetta_jit.backends.entry.link import compile_program

        return compile_program(self.kernels, "bridge", with_numba=False, references=self.references, thorough=True)

    def stage(self, stage: str) -> str:
        """The kernels or their code, as text: there is neither a model nor a codec."""
        if stage in ("model", "codec"):
            raise ValueError(f"no stage `{stage}`: messages that describe themselves need no type")
        if stage in ("kernel", "python"):
            from rosetta_jit.backends.python.function import python_text

            return "\n".join(map(to_text if stage == "kernel" else python_text, self.kernels))
        from rosetta_jit.backends.entry import link

        return (link.llvm_text if stage == "llvm" else link.assembly)(self.kernels, "bridge", with_numba=False, references=self.references)

    def files(self) -> dict[str, str | None]:
        return {path: digest_file(path) for path in self.offered}
