"""The static checks of a mapping, from what it imports to the last element of each array, as one report.

Imports are read by the front ends, names and types resolved, and each direction is checked as a whole.
"""

from __future__ import annotations

from collections.abc import Mapping as Dictionary
from collections.abc import Sequence
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import mapping as words
from rosetta_jit.catalogue import state as state_words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.errors import MappingError
from rosetta_jit.language.check.causes import OF_WHOLE, causes, relations_of, rules_first, unclear
from rosetta_jit.language.check.completeness import Missing, check_complete
from rosetta_jit.language.check.default_counts import defaulted_counts
from rosetta_jit.language.check.discriminators import discriminators_of
from rosetta_jit.language.check.file_name import misnamed
from rosetta_jit.language.check.left_out import left_out
from rosetta_jit.language.check.rounding import rounded
from rosetta_jit.language.check.state import idle, set_again
from rosetta_jit.language.check.unequal_lengths import other_lengths
from rosetta_jit.language.check.unreachable import unreachable
from rosetta_jit.language.imports.declarations import Imported, Imports, merge, reached, read_imports
from rosetta_jit.language.imports.mappings import read_usable
from rosetta_jit.language.parameters.bind import bind, handed_on
from rosetta_jit.language.parameters.state import NO_STATE, Declared, declared
from rosetta_jit.language.resolve.relations import derived
from rosetta_jit.language.resolve.rules import Resolved, TypedRules, resolve
from rosetta_jit.language.scope import Message
from rosetta_jit.language.typed import Rule, StateVariable
from rosetta_jit.language.units.hand_factors import wrong_factors
from rosetta_jit.language.uses import Signature, UsableMappings, Use
from rosetta_jit.model.expr import Side
from rosetta_jit.model.mapping import Mapping
from rosetta_jit.model.types import Schema, name_parts
from rosetta_jit.parsing.idl import FrontEnds
from rosetta_jit.parsing.search import Reading, SearchPath
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import dataclass, replace
from rosetta_jit.startup.late import Late, late

if TYPE_CHECKING:
    from rosetta_jit.catalogue.check import Block
    from rosetta_jit.language.check import wire_shares, wires
    from rosetta_jit.language.units import side_files
else:
    side_files = Late("rosetta_jit.language.units.side_files")
    wire_shares, wires = late("rosetta_jit.language.check", "wire_shares", "wires")

SIDES: tuple[Side, ...] = ("holder", "wire")


@dataclass(frozen=True, slots=True)
class Checked:
    """A mapping without errors. None as rules means that the direction has no block, ``()`` that it is empty.

    ``holder`` and ``wire`` are the message types with the schema of all imports; ``uses`` are those of other mappings. ``notes`` say
    what was made of what the text leaves open.
    """

    mapping: Mapping
    holder: Message
    wire: Message
    unpack: tuple[Rule, ...] | None
    pack: tuple[Rule, ...] | None
    functions: dict[str, Signature]
    warnings: tuple[Diagnostic, ...]
    uses: tuple[Use, ...] = ()
    notes: tuple[Diagnostic, ...] = ()
    state: Declared = NO_STATE


def check(
    mapping: Mapping,
    front_ends: FrontEnds,
    search: SearchPath,
    reading: Reading | None = None,
    parameters: Dictionary[str, object] | None = None,
) -> Checked:
    """Read what a mapping imports, and check it.

    Parameters
    ----------
    front_ends
        Of all frameworks.
    reading
        Collects the files that were read.
    parameters
        The values of the mapping's parameters; None to check it for all values that they may get.

    Raises
    ------
    MappingError
        Everything that is wrong with the mapping and with what it imports, in the order of the text; behind that, what no rule sets.
    """
    texts = _read(mapping, Imports(mapping.source, front_ends, search, reading or Reading()), parameters)
    state: Dictionary[Side, Dictionary[str, StateVariable]] = {side: texts.state.variables(side) for side in SIDES}
    resolved = resolve(texts.mapping, texts.schema, texts.schema, texts.usable, state) if texts.complete else ()
    if not isinstance(resolved, Resolved):
        raise _error([*texts.problems, *(_with_import(each, mapping, texts.imports) for each in resolved)])
    problems = _wrong(texts, resolved)
    if _errors(problems):
        raise _error(problems)
    problems += [*_silent_losses(texts.mapping, resolved, _blocks(texts.written)), *idle(texts.mapping), *unreachable(texts.written)]
    unpack, pack = (None if block is None else block.rules for block in (resolved.unpack, resolved.pack))
    functions, uses = dict(resolved.functions), tuple(texts.usable.uses)
    notes, warnings = ([each for each in problems if (each.severity == "note") == is_note] for is_note in (True, False))
    both = resolved.holder, resolved.wire
    return Checked(texts.mapping, *both, unpack, pack, functions, _sorted(warnings), uses, _sorted(notes), texts.state)


