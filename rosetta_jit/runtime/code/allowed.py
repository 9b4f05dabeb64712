"""What loaded code may take from the process. Code comes from the cache, a trusted folder, and yet is held to this list."""

from __future__ import annotations

from collections.abc import Iterable

MATHEMATICS = (
    *("acos", "acosh", "asin", "asinh", "atan", "atan2", "atanh", "cbrt", "copysign", "cos", "cosh", "erf", "erfc", "exp", "exp2", "expm1"),
    *("fabs", "fma", "fmax", "fmin", "frexp", "hypot", "ldexp", "lgamma", "log", "log10", "log1p", "log2", "nearbyint", "pow", "round"),
    *("roundeven", "sin", "sincos", "sinh", "tan", "tanh", "tgamma"),
)
"""Functions of the C library that users' functions call; those of float32 end in f."""

ALLOWED = frozenset(
    [
        "PyBuffer_Release",
        "PyByteArray_FromStringAndSize",
        "PyByteArray_Type",
        "PyBytes_FromStringAndSize",
        "PyBytes_Type",
        "PyDict_GetItemWithError",
        "PyDict_New",
        "PyDict_SetItem",
        "PyErr_Clear",
        "PyErr_ExceptionMatches",
        "PyErr_Fetch",
        "PyErr_Occurred",
        "PyErr_Restore",
        "PyErr_SetString",
        "PyEval_RestoreThread",
        "PyEval_SaveThread",
        "PyExc_AttributeError",
        "PyExc_Exception",
        "PyExc_TypeError",
        "PyFloat_FromDouble",
        "PyFloat_Type",
        "PyList_SetItem",
        "PyList_Type",
        "PyLong_AsLongLongAndOverflow",
        "PyLong_AsSsize_t",
        "PyLong_FromLongLong",
        "PyLong_FromSsize_t",
        "PyLong_FromUnsignedLongLong",
        "PyLong_Type",
        "PyMemoryView_FromObject",
        "PyObject_CallFinalizerFromDealloc",
        "PyObject_CallNoArgs",
        "PyObject_ClearWeakRefs",
        "PyObject_Free",
        "PyObject_GC_Track",
        "PyObject_GC_UnTrack",
        "PyObject_GenericGetAttr",
        "PyObject_GenericGetDict",
        "PyObject_GenericSetAttr",
        "PyObject_GetAttr",
        "PyObject_GetBuffer",
        "PyObject_Vectorcall",
        "PyObject_VectorcallMethod",
        "PySequence_GetSlice",
        "PyThread_get_thread_ident",
        "PyTuple_New",
        "PyTuple_Type",
        "PyType_GenericAlloc",
        "PyType_Type",
        "PyUnicode_AsUTF8AndSize",
        "PyUnicode_DecodeUTF8",
        "PyUnicode_Type",
        "Py_DecRef",
        "Py_IncRef",
        *("_Py_FalseStruct", "_Py_NoneStruct", "_Py_TrueStruct"),
        "clock_gettime",
        "madvise",
        *("memcmp", "memcpy", "memmove", "memset"),
        *("ceil", "ceilf", "floor", "floorf", "fmod", "fmodf", "rint", "rintf", "sqrt", "sqrtf", "trunc", "truncf"),
        *("snprintf", "strtod", "strtoll"),
        *("acos", "asin", "atan", "atan2", "cos", "sin", "sincos", "tan"),
        *(f"{name}{suffix}" for suffix in ("", "f") for name in MATHEMATICS),
    ]
)
"""Everything that object code may take from the process: what the entries call, and what LLVM turns intrinsics into."""


class ForeignCodeError(ValueError):
    """Code that is none of ours."""


def check_wanted(names: Iterable[str]) -> None:
    """ForeignCodeError if one of the names is not on the list."""
    foreign = sorted(set(names) - ALLOWED)
    if foreign:
        raise ForeignCodeError(f"the code wants {', '.join(foreign[:3])} from the process")
