"""The driver: from what a user asks for to a program, stage by stage. Whoever finds the answer in the cache never imports this.

texts → schemas and mapping → checked rules → encoding, layout → kernels → passes → proof → code
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar, Literal, cast, get_args

from rosetta_jit.backends.backend import Backend
from rosetta_jit.backends.installed import backend_named
from rosetta_jit.backends.installed import installed as installed_backends
from rosetta_jit.catalogue import pipeline as words
from rosetta_jit.frameworks.base import Choices, Framework
from rosetta_jit.frameworks.installed import GROUP as FRAMEWORKS
from rosetta_jit.kernel.host import UserFunction
from rosetta_jit.kernel.ir import Kernel, Site
from rosetta_jit.kernel.passes import order as passes
from rosetta_jit.kernel.proof.known import kept_by
from rosetta_jit.kernel.proof.verify import VerificationError
from rosetta_jit.kernel.traits import LARGE, LARGE_WITHOUT_RULES, HostUse, use_of_host
from rosetta_jit.lowering.lower import lower
from rosetta_jit.lowering.writer import References, TooManyStatementsError
from rosetta_jit.model.layout import Layout, layout
from rosetta_jit.model.serial import to_plain
from rosetta_jit.model.types import Ref, Schema, Struct
from rosetta_jit.pipeline.declared import declared_types, files_of, of_a_size, readers_of, report
from rosetta_jit.pipeline.kept_state import kept_of
from rosetta_jit.pipeline.recent import recently
from rosetta_jit.pipeline.request import ByteOrder, GivenFunction, Request
from rosetta_jit.pipeline.types import Types
from rosetta_jit.pipeline.user_functions import called_functions, check_compiled, check_given
from rosetta_jit.runtime.cache.kernels import digest_file
from rosetta_jit.runtime.cache.proofs import proven
from rosetta_jit.runtime.limits import MAX_PIXEL_BYTES
from rosetta_jit.runtime.run import GRACE_BYTES
from rosetta_jit.source import Span
from rosetta_jit.startup.cached import cached_property
from rosetta_jit.startup.dataclass import replace
from rosetta_jit.startup.entry_points import files_of_offered
from rosetta_jit.startup.garbage import imported
from rosetta_jit.startup.late import late
from rosetta_jit.wire.codec import Encoding, Rare

if TYPE_CHECKING:
    from rosetta_jit.backends.entry.program import Options
    from rosetta_jit.language.check.mapping import Checked
    from rosetta_jit.pipeline import mapped, stages
else:
    mapped, stages = late("rosetta_jit.pipeline", "mapped", "stages")


class Build:
    """A program in the making. Each stage is made when it is first asked for.

    Its kernels handle all messages of the encoding. If it ``leaves_rare`` ones and becomes machine code, they are another program's.
    A class whose ``TEXTS_STAY`` has decoders that borrow leave texts of tagged messages where they are, too. Where ``ROWS_IN_ORDER``, who
    calls an encoder has put rows of recursive structs together as `rosetta_jit.lowering.lower` says.
    """

    TEXTS_STAY: ClassVar[bool] = False
    ROWS_IN_ORDER: ClassVar[bool] = False

    def __init__(self, request: Request, references: References | None = None, *, leaves_rare: bool = False) -> None:
        self.request = request
        self.references = references
        self.sources = files_of(request)
        self._leaves_rare = leaves_rare and request.direction == "decode"

    def referring(self, references: References) -> Build:
        """The same, with bytes left in the message."""
        return Build(self.request, references)

    @cached_property
    def checked(self) -> Checked:
        """The mapping, with the parameters of the request."""
        imported("rosetta_jit.pipeline.mapped")
        return recently(self.request, self.sources, self._checked)

    def _checked(self) -> Checked:
        return mapped.checked(self.request, self.sources)

    @cached_property
    def types(self) -> Types:
        request = self.request
        types = mapped.types_of(request, self.checked) if request.mapping is not None else of_a_size(request, self._declared())
        check_given(request, types.functions)
        return types

    def _declared(self) -> Types:
        return recently(self.request, self.sources, lambda: declared_types(self.request, self.sources))

    @cached_property
    def encoding(self) -> Encoding:
        framework = self.wire_framework
        name = self.request.encoding or next(iter(framework.encodings))
        if name not in framework.encodings:
            every = {each.name: each.encodings for each in readers_of(self.request).frameworks.values()}
            raise report(self.request, words.unknown_encoding(name, framework.name, tuple(framework.encodings), every))
        encoding = framework.encoding(name)(self.types.wire, self.types.schema, name, self._choices(framework, name))
        if self.request.direction == "encode" and encoding.written is None:
            raise report(self.request, words.ambiguous_encoding(name, tuple(each for each in framework.encodings if each != name)))
        return encoding

    @property
    def rare(self) -> Rare | None:
        """The messages that are left to another program, which is made when the first of them comes."""
        is_compiled = not self.backend.runner and not self.backend.types_kernels
        return self.encoding.rare if self._leaves_rare and is_compiled else None

    @cached_property
    def layout(self) -> Layout:
        return self._layout(self.types.holder)

    def _layout(self, struct: Struct) -> Layout:
        try:
            return self._layout_of(struct.name, self.types.schema)
        except ValueError as error:
            raise report(self.request, words.too_large(struct.name, struct.span, str(error))) from error

    def _layout_of(self, name: str, schema: Schema) -> Layout:
        """Where the fields of a struct lie."""
        return layout(Ref(name), schema)

    @cached_property
    def kernels(self) -> tuple[Kernel, ...]:
        """Proven kernels: the decoder, or the encoder and what measures for it."""
        return tuple(map(self._proven, self.lowered))

    @cached_property
    def lowered(self) -> tuple[Kernel, ...]:
        """The same as they are before the passes and the proof."""
        directions = ("decode",) if self.request.direction == "decode" else ("encode", "size")
        return tuple(map(self._lowered, directions))

    def _proven(self, kernel: Kernel) -> Kernel:
        try:
            return self._optimised(kernel)
        except VerificationError as error:
            raise report(self.request, words.unproven(self._span, str(error))) from error

    def _optimised(self, kernel: Kernel) -> Kernel:
        """The kernel after the passes; VerificationError if it cannot be proven safe."""
        with kept_by(proven):
            return passes.run(kernel, large=self._large)

    @property
    def _large(self) -> int:
        """Statements from which on passes run but once."""
        return LARGE if self.types.rules is not None else LARGE_WITHOUT_RULES

    def _lowered(self, direction: Literal["decode", "encode", "size"]) -> Kernel:
        types, request = self.types, self.request
        rules = None if types.rules is None else mapped.between(types, self._layout(types.wire))
        borrow = request.borrow or self.references is not None
        encoding, goes_on = (self.encoding, False) if self.rare is None else (self.encoding.usual, True)
        try:
            kernel = lower(
                encoding,
                self.layout,
                direction,
                name=types.wire.name,
                mapped=rules,
                borrow=borrow,
                references=self.references,
                texts_stay=self.TEXTS_STAY,
                rows_in_order=self.ROWS_IN_ORDER,
            )
        except TooManyStatementsError as error:
            raise report(self.request, words.too_many_statements(self._span, str(error))) from error
        return replace(kernel, goes_on=goes_on)

    @property
    def _span(self) -> Span | None:
        """The place to show for errors of the program as a whole."""
        return self.types.wire.span if self.types.rules is None else self.checked.mapping.wire_span

    def _choices(self, framework: Framework, encoding: str) -> Choices:
        """The choices that the encoding offers and the request makes."""
        request = self.request
        if request.byte_order not in (None, *get_args(ByteOrder)):
            raise report(request, words.unknown_byte_order(request.byte_order))
        if request.byte_order is not None and encoding not in framework.byte_orders:
            raise report(request, words.fixed_byte_order(encoding))
        known = tuple(framework.leniencies.get(encoding, ()))
        for name in request.lenient:
            if name not in known:
                raise report(request, words.unknown_leniency(name, encoding, known))
        return Choices(request.byte_order, frozenset(request.lenient))

    # --- frameworks --------------------------------------------------------------------------------------------------

    @cached_property
    def wire_framework(self) -> Framework:
        return self._framework(self.types.wire)

    @cached_property
    def holder_framework(self) -> Framework:
        return self._framework(self.types.holder)

    @property
    def manners(self) -> str:
        """Where the manners of the holder's framework are found."""
        return self.holder_framework.manners

    def _framework(self, struct: Struct) -> Framework:
        """The framework whose IDL declares a type."""
        readers = readers_of(self.request)
        owner = readers.owner(struct.span.source.name) if struct.span is not None else None
        if owner is None and self.request.framework is None and self.request.encoding is None:
            raise report(self.request, words.nameless_schema())
        return owner or readers.likely[0]

    # --- results -----------------------------------------------------------------------------------------------------

    @cached_property
    def backend(self) -> Backend:
        """The one that was asked for, or LLVM."""
        found = backend_named(self.request.backend)
        if found is None:
            raise report(self.request, words.unknown_backend(self.request.backend or "", tuple(installed_backends())))
        return found

    @cached_property
    def functions(self) -> tuple[UserFunction, ...]:
        """The functions of the user's that the kernels call."""
        return called_functions(self.request, self.types.functions, self.host.calls)

    @cached_property
    def host(self) -> HostUse:
        """What the kernels have to do with their host."""
        return use_of_host(self.kernels)

    @cached_property
    def called(self) -> tuple[GivenFunction, ...]:
        """The same as they were given."""
        names = {function.name for function in self.functions}
        return tuple(function for function in self.request.functions if function.name in names)

    @cached_property
    def text(self) -> str:
        """All that the code and its `header` depend on besides this process, if all functions are identified that it calls."""
        from rosetta_jit.kernel.printer import to_text

        kernels = [to_text(kernel) for kernel in self.kernels]
        digests = [f"{function.name} {function.identity.digest}" for function in self.called]
        plain = repr([self.header[name] for name in ("state", "wires", "wire", "rare", "type")])
        return "\n".join([self.backend.name, self.entry, self.manners, str(self.limit), plain, *kernels, *digests])

    @cached_property
    def entry(self) -> Literal["decode", "borrow", "encode"]:
        if self.request.direction == "encode":
            return "encode"
        return "borrow" if self.request.borrow else "decode"

    @cached_property
    def header(self) -> dict[str, Any]:
        """What a process needs besides the code, as JSON holds it."""
        return {
            "type": to_plain(Ref(self.types.holder.name), self.types.schema),
            "manners": self.manners,
            "entry": self.entry,
            "sites": [[plain_site(site) for site in kernel.sites] for kernel in self.kernels],
            "asks_host": self.host.asks,
            "state": kept_of(self.kernels, {"": self.types.state}),
            "host": self.host.ours,
            "limit": self.limit,
            "wires": self.wires,
            "wire": None if self.types.share is None else self.types.share.number,
            "rare": None if self.rare is None else [self.rare.opening.hex(), self.rare.byte_order],
            "rest": self._rest,
        }

    @property
    def limit(self) -> int:
        """The bytes of a lane that a message may ask for, whatever its own size."""
        said = None if self.types.rules is None else self.checked.mapping.limit
        if said is not None:
            return said
        return MAX_PIXEL_BYTES if self.host.ours else GRACE_BYTES

    @property
    def wires(self) -> list[str]:
        """The names of the mapping's wires, of which the program's own is one; none where it has one wire."""
        return [] if self.request.mapping is None else [each.name for each in self.checked.mapping.wires]

    def check_functions(self) -> tuple[str, ...]:
        """The names of the user's functions whose code has addresses of this process. MappingError where one is not what is declared."""
        imported("rosetta_jit.backends.entry.link")
        return check_compiled(self.functions, self.types.functions)

    def image(self) -> bytes:
        """The object code."""
        imported("rosetta_jit.backends.entry.link")
        from rosetta_jit.backends.entry.link import compile_program

        return compile_program(self.kernels, self.entry, **self.compiled_with)

    @property
    def _rest(self) -> dict[str, Any] | None:
        """The rest of the calls, which are compiled when they are asked for; None where the code has them."""
        from rosetta_jit.backends.entry.program import Program
        from rosetta_jit.backends.entry.texts import rest_text

        program = Program(self.kernels, self.entry, {"with_numba": self.backend.types_kernels, "host": self.host, "leaves_rest": True})
        text = rest_text(program) if program.leaves_rest else None
        return None if text is None else {"symbols": program.rest_symbols, **text.plain}

    @property
    def compiled_with(self) -> Options:
        """What the code depends on besides the kernels and the entry."""
        opening = None if self.rare is None else self.rare.opening
        return {
            "with_numba": self.backend.types_kernels,
            "functions": self.functions,
            "opening": opening,
            "host": self.host,
            "leaves_rest": True,
        }

    def stage(self, stage: str) -> str:
        """What the program became, as text."""
        return stages.shown(cast("stages.Made", self), stage)  # its properties are made once

    def files(self) -> dict[str, str | None]:
        """The digests of all files that the program depends on."""
        return self.sources.digests() | {path: digest_file(path) for path in self.offered}

    @cached_property
    def offered(self) -> tuple[str, ...]:
        """The files of installed packages whose frameworks and functions this program may use: what is kept of it depends on them."""
        functions = mapped.files_of_functions() if self.request.mapping is not None else ()
        return (*files_of_offered(FRAMEWORKS), *functions)


def plain_site(site: Site) -> list[Any]:
    """A site as the headers of programs have it."""
    parts = [[part.offset, part.size, part.path, part.step] for part in site.parts]
    return [site.kind, site.path, site.detail, site.line, parts, site.detail_lane]
