"""Objects whose buffers Python code gives out and takes back. Before Python 3.12 no class can do that, so that the type is made by hand."""

from __future__ import annotations

import ctypes
from functools import cache

_GET = ctypes.PYFUNCTYPE(ctypes.c_int, ctypes.py_object, ctypes.c_void_p, ctypes.c_int)
_RELEASE = ctypes.PYFUNCTYPE(None, ctypes.py_object, ctypes.c_void_p)
_BASETYPE, _GETBUFFER, _RELEASEBUFFER = 1 << 10, 1, 2  # Include/object.h, Include/typeslots.h


class Slot(ctypes.Structure):
    _fields_ = (("slot", ctypes.c_int), ("function", ctypes.c_void_p))


class Spec(ctypes.Structure):
    _fields_ = (
        ("name", ctypes.c_char_p),
        ("basicsize", ctypes.c_int),
        ("itemsize", ctypes.c_int),
        ("flags", ctypes.c_uint),
        ("slots", ctypes.POINTER(Slot)),
    )


@_GET
def _get(exporter, view, flags):
    memory = exporter.given_out()
    exporter.memory.append(memory)
    fill = ctypes.pythonapi.PyBuffer_FillInfo
    fill.argtypes = (ctypes.c_void_p, ctypes.py_object, ctypes.c_void_p, ctypes.c_ssize_t, ctypes.c_int, ctypes.c_int)
    return fill(view, exporter, ctypes.addressof(memory), len(memory), 0, flags)


@_RELEASE
def _release(exporter, view):
    exporter.taken_back()


@cache
def _base():
    slots = (Slot * 3)(
        Slot(_GETBUFFER, ctypes.cast(_get, ctypes.c_void_p)), Slot(_RELEASEBUFFER, ctypes.cast(_release, ctypes.c_void_p)), Slot(0, None)
    )
    create = ctypes.pythonapi.PyType_FromSpec
    create.restype, create.argtypes = ctypes.py_object, [ctypes.c_void_p]
    spec = Spec(b"tests.Exporting", object.__basicsize__, 0, _BASETYPE, slots)
    return create(ctypes.addressof(spec))


def exporter(content, given_out=lambda: None, taken_back=lambda: None):
    """An object with a buffer of some content, or of so many zeros, which calls a function before it gives it out, and one afterwards."""

    class Exporter(_base()):
        def __init__(self):
            self.memory = []

        def given_out(self):
            given_out()
            return (ctypes.c_char * (content if isinstance(content, int) else len(content)))(*([] if isinstance(content, int) else content))

        def taken_back(self):
            taken_back()

    return Exporter()
