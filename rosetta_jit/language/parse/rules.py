"""Rules and expressions of a mapping: the parser's tree → the model.

The walks are recursive; the caller has bounded the depth of the tree.
"""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING, cast

from rosetta_jit.catalogue import mapping as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.language.limits import MAX_DIGITS
from rosetta_jit.language.parse.templates import pieces_of
from rosetta_jit.model import expr
from rosetta_jit.model.mapping import (
    Arranged,
    Assign,
    Default,
    For,
    Parameter,
    Reject,
    Relation,
    Renamed,
    Rest,
    Rule,
    SameNames,
    SetLength,
    SetState,
    Several,
    State,
    Via,
    When,
)
from rosetta_jit.parsing.lalr import Token, Tree
from rosetta_jit.source import Source, Span
from rosetta_jit.startup.dataclass import dataclass
from rosetta_jit.startup.late import Late

if TYPE_CHECKING:
    from rosetta_jit.model import element_rules
else:
    element_rules = Late("rosetta_jit.model.element_rules")

ESCAPES = {'"': '"', "\\": "\\", "n": "\n", "t": "\t", "r": "\r"}

OTHERWISE = ("otherwise", "otherwise_of_both")


@dataclass(frozen=True, slots=True)
class Context:
    """Which side the rules of a block write and which they read, and where their problems go."""

    source: Source
    target: expr.Side
    origin: expr.Side
    problems: list[Diagnostic]

    def span(self, node: Tree | Token) -> Span:
        if isinstance(node, Token):
            return Span(self.source, node.start_pos, node.end_pos)
        return Span(self.source, node.start_pos, node.end_pos)


def read_rule(tree: Tree, context: Context) -> Rule:
    """One rule: the place is on the target's side, everything else on the origin's."""
    span = context.span(tree)
    match str(tree.data):
        case "assign" | "relation":
            return _set(tree, context, span)
        case "set_length":
            place, value = _trees(tree)
            return SetLength(_path(place, context.target, context), read_expression(value, context), span)
        case "length_relation":
            left, right = _trees(tree)
            place = _path(left, context.target, context)
            return Relation(expr.Len(place, place.span), read_expression(right, context), span)
        case "arranged" | "arranged_both":
            return _arranged(tree, context, span)
        case "when" | "when_of_both":
            condition, *body = _trees(tree)
            return _when(read_expression(condition, context), body, context, span)
        case "ignore" | "default":
            return _left_alone(tree, context, span)
        case "same" | "same_of_both":
            return _same_names(tree, context, span)
        case "reject":
            return _reject(tree, context, span)
        case "set_state":
            return SetState(_name(tree), read_expression(_trees(tree)[0], context), span)
        case _:
            start, stop, *body = _trees(tree)
            variable = str(_tokens(tree)[0])
            rules = tuple(read_rule(rule, context) for rule in body)
            return For(variable, read_expression(start, context), read_expression(stop, context), rules, span)


def _set(tree: Tree, context: Context, span: Span) -> Rule:
    """A place, or several, and what is assigned or related to them."""
    parts = _trees(tree)
    where = [_trees(parts.pop())[0]] if parts[-1].data == "where" else []
    via = [parts.pop()] if parts[-1].data == "via" else []
    *places, value = parts
    found = [_path(place, context.target, context) for place in places]
    is_relation = tree.data == "relation"
    if is_relation:
        context.problems.extend(words.filter_both_ways(context.span(each)) for each in where)
    if len(found) > 1:
        context.problems.extend(words.via_of_several(context.span(each)) for each in via)
        context.problems.extend(words.filter_of_several(context.span(each)) for each in where if not is_relation)
        return Several(tuple(found), read_expression(value, context), span, is_relation=is_relation)
    (place,) = found
    if is_relation:
        return Relation(place, read_expression(value, context), span, _via(via, context))
    condition = next((read_expression(each, context) for each in where), None)
    return Assign(place, read_expression(value, context), span, _via(via, context), condition)


def _left_alone(tree: Tree, context: Context, span: Span) -> Rule:
    is_ignored = tree.data == "ignore"
    paths = [_path(each, context.origin if is_ignored else context.target, context) for each in _trees(tree)]
    if not paths:
        return Rest("ignore" if is_ignored else "default", span)
    return element_rules.ignoring(paths[0], span) if is_ignored else Default(paths[0], span)


def _same_names(tree: Tree, context: Context, span: Span) -> SameNames:
    renamed, but = ([each for each in _trees(tree) if (each.data == "path") == is_path] for is_path in (False, True))
    pairs = [(_trees(each), context.span(each)) for each in renamed]
    renames = tuple(
        Renamed(_path(place, context.target, context), _path(value, context.origin, context), where) for (place, value), where in pairs
    )
    return SameNames(tuple(_path(each, context.target, context) for each in but), span, renames=renames)


