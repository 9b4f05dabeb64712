"""What programs for several wires of a mapping share; of a mapping with one wire it is the program's alone."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

from rosetta_jit.runtime.holder import Holder
from rosetta_jit.runtime.lanes import Lanes
from rosetta_jit.runtime.registers import Registers
from rosetta_jit.startup.cached import cached_property

if TYPE_CHECKING:
    from collections.abc import Callable


class Shared:
    """State, the own holder of decoders, and those that stand for it.

    Attributes
    ----------
    registers : Registers or None
        What the programs keep from message to message.
    """

    def __init__(self, holder_type: type[Holder], registers: Registers | None) -> None:
        self._holder_type, self.registers = holder_type, registers

    @cached_property
    def holder(self) -> Holder:
        """The own holder, made for the first message: who decodes into other holders, and who encodes, needs none."""
        return type.__call__(self._holder_type)  # one holder is not worth the time to compile how classes are called

    def is_of(self, thread: int) -> bool:
        """Whether the own holder belongs to a thread: to the first that asks. Told in one step, which dicts have."""
        return vars(self).setdefault("thread", thread) == thread

    def of_this_thread(self, new: Callable[[], Holder]) -> Holder:
        """What stands for the own holder in a thread that it does not belong to."""
        if not hasattr(self._others, "holder"):
            self._others.holder = new()
        return self._others.holder

    @cached_property
    def _others(self) -> Any:
        from threading import local

        return local()

    @cached_property
    def broken(self) -> WeakKeyDictionary[Lanes, set[int]]:
        """Of holders of several wires, the numbers of those whose last message was refused."""
        return WeakKeyDictionary()
