"""Families: the class of a type, that of its views, and what their objects share. Equal types share one family."""

from __future__ import annotations

import marshal
import sys
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, cast
from weakref import WeakValueDictionary

import numpy as np

from rosetta_jit.kernel.state import VALID, WASTED
from rosetta_jit.model.layout import layout
from rosetta_jit.model.serial import Plain, declared_in, from_plain, to_plain
from rosetta_jit.model.types import Schema, Struct, Type
from rosetta_jit.runtime.attributes import descriptors
from rosetta_jit.runtime.attributes.code import library
from rosetta_jit.runtime.attributes.field_table import KeptFields, OfSequences
from rosetta_jit.runtime.attributes.makers import make_quickly, set_recipe
from rosetta_jit.runtime.attributes.methods import put
from rosetta_jit.runtime.holder.classes import Holder, HolderClass, HolderFamily
from rosetta_jit.runtime.holder.making import Making
from rosetta_jit.runtime.holder.manners import PLAIN, Manners, manners_at
from rosetta_jit.runtime.holder.message import OWN_NAMES, Access, View, in_row, read_field, write_field
from rosetta_jit.runtime.holder.record import Entry, Record
from rosetta_jit.runtime.holder.serialising import building_method, serialising_methods
from rosetta_jit.runtime.holder.tree import Tree, written_within
from rosetta_jit.runtime.lanes import MOST_UNASKED, Lanes
from rosetta_jit.runtime.locks import shared_lock
from rosetta_jit.runtime.looks.described import Constructor, Described
from rosetta_jit.runtime.memory_plan import Plan, plan
from rosetta_jit.runtime.row_counts import initialised, roomier
from rosetta_jit.startup.cached import cached_property
from rosetta_jit.startup.garbage import object_at
from rosetta_jit.startup.late import Late
from rosetta_jit.startup.sha import sha256

if TYPE_CHECKING:
    from rosetta_jit.runtime.attributes.sameness import Sameness
    from rosetta_jit.runtime.holder import access
    from rosetta_jit.runtime.holder.objects.foreign import Foreign, Wholes
    from rosetta_jit.runtime.holder.objects.giving import Givers
    from rosetta_jit.runtime.holder.objects.taking import Takers
else:
    access = Late("rosetta_jit.runtime.holder.access")


_ONE_AT_A_TIME = shared_lock()
"""Held where a class is made: two of one type would take each other's holders for foreign."""


