"""The words of C: its types, and those that no identifier from a schema may be (also of C++, of headers, and of compilers)."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

C_TYPES: dict[str, str] = {
    "bool": "bool",
    **{f"{kind[0]}{bits}": f"{kind}{bits}_t" for kind in ("int", "uint") for bits in (8, 16, 32, 64)},
    "f32": "float",
    "f64": "double",
}
"""By the kernel's names."""

C_ROWS = {**C_TYPES, "bool": "uint8_t"}
"""Types of scalars in rows."""

_LANGUAGE = """
alignas alignof and and_eq asm auto bitand bitor bool break case catch char char8_t char16_t char32_t class compl concept const consteval
constexpr constinit const_cast continue co_await co_return co_yield decltype default delete do double dynamic_cast else enum explicit export
extern false float for friend goto if inline int long mutable namespace new noexcept not not_eq nullptr operator or or_eq private protected
public register reinterpret_cast requires restrict return short signed sizeof static static_assert static_cast struct switch template this
thread_local throw true try typedef typeid typename typeof typeof_unqual union unsigned using virtual void volatile wchar_t while xor xor_eq
"""
_NAMES = """
offsetof i386 arm mips sparc sun vax assert isnan isinf isfinite isnormal signbit memcpy memset memmove
fmod sqrt sin cos tan asin acos atan atan2 fabs floor ceil trunc rint near far small interface min max
"""
_LIMITS = [f"{sign}INT{bits}_C" for sign in ("", "U") for bits in (8, 16, 32, 64, "MAX")]

_OF_FILES = ("HAS_ORDER", "ONCE", "IN_ORDER_le", "IN_ORDER_be", "TEXT")
"""Macros of the files themselves, besides those that begin with the unit's name."""
_TYPES = {*C_TYPES.values(), "size_t", "ptrdiff_t", "intptr_t", "uintptr_t", "intmax_t", "uintmax_t"}

_MACROS = (Path(__file__).parent / "macros.txt").read_text("utf-8").split()
"""Those without parameters that the headers of C11, C++20 and POSIX define, as glibc has them, with gcc's own."""

RESERVED = frozenset((*_LANGUAGE.split(), *_TYPES, *_OF_FILES, *_NAMES.split(), *_LIMITS, *_MACROS))


def of_unit(unit: str, names: Iterable[str]) -> frozenset[str]:
    """Names that look like those of the types, functions and macros of a unit, or of the header that all units in C++ share."""
    return frozenset(name for name in names if name.startswith((f"{unit}_", f"{unit.upper()}_", "ROSETTA_JIT_")))
