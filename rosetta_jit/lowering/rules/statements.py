"""Rules of a mapping as statements of the kernel, the same in both directions: read one side, write the other.

To unpack, the walk has found the wire's fields, and the rules fill the holder. To pack, the walk asks for numbers and sizes while it
lays out the message (`packed_values`), and the rules then fill the elements into their places.
"""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager
from typing import TYPE_CHECKING, assert_never, cast

from rosetta_jit.catalogue import pipeline as words
from rosetta_jit.errors import MappingError
from rosetta_jit.kernel.nodes import Block, Compare, Copy, Expr, For, If, IsText, Local, Wire
from rosetta_jit.kernel.terms import add, index
from rosetta_jit.language import typed
from rosetta_jit.lowering.arithmetic import binary
from rosetta_jit.lowering.evaluation import lowered
from rosetta_jit.lowering.rules.holder_side import HolderSide, presence
from rosetta_jit.lowering.rules.packed_values import place_of, units_of
from rosetta_jit.lowering.rules.state import remember
from rosetta_jit.lowering.rules.values import Values
from rosetta_jit.lowering.rules.wire_side import WireSide, wire_key
from rosetta_jit.lowering.writer import Writer, block
from rosetta_jit.model.rules import Kept
from rosetta_jit.model.types import Array, Bytes, Map, Ref, String, Struct, Union
from rosetta_jit.startup.dataclass import dataclass, replace
from rosetta_jit.startup.late import Late, late

if TYPE_CHECKING:
    from rosetta_jit.lowering import made_arrays
    from rosetta_jit.lowering.rules import filters, look_ahead, putting, rescaling
    from rosetta_jit.lowering.texts import separated, views
    from rosetta_jit.lowering.texts import values as text_values
else:
    made_arrays = Late("rosetta_jit.lowering.made_arrays")
    filters, look_ahead, putting, rescaling = late("rosetta_jit.lowering.rules", "filters", "look_ahead", "putting", "rescaling")
    separated, text_values, views = late("rosetta_jit.lowering.texts", "separated", "values", "views")

Side = HolderSide | WireSide