class Family:
    """What the objects and views of one holder class share."""

    def __init__(self, plain: Plain, key: bytes, manners: Manners) -> None:
        self._plain, self._key = plain, key
        self.manners = manners
        self.type, self.schema = from_plain(plain)
        self.layout = layout(self.type, self.schema)
        self.tree = Tree(self.type, self.schema, self.layout)
        self.plan = initialised(plan(self.layout, initial=self.tree.initial))
        self.cell = [self.plan]
        self.array_type = manners.array_type
        self.assigns_whole = manners.assigns_whole
        self._accesses: dict[int, Access] = {}
        self._views: dict[str, type[View]] = {}
        self._of_structs, self._referred = dict[str, "type[Holder]"](), dict[str, list[str]]()
        self._shown_of: dict[int, frozenset[str]] = {}
        self._of_rows, self.making = self.plan, Making(cast("Any", self))  # its properties are made once
        self.struct = cast("Struct", self.schema.resolve(self.type))
        self._holder: type[Holder] | None = None
        self._kept: KeptFields | None = None
        self.programs: Any = None  # what serialises the holders, when somebody has asked for it: it ends with them

    @cached_property
    def text(self) -> str:
        """The type as text, by which other processes know it."""
        import json  # most processes ask for none

        return json.dumps(self._plain, sort_keys=True)

    @property
    def holder(self) -> type[Holder]:
        """The holder class, one however many threads ask for it at once."""
        if self._holder is None:
            with _ONE_AT_A_TIME:
                self._holder = self._holder or self._made()
        return self._holder

    def _made(self) -> type[Holder]:
        entries, code = self.tree.root.entries, library()
        shown = _shown(self.tree.root, self.manners.base)
        slots = () if code is None else descriptors.slots(entries.values())
        properties = {name: property(read_field(name), write_field(name)) for name in shown}
        members = {"family_": self, "__slots__": (self._mark, *slots), **self.described}
        base = self.manners.base if code is None else descriptors.assignable(self.manners.base)
        methods = {} if code is None else serialising_methods(self.manners.base, self.manners.methods(self), self)
        if code is not None and self.manners.base.from_dict.__func__ is Holder.from_dict.__func__:
            methods["from_dict"] = building_method(self.manners.base, self)
        made = _class(self.struct.name, (base,), {**methods, **self.manners.members(self), **properties, **members})
        for each in methods.values():
            put(each, holder_type=made)
        if code is not None:
            self._kept = descriptors.take_slots(made, list(entries.values()))
            descriptors.describe(made, entries, shown, self._kept, plain_arrays=self.array_type is np.ndarray, has_methods=len(methods) > 1)
            make_quickly(made)
            self.making.is_alike = made.__init__ is Holder.__init__ or made.begins_alike_ is True
        return made

    @property
    def described(self) -> dict[str, Any]:
        """The text that `help` shows of the class."""
        return {"__doc__": Described(self), "__signature__": Constructor()}

    def kept_of(self, struct: str) -> KeptFields | None:
        """Where messages of a struct keep what shows their fields; None where no compiled code reads them."""
        if not struct or library() is None:  # the pairs of a map have no name, and no attributes
            return None
        family = cast("Family", self.of_struct(struct).family_)
        return family._kept  # noqa: SLF001 - of the same class

    @property
    def sequences(self) -> OfSequences:
        """The functions that compiled code calls for sequences."""
        from rosetta_jit.runtime.holder.sequence import OF_SEQUENCES

        return OF_SEQUENCES

    @property
    def _mark(self) -> str:
        """The name of a slot that no other type's holders have: Python lets ``__class__`` be exchanged among classes of the same slots."""
        return f"_of_{sha256(self._key).hexdigest()[:16]}"

    def of_struct(self, struct: str) -> type[Holder]:
        """The holder class of another struct of the schema, with the same manners."""
        if struct == self.struct.name:
            return self.holder
        other = self._of_structs.get(struct)
        if other is None:
            within = None if struct in self.schema.types else written_within(self.struct, self.schema, struct)
            plain = declared_in(self._plain, struct, self._referred) if within is None else to_plain(within, self.schema)
            other = self._of_structs[struct] = holder_class_of(plain, self.manners)
        return other

    def view_class(self, struct: str) -> type[View]:
        """The class of views of a struct: a subclass of its holder class."""
        view = self._views.get(struct)
        if view is None:
            base = self.of_struct(struct)
            view = _class(struct, (View, base), {"__slots__": ("_is_view",), **base.family_.described})
            descriptors.describe_view(view, base, base.family_.kept_of(struct))
            self._views[struct] = view
        return view

    def access(self, record: Record) -> Access:
        """How the fields of a record are read and written."""
        known = self._accesses.get(id(record))
        if known is None:
            known = self._accesses[id(record)] = Access(record, self, access)
        return known

    def learn_room(self, lanes: Lanes) -> None:
        """Give new holders the room that assignments have taken, unless that is much; more to those that programs make."""
        plan, self.cell[0] = roomier(self.plan, lanes, MOST_UNASKED), roomier(self.roomy, lanes)
        if plan is not self.plan:
            self.plan = plan
            set_recipe(self.holder, None)

    @property
    def roomy(self) -> Plan:
        """The plan of holders that programs make, as far as others have needed room."""
        return self.cell[0]

    def plan_of(self, rows: int) -> Plan:
        """The plan of so many messages, as `plan` makes it; the last one is kept, because batches are mostly as long as those before."""
        kept = self._of_rows
        if kept is self.plan or kept.rows != rows:
            kept = self._of_rows = plan(self.layout, rows, self.tree.initial)
        return kept

    @property
    def sameness(self) -> Sameness:
        """What tells whether two messages are the same; one, however many threads ask for it at once."""
        return self._sameness

    @cached_property
    def _sameness(self) -> Sameness:
        from rosetta_jit.runtime.attributes.sameness import Sameness

        return Sameness()

    @property
    def sequence(self) -> Callable[[View, Entry], Any]:
        """What shows arrays of anything but numbers."""
        return object_at(self.manners.sequence)

    @property
    def mapping(self) -> Callable[[View, Entry], Any]:
        """What shows maps."""
        return object_at(self.manners.mapping)

    @cached_property
    def foreign(self) -> Foreign:
        """The peculiarities of objects of the framework's own package."""
        return object_at(self.manners.foreign)

    @cached_property
    def wholes(self) -> Wholes:
        """How objects of other classes are handed over at once."""
        from rosetta_jit.runtime.holder.objects.foreign import Wholes

        return Wholes(self.foreign, self)

    @cached_property
    def takers(self) -> Takers:
        """The takers, which copy objects of other classes into the holders."""
        from rosetta_jit.runtime.holder.objects.taking import Takers

        return Takers(cast("HolderFamily", self))  # its properties are made once

    @cached_property
    def givers(self) -> Givers:
        """The givers, which make objects of other classes from the holders."""
        from rosetta_jit.runtime.holder.objects.giving import Givers

        return Givers(cast("HolderFamily", self))

    def shown(self, record: Record) -> frozenset[str]:
        """The fields of a record that are attributes of its messages."""
        found = self._shown_of.get(id(record))
        if found is None:
            found = self._shown_of[id(record)] = frozenset(_shown(record, self.manners.base))
        return found

    @cached_property
    def mark(self) -> str:
        """What tells the type, how its values lie in lanes, and the manners: what lanes with the same mark hold, these can hold."""
        said = f"{self.text}|{self.layout}|{sys.byteorder}|{self.manners.place or id(self.manners)}"
        mark = sha256(said.encode()).hexdigest()[:32]
        _MARKED[mark] = self
        return mark

    def pickled(self, contents: tuple[int, int, list[bytes]]) -> tuple[Any, ...]:
        """A holder as pickles have it, of two words of its state and the bytes of its lanes."""
        return revived, (self.mark, self.text, self.manners.place or self.manners, contents)

    @cached_property
    def root(self) -> Access:
        """How the fields of the message itself are read and written."""
        return self.access(self.tree.root)

    @cached_property
    def _empty(self) -> Lanes:
        lanes = Lanes(self.plan, self.array_type)
        with lanes:
            for lane in self.tree.recursive:
                if not lanes.used(lane):
                    lanes.initialise(self.tree.initial_of(lane), lanes.take(lane, 1), 1)
        return lanes

    def empty_lanes(self) -> Lanes:
        """Lanes in which everything is absent or has its initial value, with a row of each recursive struct; they are never written."""
        return self._empty

    def row(self, lanes: Lanes, row: int) -> View:
        """A view of one message of a batch."""
        cls = self.view_class(self.struct.name)
        view = cls.__new__(cls)
        in_row(view, lanes, self.root, row)
        return view


