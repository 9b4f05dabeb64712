"""The words of C: its types, and those that no identifier from a schema may be (also of C++, of headers, and of compilers)."""

from __future__ import annotations

from collections.abc import Iterable

C_TYPES: dict[str, str] = {
    "bool": "bool",
    **{f"{kind[0]}{bits}": f"{kind}{bits}_t" for kind in ("int", "uint") for bits in (8, 16, 32, 64)},
    "f32": "float",
    "f64": "double",
}
"""By the kernel's names."""

_LANGUAGE = """
alignas alignof and and_eq asm auto bitand bitor bool break case catch char char8_t char16_t char32_t class compl concept const consteval
constexpr constinit const_cast continue co_await co_return co_yield decltype default delete do double dynamic_cast else enum explicit export
extern false float for friend goto if inline int long mutable namespace new noexcept not not_eq nullptr operator or or_eq private protected
public register reinterpret_cast requires restrict return short signed sizeof static static_assert static_cast struct switch template this
thread_local throw true try typedef typeid typename typeof typeof_unqual union unsigned using virtual void volatile wchar_t while xor xor_eq
"""
_MACROS = """
NULL offsetof unix linux i386 arm mips sparc sun vax errno assert stdin stdout stderr EOF INFINITY NAN HUGE_VAL HUGE_VALF
isnan isinf isfinite isnormal signbit memcpy memset memmove fmod sqrt sin cos tan asin acos atan atan2 fabs floor ceil trunc rint
near far small interface min max
"""
_LIMITS = [
    f"{sign}INT{kind}{bits}_{end}"
    for sign in ("", "U")
    for kind in ("", "_LEAST", "_FAST")
    for bits in (8, 16, 32, 64)
    for end in ("MIN", "MAX", "C")
]
_OTHERS = [
    "FLT_EVAL_METHOD",
    "FLT_RADIX",
    "SIZE_MAX",
    "INTPTR_MIN",
    "INTPTR_MAX",
    "UINTPTR_MAX",
    "INTMAX_MIN",
    "INTMAX_MAX",
    "UINTMAX_MAX",
    "PTRDIFF_MIN",
    "PTRDIFF_MAX",
]
_OF_FLOATS = ("FLT_EVAL_METHOD", "FLT_RADIX")
_FLOATS = [f"{kind}_{what}" for kind in ("FLT", "DBL") for what in ("MAX", "MIN", "EPSILON", "DIG", "MANT_DIG", "MAX_EXP", "MIN_EXP")]

_OF_FILES = ("HAS_ORDER", "IN_ORDER_le", "IN_ORDER_be", "TEXT")
"""Macros of the files themselves, besides those that begin with the unit's name."""
_TYPES = {*C_TYPES.values(), "size_t", "ptrdiff_t", "intptr_t", "uintptr_t", "intmax_t", "uintmax_t"}

RESERVED = frozenset(
    (*_LANGUAGE.split(), *_TYPES, *_OF_FILES, *_MACROS.split(), *_LIMITS, *_OTHERS, *_FLOATS, "FLT_EVAL_METHOD", "FLT_RADIX")
)


def of_unit(unit: str, names: Iterable[str]) -> frozenset[str]:
    """Names that look like those of the types, functions and macros of a unit, or of the header that all units in C++ share."""
    return frozenset(name for name in names if name.startswith((f"{unit}_", f"{unit.upper()}_", "ROSETTA_JIT_")))
