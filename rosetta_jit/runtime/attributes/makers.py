"""What makes holders in compiled code: a decoder's `new`, and a call of a holder class without arguments."""

from __future__ import annotations

import ctypes
from contextlib import suppress
from functools import cache
from typing import TYPE_CHECKING, Any, cast
from weakref import WeakSet

from rosetta_jit.runtime import type_specs
from rosetta_jit.runtime.attributes.code import HEAP_TYPE_BYTES, functions, library, when_there
from rosetta_jit.runtime.attributes.groups import END
from rosetta_jit.runtime.callable import is_native, putting

if TYPE_CHECKING:
    from rosetta_jit.runtime.memory_plan import Plan

ENTRY, MAKER_BYTES = 64, 72
DEALLOC, FLAGS, CLASS_CALL = 48, 168, 400
"""Where in a class (PyTypeObject of Include/cpython/object.h) stand what ends its objects, its flags, and what calls it."""


class _Maker:
    """Makes holders. Compiled code reads all but `plan`, in this order in memory (`holders/calling.ll`)."""

    __slots__ = ("cell", "holder_type", "plan", "recipe", "seen", "slow")
    cell: list[Plan]
    holder_type: type
    plan: Plan
    recipe: Any
    seen: Plan | None
    slow: Any

    def __repr__(self) -> str:
        return f"<makes {self.holder_type.__qualname__!r} objects>"


_put = putting(_Maker)


@cache
def _maker_class() -> type:
    members = (type_specs.Member * 2)(type_specs.Member(b"__vectorcalloffset__", type_specs.SSIZE_T, ENTRY, type_specs.READONLY, None))
    slots = ((type_specs.TP_MEMBERS, ctypes.addressof(members)), (type_specs.TP_CALL, type_specs.address_of("PyVectorcall_Call")))
    created = type_specs.from_spec("Maker", _Maker, MAKER_BYTES, type_specs.DEFAULT | type_specs.VECTORCALL, slots)
    return type_specs.with_attributes(created, {"__module__": __name__, "_members": members, "_code": library()})


def maker(holder_type: Any, plan: Plan) -> Any:
    """A maker of holders of a class. They have the room of a plan, or that of their family's if it is more."""
    code = library()
    assert code is not None, "there are makers"
    maker_class: Any = _maker_class()
    made = maker_class.__new__(maker_class)
    _put(made, holder_type=holder_type, cell=holder_type.family_.cell, plan=plan, slow=_made, recipe=None, seen=None)
    type_specs.write_word(id(made) + ENTRY, code["call_maker"])
    return made


def give_room(maker: Any, plan: Plan) -> None:
    """From now on make holders with the room of a plan of the same layout, or of their family's if that is more."""
    _put(maker, plan=plan, recipe=None)


def _made(maker: _Maker) -> Any:
    """A new holder, when there was another plan for the last one."""
    family: Any = cast("Any", maker.holder_type).family_
    own, roomy = maker.plan, maker.cell[0]
    recipe: Any = family.making.recipe(own if own.size_bytes > roomy.size_bytes else roomy)
    _put(maker, recipe=recipe, seen=roomy)
    return functions()["spawn"](maker.holder_type, recipe)


def class_of_holder_classes() -> type:
    """A class to derive the class of holder classes from, with room behind each for what compiled code makes its objects of."""
    if not is_native():
        return type("HolderClassBase", (type_specs.Listed,), {"__module__": __name__})
    return type_specs.from_spec("HolderClassBase", type_specs.Listed, HEAP_TYPE_BYTES + 16, type_specs.DEFAULT | type_specs.BASETYPE, ())


def let_call(metaclass: type) -> None:
    """Let CPython call the classes of a metaclass through what each of them has for that, as it calls all whose class is `type`."""
    if is_native():
        type_specs.write_word(id(metaclass) + FLAGS, type_specs.read_word(id(metaclass) + FLAGS) | type_specs.VECTORCALL)


def make_quickly(holder_type: type) -> None:
    """Let compiled code end the objects of a holder class, and make them once it has a recipe (`set_recipe`)."""
    code = library()
    assert code is not None, "there is code for it"
    if not holder_type.__dictoffset__:  # whose base, which is not ours, has forgotten its slots: CPython lets go of the dict
        _ENDED_BY_PYTHON.add(holder_type)
        when_there(END, _let_end)
    type_specs.write_word(id(holder_type) + CLASS_CALL, code["call_class"])


_ENDED_BY_PYTHON = WeakSet[type]()
"""Holder classes whose objects CPython ends until there is code for it."""


def _let_end(code: int) -> None:
    with suppress(KeyError):  # none is left: other threads take some, too, and classes end
        while True:
            type_specs.write_word(id(_ENDED_BY_PYTHON.pop()) + DEALLOC, code)


def set_recipe(holder_type: type, recipe: tuple[Any, ...] | None) -> None:
    """Make a class's objects of this from now on when it is called without arguments; it must live until another one is set. Without one,
    call the class as any other.
    """
    if is_native():
        type_specs.write_word(id(holder_type) + HEAP_TYPE_BYTES, 0 if recipe is None else id(recipe))


def call_as_any(holder_type: type) -> None:
    """Let a class make its objects as Python says from now on: somebody gives it another constructor."""
    if is_native():
        type_specs.write_word(id(holder_type) + CLASS_CALL, 0)
