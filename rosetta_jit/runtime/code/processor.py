"""What the compiler sees of the processor, as text: code that is made for one does not run on every other.

The C library has asked the processor, when the process began, all that LLVM asks (sys/platform/x86.h, glibc 2.33). To ask LLVM itself would
mean to import it, which takes longer than all the rest of a warm start.
"""

from __future__ import annotations

import ctypes
import os
import sys

LEAVES = range(16)
"""Answers to CPUID that glibc keeps, by its own numbers; there are fewer, and behind the last are zeros."""

OF_THE_MACHINE = ((0, 1), (5, 2))
"""Leaf and word: the core that was asked (CPUID 1, EBX), and how many there are (0x80000008, ECX); not what the processor can do."""

USABLE_ECX = 6
"""Where the text has what can be used of the third word of leaf 0."""

_WORDS = ctypes.c_uint32 * 8
"""Four words that the processor gave, and four of them with what can be used of it."""


def processor() -> str:
    """The same on processors that the compiler cannot tell from one another, for this version of the compiler."""
    if sys.platform == "linux" and os.uname().machine == "x86_64":
        known = _asked_of_glibc()
        if known:
            return known
    import llvmlite.binding as llvm

    return " ".join((llvm.get_process_triple(), llvm.get_host_cpu_name(), llvm.get_host_cpu_features().flatten()))


def multiplies_without_carries() -> bool:
    """Whether it is of x86-64 and has PCLMULQDQ (CPUID 1, ECX, bit 1)."""
    known = processor()
    if "+" in known:
        return known.startswith("x86_64") and "+pclmul" in known
    return bool(int(known.split(" ")[USABLE_ECX], 16) & 2)


def _asked_of_glibc() -> str:
    leaf = getattr(ctypes.CDLL(None), "__x86_get_cpuid_feature_leaf", None)
    if leaf is None:
        return ""
    leaf.restype, leaf.argtypes = ctypes.POINTER(_WORDS), [ctypes.c_uint]
    answers = [list(leaf(number).contents) for number in LEAVES]
    for number, word in OF_THE_MACHINE:
        answers[number][word] = 0
    return " ".join(f"{word:x}" for answer in answers for word in answer)
