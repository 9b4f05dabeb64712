"""What a framework is: IDLs, encodings, and the manners of its holders, each named by where it is found and imported when it is used."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from fnmatch import fnmatch
from typing import TYPE_CHECKING, Literal, Protocol, cast

from rosetta_jit.model.types import Schema, Struct, name_parts
from rosetta_jit.startup.dataclass import dataclass, field
from rosetta_jit.startup.garbage import object_at

if TYPE_CHECKING:
    from rosetta_jit.frameworks.definitions import Definition
    from rosetta_jit.frameworks.probe import Probes
    from rosetta_jit.parsing.idl import FrontEnd, Load
    from rosetta_jit.source import Source
    from rosetta_jit.wire.codec import Encoding
    from rosetta_jit.wire.other_type import Partners
    from rosetta_jit.wire.self_describing import Tree

    Encoder = Callable[[Struct, Schema, str, "Choices"], Encoding]
    """From a struct to the encoding of a name: what describes its bytes."""
    Successors = Callable[[Struct, Struct, str], Partners]
    """From an older struct, the one that followed it, and its name for people, to what became of its fields: the newer name, or None."""
    TreeOf = Callable[[str, str], Tree | None]
    """From two encodings to what messages of one become in the other."""
    Define = Callable[[Struct, Schema], Definition | None]
    """From a struct to its definition as logs carry it."""
    Announce = Callable[[Struct, Schema], dict[str, str]]
    """From a struct to what publishers say of it: by the names of transports' options, as ``type``, ``md5`` or ``hash``."""
    FileOf = Callable[["Framework", str, str], str]
    """From a type and a text that declares it to the name of the file that it would be."""

    class Infer(Protocol):
        """A function from captured messages to a schema that describes them."""

        def __call__(self, messages: Iterable[bytes], *, name: str, encoding: str) -> str:
            """The schema of a type of that name, as text."""
            ...


ByteOrder = Literal["little", "big"]

ANY_BYTE = "every byte but 0 is true"
"""What several frameworks forgive in a bool."""


@dataclass(frozen=True, slots=True)
class Choices:
    """What a caller may say about an encoding besides its name.

    Attributes
    ----------
    byte_order
        None for the usual one, or for either, where messages say which it is.
    lenient
        Names of what is forgiven: keys of the framework's ``leniencies``.
    """

    byte_order: ByteOrder | None = None
    lenient: frozenset[str] = frozenset()


