"""The type that a request names, where no mapping does: from the files that declare it, or with less than these promise."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rosetta_jit.catalogue import bind, wires
from rosetta_jit.catalogue import pipeline as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.errors import MappingError, SchemaError
from rosetta_jit.frameworks.installed import Readers, installed
from rosetta_jit.model.expansion import excess
from rosetta_jit.model.serial import from_plain
from rosetta_jit.model.types import Array, Declaration, Map, Optional, Schema, String, Struct, Type, Union, same_name
from rosetta_jit.parsing.search import UNITS_SUFFIX, Reading, SearchPath, refusal
from rosetta_jit.pipeline.types import Types
from rosetta_jit.runtime.cache.kernels import digest_file
from rosetta_jit.source import Source
from rosetta_jit.startup.dataclass import dataclass, replace
from rosetta_jit.startup.late import Late

if TYPE_CHECKING:
    from rosetta_jit.pipeline import similar_types
    from rosetta_jit.pipeline.request import Request
else:
    similar_types = Late("rosetta_jit.pipeline.similar_types")


@dataclass(frozen=True, slots=True)
class Files:
    """Where a request's files are: those given as ``texts``, those that are searched for, and what was found of both."""

    texts: dict[str, str]
    search: SearchPath
    reading: Reading

    def digests(self) -> dict[str, str | None]:
        """The files that were read, with their digests, and the files that would have been read instead if they existed."""
        lookups = [each for each in self.reading.lookups if each.found not in self.texts]
        preferred = (path for lookup in lookups for path in self.search.preferred(lookup))
        return dict.fromkeys(preferred) | {lookup.found: lookup.digest for lookup in lookups if lookup.found is not None}

    def are_unchanged(self) -> bool:
        """Whether the same would be read again."""
        return all(digest_file(path) == digest for path, digest in self.digests().items())


def files_of(request: Request) -> Files:
    """The files of a request, of which none has been read."""
    texts = _texts(request)
    return Files(texts, SearchPath.of(request.folders, files=texts), Reading())


def declared_types(request: Request, files: Files) -> Types:
    """The type that a request names, as it is declared."""
    if request.wire is not None:
        raise report(request, wires.unknown(None, request.wire, ()))
    for name in request.values:
        raise report(request, bind.needless(name))
    if request.plain is not None:
        import json  # few types come so

        type_, schema = from_plain(json.loads(request.plain))
        struct = schema.resolve(type_)
        assert isinstance(struct, Struct)
        return Types(struct, struct, schema, None)
    schema = _imported(request, files)
    if "text" in request.lenient:
        schema = without_text(schema)
    found = [each for name, each in schema.types.items() if isinstance(each, Struct) and same_name(name, request.type or "")]
    if not found:
        why = [each for name, each in schema.left_out.items() if same_name(name, request.type or "")]
        near = () if request.imports or files.texts else similar_types.similar_types(request.type or "", readers_of(request), files.search)
        raise SchemaError(tuple(why) or (words.unknown_type(request.type or "", (*schema.types, *near)),))
    return Types(found[0], found[0], schema, None)


def _imported(request: Request, files: Files) -> Schema:
    """All that the named files declare; without names, the files given as text, or the file where such a type should be."""
    readers = readers_of(request)
    type_name = request.type or ""
    names_given = tuple(name for name in files.texts if not name.endswith(UNITS_SUFFIX))
    names = request.imports or names_given or tuple(readers.guesses(type_name))
    types: dict[str, Any] = {}
    constants: dict[str, Any] = {}
    left_out: dict[str, Any] = {}
    for name in names:
        source = _named(name, readers, files.search) if request.imports else files.search.find(name)
        if source is not None:
            files.reading.record(name, None, source)
            end = readers.find(source.name)
            if end is None:
                raise SchemaError((words.unknown_suffix(name, readers.suffixes),))
            found = end(source, files.search.loader(files.reading, source))
            types |= found.types
            constants |= found.constants
            left_out |= found.left_out
            if not request.imports and not request.files and any(same_name(each, type_name) for each in types):
                break
        elif request.imports:
            raise SchemaError((words.no_such_file(name, tuple(map(str, files.search.folders))),))
    return Schema(types, constants=constants, left_out=left_out)


def _named(name: str, readers: Readers, search: SearchPath) -> Source | None:
    """The file that the user names: by its path, or by a type that it declares."""
    found = search.named(name)
    homes = () if found is not None or readers.find(name) is not None else readers.homes(name)
    return found or next((source for home in homes if not refusal(home) and (source := search.find(home)) is not None), None)


def of_a_size(request: Request, types: Types) -> Types:
    """Types that can be laid out and compiled; those of a mapping are checked with it."""
    why = excess(types.holder, types.schema)
    if why:
        raise report(request, words.too_large(types.holder.name, types.holder.span, why))
    return types


def _texts(request: Request) -> dict[str, str]:
    """The files that came as texts. One without a name declares the type, in the language of the framework that is asked for."""
    files = dict(request.files)
    if "" in files:
        if request.encoding is None and request.framework is None:
            raise report(request, words.nameless_schema())
        text = files.pop("")
        files[readers_of(request).likely[0].file_of(request.type or "schema", text)] = text
    return files


def readers_of(request: Request) -> Readers:
    """The front ends that the request leaves to choose from."""
    readers = Readers(installed(), request.framework, request.encoding)
    if request.framework is not None and request.framework not in readers.frameworks:
        raise report(request, words.unknown_framework(request.framework, tuple(readers.frameworks)))
    return readers


def report(request: Request, diagnostic: Diagnostic) -> SchemaError | MappingError:
    """The error for a diagnostic: MappingError or SchemaError, by what the request names."""
    return (MappingError if request.mapping is not None else SchemaError)((diagnostic,))


def without_text(schema: Schema) -> Schema:
    """The schema with strings of octets in place of UTF-8."""
    return replace(schema, types={name: _declaration(each) for name, each in schema.types.items()})


def _declaration(declared: Declaration) -> Declaration:
    if not isinstance(declared, Struct):
        return declared
    return replace(declared, fields=tuple(replace(each, type=_type(each.type)) for each in declared.fields))


def _type(type_: Type) -> Type:
    match type_:
        case String("utf-8"):
            return replace(type_, encoding="octets")
        case Array(element):
            return replace(type_, element=_type(element))
        case Optional(value):
            return Optional(_type(value))
        case Map(key, value):
            return replace(type_, key=_type(key), value=_type(value))
        case Union(_, cases):
            return replace(type_, cases=tuple(replace(each, type=_type(each.type)) for each in cases))
        case _:
            return type_
