"""What is compiled together: kernels, the entry that stands around them, and what that decides about both."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NotRequired, TypedDict

from rosetta_jit.kernel import traits
from rosetta_jit.kernel.entries import ANY_CALL, HOST, LATER, NEXT, NEXT_CALL, NEXT_KERNEL, ON_DEMAND, REST, SYMBOLS, EntryName
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.runtime.code.prelink import is_prelinking
from rosetta_jit.startup.cached import cached_property

if TYPE_CHECKING:
    from rosetta_jit.kernel.host import UserFunction


class Options(TypedDict):
    """What a program is compiled with, besides its kernels.

    ``with_numba`` says whether the first kernel is typed by numba on its way, unless it is large: that optimises it once more; the code
    does the same. ``functions`` are those of the user's that the kernels call; they need numba. ``references`` are, of a bridge, the lanes
    that become the message when it is decoded. ``thorough`` takes the time for LLVM's slow passes, whatever the kernels look like.
    ``opening`` is what messages begin with that are left to another program, which is made on demand (`rosetta_jit.runtime.on_demand`).
    ``host`` is what the kernels have to do with their host, where that is known.
    ``leaves_rest`` says whether only the usual call is compiled now, where code is prelinked, and the rest when it is asked for.
    """

    with_numba: bool
    functions: NotRequired[Sequence[UserFunction]]
    references: NotRequired[Sequence[int]]
    thorough: NotRequired[bool]
    opening: NotRequired[bytes | None]
    host: NotRequired[traits.HostUse]
    leaves_rest: NotRequired[bool]


VAST = 12_000
"""Statements of kernels, each counted once for every block that it stands in, from which on work that grows faster takes minutes."""

LONG = 130_000
"""Lines of LLVM's text, each counted once for every block that a statement stands in on average, from which on code is made in a hurry:
in a tenth of the time, which is a second for so many lines and grows faster than they do. Calls take three to twenty times as long."""


class Program:
    """Kernels that are compiled together, as `link.compile_program` takes them. Large ones are looked through once for each question.

    Attributes
    ----------
    kernels
        The first is the decoder or the encoder.
    entry, options
        What stands around them, and what else they are compiled with.
    """

    def __init__(self, kernels: Sequence[Kernel], entry: EntryName, options: Options) -> None:
        self.kernels = kernels
        self.entry: EntryName = entry
        self.options = options

    @property
    def first(self) -> Kernel:
        """The decoder or the encoder."""
        return self.kernels[0]

    @property
    def exported(self) -> tuple[str, ...]:
        """The symbols that others may ask for: its users, and the parts of which it is made."""
        return (*self.symbols, HOST, ON_DEMAND, *((NEXT_KERNEL, NEXT_CALL) if self.has_usual else ()))

    @cached_property
    def symbols(self) -> tuple[str, ...]:
        """What it defines for its users."""
        every = SYMBOLS[self.entry]
        if not self.leaves_rest:
            return every
        places = (REST, NEXT) if self.leaves_next else (REST,)
        return (*(each for each in every if each not in self.rest_symbols), *places)

    @cached_property
    def rest_symbols(self) -> tuple[str, ...]:
        """What the rest defines."""
        later = (each for each in LATER if each in SYMBOLS[self.entry] and not (each == "many" and self.has_own_many))
        if self.entry == "bridge":
            return ()
        return (ANY_CALL, NEXT_CALL, *later) if self.leaves_next else (ANY_CALL, *later)

    @cached_property
    def leaves_rest(self) -> bool:
        """Whether the rest is compiled when it is asked for."""
        return self.options.get("leaves_rest", False) and is_prelinking() and self.entry != "bridge"

    @cached_property
    def leaves_next(self) -> bool:
        """Whether the next call is made with the rest."""
        return self.leaves_rest and self.has_usual

    @cached_property
    def leaves_something(self) -> bool:
        """Whether an encoder's messages are measured before they are written, for what that leaves in the holder."""
        return self.entry == "encode" and traits.leaves_something(self.kernels[1])

    @cached_property
    def is_vast(self) -> bool:
        """Whether only work in proportion to the kernels' size is done on them."""
        return self._counted.of_all_blocks > VAST

    def would_take_long(self, lines: int) -> bool:
        """Whether LLVM would take long to make good code of so many lines: the more for one, the deeper in loops and branches it stands."""
        statements, of_all_blocks = self._counted
        return lines * of_all_blocks > LONG * statements

    @cached_property
    def _counted(self) -> traits.Counted:
        return traits.counted(self.kernels)

    @cached_property
    def calls_host(self) -> bool:
        """Whether kernels call functions of their host."""
        return bool(self._host.calls)

    @cached_property
    def asks_host(self) -> bool:
        """Whether kernels ask for the time, or for the number of a message."""
        return self._host.asks

    @cached_property
    def _host(self) -> traits.HostUse:
        return self.options.get("host") or traits.use_of_host(self.kernels)

    @cached_property
    def are_short(self) -> tuple[bool, ...]:
        """Of each kernel, whether it takes no longer than a call of it by much."""
        return tuple(map(traits.is_short_and_straight, self.kernels))

    @cached_property
    def is_typed(self) -> bool:
        """Whether the first kernel goes through numba."""
        return self.options["with_numba"] and not traits.is_large(self.first) and not self.calls_host

    @cached_property
    def is_inside(self) -> bool:
        """Whether the usual call is compiled with the kernels, of which those that are short become a part of it."""
        return self.entry == "bridge" or self.are_short[0]

    @cached_property
    def has_usual(self) -> bool:
        """Whether of the kernel the first of several bodies alone becomes a part of the usual call."""
        several = len(self.first.bodies) > 1 and not self.first.hidden and self.are_short[0]
        return self.entry in ("decode", "borrow") and several and not (self.calls_host or self.is_typed)

    @cached_property
    def has_own_many(self) -> bool:
        """Whether the loop over many messages is compiled with the kernel, whose usual body becomes a part of it.

        That is so where messages depend on those before them: what one keeps, the next one must not wait for.
        """
        return self.entry == "decode" and self.first.registers > 0 and traits.is_short(self.first) and not self.calls_host
