"""Parameters of a mapping: their values in place of their names, before anything else is looked at.

Where a value is not known yet, a `Given` stands for it, so that the mapping is checked for all values that it may get. A condition that is
known with the values leaves one of its blocks, and the other is not looked at.
"""

from __future__ import annotations

from collections.abc import Mapping as Dictionary
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import bind as words
from rosetta_jit.catalogue import groups
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.language.groups import group_of
from rosetta_jit.language.limits import MAX_CHOSEN
from rosetta_jit.model.expr import Call, Choice, Expr, Given, Item, List, Literal, Name
from rosetta_jit.model.mapping import Assign, For, Mapping, Parameter, Relation, Rule, Several, When
from rosetta_jit.model.types import Int
from rosetta_jit.model.walk import parts, rebuilt, with_expressions
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import dataclass, field, replace
from rosetta_jit.startup.late import Late

if TYPE_CHECKING:
    from rosetta_jit.language import folding
    from rosetta_jit.language.parameters import several_places
    from rosetta_jit.language.parameters import values as kinds
else:
    folding = Late("rosetta_jit.language.folding")
    kinds = Late("rosetta_jit.language.parameters.values")
    several_places = Late("rosetta_jit.language.parameters.several_places")


def bind(mapping: Mapping, arguments: Dictionary[str, object] | None, problems: list[Diagnostic]) -> Mapping:
    """The mapping with the values of its parameters; None where it is checked before there are any.

    Lists that are assigned are assigned item by item, whether they are parameters or stand in the text.
    """
    binder = _Binder(_values(mapping, arguments, problems), problems)
    blocks = [None if block is None else binder.rules(block, ()) for block in (mapping.rules, mapping.unpack_rules, mapping.pack_rules)]
    state = tuple(replace(each, initial=folding.folded(binder.expr(each.initial))) for each in mapping.state)
    unused = [parameter for parameter in mapping.parameters if parameter.name not in binder.used and parameter.type in kinds.SCALARS]
    problems.extend(words.unused(parameter.span, parameter.name) for parameter in unused)
    return replace(mapping, rules=blocks[0], unpack_rules=blocks[1], pack_rules=blocks[2], state=state)


def handed_on(mapping: Mapping, arguments: Dictionary[str, object] | None) -> Dictionary[str, object] | None:
    """The values of a mapping's parameters that the mappings it uses have too: the ``arguments``, and its defaults for the rest."""
    if arguments is None:
        return None
    defaults = {each.name: kinds.written(folding.folded(each.default)) for each in mapping.parameters if each.default is not None}
    return {**defaults, **arguments}


def _values(mapping: Mapping, arguments: Dictionary[str, object] | None, problems: list[Diagnostic]) -> dict[str, Expr]:
    declared = {parameter.name: parameter for parameter in mapping.parameters}
    problems.extend(words.unknown(mapping.holder_span, name, declared) for name in (arguments or {}) if name not in declared)
    values: dict[str, Expr] = {}
    for parameter in mapping.parameters:
        if parameter.name in values:
            problems.append(words.repeated(parameter.span, parameter.name))
        elif parameter.type not in kinds.SCALARS:
            problems.append(words.unknown_type(parameter.span, parameter.name, parameter.type, kinds.SCALARS))
        else:
            values[parameter.name] = _value(parameter, arguments, problems)
    return values


def _value(parameter: Parameter, arguments: Dictionary[str, object] | None, problems: list[Diagnostic]) -> Expr:
    """The value of a parameter, or what stands for it where it has none."""
    type_ = kinds.SCALARS[parameter.type]
    unknown = Given(parameter.name, (), type_, parameter.span, is_list=parameter.is_list)
    default = None if parameter.default is None else folding.folded(parameter.default)
    if arguments is not None and parameter.name in arguments:
        value, span = arguments[parameter.name], parameter.span
    elif default is not None:
        value, span = kinds.written(default), parameter.default.span if parameter.default else None
    else:
        if arguments is not None:
            problems.append(words.missing(parameter.span, parameter.name))
        return unknown
    found = kinds.accepted(value, parameter)
    if isinstance(found, str):
        problems.append(words.unfit(span, parameter.name, found))
        return unknown
    return found