def _arranged(tree: Tree, context: Context, span: Span) -> Arranged:
    place, flag, *entries = _trees(tree)
    cases = [tuple(read_expression(part, context) for part in _trees(entry)) for entry in entries]
    both = (_path(place, context.target, context), _path(flag, context.target, context))
    return Arranged(*both, tuple((key, value) for key, value in cases), span)


def _via(trees: list[Tree], context: Context) -> Via | None:
    if not trees:
        return None
    name, *depth = (token for token in _tokens(trees[0]) if token.type in {"STRING", "INTEGER"})
    deepest = _integer(depth[0], context) if depth else None
    return Via(read_string(name, context.source, context.problems), deepest, context.span(trees[0]))


def _when(condition: expr.Expr, body: list[Tree], context: Context, span: Span) -> Rule:
    then = tuple(read_rule(rule, context) for rule in body if rule.data not in OTHERWISE)
    otherwise = (rule for block in body if block.data in OTHERWISE for rule in _trees(block))
    return When(condition, then, tuple(read_rule(rule, context) for rule in otherwise), span)


def _reject(tree: Tree, context: Context, span: Span) -> Rule:
    text, pieces = _template(tree, context)
    rejection = Reject(text, span, pieces, written=True)
    for condition in _trees(tree):
        return When(read_expression(condition, context), (rejection,), (), span)
    return rejection


def _template(tree: Tree, context: Context) -> tuple[str, tuple[expr.Expr, ...]]:
    """A text and, where it has values in braces, what it consists of."""
    text, place = _text(tree, context), context.span(_tokens(tree)[0])
    return text, pieces_of(text, place, context.problems, lambda value: read_expression(value, context))


def _text(tree: Tree, context: Context) -> str:
    return read_string(_tokens(tree)[0], context.source, context.problems)


def read_string(token: Token, source: Source, problems: list[Diagnostic]) -> str:
    """The characters that a quoted text stands for."""
    text = str(token)[1:-1]
    if "\\" not in text:
        return text
    start = token.start_pos + 1
    problems.extend(
        words.escape(Span(source, start + escape.start(), start + escape.end()), escape[0])
        for escape in re.finditer(r"\\(.)", text)
        if escape[1] not in ESCAPES
    )
    return re.sub(r"\\(.)", lambda escape: ESCAPES.get(escape[1], escape[1]), text)


def read_expression(tree: Tree, context: Context) -> expr.Expr:
    """An expression, whose fields are on the origin's side."""
    span = context.span(tree)
    match str(tree.data):
        case "integer":
            return expr.Literal(_integer(_tokens(tree)[0], context), span)
        case "real":
            return expr.Literal(_real(_tokens(tree)[0], context), span)
        case "string":
            return expr.Literal(_text(tree, context), span)
        case "true" | "false":
            return expr.Literal(str(tree.data) == "true", span)
        case "name":
            return expr.Name(str(_tokens(tree)[0]), span)
        case "path":
            return _path(tree, context.origin, context)
        case "length":
            measured = read_expression(_trees(tree)[0], context)
            return expr.Len(measured, span) if isinstance(measured, expr.Path) else expr.Call("len", (measured,), span)
        case "list":
            return expr.List(tuple(read_expression(item, context) for item in _trees(tree)), span)
        case "item":
            index = _trees(_trees(tree)[0])[0]
            return expr.Item(expr.Name(str(_tokens(tree)[0]), span), read_expression(index, context), span)
        case "negative" | "inversion":
            return expr.Unary("-" if tree.data == "negative" else "not", read_expression(_trees(tree)[0], context), span)
        case "conditional":
            then, condition, other = (read_expression(part, context) for part in _trees(tree))
            return expr.Choice(((condition, then),), other, span=span)
        case "table":
            return _table(tree, context, span)
        case "binary":
            left, right = (read_expression(operand, context) for operand in _trees(tree))
            return expr.Binary(cast("expr.Operator", str(_tokens(tree)[0])), left, right, span)
        case "group":
            return read_expression(_trees(tree)[0], context)
        case _:
            return _call(tree, context, span)


def _call(tree: Tree, context: Context, span: Span) -> expr.Expr:
    """A call, or one number of the group that it gives."""
    where = next((read_expression(_trees(each)[0], context) for each in _trees(tree) if each.data == "where"), None)
    arguments = tuple(read_expression(argument, context) for argument in _trees(tree) if argument.data != "where")
    function, *members = (token for token in _tokens(tree) if token.type in {"NAME", "MEMBER"})
    call = expr.Call(str(function), arguments, span, where)
    return expr.Item(call, expr.Literal("".join(members)[1:].replace('"', ""), span), span) if members else call