@dataclass(frozen=True, slots=True)
class _Texts:
    """What is read for a mapping: as it is ``written``, and with the rules of each direction; the mappings and types that it uses.

    ``complete`` is whether all of that could be read; ``underived`` says which relations could not be turned round.
    """

    written: Mapping
    mapping: Mapping
    usable: UsableMappings
    imports: Imports
    imported: list[Imported]
    schema: Schema
    state: Declared
    complete: bool
    underived: list[Diagnostic]
    problems: list[Diagnostic]


def _read(mapping: Mapping, imports: Imports, parameters: Dictionary[str, object] | None) -> _Texts:
    """Read what a mapping imports, and turn its relations round with the types of their fields."""
    problems: list[Diagnostic] = []
    bound: list[Diagnostic] = []
    underived: list[Diagnostic] = []
    underived_there: list[Diagnostic] = []
    written = bind(mapping, parameters, bound)
    read = read_usable(written, imports.search, imports.reading, problems, handed_on(written, parameters))
    imported = read_imports(written, imports, problems)
    theirs = [each for other in read.mappings() for each in read_imports(other, replace(imports, importer=other.source), problems)]
    merged = merge([*imported, *theirs], problems)
    if mapping.wires:
        merged = wires.message_of_wires(mapping, merged)
    derived_mapping = derived(written, merged, read, underived)
    usable = read.changed(lambda other: derived(other, merged, read, underived_there))
    problems += [] if _errors(problems) else underived_there  # what could not be turned round follows from what is wrong there
    complete = not _errors(problems)
    problems += [*_without_handed_on(bound, mapping, usable), *(underived if complete else ())]
    units = [file for each in (*imported, *theirs) for file in each.units]
    schema = side_files.annotated(merged, units, imports.has, problems) if units else merged
    state = declared(derived_mapping, problems)
    return _Texts(written, derived_mapping, usable, imports, imported, schema, state, complete, underived, problems)


def _wrong(texts: _Texts, resolved: Resolved) -> list[Diagnostic]:
    """What is wrong with the texts, with the rules, and with each direction as a whole."""
    relations, mapping = relations_of(texts.written.rules or ()), texts.mapping
    packs = not _errors(texts.underived) and not unclear([*texts.problems, *resolved.problems], relations)
    problems = causes([*texts.problems, *resolved.problems], relations)
    problems += _directions(mapping, resolved, _blocks(texts.written), packs=packs)
    problems += [found for block in (resolved.unpack, resolved.pack) if block for found in wrong_factors(block.rules)]
    problems += [*_unused(texts.imported, resolved), *misnamed(mapping, texts.schema)]
    problems += [found for block in (resolved.unpack, resolved.pack) if block for found in set_again(block.rules)]
    again = {each.span for each in problems if each.code == "set-twice"}
    problems += [each for each in (_of_wires(resolved) if mapping.wires else ()) if each.span not in again]
    problems += [state_words.in_used(other.state[0].span, other.source.name) for other in texts.usable.mappings() if other.state]
    return rules_first(problems, relations)


def _of_wires(resolved: Resolved) -> list[Diagnostic]:
    """What is wrong with the rules of several wires."""
    blocks: tuple[tuple[Side, TypedRules | None], ...] = (("holder", resolved.unpack), ("wire", resolved.pack))
    return [found for target, block in blocks if block for found in wire_shares.wrong_wires(block.rules, target, resolved.holder)]


def _error(problems: Sequence[Diagnostic]) -> MappingError:
    """All that is wrong; what would have been made of the rest does not matter then."""
    shown = _sorted([each for each in problems if each.severity != "note"])
    return MappingError(tuple(sorted(shown, key=lambda each: each.code in OF_WHOLE)))


def _with_import(problem: Diagnostic, mapping: Mapping, imports: Imports) -> Diagnostic:
    """The report of a type that no import declares, with the import that would."""
    named = {mapping.holder_span: mapping.holder_type, mapping.wire_span: mapping.wire_type}
    named |= {each.span: each.type for each in mapping.wires}
    home = imports.home(named[problem.span]) if problem.code == "unknown-type" and problem.span in named else None
    return problem if home is None else replace(problem, help=f'import the file that declares it: `import "{home}"`')


