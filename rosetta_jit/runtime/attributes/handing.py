"""Compiled code that passes objects of other classes as bytes: when an encoder is called with one, and in a decoder's `to`."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from functools import cache
from typing import TYPE_CHECKING, Any, Literal

from rosetta_jit.runtime import type_specs
from rosetta_jit.runtime.attributes.code import library
from rosetta_jit.runtime.callable import putting

if TYPE_CHECKING:
    from rosetta_jit.runtime.holder.objects.in_c import InC

Kind = Literal["hand_in", "hand_out"]
NO_ARGUMENTS = ()
ENTRY, IN_C, HANDING_BYTES = 72, 80, 104
"""Where the address of the code lies, and those of the functions in C behind ``over``."""


class _Handing:
    """Hands over objects of one class. Compiled code reads all of it, in this order in memory (`programs/handing.ll`)."""

    __slots__ = ("decode", "encode", "new", "over", "slow", "spare", "whose")
    decode: Callable[..., Any]
    encode: Callable[..., Any]
    new: Callable[[], Any]
    over: Callable[[Any], Any]
    slow: Callable[..., Any]
    spare: Any
    whose: type


_put = putting(_Handing)


@cache
def _handing_class() -> type:
    members = (type_specs.Member * 2)(type_specs.Member(b"__vectorcalloffset__", type_specs.SSIZE_T, ENTRY, type_specs.READONLY, None))
    slots = ((type_specs.TP_MEMBERS, ctypes.addressof(members)), (type_specs.TP_CALL, type_specs.address_of("PyVectorcall_Call")))
    created = type_specs.from_spec("Handing", _Handing, HANDING_BYTES, type_specs.DEFAULT | type_specs.VECTORCALL, slots)
    return type_specs.with_attributes(created, {"__module__": __name__, "_members": members, "_code": library()})


def handing(
    kind: Kind,
    *,
    decode: Callable[..., Any] | None,
    encode: Callable[..., Any] | None,
    new: Callable[[], Any],
    over: Callable[[Any], Any],
    slow: Callable[..., Any],
    in_c: InC | None = None,
) -> Callable[..., Any]:
    """The object that hands over the objects of a class.

    Parameters
    ----------
    kind
        ``"hand_in"`` makes bytes of an object, ``"hand_out"`` an object of bytes.
    decode, new
        What fills a holder from bytes, and what makes one. Without a decoder nothing looks at the bytes but ``over``, and ``slow`` has
        the word where that fails.
    encode
        What makes bytes of that holder. Without it bytes go on as they are once they have been decoded, which finds what is wrong.
    over
        The class's own function: to hand in, from an object to its bytes; to hand out, from bytes to an object.
    slow
        Does the same for other arguments.
    in_c
        The functions in C that do what ``over`` does.
    """
    code = library()
    assert code is not None, "there is code that hands over"
    handing_class: Any = _handing_class()
    made = handing_class.__new__(handing_class)
    _put(made, new=new, over=over, slow=slow)
    if decode is not None:
        _put(made, decode=decode)
    if encode is not None:
        _put(made, encode=encode)
    type_specs.write_word(id(made) + ENTRY, code[kind])
    if in_c is not None:
        _put(made, whose=in_c.object_type)
        functions = (in_c.write, 0) if kind == "hand_in" else (in_c.allocate, in_c.merge)
        for index, word in enumerate((*functions, id(NO_ARGUMENTS))):
            type_specs.write_word(id(made) + IN_C + 8 * index, word)
    return made


def caller_of(function: Callable[..., Any]) -> int:
    """The address of the function in C that calls a callable, as `PyObject_Vectorcall` does, which it is for all but those made here."""
    is_ours = library() is not None and isinstance(function, _handing_class())
    return type_specs.read_word(id(function) + ENTRY) if is_ours else type_specs.address_of("PyObject_Vectorcall")
