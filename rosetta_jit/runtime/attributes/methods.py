"""Methods that serialise in compiled code: a call of one is a call of the program behind it, without a Python function around that.

Each class has methods of its own, which know its program as soon as one has been compiled. All that is not the common case goes to the
Python function that the class would have otherwise: views, subclasses, other arguments, the first call.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from functools import cache
from types import MethodType
from typing import Any, Literal, cast

from rosetta_jit.runtime import type_specs
from rosetta_jit.runtime.attributes.code import library
from rosetta_jit.runtime.callable import putting

Kind = Literal["encode", "write", "decode", "parse", "make", "build", "turn"]
"""``x.encode()``, ``x.serialize(file)``, ``x.deserialize(message)``, ``x.ParseFromString(message)``, ``cls.FromString(message)``,
``cls.from_dict(plain)``; of a decoder, ``to(message, object_type)``."""

OF_CLASSES = ("make", "build")
ENTRY, METHOD_BYTES = 56, 64


class _Method:
    """What a method refers to, in this order in memory. `holder_type`, `needed` and `program` are what compiled code reads."""

    __slots__ = ("function", "holder_type", "needed", "program", "slow")
    function: Any
    holder_type: type
    needed: Any
    program: Any
    slow: Callable[..., Any]

    def __repr__(self) -> str:
        return f"<method {self.__name__!r} of {self.holder_type.__qualname__!r} objects>"

    @property
    def __name__(self) -> str:
        return self.function.__name__

    @property
    def __wrapped__(self) -> Any:
        """The function whose signature the method shows."""
        return MethodType(self.function, self.holder_type)


put = putting(_Method)


class _BoundMethod(_Method):  # one that is called on an object
    __slots__ = ()

    @property
    def __wrapped__(self) -> Any:
        """The function that says which arguments there are."""
        return self.function

    def __get__(self, instance: object, owner: type | None = None) -> Any:
        return self if instance is None else MethodType(cast("Any", self), instance)


@cache
def _class_of(kind: Kind) -> type:
    """The class of methods of a kind."""
    base = _Method if kind in OF_CLASSES else _BoundMethod
    flags = type_specs.DEFAULT | type_specs.VECTORCALL | (0 if kind in OF_CLASSES else type_specs.METHOD_DESCRIPTOR)
    members = (type_specs.Member * 2)(type_specs.Member(b"__vectorcalloffset__", type_specs.SSIZE_T, ENTRY, type_specs.READONLY, None))
    slots = ((type_specs.TP_MEMBERS, ctypes.addressof(members)), (type_specs.TP_CALL, type_specs.address_of("PyVectorcall_Call")))
    created = type_specs.from_spec("Method", base, METHOD_BYTES, flags, slots)
    doc = property(lambda method: method.function.__doc__)
    return type_specs.with_attributes(created, {"__module__": __name__, "__doc__": doc, "_members": members, "_code": library()})


def method(kind: Kind, function: Any, bind: Callable[[Any], None]) -> Any:
    """A method of a class whose ``holder_type`` is set later.

    Parameters
    ----------
    function
        What does the same in Python; of a class method, the function that is given the class.
    bind
        Is given the method after each call that Python has done, and sets its ``program`` and what else it needs when there is one.
    """
    code = library()
    assert code is not None, "there are methods"
    method_class: Any = _class_of(kind)
    made = method_class.__new__(method_class)
    type_specs.write_word(id(made) + ENTRY, code[f"method_{kind}"])
    put(made, function=function)

    def slow(*arguments: Any, **named: Any) -> Any:
        positional = (made.holder_type, *arguments) if kind in OF_CLASSES else arguments
        answer = function(*positional, **named)
        bind(made)
        return answer

    put(made, slow=slow)
    return made


def turning(function: Any, program_type: type, turned: Callable[[], tuple[type, Any] | None]) -> Any:
    """A decoder's `to`, which calls ``function`` for classes that it does not know.

    ``turned`` gives, behind such a call, the class and what makes objects of it for one argument, if there is that; it must live on.
    """

    def bind(made: Any) -> None:
        found = turned()
        if found is not None:
            put(made, program=found)

    made = method("turn", function, bind)
    put(made, holder_type=program_type)
    return made