@dataclass(frozen=True, slots=True)
class Framework:
    """One framework; every implementation as ``module:name``.

    Attributes
    ----------
    idl
        Front ends by the suffix of the files that they read.
    encodings
        By name; the first is the one that decoders use where none is named.
    manners
        Of its holders; empty for plain ones.
    files
        Patterns of the file names that are this framework's and not another's with the same suffix.
    several
        For suffixes of files that declare several types: how the names of those end, behind that of the file. They lie in a folder that is
        called like their suffix.
    homes
        For types whose file is not called as they are: the name of the file.
    leniencies
        For each encoding, what it can be asked to forgive: a name, and the peer that needs it.
    byte_orders
        Encodings whose byte order can be chosen.
    features
        Probes of what its IDLs can describe: see `rosetta_jit.frameworks.features`.
    texts
        A function that gives the file that declares a type the name that its text calls for: see `file_of`. Empty where all texts are of
        one kind.
    transcoding
        A function that gives the `rosetta_jit.wire.self_describing.Tree` of two encodings. Empty where messages do not describe themselves.
    follows
        Older frameworks whose types this one has under the same names, and for each a function that says what became of a type's fields.
    infer
        A function that drafts a schema from captured messages. Empty where their bytes do not tell where a field begins.
    definition
        A function from a struct and its schema to its `Definition`; empty where logs carry none.
    announcement
        A function from a struct and its schema to what a publisher says of it; empty where that is nothing.
    """

    name: str
    idl: Mapping[str, str]
    encodings: Mapping[str, str]
    manners: str = ""
    files: tuple[str, ...] = ()
    several: Mapping[str, tuple[str, ...]] = field(default_factory=dict[str, "tuple[str, ...]"])
    homes: Mapping[str, str] = field(default_factory=dict[str, str])
    leniencies: Mapping[str, Mapping[str, str]] = field(default_factory=dict[str, "Mapping[str, str]"])
    byte_orders: tuple[str, ...] = ()
    features: str = ""
    texts: str = ""
    transcoding: str = ""
    follows: Mapping[str, str] = field(default_factory=dict[str, str])
    infer: str = ""
    definition: str = ""
    announcement: str = ""

    def successors(self, older: str) -> Successors | None:
        """The function that says what became of an older framework's types in this one; None where this one does not follow that."""
        return cast("Successors", object_at(self.follows[older])) if older in self.follows else None

    def tree(self, source: str, target: str) -> Tree | None:
        """What messages of one encoding become in another one, if they describe themselves and differ in codes alone."""
        return cast("TreeOf", object_at(self.transcoding))(source, target) if self.transcoding else None

    def probes(self) -> Probes:
        """The probes of its features, none where it offers none."""
        return cast("Probes", object_at(self.features)) if self.features else {}

    def definition_of(self, struct: Struct, schema: Schema) -> Definition | None:
        """The definition of a struct as logs carry it; None where that cannot be had."""
        return cast("Define", object_at(self.definition))(struct, schema) if self.definition else None

    def announced(self, struct: Struct, schema: Schema) -> dict[str, str]:
        """What a publisher says of a struct, by the names of transports' options."""
        return cast("Announce", object_at(self.announcement))(struct, schema) if self.announcement else {}

    def encoding(self, name: str) -> Encoder:
        """The encoding of a name."""
        return cast("Encoder", object_at(self.encodings[name]))

    def drafts(self) -> Infer | None:
        """The function that drafts schemas from captured messages; None where its bytes do not tell where a field begins."""
        return cast("Infer", object_at(self.infer)) if self.infer else None

    def reads(self, file: str) -> bool:
        """Whether it has a front end for a file of that name."""
        return file.endswith(tuple(self.idl))

    def claims(self, file: str) -> bool:
        """Whether files of that name are its own."""
        return any(fnmatch(file, pattern) for pattern in self.files)

    def files_of(self, parts: tuple[str, ...]) -> Iterator[str]:
        """The files of several types of which one has that name."""
        if ".".join(parts) in self.homes:
            yield self.homes[".".join(parts)]
        for suffix in self.several:
            yield from self.files_of_kind(parts, suffix)

    def files_of_kind(self, parts: tuple[str, ...], suffix: str) -> Iterator[str]:
        """Those of them with that suffix."""
        folders = tuple(each for each in parts[:-1] if each != suffix[1:])
        for stem in (parts[-1].removesuffix(each) for each in self.several[suffix] if parts[-1].endswith(each)):
            yield "/".join((*folders, suffix[1:], stem)) + suffix
            yield "/".join((*folders, stem)) + suffix

    def file_of(self, type_: str, text: str) -> str:
        """The name of the file that a text would be which comes without one, and declares a type."""
        if self.texts:
            return cast("FileOf", object_at(self.texts))(self, type_, text)
        return "/".join(name_parts(type_)) + next(iter(self.idl))

    def front_end(self, file: str) -> FrontEnd:
        """The front end for a file that it `reads`, imported when it is first called."""
        return _lazy(next(place for suffix, place in self.idl.items() if file.endswith(suffix)))


def _lazy(place: str) -> FrontEnd:
    def parse(source: Source, load: Load) -> Schema:
        from rosetta_jit.parsing.remembered import parsed

        return parsed(cast("FrontEnd", object_at(place)), source, load)

    return parse
