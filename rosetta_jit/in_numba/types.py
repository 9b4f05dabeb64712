"""Numba's types of messages and of sequences in them, and how their values lie in registers.

    Message  = meminfo, taken, state, row             a row of a lane, or a part of one
    Sequence = meminfo, taken, state, start, count    elements of a lane
    Map      = meminfo, taken, state, start, count    pairs of a lane

``state`` is where the holder's state lies, ``taken`` the object that compiled code asks for help with it (`taking.Taken`), ``meminfo`` what
numba counts references with, to keep that object alive. Nothing else is remembered: lanes are looked up in the state whenever a field is
read, so that a value stays safe to use when lanes grow.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, TypeAlias

from numba import types
from numba.core.errors import NumbaTypeError
from numba.extending import models, register_model

from rosetta_jit.runtime.cells import SCALARS, dtype_of
from rosetta_jit.runtime.holder.classes import HolderFamily
from rosetta_jit.runtime.holder.record import Blob, Child, Items, Node, Numbers, Pairs, Record, Scalar, Text

if TYPE_CHECKING:
    from llvmlite import ir
    from numba.core.datamodel import DataModelManager


COMMON = (
    ("meminfo", types.MemInfoPointer(types.voidptr)),
    ("taken", types.voidptr),
    ("state", types.CPointer(types.int64)),
)
ROWS = types.Array(types.int64, 1, "C")
"""The pairs of a map in the order of an iteration."""

Shown: TypeAlias = Literal["keys", "values", "items"]
"""What an iteration over a map gives."""

PARALLEL = (
    "a holder is for one thread, and the loop of a `prange` runs in several. Before the loop, take the arrays that it reads out of the "
    "holder, as in `position = holder.position`; to decode in parallel, call a function without `prange` in threads, with a holder for "
    "each (`nogil=True` lets them run at once)"
)
NUMBERS: dict[str, types.Type] = dict(
    zip(
        SCALARS,
        (
            types.boolean,
            types.int8,
            types.uint8,
            types.int16,
            types.uint16,
            types.int32,
            types.uint32,
            types.int64,
            types.uint64,
            types.float32,
            types.float64,
        ),
        strict=True,
    )
)


class MessageType(types.Type):
    """A message of a holder: itself, or one that is nested in it. Each place in a holder class has a type of its own."""

    def __init__(self, family: HolderFamily, record: Record) -> None:
        self.family, self.record = family, record
        super().__init__(name=f"message {record.struct} of {family.struct.name}, lane {record.lane}, byte {record.start} ({id(record):x})")

    @property
    def key(self) -> tuple[object, ...]:
        return self.family, self.record

    @property
    def is_whole(self) -> bool:
        """Whether it is the holder's own message."""
        return self.record is self.family.tree.root


class SequenceType(types.IterableType):
    """An array of messages, texts or arrays in a holder."""

    def __init__(self, family: HolderFamily, node: Items) -> None:
        self.family, self.node = family, node
        super().__init__(name=f"elements of lane {node.lane} of {family.struct.name} ({id(node):x})")

    @property
    def key(self) -> tuple[object, ...]:
        return self.family, self.node

    @property
    def element(self) -> types.Type:
        """The type of its elements."""
        return type_of(self.family, self.node.element)

    @property
    def iterator_type(self) -> IteratorType:
        return IteratorType(self)


class IteratorType(types.SimpleIteratorType):
    """An iteration over a sequence."""

    def __init__(self, sequence: SequenceType) -> None:
        self.sequence = sequence
        super().__init__(f"iterator over {sequence.name}", sequence.element)


class MapType(types.IterableType):
    """A map in a holder; ``shown`` is what iteration gives of each pair."""

    def __init__(self, family: HolderFamily, node: Pairs, shown: Shown = "keys") -> None:
        self.family, self.node = family, node
        self.shown: Shown = shown
        super().__init__(name=f"{shown} of the map in lane {node.lane} of {family.struct.name} ({id(node):x})")

    @property
    def key(self) -> tuple[object, ...]:
        return self.family, self.node, self.shown

    def part(self, shown: Shown) -> types.Type:
        """The type of the key of a pair, of its value, or of both."""
        key, value = type_of(self.family, self.node.key), type_of(self.family, self.node.value.node)
        match shown:
            case "keys":
                return key
            case "values":
                return value
            case "items":
                return types.Tuple((key, value))

    @property
    def iterator_type(self) -> MapIteratorType:
        return MapIteratorType(self)


class MapIteratorType(types.SimpleIteratorType):
    """An iteration over a map."""

    def __init__(self, table: MapType) -> None:
        self.table = table
        super().__init__(f"iterator over {table.name}", table.part(table.shown))


def type_of(family: HolderFamily, node: Node) -> types.Type:
    """The type that a field is read as."""
    match node:
        case Scalar(cell):
            return NUMBERS[SCALARS[cell.key & 15]]
        case Text(_, lane) | Blob(_, lane):
            return types.Array(_element(family, lane), 1, "C", readonly=True)
        case Numbers(_, lane):
            return types.Array(_element(family, lane), 1, "C")
        case Items():
            return SequenceType(family, node)
        case Record():
            return MessageType(family, node)
        case Child(record=record):
            return MessageType(family, record)
        case Pairs():
            return MapType(family, node)


def _element(family: HolderFamily, lane: int) -> types.Type:
    """The type of the numbers of a lane."""
    dtype = family.plan.dtypes[lane]
    return next(type_ for scalar, type_ in NUMBERS.items() if dtype_of(scalar) == dtype)


class _OfOneThread(models.StructModel):
    """A message or a sequence of a holder, which is no argument of the loop that numba makes of a ``prange``."""

    def from_argument(self, builder: ir.IRBuilder, value: object) -> object:
        """The argument of a function that is being compiled.

        Raises
        ------
        NumbaTypeError
            The function is the body of a loop that runs in several threads.
        """
        if "__numba_parfor" in builder.function.name:
            raise NumbaTypeError(PARALLEL)
        return super().from_argument(builder, value)


@register_model(MessageType)
class _MessageModel(_OfOneThread):
    def __init__(self, manager: DataModelManager, type_: MessageType) -> None:
        super().__init__(manager, type_, [*COMMON, ("row", types.int64)])


@register_model(SequenceType)
class _SequenceModel(_OfOneThread):
    def __init__(self, manager: DataModelManager, type_: SequenceType) -> None:
        super().__init__(manager, type_, [*COMMON, ("start", types.int64), ("count", types.int64)])


@register_model(MapType)
class _MapModel(_OfOneThread):
    def __init__(self, manager: DataModelManager, type_: MapType) -> None:
        super().__init__(manager, type_, [*COMMON, ("start", types.int64), ("count", types.int64)])


@register_model(MapIteratorType)
class _MapIteratorModel(models.StructModel):
    def __init__(self, manager: DataModelManager, type_: MapIteratorType) -> None:
        super().__init__(manager, type_, [("index", types.EphemeralPointer(types.int64)), ("rows", ROWS), ("table", type_.table)])


@register_model(IteratorType)
class _IteratorModel(models.StructModel):
    def __init__(self, manager: DataModelManager, type_: IteratorType) -> None:
        super().__init__(manager, type_, [("index", types.EphemeralPointer(types.int64)), ("sequence", type_.sequence)])