def _errors(problems: list[Diagnostic]) -> list[Diagnostic]:
    return [problem for problem in problems if problem.severity == "error"]


def _without_handed_on(problems: list[Diagnostic], mapping: Mapping, usable: UsableMappings) -> list[Diagnostic]:
    """Without the warnings about parameters that no rule uses, but a mapping that is used."""
    declared = {each.name for other in usable.mappings() for each in other.parameters}
    spans = [each.span for each in mapping.parameters if each.name in declared]
    return [each for each in problems if each.code != "parameter-unused" or each.span not in spans]


def _blocks(written: Mapping) -> tuple[Block, Block]:
    """The blocks in which rules that are missing for unpacking, and for packing, are to be written."""
    if not written.rules:
        return "", ""
    return ("unpack-rules", "pack-rules") if written.unpack_rules or written.pack_rules else ("rules", "rules")


def _directions(mapping: Mapping, resolved: Resolved, blocks: tuple[Block, Block], *, packs: bool) -> list[Diagnostic]:
    """Each direction as a whole; ``packs`` unless rules to pack are missing that could not be derived, or are open.

    An empty block says that the direction is not meant to exist.
    """
    if resolved.unpack is None and resolved.pack is None:
        return [words.no_rules(mapping.wire_span)]
    problems: list[Diagnostic] = []
    holder, wire = resolved.holder, resolved.wire
    if mapping.unpack_rules and resolved.unpack is not None:
        problems += check_complete(resolved.unpack, holder, Missing("holder", mapping.holder_span, blocks[0]))
    if packs and mapping.pack_rules and resolved.pack is not None:
        problems += check_complete(resolved.pack, wire, Missing("wire", mapping.wire_span, blocks[1], _wire_spans(mapping)))
    for block, target in ((resolved.unpack, holder), (resolved.pack, wire)):
        if block is not None:
            problems += defaulted_counts(block.rules, target)
            _check_order(block.rules, target, problems)
    return problems


def _wire_spans(mapping: Mapping) -> dict[str, Span | None]:
    return {each.name: each.span for each in mapping.wires}


def _check_order(rules: tuple[Rule, ...], target: Message, problems: list[Diagnostic]) -> None:
    """Each discriminator can be set before a case of its union."""
    unions = discriminators_of(rules, target)
    if unions:
        from rosetta_jit.language.check.discriminator_order import discriminators_first

        discriminators_first(rules, unions, problems)


def _silent_losses(mapping: Mapping, resolved: Resolved, blocks: tuple[Block, Block]) -> list[Diagnostic]:
    """What rules without errors leave out."""
    warnings: list[Diagnostic] = []
    spans = _wire_spans(mapping)
    holder, wire = (resolved.holder, mapping.holder_span), (resolved.wire, mapping.wire_span)
    unpack: tuple[Side, Block] = ("holder", blocks[0])
    pack: tuple[Side, Block] = ("wire", blocks[1])
    for block, (source, read_at), (target, set_at), where in ((resolved.unpack, wire, holder, unpack), (resolved.pack, holder, wire, pack)):
        if block is not None and block.rules:
            warnings += left_out(block.rules, source, target, (read_at, set_at), where, spans)
            warnings += [*other_lengths(block.rules), *([] if mapping.rounds else rounded(block.rules))]
    return warnings


def _unused(imported: list[Imported], resolved: Resolved) -> list[Diagnostic]:
    used = {*reached(resolved.holder.root, resolved.holder.schema), *reached(resolved.wire.root, resolved.wire.schema), *resolved.named}
    known = {name_parts(name) for name in resolved.holder.schema.types}
    return [words.import_unused(one.statement.span, one.statement.path) for one in imported if not _is_used(one, used, known)]


def _is_used(one: Imported, used: set[str], known: set[tuple[str, ...]]) -> bool:
    measured = any(name_parts(each.text) in known for file in one.units for each in file.types)
    return measured or bool(used & {*one.schema.types, *one.schema.constants})


def _sorted(problems: Sequence[Diagnostic]) -> tuple[Diagnostic, ...]:
    def place(problem: Diagnostic) -> tuple[str, int, bool]:
        is_warning = problem.severity != "error"  # of one place, what is wrong comes before what is suspect
        return ("", -1, is_warning) if problem.span is None else (problem.span.source.name, problem.span.start, is_warning)

    return tuple(sorted(dict.fromkeys(problems), key=place))
