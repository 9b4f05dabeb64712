"""Relations to the measures of an image that another relation decompresses: together they say how it is compressed.

`.width <-> uint32(image_width(.data))`, `.height <-> uint32(image_height(.data))` and
`.pixels <-> decompress(.data, "png", image_width(.data), image_height(.data), 3)` pack as
`.data = compress(.pixels, "png", .width, .height, 3)`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.language.both_ways.inverse import NoInverseError, Solution, fields_in, solve
from rosetta_jit.language.both_ways.inverse_parts import until
from rosetta_jit.model.expr import Call, Expr
from rosetta_jit.model.mapping import Relation
from rosetta_jit.model.walk import fields_of, parts, rebuilt
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.language.both_ways.inverse import TypeOf
    from rosetta_jit.language.both_ways.joint_relations import Related

MEASURES = ("image_width", "image_height", "image_channels")


@dataclass(frozen=True, slots=True)
class Image:
    """The relation that decompresses an image, and those to its measures."""

    pixels: Related
    measures: tuple[Related, ...]

    def solved(self, type_of: TypeOf) -> Solution:
        """The image that has these pixels and measures; raises NoInverseError."""
        known = {call: until(rule.value, rule.place, call, type_of) for rule, _ in self.measures if (call := measure_in(rule)) is not None}
        found = solve(_with_measures(self.pixels[0].value, known), self.pixels[0].place, type_of)
        if fields_of(found.value, "wire"):
            raise NoInverseError(self.pixels[0].value, "no relation says what its measures are")
        return found

    @property
    def whole(self) -> Expr:
        return self.pixels[0].value

    @property
    def relations(self) -> tuple[Related, ...]:
        """That to the pixels first."""
        return self.pixels, *self.measures

    def length(self, type_of: TypeOf) -> None:
        """Not known: it is that of what compresses."""
        del type_of

    @property
    def refused(self) -> tuple[tuple[Expr, str], ...]:
        """None: packing gives every message back."""
        return ()


def images_of(relations: list[Related]) -> list[Image]:
    """The images that relations decompress and measure."""
    measured: dict[object, list[Related]] = {}
    for rule, loops in relations:
        if (call := measure_in(rule)) is not None:
            measured.setdefault((call.arguments[0], loops), []).append((rule, loops))
    found: list[Image] = []
    for rule, loops in relations:
        image = _image_in(rule)
        if image is not None and (image, loops) in measured:
            found.append(Image((rule, loops), tuple(measured.pop((image, loops)))))
    return found


def measure_in(rule: Relation) -> Call | None:
    """The measure of an image that a relation reads, where the image is the only field."""
    if len(fields_in(rule.value)) != 1 or fields_of(rule.place, "wire") or _image_in(rule) is not None:
        return None
    return next((part for part in parts(rule.value) if isinstance(part, Call) and part.function in MEASURES), None)


def _image_in(rule: Relation) -> Expr | None:
    """The image that a relation decompresses, and says the measures of."""
    found = (part for part in parts(rule.value) if isinstance(part, Call) and part.function == "decompress" and len(part.arguments) > 1)
    return next((call.arguments[0] for call in found), None)


def _with_measures(expr: Expr, known: dict[Call, Expr]) -> Expr:
    """An expression with what relations say of measures in place of them."""
    return known[expr] if isinstance(expr, Call) and expr in known else rebuilt(expr, lambda part: _with_measures(part, known))
