"""Types that compiled entries know: callables whose vectorcall slot is an entry, holders with their state's address in a fixed place.

Such types cannot be written in Python (`runtime.type_specs`). Their objects lie in memory so:

    a callable    0 the instance of its Python base class    64 vectorcall    72 context
    a message     0 object header    16 … 72 words of ours

Where Python is not one that we know, `callable_class` gives a Python class that calls the slow path, and `holder_base` a plain one.
"""

from __future__ import annotations

import ctypes
import sys
from collections.abc import Callable
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from rosetta_jit.kernel.state import state_words
from rosetta_jit.runtime import type_specs
from rosetta_jit.startup.dataclass import dataclass, field

if TYPE_CHECKING:
    Words = np.ndarray[tuple[int], np.dtype[np.int64]]

VECTORCALL, CONTEXT, CALLABLE_BYTES = 64, 72, 80
OWN_STATE, OWN_HOLDER, OWN_CELL = 0, 1, 3
MADE, THREAD, REGISTERS, FAILED, OTHERS = 5, 6, 7, 8, 9
"""Words of a program's context: how many messages it has made, if its kernel asks; the thread that its own holder belongs to, or 0; the
address of its registers, or 0; 1 where an entry comes to the slow path because the kernel for one of several wires has failed; of an
encoder, the address of three words, or 0: a class of other objects, what is called with one of them, and what calls that. Behind these
are two words that only entries use: of an encoder, the list with the number that it last gave, and that number."""

NOBODYS = np.full(state_words(0), -1, np.int64)
"""The state of a program that has no holder of its own: always in use, by its epoch."""

STATE, INDEX, MESSAGE_BYTES = 16, 56, 72
ALWAYS, NEVER = -(1 << 63), 1 - (1 << 63)
"""No epochs: of a message whose row is fixed, and of one whose row must be looked for."""


@dataclass(frozen=True, slots=True)
class Context:
    """What an entry needs of its program.

    Attributes
    ----------
    slow
        Called with the arguments of every call that is not the common case.
    holder_type
        The exact type of holders that the entry takes.
    registers
        Their address, 0 where there are none.
    kept
        What else compiled code has addresses of: the code itself, and what the program adds later.
    last
        A list of one item: the number that an encoder last gave, where a message ended.
    """

    slow: Callable[..., object]
    holder_type: type
    registers: int = 0
    kept: list[object] = field(default_factory=list[object])
    last: list[int] = field(default_factory=lambda: [0])

    def words(self) -> Words:
        """The array that the entry reads, and where it counts. It borrows every reference: `self` must live as long."""
        own = NOBODYS.ctypes.data, 0, id(self.slow), 0, id(self.holder_type)
        return np.array([*own, 0, 0, self.registers, 0, 0, id(self.last), 0], np.int64)


def is_native() -> bool:
    """Whether objects of this Python lie in memory as the entries expect: CPython 3.11 to 3.14, 64 bits, with the interpreter lock."""
    known = sys.implementation.name == "cpython" and (3, 11) <= sys.version_info < (3, 15)
    return known and sys.maxsize == 2**63 - 1 and not _is_free_threaded()


def _is_free_threaded() -> bool:
    if sys.version_info < (3, 13):
        return False
    import sysconfig  # slow

    return bool(sysconfig.get_config_var("Py_GIL_DISABLED"))


def callable_class(base: type, *, native: bool | None = None) -> type:
    """A subclass of ``base`` whose instances are called through an entry; see `bind_call`.

    Parameters
    ----------
    base
        An ordinary class with methods and attributes. Its instances may take up to 64 bytes beside their ``__dict__``.
    native
        False forces the class that always takes the slow path; by default that is what `is_native` says.
    """
    if not _chosen(native) or base.__basicsize__ > VECTORCALL:
        return type(base.__name__, (base,), {"__call__": _call_slow, "_is_native": False, **_names(base)})
    members = (type_specs.Member * 2)(type_specs.Member(b"__vectorcalloffset__", type_specs.SSIZE_T, VECTORCALL, type_specs.READONLY, None))
    slots = ((type_specs.TP_MEMBERS, ctypes.addressof(members)), (type_specs.TP_CALL, type_specs.address_of("PyVectorcall_Call")))
    created = type_specs.from_spec(
        base.__name__, base, CALLABLE_BYTES, type_specs.DEFAULT | type_specs.VECTORCALL | type_specs.BASETYPE, slots
    )
    return type_specs.with_attributes(created, {"_is_native": True, "_members": members, **_names(base)})


def message_base(*, native: bool | None = None) -> type:
    """A class to derive messages from, with room for what compiled code must know of them (`bind_message`); ``index_`` is a part of it."""
    if not _chosen(native):
        return type_specs.Listed("MessageBase", (), {"_is_native": False, "__module__": __name__, "__slots__": ("index_",)})
    members = (type_specs.Member * 2)(type_specs.Member(b"index_", type_specs.SSIZE_T, INDEX, 0, None))
    created = type_specs.from_spec(
        "MessageBase",
        object,
        MESSAGE_BYTES,
        type_specs.DEFAULT | type_specs.BASETYPE,
        ((type_specs.TP_MEMBERS, ctypes.addressof(members)),),
    )
    return type_specs.with_attributes(
        type_specs.let_list(created), {"_is_native": True, "__module__": __name__, "__qualname__": "MessageBase", "_members": members}
    )