@dataclass(frozen=True, slots=True)
class Runner:
    """Runs rules from one side to the other."""

    writer: Writer
    source: Side
    target: Side

    def run(self, rules: tuple[typed.Rule, ...], values: Values) -> None:
        for rule in rules:
            here = replace(values, where=place_of(rule, values)).at_rule(rule.span)
            if isinstance(rule, typed.Assign | typed.SetLength) and isinstance(self.target, HolderSide):
                self.target.choose(rule.place, here)
            match rule:
                case typed.Assign(place, value):
                    self.assign(place, value, here, rule.by)
                case typed.SetLength(place, value):
                    self.take(place, self.count(here.of(value)), here)
                case typed.For(kept=Kept() as kept):
                    filters.filtered(self, rule, kept, here)
                case typed.For():
                    self.loop(rule, here)
                case typed.When(condition, (typed.Reject(text, span, pieces),), ()):
                    here.at_rule(span).reject(text, pieces, when=here.of(condition))
                case typed.When(condition, then, otherwise):
                    holds = here.of(condition)
                    self.writer.emit(If(holds, self.branch(then, values), self.branch(otherwise, values)))
                case typed.Reject(text, _, pieces):
                    here.reject(text, pieces)
                case typed.Default(place):
                    self.leave(place, here)
                case typed.SetState(variable, value):
                    remember(self.writer, variable.number, here, value)
                case typed.Ignore():
                    pass
                case _:
                    assert_never(rule)

    def leave(self, place: typed.Place, values: Values) -> None:
        """Leave a place as it is, which is 0 or empty; what the schema requires is there, also of the messages around it."""
        if isinstance(self.target, WireSide):
            self.target.clear(place, values)
        else:
            self.target.require(place, values)

    def branch(self, rules: tuple[typed.Rule, ...], values: Values) -> Block:
        """Rules that run or not; what is looked up within them is forgotten behind them."""
        with self.forgetting(), self.writer.nested() as body:
            self.run(rules, values)
        return block(body)

    @contextmanager
    def forgetting(self) -> Generator[None]:
        """Around statements that may not run, or run again: what is looked up within them is not known behind them."""
        with self.source.forgetting(), self.target.forgetting():
            yield

    def count(self, value: Expr) -> Expr:
        """A length that is used more than once."""
        return self.writer.let("length", value)

    def count_of(self, place: typed.Place, values: Values) -> Expr:
        """How many elements an array of the target has, whose length was set."""
        return self.target.count(place, values)

    def take(self, place: typed.Place, count: Expr, values: Values) -> None:
        """Room for so many elements or bytes, if the target's type can have as many; those of a wire in place are bounded by the walk."""
        if isinstance(self.target, HolderSide):
            self.bound(place, count, values)
        self.target.set_length(place, count, values)

    def bound(self, place: typed.Place, count: Expr, values: Values) -> None:
        """A number of elements that the type of a place allows."""
        kind = "count" if isinstance(place.type, Array | Map) else "length"
        match place.type:
            case Array(length=int(length)) | Bytes(length=int(length)):
                self.writer.expect(Compare("eq", count, index(length)), kind, values.where, f"must be {length}", line=values.line)
            case Array(maximum=int(most)) | Bytes(maximum=int(most)) | String(maximum=int(most)) | Map(maximum=int(most)):
                self.writer.expect(Compare("le", count, index(most)), kind, values.where, f"at most {most}", line=values.line)
            case _:
                pass

    def loop(self, rule: typed.For[typed.Rule, typed.Expr], values: Values) -> None:
        """A loop; what is looked up within it is forgotten behind it."""
        start = values.of(rule.start)
        stop = values.of(rule.stop)
        self.writer.expect(Compare("ge", stop, start), "count", values.where, "the loop ends before it starts", line=values.line)
        count = stop if start == index(0) else binary(self.writer, "-", stop, start, values.where, values.line)
        number = Local("i64", self.writer.fresh(rule.variable))
        look_ahead.look_ahead(rule.body, values)
        with self.forgetting(), self.writer.nested() as body:
            variable = number if start == index(0) else self.writer.let(rule.variable, add(number, start))
            self.run(rule.body, replace(values, variables={**values.variables, rule.variable: variable}))
        self.writer.emit(For(number.name, count, block(body)))

    def assign(self, place: typed.Place, value: typed.Expr, values: Values, change: typed.Change | None = None) -> None:
        match place.type, value:
            case String(encoding="utf-16"), typed.Access(origin):
                self.assign_array(place, origin, values)
            case ((String() | Bytes()), typed.Const(str(text))):
                self.assign_text(place, text, values)
            case ((String() | Bytes()), typed.Listed()):
                self.assign_listed(place, value, values)
            case ((String() | Bytes()), typed.Access(origin)):
                self.assign_bytes(place, origin, values)
            case Array(), typed.Call("split"):
                self.assign_parts(place, value, values)
            case ((Array() | Bytes()), typed.Call(type=Array())):
                self.assign_made(place, value, values)
            case ((String() | Bytes() | Array()), typed.Call()):
                self.assign_computed(place, value, values)
            case ((Struct() | Map() | Union() | Array(element=Ref() | Struct() | Map() | Union())), typed.Access(origin)):
                self.copy(place, origin, values, change)
            case Array(), typed.Access(origin):
                self.assign_array(place, origin, values, change)
            case _ if isinstance(self.target, WireSide) and not wire_key(place)[1]:
                pass  # the walk has asked for this number
            case _:
                self.target.set_number(place, values.of(value), values)

    def assign_text(self, place: typed.Place, text: str, values: Values) -> None:
        """A text that is written down, in the units of the place."""
        units = units_of(text, place.type)
        self.take(place, index(len(units)), values)
        for number, unit in enumerate(units):
            self.target.set_unit(place, number, unit, values)

    def assign_listed(self, place: typed.Place, listed: typed.Listed, values: Values) -> None:
        """One of several texts; what is looked up for one of them is forgotten behind it."""

        def use(item: typed.Expr) -> None:
            with self.forgetting():
                self.assign(place, item, values)

        values.switch(listed, use)

    def assign_bytes(self, place: typed.Place, origin: typed.Place, values: Values) -> None:
        """A string or bytes as a whole. To the wire, the walk may have copied it."""
        if isinstance(self.target, WireSide) and not self.target.is_open(place):
            return
        size, source = self.source.count(origin, values), self.source.address(origin, values)
        if isinstance(source, Wire):
            self.writer.require(size, values.where, at=source.at)  # it is there: said again where the proof may have lost it
        if isinstance(place.type, String) and place.type.encoding == "utf-8":
            self.writer.expect(IsText(source, size), "text", values.where, "not valid UTF-8", line=values.line)
        if isinstance(source, Wire) and isinstance(place.type, Bytes) and isinstance(self.target, HolderSide) and self.target.borrows:
            self.target.borrow(place, source.at, size, values)
            return
        self.take(place, size, values)
        address = self.target.address(place, values)
        if isinstance(address, Wire):  # one of several rules for it, so that the walk has taken room for some size
            self.writer.require(size, values.where, at=address.at)
        self.writer.emit(Copy(address, source, size))

    def assign_computed(self, place: typed.Place, value: typed.Call, values: Values) -> None:
        """A text that is made of others, an image, or its pixels. On the wire there is no place for it before it is made."""
        assert isinstance(self.target, HolderSide)
        view = views.placed(self.writer, text_values.text_of(value, values))
        if isinstance(place.type, String) and place.type.encoding == "utf-8":
            view = text_values.checked(view, values)
        size = self.count(view.size)
        self.take(place, size, values)
        self.writer.emit(Copy(self.target.address(place, values), view.address, size))

    def assign_made(self, place: typed.Place, call: typed.Call, values: Values) -> None:
        """An array that a function makes of others. On the wire there is no place for it before it is known how long it is."""
        assert isinstance(self.target, HolderSide)
        made = cast("made_arrays.MadeArray", lowered(call, values))
        self.take(place, self.count(made.count), values)
        variable = typed.Local(next(name for name in rescaling.names_of_elements() if name not in values.variables))
        type_ = place.type.element if isinstance(place.type, Array) else made_arrays.UINT8
        element = typed.Place(place.side, (*place.steps, typed.IndexStep(variable)), type_)
        put = putting.Putting(self.target, element, variable, values)
        with self.forgetting():
            made.fill(put)
            put.check(made.fill)

    def assign_parts(self, place: typed.Place, call: typed.Call, values: Values) -> None:
        """The parts of a text, each as an element. What is between separators is whole characters."""
        assert isinstance(self.target, HolderSide)
        assert isinstance(place.type, Array)
        text, pattern = cast("tuple[views.View, bytes]", lowered(call, values))
        view = text_values.checked(text, values) if isinstance(place.type.element, String) else text
        count = self.count(separated.count_of_parts(self.writer, view, pattern))
        self.take(place, count, values)
        variable = typed.Local(next(name for name in rescaling.names_of_elements() if name not in values.variables))
        element = typed.Place(place.side, (*place.steps, typed.IndexStep(variable)), place.type.element)
        with self.forgetting(), separated.parts_of(self.writer, view, pattern, count) as (number, part):
            inner = replace(values, variables={**values.variables, variable.name: number}, where=values.where.element(number))
            size = self.count(part.size)
            self.take(element, size, inner)
            self.writer.emit(Copy(self.target.address(element, inner), part.address, size))

    def copy(self, place: typed.Place, origin: typed.Place, values: Values, change: typed.Change | None) -> None:
        """A message, union or map as a whole."""
        assert isinstance(self.source, HolderSide)
        assert isinstance(self.target, HolderSide)
        chosen = self.target.case_of(place, values)
        source, path, _ = self.source.descend(origin, values)
        target, target_path, _ = self.target.descend(place, values)
        if putting.is_endless(source.layout, source.find(path).slot):
            raise MappingError((words.endless_copy(place.span),))
        if isinstance(place.type, Array | Map):
            self.bound(place, self.source.count(origin, values), values)
        with self.writer.nested() as there:
            putting.copy(source, path, target, target_path, change)
        present = presence(source, path, outer=True)
        self.writer.emit(*there if present is None else (If(present, block(there)),))
        if chosen is not None:
            self.target.expect_case(*chosen, values)

    def assign_array(self, place: typed.Place, origin: typed.Place, values: Values, change: typed.Change | None = None) -> None:
        """An array as a whole, or a text in units of 16 bits: its length, then each element."""
        count = self.source.count(origin, values)
        self.take(place, count, values)
        variable = typed.Local(next(name for name in rescaling.names_of_elements() if name not in values.variables))
        rule = rescaling.element_rule(place, origin, variable, change)
        self.loop(typed.For(variable.name, typed.Const(0, typed.INT64), typed.LenOf(origin), (rule,)), values)
