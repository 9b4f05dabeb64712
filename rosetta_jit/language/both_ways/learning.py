"""What the relations of a block say of the wire's fields: each is solved for the field that it leaves unknown."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

from rosetta_jit.language.both_ways.array_relations import equal_lengths
from rosetta_jit.language.both_ways.digit_relations import Digits, digits_of
from rosetta_jit.language.both_ways.image_relations import images_of
from rosetta_jit.language.both_ways.inverse import NoInverseError, condition_in, fields_in, solved
from rosetta_jit.language.both_ways.inverse_parts import below, part, plain, put_together, rest_of, taken_part
from rosetta_jit.language.both_ways.knowledge import Beside, Knowledge, Loop, Loops, key_of
from rosetta_jit.language.both_ways.linear_relations import related, solve_together
from rosetta_jit.language.both_ways.presence import flag_of, is_kept
from rosetta_jit.language.both_ways.signal_relations import frames_of, told_in_all
from rosetta_jit.language.both_ways.text_parts import parts_of_texts
from rosetta_jit.language.function import Affine
from rosetta_jit.language.installed import written
from rosetta_jit.language.operators import form_of
from rosetta_jit.model.expr import Binary, Call, Choice, Expr, Len, Literal, Name, Path, Unary
from rosetta_jit.model.mapping import Arranged, For, Relation, Rule, When
from rosetta_jit.model.printer import show_expr
from rosetta_jit.model.walk import Field, fields_of, parts, path_of, rebuilt

if TYPE_CHECKING:
    from rosetta_jit.language.both_ways.joint_relations import Together


def learn(known: Knowledge, rules: tuple[Rule, ...], loops: Loops, is_assigned: Callable[[Field], bool]) -> None:
    """Relations of one field first, then those that have one left when the others are known, then those whose fields are parts of a value.

    Where several tell of one field, it is taken from the one that keeps most of it: the others are checks, and what was unpacked
    must pass them. What ``is_assigned`` is set by rules to pack.
    """
    for rule in rules:
        if (flag := flag_of(rule)) is not None and not is_assigned(flag[1]) and is_kept(flag, rules):
            known.learn_flag(*flag, loops)
        if isinstance(rule, When) and not loops:
            known.signals |= told_in_all(rule, known.type_of)
    relations = [each for each in _relations(rules, loops) if not _is_left(each[0], is_assigned)]
    groups = (*parts_of_texts(relations), *frames_of(relations), *images_of(relations), *digits_of(relations))
    wholes = {(rule.value, around) for rule, around in relations if isinstance(rule.value, Path)}
    done = _together(known, groups, lambda place, around: is_assigned(place) or (place, around) in wholes)
    done |= _pairs(known, [each for each in relations if id(each[0]) not in done])
    single = [each for each in sorted(relations, key=_loss) if not _is_size_of(*each, wholes)]
    done |= {id(rule) for rule, around in single if id(rule) not in done and _solve(known, rule, around)}
    later = [each for each in relations if id(each[0]) not in done]
    for _ in range(2):
        later = [each for each in later if not _solve_rest(known, *each)]
    later = _solve_sums(known, later, is_assigned)
    later = [each for each in later if not _solve_parts(known, *each, is_assigned)]
    for each in later:
        _solve_rest(known, *each)


def _relations(rules: tuple[Rule, ...], loops: Loops) -> list[tuple[Relation, Loops]]:
    """All relations that hold whatever conditions say, with the loops around them."""
    found: list[tuple[Relation, Loops]] = []
    for rule in rules:
        if isinstance(rule, Relation):
            found.append((rule, loops))
        elif isinstance(rule, Arranged):
            found.append((Relation(rule.place, rule.cases[0][1], rule.span), loops))
        elif isinstance(rule, For):
            found += _relations(rule.body, (*loops, Loop(rule.variable, rule.start, rule.stop)))
    return found


def _is_left(rule: Relation, is_assigned: Callable[[Field], bool]) -> bool:
    """Whether a relation to a part of a field is left to the rules to pack, which set it."""
    call = taken_part(rule.value)
    return call is not None and rest_of(call) is None and bool(below(call)) and any(map(is_assigned, fields_in(call)))


def _is_size_of(rule: Relation, loops: Loops, wholes: set[tuple[Path, Loops]]) -> bool:
    """Whether a relation says how long an array is that another one sets as a whole: then it is a check."""
    fields = fields_in(rule.value)
    return len(fields) == 1 and isinstance(fields[0], Len) and (fields[0].path, loops) in wholes


def _loss(relation: tuple[Relation, Loops]) -> int:
    """How much of a field its relation loses: nothing, nothing that is not refused, or perhaps something."""
    value = relation[0].value
    return 0 if isinstance(value, Path | Len) else 1 if all(map(_is_reversible, parts(value))) else 2


def _is_reversible(part: Expr) -> bool:
    """Whether an operation gives another value for each, or refuses it, whatever the types."""
    match part:
        case Path() | Len() | Literal() | Name() | Unary():
            return True
        case Binary(operator):
            form = form_of(operator, is_left=True)
            return form is not None and form.exact
        case Call(function="int8" | "int16" | "int32" | "int64" | "uint8" | "uint16" | "uint32" | "uint64", arguments=(_,)):
            return True
        case Call(function) if (known := written(function)) is not None:
            return isinstance(known.law, Affine) and known.law.exact
        case _:
            return False


def _solve(known: Knowledge, rule: Relation, loops: Loops) -> bool:
    """A relation of one field, whatever else is known."""
    if len(fields_of(rule.value, "wire")) != 1 or fields_of(rule.place, "wire") or condition_in(rule.value):
        return False
    return _set_by(known, rule, rule.value, rule.place, loops)


def _solve_rest(known: Knowledge, rule: Relation, loops: Loops) -> bool:
    """A relation of several fields of which one is not known."""
    place = known.replaced(rule.place, loops)
    unknown = [each for each in fields_in(rule.value) if known.value(each, loops) is None]
    if fields_of(place, "wire") or len(unknown) != 1:
        return False
    conditional = condition_in(rule.value)
    if conditional is not None:
        return _solve_choice(known, rule, conditional, place, loops)
    return _set_by(known, rule, _with_known(rule.value, unknown, known, loops), place, loops)


def _solve_sums(
    known: Knowledge, later: list[tuple[Relation, Loops]], is_assigned: Callable[[Field], bool]
) -> list[tuple[Relation, Loops]]:
    """Relations of several fields that are not known, as many as there are of these; gives those that are left."""
    open_: list[tuple[Relation, Loops, Expr, list[Field]]] = []
    for rule, loops in later:
        place = known.replaced(rule.place, loops)
        unknown = [each for each in fields_in(rule.value) if known.value(each, loops) is None]
        is_single = isinstance(rule.place, Path) and not fields_of(place, "wire") and condition_in(rule.value) is None
        if len(unknown) > 1 and is_single and not any(map(is_assigned, unknown)):
            open_.append((rule, loops, place, unknown))
    done: set[int] = set()
    for numbers in related([frozenset((loops, each) for each in unknown) for _, loops, _, unknown in open_]):
        done |= _solve_sum(known, [open_[number] for number in numbers])
    return [each for each in later if id(each[0]) not in done]


def _solve_sum(known: Knowledge, rules: list[tuple[Relation, Loops, Expr, list[Field]]]) -> set[int]:
    """Relations that have some fields in common: each field is set by the first relation that has it."""
    loops = rules[0][1]
    fields = list(dict.fromkeys(field for _, _, _, unknown in rules for field in unknown))
    expressions = [(_with_known(rule.value, unknown, known, around), place) for rule, around, place, unknown in rules]
    try:
        found = solve_together(expressions, fields, known.type_of)
    except NoInverseError as error:
        at = show_expr(error.part)[1:-1] if isinstance(error.part, Binary) else show_expr(error.part)
        known.unsolved.update({id(rule): f"at `{at}`, {error.why}" for rule, _, _, _ in rules})
        return set()
    for solution in found.solutions:
        _say(known, next(rule for rule, _, _, unknown in rules if solution.place in unknown), solution.place, solution.value, loops)
    for rule, _, _, _ in rules:
        known.beside[id(rule)] = Beside(rule, "holder", (), is_asked=found.is_checked)
    return {id(rule) for rule, _, _, _ in rules}


def _solve_parts(known: Knowledge, rule: Relation, loops: Loops, is_assigned: Callable[[Field], bool]) -> bool:
    """A relation of several fields that are not known, each of which is a part of the value."""
    place = known.replaced(rule.place, loops)
    unknown = [each for each in fields_in(rule.value) if known.value(each, loops) is None]
    if fields_of(place, "wire") or len(unknown) < 2 or condition_in(rule.value) or any(map(is_assigned, unknown)):
        return False
    try:
        found = part(_with_known(rule.value, unknown, known, loops), place, known.type_of)
    except NoInverseError:
        return False
    for setting in found.settings:
        known.setters.setdefault(key_of(setting.place, loops)[0], (rule, setting.value))
        known.learn(setting.place, setting.value, loops)
    known.beside[id(rule)] = Beside(rule, "wire", found.digits)
    return True


def _pairs(known: Knowledge, relations: list[tuple[Relation, Loops]]) -> set[int]:
    """Two relations of one field, each to a part of it, set it together; gives the relations for which that is so."""
    taken = [(rule, loops, call) for rule, loops in relations if (call := _part_of(rule)) is not None]
    rests = {(rest_of(call), loops): rule for rule, loops, call in reversed(taken) if rest_of(call) is not None}
    paired: set[int] = set()
    for rule, loops, call in taken:
        other = rests.get((plain(call), loops))
        if other is not None and id(other) not in paired and _put_together(known, rule, other, loops):
            paired |= {id(rule), id(other)}
    return paired


def _part_of(rule: Relation) -> Call | None:
    if len(fields_of(rule.value, "wire")) != 1 or fields_of(rule.place, "wire") or condition_in(rule.value):
        return None
    return taken_part(rule.value)


def _put_together(known: Knowledge, rule: Relation, other: Relation, loops: Loops) -> bool:
    try:
        solution, digit = put_together(rule.value, rule.place, other.value, other.place, known.type_of)
    except NoInverseError:
        return False
    digits = () if digit is None else (digit,)
    _say(known, rule, solution.place, solution.value, loops)
    known.beside[id(other)] = Beside(other, "holder", digits)
    return True


def _together(known: Knowledge, groups: Iterable[Together], is_told: Callable[[Field, Loops], bool]) -> set[int]:
    """Relations that together say what a value is set it, the first of them for all; gives the relations for which that is so.

    What another rule tells, all of it, is left to that.
    """
    done: set[int] = set()
    for group in groups:
        (first, loops), *others = group.relations
        if any(is_told(each, loops) for each in fields_in(group.whole)):
            if all(rule.span == first.span for rule, _ in others):  # one rule for several places says how many parts there are
                known.unpacked[id(first)] = Beside(first, "wire", (), group.refused)
            continue
        try:
            solution, length = group.solved(known.type_of), group.length(known.type_of)
        except NoInverseError:
            continue
        _say(known, first, solution.place, solution.value, loops)
        if length is not None:
            known.learn(Len(path_of(solution.place)), Literal(length, first.span), loops)
        if group.refused:
            known.beside[id(first)] = Beside(first, "wire", (), group.refused)
        known.beside.update({id(rule): Beside(rule, "holder", ()) for rule, _ in others})
        if isinstance(group, Digits):
            checked = group.digits(known.type_of)
            known.beside.update({id(rule): Beside(rule, "holder", checked.get(id(rule), ())) for rule, _ in group.relations})
        done |= {id(rule) for rule, _ in group.relations}
    return done


def _solve_choice(known: Knowledge, rule: Relation, parts: tuple[Expr, Expr, Expr], place: Expr, loops: Loops) -> bool:
    """`a if condition else b`, of one field in both and with a condition that is known."""
    condition = known.replaced(parts[0], loops)
    if fields_of(condition, "wire") or any(condition_in(part) for part in parts[1:]):
        return False
    try:
        found = [solved(part, place, known.type_of) for part in parts[1:] if len(fields_in(part)) == 1]
    except NoInverseError:
        return False
    if len(found) != 2 or found[0].place != found[1].place:
        return False
    _say(known, rule, found[0].place, Choice(((condition, found[0].value),), found[1].value, span=rule.span), loops)
    return True


def _set_by(known: Knowledge, rule: Relation, expr: Expr, place: Expr, loops: Loops) -> bool:
    try:
        solution = solved(expr, place, known.type_of)
    except NoInverseError:
        return False
    _say(known, rule, solution.place, solution.value, loops)
    return True


def _say(known: Knowledge, rule: Relation, place: Field, value: Expr, loops: Loops) -> None:
    known.setters.setdefault(key_of(place, loops)[0], (rule, value))
    known.learn(place, value, loops)
    if isinstance(rule.place, Path) and isinstance(place, Path) and value == rule.place:
        known.learn(Len(place), Len(rule.place, rule.span), loops)  # arrays that are equal have equal lengths
    if (lengths := equal_lengths(rule.place, rule.value)) is not None:
        known.learn(*lengths, loops)


def _with_known(value: Expr, unknown: list[Field], known: Knowledge, loops: Loops) -> Expr:
    """An expression with all fields but some replaced."""
    if value in unknown:
        return value
    if isinstance(value, Path | Len):
        return known.replaced(value, loops)
    return rebuilt(value, lambda part: _with_known(part, unknown, known, loops))