@dataclass(frozen=True, slots=True)
class _Binder:
    """Puts values in place of names."""

    values: dict[str, Expr]
    problems: list[Diagnostic]
    used: set[str] = field(default_factory=set[str])
    compiled: list[int] = field(default_factory=list[int])

    def rules(self, rules: tuple[Rule, ...], variables: tuple[str, ...]) -> tuple[Rule, ...]:
        return tuple(found for rule in rules for found in self.rule(rule, variables))

    def rule(self, rule: Rule, variables: tuple[str, ...]) -> tuple[Rule, ...]:
        bound = with_expressions(rule, self.expr)
        match bound:
            case For(variable=variable, body=body):
                if variable in self.values:
                    self.problems.append(words.shadowed(rule.span, variable))
                if isinstance(rule, For) and self.has_no_rounds(rule, bound):
                    return ()
                return (replace(bound, body=self.rules(body, (*variables, variable))),)
            case When(condition, then, otherwise):
                known = self.decided(rule.condition if isinstance(rule, When) else condition, condition)
                if known is not None:
                    return self.rules(then if known else otherwise, variables)
                return (replace(bound, then=self.rules(then, variables), otherwise=self.rules(otherwise, variables)),)
            case Several():
                single = several_places.one_by_one(bound, self.problems)
                return tuple(found for each in single for found in several_places.spread(each, variables))
            case Assign(value=List() | Given(is_list=True)) | Relation(value=List() | Given(is_list=True)):
                return several_places.spread(bound, variables)
            case _:
                return (bound,)

    def expr(self, expr: Expr) -> Expr:
        if isinstance(expr, Choice):
            return self.choice(expr)
        bound = rebuilt(expr, self.expr)
        match bound:
            case Name(name) if name in self.values:
                self.used.add(name)
                return _placed(self.values[name], expr.span)
            case Call("len", (List(items),)):
                return Literal(len(items), bound.span)
            case Call("len", (Given(name, is_list=True),)):
                return Given(f"len({name})", (), Int(64), bound.span)
            case Item(items, index):
                return self.item(items, index, bound)
            case _:
                return bound

    def item(self, items: Expr, index: Expr, item: Item) -> Expr:
        """An item of a list; the item itself where its number is known."""
        match items, folding.folded(index):
            case Call(), Literal(str(name)):
                return self.component(items, name, item)
            case List(()), _:
                self.problems.append(words.empty_list(item.span))
            case List(values), Literal(int(number)) if 0 <= number < len(values):
                return values[number]
            case List(values), Literal(int(number)):
                self.problems.append(words.no_such_item(index.span, number, len(values)))
            case Given(name, _, element, is_list=True), _:
                return Given(name, (index,), element, item.span)
            case List(values), _:
                return self.chosen(item, len(values))
            case _:
                self.problems.append(words.not_a_list(item.span))
        return Literal(0, item.span)

    def component(self, value: Call, name: str, item: Item) -> Expr:
        """One number of a group, by its name."""
        group = group_of(value)
        names = [] if group is None else [each.names[0] for each in group.components]
        if name in names:
            return item
        self.problems.append(groups.no_component(item.span, name, names))
        return Literal(0, item.span)

    def chosen(self, item: Item, count: int) -> Expr:
        """An item that is chosen when a message comes; each such place is compiled for every item of the list."""
        before = self.compiled[-1] if self.compiled else 0
        self.compiled.append(before + count)
        if before <= MAX_CHOSEN < before + count:
            self.problems.append(words.many_items(item.span, MAX_CHOSEN))
        return item if before + count <= MAX_CHOSEN else Literal(0, item.span)

    def choice(self, choice: Choice) -> Expr:
        """A choice without the cases that are known not to be; their values are not looked at."""
        cases: list[tuple[Expr, Expr]] = []
        for written_condition, value in choice.cases:
            condition = self.expr(written_condition)
            known = self.decided(written_condition, condition)
            if known:
                return replace(choice, cases=tuple(cases), otherwise=self.expr(value)) if cases else self.expr(value)
            cases += [(condition, self.expr(value))] if known is None else []
        otherwise = None if choice.otherwise is None else self.expr(choice.otherwise)
        if otherwise is not None and not cases:
            return otherwise
        if not cases:
            cases = [(Literal(value=False, span=choice.span), self.expr(choice.cases[0][1]))]
        return replace(choice, cases=tuple(cases), otherwise=otherwise)

    def has_no_rounds(self, written_loop: For[Rule, Expr], loop: For[Rule, Expr]) -> bool:
        """Whether a loop ends where it starts for the parameters' values, as one over an empty list does."""
        if not any(isinstance(part, Name) and part.name in self.values for part in parts(written_loop.stop)):
            return False
        start, stop = folding.folded(loop.start), folding.folded(loop.stop)
        return isinstance(start, Literal) and isinstance(stop, Literal) and start.value == stop.value

    def decided(self, written_condition: Expr, condition: Expr) -> bool | None:
        """Whether a condition on parameters holds; None where it is on something else, too."""
        if not any(isinstance(part, Name) and part.name in self.values for part in parts(written_condition)):
            return None
        match folding.folded(condition):
            case Literal(bool(value)):
                return value
            case _:
                return None


def _placed(value: Expr, span: Span | None) -> Expr:
    """A value as if it stood where its name does."""
    return rebuilt(replace(value, span=span), lambda part: replace(part, span=span))