def bind_call(target: Any, entry: int | None, context: Context) -> None:
    """Let calls of ``target``, an instance of a `callable_class`, go to the entry at an address; without one, to the slow path.

    The code there must live as long as the object. The object keeps the context in ``_context``, which should be a slot: what stands in its
    ``__dict__`` ends where somebody clears that.
    """
    words = context.words()
    target._context = (context, words)  # noqa: SLF001 - the class is ours
    if not target._is_native:  # noqa: SLF001 - as above
        return
    if entry is None:
        target.__class__ = _without_entry(target.__class__)
    else:
        type_specs.write_word(id(target) + CONTEXT, words.ctypes.data)
        type_specs.write_word(id(target) + VECTORCALL, entry)


def give_own(target: Any, holder: object, state: Words, cell: list[object]) -> None:
    """Let calls of a bound ``target`` that name no holder fill this one, the target's own.

    Parameters
    ----------
    state
        The holder's state, int64. Word 0 is its address.
    cell
        A list of one item, the source of borrowed values.
    """
    context, words = target._context  # noqa: SLF001 - the class is ours
    context.kept.append((holder, state, cell))
    words[OWN_STATE], words[OWN_HOLDER], words[OWN_CELL] = state.ctypes.data, id(holder), id(cell)


def builtin_of(target: Any, name: str, doc: str) -> Callable[..., Any]:
    """The call of a bound ``target`` as a built-in function. CPython calls those with less ado than an object of any other type.

    Its ``__self__`` is the target, which it keeps alive.
    """
    entry = type_specs.read_word(id(target) + VECTORCALL) if target._is_native else 0  # noqa: SLF001 - the class is ours
    if not entry:
        return target._context[0].slow  # noqa: SLF001 - as above
    method = type_specs.Method(name.encode(), entry, type_specs.FASTCALL | type_specs.KEYWORDS, doc.encode())
    create = ctypes.pythonapi.PyCFunction_NewEx
    create.restype, create.argtypes = ctypes.py_object, [ctypes.c_void_p, ctypes.py_object, ctypes.py_object]
    return create(ctypes.addressof(method), target, _Module.of(method))


class _Module(str):
    """The name of the module of a built-in function. CPython lets it live as long as the function, and so the function's definition."""

    __slots__ = ("method",)
    method: type_specs.Method

    @classmethod
    def of(cls, method: type_specs.Method) -> _Module:
        module = cls(__name__)
        module.method = method
        return module


def sealed(owner: Any) -> dict[str, Callable[[Any, Any], None]]:
    """Let Python read the slots of a class and change none of them, as compiled code takes what stands there for what it was.

    The answer has what sets each of them, by name and in their order.
    """
    slots: dict[str, Any] = {name: vars(owner)[name] for name in owner.__slots__}
    setters = {name: each.__set__ for name, each in slots.items()}
    if is_native():
        members = [
            type_specs.Member(name.encode(), type_specs.OBJECT, type_specs.slot_offset(each), type_specs.READONLY)
            for name, each in slots.items()
        ]
        readable = {name: type_specs.member_of(owner, member) for name, member in zip(slots, members, strict=True)}
        type_specs.with_attributes(owner, {**readable, "_readable": members})
    return setters


def putting(owner: Any) -> Callable[..., None]:
    """The same as one function, ``put(instance, name=value)``."""
    setters = sealed(owner)

    def put(instance: object, /, **values: object) -> None:
        for name, value in values.items():
            setters[name](instance, value)

    return put


def bind_state(holder: Any, address: int) -> None:
    """Tell the entries where the state of a holder, an instance of a subclass of a `message_base`, lies. The holder must keep it alive."""
    if holder._is_native:  # noqa: SLF001 - the class is ours
        type_specs.write_word(id(holder) + STATE, address)


@cache
def _without_entry(native: type) -> type:
    """A subclass with an ordinary ``__call__``: CPython takes that before the vectorcall slot."""
    return type(native.__name__, (native,), {"__call__": _call_slow, "__slots__": (), "_with_entry": native, **_names(native)})


def public_class(target: object) -> type:
    """The class that a program was made as, which its module knows by its name."""
    return getattr(type(target), "_with_entry", type(target))


def _call_slow(self: Any, *arguments: object, **named: object) -> object:
    return self._context[0].slow(*arguments, **named)


def _chosen(native: bool | None) -> bool:
    return is_native() if native is None else native


def _names(base: type) -> dict[str, Any]:
    return {"__module__": base.__module__, "__qualname__": base.__qualname__, "__doc__": vars(base).get("__doc__")}
