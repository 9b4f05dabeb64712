"""Objects to holders: a function is written for each class, with one assignment a field. What it cannot do is left to `reading`.

The holder is empty before. Where a function fails the object is read again, slowly, and either that succeeds or it says what is wrong, and
where.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, cast

from rosetta_jit.model.types import Enum
from rosetta_jit.runtime.holder import arena, coerce, values
from rosetta_jit.runtime.holder.access import assigner, raw
from rosetta_jit.runtime.holder.classes import HolderFamily, plain
from rosetta_jit.runtime.holder.message import Message, make_present, writable
from rosetta_jit.runtime.holder.objects import reading, shapes, unions
from rosetta_jit.runtime.holder.objects.source import ByClass, Source, assignment, attribute
from rosetta_jit.runtime.holder.objects.steps import LEFT, Steps, Ways
from rosetta_jit.runtime.holder.record import Blob, Entry, Items, Numbers, Record, Scalar, Text
from rosetta_jit.runtime.limits import MAX_CLASSES
from rosetta_jit.startup.cached import cached_property

Take = Callable[[Any, Any], None]
"""Gives an empty message the values of an object."""

INLINED = 3
"""How deep messages lie in others whose fields one function sets."""

_UNKNOWN: Any = object()


class Takers:
    """What takes objects into the holders of a family."""

    def __init__(self, family: HolderFamily) -> None:
        self._family = family
        self._of_records: dict[int, ByClass] = {}
        self._steps: dict[type, Steps | None] = {}

    def take(self, holder: Any, value: object) -> None:
        """Give an empty holder the values of an object, or of a mapping.

        Raises
        ------
        ValuesError
            If an attribute is missing, of no field, or of a value that its field cannot have. The holder has some of the values then.
        TypeError
            If the object is of a framework's own class, and that of another type.
        """
        whole = self._family.wholes[type(value)]
        if whole is not None:
            whole.take(holder, value)
            return
        try:
            steps = self.steps(value)
            if steps is None or not steps.take(holder, value):
                self.is_stale(type(value))
                self._of_root[type(value)](holder, value)
        except LEFT:
            self._take_slowly(holder, value)

    def steps_of(self, object_type: type) -> Steps | None:
        """How compiled code takes objects of a class; None if it cannot, or none has come."""
        return self._steps.get(object_type)

    @cached_property
    def _ways(self) -> Ways:
        family = self._family
        return Ways(
            family.foreign.names,
            lambda record: reading.without_meaning(record, family),
            lambda record, object_type: family.of_struct(record.struct).family_.wholes[object_type] is not None,
            {Scalar: reading.number, Blob: reading.octets, Numbers: reading.numbers, Items: reading.listed},
        )

    def is_stale(self, object_type: type) -> bool:
        """Whether compiled code knew how to take objects of a class, which has changed since; then it is to learn it anew."""
        steps = self._steps.get(object_type)
        is_stale = steps is not None and steps.is_stale()
        if is_stale:
            self._steps.pop(object_type, None)
        return is_stale

    def steps(self, value: object) -> Steps | None:
        """How compiled code takes objects like one; None if it cannot."""
        object_type = type(value)
        found = self._steps.get(object_type, _UNKNOWN)
        if found is _UNKNOWN:
            try:
                found = Steps(self._family, self._ways, self._family.tree.root, value)
            except LEFT:
                found = None
            if len(self._steps) < MAX_CLASSES:
                self._steps[object_type] = found
        return found

    def take_plain(self, holder: Any, plain: Any) -> None:
        """The same of plain values, as `Holder.from_dict` is given them."""
        value: object = plain
        try:
            steps = self._steps.get(dict) if type(value) is dict else None
            if steps is None or not steps.take(holder, plain):
                self._take_dict(holder, plain)
        except LEFT:
            with holder.lanes_ as lanes:
                lanes.reset()
                values.write_record(self._family.tree.root, lanes, 0, raw(plain))

    def _take_dict(self, holder: Any, plain: Any) -> None:
        """The same of a dict for which compiled code knows no steps; the first that names all fields tells them."""
        if type(cast("object", plain)) is dict and dict not in self._steps and plain.keys() == self._family.tree.root.entries.keys():
            self.steps(plain)
        self._of_dict(holder, plain)

    def take_message(self, holder: Any, message: Message) -> None:
        """The same of a holder of another family, or of a part of one; nothing that another thread changes meanwhile is mixed."""
        try:
            message.lanes_.consistent(lambda source: self._of_root[type(source)](holder, source), message)
        except LEFT:
            holder.lanes_.restart()
            self.take_plain(holder, plain(message))

    def _take_slowly(self, holder: Any, value: object) -> None:
        record = self._family.tree.root
        plain = reading.plain_record(record, value, self._family)
        with holder.lanes_ as lanes:
            lanes.reset()
            values.write_record(record, lanes, 0, plain)

    @cached_property
    def _of_root(self) -> ByClass:
        return self._of_record(self._family.tree.root)

    @cached_property
    def _of_dict(self) -> Take:
        return self._of_root[dict]

    def _of_record(self, record: Record) -> ByClass:
        found = self._of_records.get(id(record))
        if found is None:
            found = self._of_records[id(record)] = ByClass(lambda object_type: self._written(record, object_type))
        return found

    def _written(self, record: Record, object_type: Any) -> Take:
        """The function for objects of a class."""
        if issubclass(object_type, Mapping):
            return self._of_mapping(record)
        if issubclass(object_type, Message):
            return self._of_holders(record, cast("Any", object_type).family_.tree.root)
        is_whole = self._family.of_struct(record.struct).family_.wholes[object_type] is not None
        if unions.discriminator_of(record) is not None or not shapes.has_messages(object_type) or is_whole:
            raise TypeError("left to the slow way")
        source = Source("take")
        names = {each: self._family.foreign.names(record, each) for each in record.entries}
        known = reading.without_meaning(record, self._family).union(*names.values())
        if not shapes.declared(object_type) <= known:
            raise TypeError("left to the slow way")
        if shapes.has_dict(object_type):
            source.add(_guard(source, object_type, known))
        for entry in record.entries.values():
            if names[entry.name]:
                self._add(source, record, entry, attribute("source", _spelled(object_type, names[entry.name])))
        return source.made("target, source")

    def _of_holders(self, record: Record, other: Record) -> Take:
        """The function for holders and parts of them, of whose fields none can be absent, and which all are attributes."""
        entries = record.entries.values()
        is_plain = all(entry.presence is None and other.entries[entry.name].presence is None for entry in entries)
        shown = self._family.shown(record)
        if record.entries.keys() != other.entries.keys() or not is_plain or not shown.issuperset(record.entries):
            raise TypeError("left to the slow way")
        source = Source("take")
        for entry in entries:
            self._add(source, record, entry, attribute("source", entry.name), is_there=True)
        return source.made("target, source")

    def _of_mapping(self, record: Record) -> Take:
        """The function for mappings: those that name every field, and others."""
        source = Source("take")
        some = source.name_of(self._of_some(record))
        source.add(f"if len(source) != {len(record.entries)}: return {some}(target, source)")
        self._add_fields(source, record, "target", "source", 0)
        return source.made("target, source")

    def _add_fields(self, source: Source, record: Record, target: str, values: str, depth: int) -> None:
        """Lines that set all fields, out of a mapping that names them all."""
        for entry in record.entries.values():
            value = f"{values}[{entry.name!r}]"
            if depth < INLINED and self._is_nested(record, entry):
                self._add_inlined(source, entry, target, value, depth + 1)
            else:
                self._add(source, record, entry, value, target, is_there=True)

    def _add_inlined(self, source: Source, entry: Entry, target: str, value: str, depth: int) -> None:
        """Lines that set a message in another: of a dict that names all its fields these are set here, which saves a call."""
        record, inner, values = cast("Record", entry.node), f"target_{depth}", f"values_{depth}"
        source.add(f"{inner}, {values} = {attribute(target, entry.name)}, {value}")
        if entry.presence is not None:
            source.add(f"{source.name_of(make_present)}({inner})")
        source.add(f"if {source.name_of(type)}({values}) is {source.name_of(dict)} and len({values}) == {len(record.entries)}:")
        with source.indented():
            source.add("pass")
            self._add_fields(source, record, inner, values, depth)
        source.add(f"else: {source.name_of(self._of_record(record))}[{source.name_of(type)}({values})]({inner}, {values})")

    def _is_nested(self, record: Record, entry: Entry) -> bool:
        """Whether a field is a message that is written within the row of the one around it, and an attribute of that."""
        node = entry.node
        return isinstance(node, Record) and entry.name in self._family.shown(record) and unions.discriminator_of(node) is None

    def _of_some(self, record: Record) -> Take:
        setters = {entry.name: self._setter(record, entry) for entry in record.entries.values()}

        def take(target: Any, source: Mapping[str, Any]) -> None:
            for name, value in source.items():
                setters[name](target, value)

        return take

    def _setter(self, record: Record, entry: Entry) -> Take:
        source = Source("take")
        self._add(source, record, entry, "source", is_there=True)
        return source.made("target, source")

    def _add(self, source: Source, record: Record, entry: Entry, value: str, target: str = "target", *, is_there: bool = False) -> None:
        """Lines that set a field; None is a value that is absent, but where the field is known to be there."""
        indent = ""
        if entry.presence is not None and not is_there:
            source.add(f"value = {value}")
            source.add("if value is not None:")
            value, indent = "value", "    "
        for line in self._lines(source, record, entry, value, target):
            source.add(indent + line)

    def _lines(self, source: Source, record: Record, entry: Entry, value: str, target: str) -> list[str]:
        node, shown = entry.node, entry.name in self._family.shown(record)
        match node:
            case Scalar() if isinstance(node.type, Enum):
                value = f"{source.name_of(reading.number)}({value})"
            case Blob():
                value = f"{source.name_of(reading.octets)}({value})"
            case Numbers() if not isinstance(node.type, Enum):
                value = _list_or(source, reading.numbers, value)
            case Items(element=Text()):
                value = _list_or(source, reading.listed, value)
            case Scalar() | Text():
                pass
            case Record() if shown and unions.discriminator_of(node) is None:
                return self._nested(source, entry, node, value, target)
            case Items(element=Record()) if shown:
                return [f"{source.name_of(self._items(entry))}({target}, {value})"]
            case _:
                value = f"{source.name_of(self._plain(entry))}({value})"
        if shown and (self._family.assigns_whole or isinstance(node, Scalar | Text | Blob)):
            return [assignment(target, entry.name, value)]
        return [f"{source.name_of(assigner(entry))}({target}, {value})"]

    def _nested(self, source: Source, entry: Entry, record: Record, value: str, target: str) -> list[str]:
        takers, own = source.name_of(self._of_record(record)), attribute(target, entry.name)
        inner = source.name_of(type)
        lines = [f"{source.name_of(make_present)}({own})"] if entry.presence is not None else []
        return [*lines, f"inner = {value}", f"{takers}[{inner}(inner)]({own}, inner)"]

    def _items(self, entry: Entry) -> Take:
        """What sets an array of messages."""
        node, name = entry.node, entry.name
        assert isinstance(node, Items)
        assert isinstance(node.element, Record)
        takers = self._of_record(node.element)

        def take(target: Any, source: Any) -> None:
            if not isinstance(source, list | tuple):
                raise TypeError("left to the slow way")
            objects = cast("list[Any] | tuple[Any, ...]", source)
            _resize(target, entry, node, len(objects))
            for element, each in zip(getattr(target, name), objects, strict=True):
                takers[type(each)](element, each)

        return take

    def _plain(self, entry: Entry) -> Callable[[Any], Any]:
        node, family = entry.node, self._family
        return lambda value: reading.plain(node, value, family)


def _list_or(source: Source, other: Callable[[Any], Any], value: str) -> str:
    """A value as it is if it is a list, else what a function makes of it: the call is what lists, which are many, do not need."""
    kind, exact = source.name_of(type), source.name_of(list)
    return f"each if {kind}(each := {value}) is {exact} else {source.name_of(other)}(each)"


def _spelled(object_type: type, names: tuple[str, ...]) -> str:
    """Which of some names a class has for an attribute; the first where it does not say."""
    own = shapes.declared(object_type)
    return next((name for name in names if name in own or hasattr(object_type, name)), names[0])


def _guard(source: Source, object_type: type, known: frozenset[str]) -> str:
    """A line that fails where an object has an attribute that is no field. A dataclass's constructor sets all that there are to be."""
    fields = [name for name in shapes.fields_of(object_type) if name in known]
    if len(fields) == len(shapes.fields_of(object_type)) and not vars(object_type).get("__slots__"):
        return f"if len(source.__dict__) != {shapes.field_count(object_type)}: raise TypeError"
    return f"if not {source.name_of(known)}.issuperset(source.__dict__): raise TypeError"


def _resize(message: Message, entry: Entry, node: Items, count: int) -> None:
    coerce.counted(count, node.length, node.maximum)
    with message.lanes_:
        lanes, row = writable(message)
        arena.mark(lanes, entry.presence, row)
        arena.resize(lanes, node, row, count)