def _shown(record: Record, base: type) -> list[str]:
    """Fields that become properties: all but those whose names Python or the holder need for themselves."""
    own = {*OWN_NAMES, "family_", "programs_", "_is_native"}
    return [name for name in record.entries if name not in own and not (name.startswith("_") and hasattr(base, name))]


def _class(qualified: str, bases: tuple[type, ...], namespace: dict[str, Any]) -> Any:
    module, _, name = qualified.replace("::", ".").replace("/", ".").rpartition(".")
    return HolderClass(name or "Message", bases, {"__module__": module, **namespace})


def holder_class(type_: Type, schema: Schema, manners: Manners = PLAIN) -> type[Holder]:
    """The holder class of a struct. Equal types give the same class.

    Raises
    ------
    ValueError
        If the type is not a struct, or its rows would be too large.
    """
    return holder_class_of(to_plain(type_, schema), manners)


def holder_class_of(plain: Plain, manners: Manners = PLAIN) -> type[Holder]:
    """The holder class of a type as `rosetta_jit.model.serial` writes it."""
    return _family_of(plain, manners).holder


def family_of(text: str, manners: Manners) -> Family:
    """The family of a type as `Family.text` has it."""
    import json  # of pickles alone

    return _family_of(json.loads(text), manners)


def _family_of(plain: Plain, manners: Manners) -> Family:
    """The family of a type: one for the same type as long as any of its holders or programs lives, whatever threads ask at once."""
    key = marshal.dumps(plain, VALUES_ALONE)
    with _ONE_AT_A_TIME:
        family = _FAMILIES.get((key, manners))
        if family is None:
            family = _FAMILIES[key, manners] = Family(plain, key, manners)
        return family


VALUES_ALONE = 2
"""The version of `marshal` that writes no references: what is equal is the same bytes, whatever objects it shares."""

_FAMILIES: WeakValueDictionary[tuple[bytes, Manners], Family] = WeakValueDictionary()


_MARKED: WeakValueDictionary[str, Family] = WeakValueDictionary()


def revived(mark: str, text: str, manners: Manners | str, contents: tuple[int, int, list[bytes]]) -> Holder:
    """Unpickle.

    Raises
    ------
    ValueError
        If another version of rosetta_jit has written this, whose lanes are others.
    """
    from rosetta_jit.runtime.pickled_lanes import fill  # only pickles need it

    family = _MARKED.get(mark)
    if family is None:
        family = family_of(text, manners_at(manners) if isinstance(manners, str) else manners)
        if family.mark != mark and isinstance(manners, str):
            raise ValueError("another version of rosetta_jit has pickled this holder")
    holder = family.making.new(family.plan)
    with holder.lanes_ as lanes:
        lanes.words[VALID], lanes.words[WASTED], content = contents
        fill(lanes, content)
    return holder
