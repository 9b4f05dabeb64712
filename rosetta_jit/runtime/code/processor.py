"""What the compiler sees of the processor, as text: code that is made for one does not run on every other.

The C library has asked the processor, when the process began, all that LLVM asks (sys/platform/x86.h, glibc 2.33). To ask LLVM itself would
mean to import it, which takes longer than all the rest of a warm start.
"""

from __future__ import annotations

import ctypes
import os
import sys
from typing import Literal

LEAVES = range(16)
"""Answers to CPUID that glibc keeps, by its own numbers; there are fewer, and behind the last are zeros."""

OF_THE_MACHINE = ((0, 1), (5, 2))
"""Leaf and word: the core that was asked (CPUID 1, EBX), and how many there are (0x80000008, ECX); not what the processor can do."""

USABLE_ECX, USABLE_EBX_7, USABLE_ECX_7 = 6, 13, 14
"""Where the text has what can be used of glibc's leaf 0 (CPUID 1), third word, and of its leaf 1 (CPUID 7), second and third word."""

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


def carryless_bits() -> Literal[0, 128, 512]:
    """How wide the registers are that it multiplies without carries, of x86-64; 0 where it cannot.

    128 bits take PCLMULQDQ (CPUID 1, ECX, bit 1), 512 AVX-512 F (CPUID 7, EBX, bit 16) and VPCLMULQDQ (CPUID 7, ECX, bit 10) besides.
    """
    known = processor()
    if "+" in known:
        has_128 = known.startswith("x86_64") and "+pclmul" in known
        has_512 = "+vpclmulqdq" in known and "+avx512f" in known
    else:
        words = [int(each, 16) for each in known.split(" ")]
        has_128 = bool(words[USABLE_ECX] & 1 << 1)
        has_512 = bool(words[USABLE_EBX_7] & 1 << 16 and words[USABLE_ECX_7] & 1 << 10)
    return 512 if has_128 and has_512 else 128 if has_128 else 0


def _asked_of_glibc() -> str:
    leaf = getattr(ctypes.CDLL(None), "__x86_get_cpuid_feature_leaf", None)
    if leaf is None:
        return ""
    leaf.restype, leaf.argtypes = ctypes.POINTER(_WORDS), [ctypes.c_uint]
    answers = [list(leaf(number).contents) for number in LEAVES]
    for number, word in OF_THE_MACHINE:
        answers[number][word] = 0
    return " ".join(f"{word:x}" for answer in answers for word in answer)