def _table(tree: Tree, context: Context, span: Span) -> expr.Choice:
    """A table, as a choice among comparisons of its subject."""
    subject, *entries = _trees(tree)
    compared = read_expression(subject, context)
    cases: list[tuple[expr.Expr, expr.Expr]] = []
    otherwise, reason, pieces = None, "the table has no entry for it", ()
    for entry in entries:
        values = [read_expression(part, context) for part in _trees(entry)]
        if entry.data == "entry":
            cases.append((expr.Binary("==", compared, values[0], context.span(entry)), values[1]))
        elif values:
            otherwise = values[0]
        else:
            reason, pieces = _template(entry, context)
    return expr.Choice(tuple(cases), otherwise, reason, span, pieces)


def _path(tree: Tree, side: expr.Side, context: Context) -> expr.Path:
    return expr.Path(side, tuple(_step(step, context) for step in tree.children), context.span(tree))


def _step(step: Tree | Token, context: Context) -> expr.Step:
    if isinstance(step, Token):
        return expr.Member(str(step)[1:].strip('"'), context.span(step))
    span, parts = context.span(step), [read_expression(part, context) for part in _trees(step)]
    match str(step.data), parts:
        case "keyed", [expr.Path(steps=steps, span=place), value]:
            return _keyed(steps, place, value, context, span)
        case "each", _:
            return expr.Each(span)
        case "slice", [start, *bounds]:
            stop, by = (*bounds, None, None)[:2]
            return expr.Slice(start, stop, by or expr.Literal(1), span)
        case _, [expr.List(items)]:
            return expr.Pick(_numbers(items, context), span)
        case _, [expr.Binary("==") as compared, *_]:
            context.problems.append(words.compared_index(compared.span))
            return expr.Index(compared, span)
        case _, [index, *_]:
            return expr.Index(index, span)
        case _:
            raise AssertionError(step)


def _keyed(steps: tuple[expr.Step, ...], place: Span | None, value: expr.Expr, context: Context, span: Span) -> expr.Keyed:
    """An element by a field of it, or by the element of the same number of an array beside."""
    number = next((number for number, step in enumerate(steps) if isinstance(step, expr.Each)), None)
    if number is None:
        return expr.Keyed(_names(steps, place, context), value, span)
    return expr.Keyed(_names(steps[number + 1 :], place, context), value, span, _names(steps[:number], place, context))


def _names(steps: tuple[expr.Step, ...], span: Span | None, context: Context) -> tuple[str, ...]:
    """The field of an element by which it is known."""
    if not all(isinstance(step, expr.Member) for step in steps):
        context.problems.append(words.key_field(span))
    return tuple(step.name for step in steps if isinstance(step, expr.Member))


def _numbers(items: tuple[expr.Expr, ...], context: Context) -> tuple[int, ...]:
    """The elements that a list names: numbers that stand in the text."""
    numbers = [item.value for item in items if isinstance(item, expr.Literal) and type(item.value) is int]
    context.problems.extend(words.picked(item.span) for item in items if not (isinstance(item, expr.Literal) and type(item.value) is int))
    return tuple(numbers)


def _integer(token: Token, context: Context) -> int:
    if len(token) <= MAX_DIGITS:
        value = int(token, 16) if token[:2] in {"0x", "0X"} else int(token)
        if value < 2**64:
            return value
    context.problems.append(words.number(context.span(token), "an integer of 64 bits"))
    return 0


def _real(token: Token, context: Context) -> float:
    value = float(token) if len(token) <= MAX_DIGITS else math.inf
    if math.isinf(value):
        context.problems.append(words.number(context.span(token), "a float64"))
        return 0.0
    return value


def read_parameter(tree: Tree, context: Context) -> Parameter:
    """A parameter with the name of its type, whatever that is."""
    name, *_, type_ = (token for token in _tokens(tree) if token.type == "NAME")
    default = next((read_expression(value, context) for value in _trees(tree)), None)
    is_list = any(token.type == "LIST" for token in _tokens(tree))
    return Parameter(str(name), str(type_), is_list, default, context.span(tree))


def read_state(tree: Tree, context: Context) -> State:
    """A state variable with the name of its type, whatever that is."""
    _, type_ = (token for token in _tokens(tree) if token.type == "NAME")
    return State(_name(tree), str(type_), read_expression(_trees(tree)[0], context), context.span(tree))


def _name(tree: Tree) -> str:
    """The first name among the words of a statement or rule."""
    return next(str(token) for token in _tokens(tree) if token.type == "NAME")


def _trees(tree: Tree) -> list[Tree]:
    return [child for child in tree.children if isinstance(child, Tree)]


def _tokens(tree: Tree) -> list[Token]:
    return [child for child in tree.children if isinstance(child, Token)]
