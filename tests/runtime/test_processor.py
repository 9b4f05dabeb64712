"""Which processor code was made for: the same wherever it is asked, and told without LLVM or with it."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from rosetta_jit.runtime.code import processor

TELL = "from rosetta_jit.runtime.code.processor import processor; print(processor())"


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="processes cannot be told where to run")
def test_every_core_says_the_same():
    told = set()
    for core in sorted(os.sched_getaffinity(0))[:4]:
        script = f"import os; os.sched_setaffinity(0, [{core}])\n{TELL}"
        told.add(subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout)
    assert told == {processor.processor() + "\n"}


def test_without_the_c_librarys_answers_llvm_is_asked(monkeypatch):
    from llvmlite import binding

    monkeypatch.setattr(processor, "_asked_of_glibc", str)
    assert processor.processor().split()[0] == binding.get_process_triple()
    assert binding.get_host_cpu_name() in processor.processor()


def test_features_of_the_processor_are_told():
    """The second and third leaves have what vectors need: were they left out, code with vectors would meet processors without."""
    known = processor._asked_of_glibc().split()
    if not known:
        pytest.skip("this C library keeps no answers")
    assert len(known) == 8 * len(processor.LEAVES)
    avx = int(known[2], 16) >> 28 & 1  # CPUID.1:ECX.AVX
    assert avx == ("avx" in Path("/proc/cpuinfo").read_text().split())
