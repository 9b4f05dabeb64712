"""Relations to the parts of one text: `.x <-> number(part(.t, ",", 0))` and `.name <-> part(.t, ",", 1)` together say what `.t` is.

Packing writes the parts with the separators between them, and refuses a text that holds the separator itself. Unpacking rejects a text that
has more parts than relations.
"""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import derive as words
from rosetta_jit.language.both_ways.inverse import Solution, fields_in, solve
from rosetta_jit.language.both_ways.inverse_parts import until
from rosetta_jit.language.functions.texts import separates
from rosetta_jit.model.expr import Binary, Call, Choice, Expr, Literal, Unary
from rosetta_jit.model.mapping import Relation
from rosetta_jit.model.types import Enum
from rosetta_jit.model.walk import fields_of, parts
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.language.both_ways.inverse import TypeOf
    from rosetta_jit.language.both_ways.joint_relations import Related


@dataclass(frozen=True, slots=True)
class PartsOfText:
    """A text, and the relations to its parts, by their place."""

    whole: Expr
    separator: Literal
    relations: tuple[Related, ...]

    def solved(self, type_of: TypeOf) -> Solution:
        """The text that has these parts; raises NoInverseError."""
        whole: Expr | None = None
        for rule, _ in self.relations:
            call = _numbered_part(rule)
            assert call is not None
            spelt = until(rule.value, rule.place, call, type_of)
            if isinstance(type_of(spelt), Enum):
                spelt = Call("text", (spelt,), spelt.span)
            if not _is_number(rule, call):
                spelt = self.one_part(spelt)
            whole = spelt if whole is None else Binary("+", Binary("+", whole, self.separator, rule.span), spelt, rule.span)
        assert whole is not None
        return solve(self.whole, whole, type_of)

    def one_part(self, text: Expr) -> Expr:
        """A text, which is refused where it holds the separator."""
        holds = Call("contains", (text, self.separator), text.span)
        return Choice(((Unary("not", holds, text.span), text),), None, words.HAS_SEPARATOR, text.span)

    def length(self, type_of: TypeOf) -> None:
        """Not known: it is that of the parts as they are written."""
        del type_of

    @property
    def refused(self) -> tuple[tuple[Expr, str], ...]:
        """A text that has another number of parts than relations."""
        span = self.whole.span
        parts_ = Call("parts", (self.whole, self.separator), span)
        return ((Binary("!=", parts_, Literal(len(self.relations), span), span), words.OTHER_PARTS),)


def parts_of_texts(relations: list[Related]) -> list[PartsOfText]:
    """The texts of which relations name all parts, from the first on."""
    found: defaultdict[object, dict[int, Related]] = defaultdict(dict)
    for rule, loops in relations:
        call = _numbered_part(rule)
        if call is not None:
            text, separator, number = call.arguments
            assert isinstance(number, Literal)
            found[text, separator, loops].setdefault(int(number.value), (rule, loops))
    whole = [numbered for numbered in found.values() if sorted(numbered) == list(range(len(numbered))) and len(numbered) > 1]
    return [_of(tuple(numbered[number] for number in sorted(numbered))) for numbered in whole]


def _of(relations: tuple[Related, ...]) -> PartsOfText:
    call = _numbered_part(relations[0][0])
    assert call is not None
    text, separator, _ = call.arguments
    assert isinstance(separator, Literal)
    return PartsOfText(text, separator, relations)


def _numbered_part(rule: Relation) -> Call | None:
    """The part of a text that a relation reads, where the only field is in the text; separators of texts have one character."""
    if len(fields_in(rule.value)) != 1 or fields_of(rule.place, "wire"):
        return None
    for each in parts(rule.value):
        match each:
            case Call("part", (_, Literal(str(separator)), Literal(int()))) as call:
                is_apart = separates(separator) if _is_number(rule, call) else len(separator.encode()) == 1
                return call if is_apart else None
            case _:
                pass
    return None


def _is_number(rule: Relation, call: Call) -> bool:
    """Whether a relation reads a number from a part."""
    return any(
        isinstance(each, Call) and each.function in {"number", "integer"} and each.arguments == (call,) for each in parts(rule.value)
    )
