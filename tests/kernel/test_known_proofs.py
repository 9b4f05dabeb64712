"""A routine is proven once a machine, and what could not be proven is never known."""

from __future__ import annotations

from dataclasses import replace

import pytest

from rosetta_jit.errors import CacheWarning
from rosetta_jit.kernel.proof import verify as proof
from rosetta_jit.kernel.proof.known import kept_by
from rosetta_jit.kernel.proof.obligations import UnprovenError
from rosetta_jit.kernel.proof.verify import VerificationError, verify
from rosetta_jit.runtime.cache.proofs import proven
from tests.kernel.test_routines import calling, noting


@pytest.fixture(autouse=True)
def own_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("ROSETTA_JIT_CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.delenv("ROSETTA_JIT_CACHE", raising=False)
    return tmp_path / "cache"


@pytest.fixture
def walks(monkeypatch):
    """The routines that were proven by going through them."""
    found, walk = [], proof._routine

    def noted(strides, routine, called, record):
        found.append(routine.name)
        walk(strides, routine, called, record)

    monkeypatch.setattr(proof, "_routine", noted)
    return found


def as_another_process(kernel):
    proof._prove_routine.cache_clear()
    with kept_by(proven):
        verify(kernel)


def test_another_process_proves_nothing_again(walks):
    for _ in range(2):
        as_another_process(calling(noting(1), (16, 8)))
    assert walks == ["one"]


def test_nobody_keeps_proofs_unasked(walks):
    for _ in range(2):
        proof._prove_routine.cache_clear()
        verify(calling(noting(1), (16, 8)))
    assert walks == ["one", "one"]


def test_where_nothing_is_kept_all_is_proven(walks, monkeypatch):
    monkeypatch.setenv("ROSETTA_JIT_CACHE", "off")
    for _ in range(2):
        as_another_process(calling(noting(1), (16, 8)))
    assert walks == ["one", "one"]


def test_what_could_not_be_proven_is_not_known():
    for _ in range(2):
        with pytest.raises(VerificationError, match="routine one"):
            as_another_process(calling(noting(1), (16, 4)))


def test_another_routine_of_the_name_is_proven(walks):
    routine = noting(1)
    as_another_process(calling(routine, (16, 8)))
    as_another_process(calling(replace(routine, requires=(*routine.requires, *routine.requires)), (16, 8)))
    as_another_process(calling(routine, (16, 16)))
    assert walks == ["one"] * 3


@pytest.mark.parametrize("harm", [lambda data: data[:0], lambda data: data[:-1], lambda data: data[:-1] + bytes([data[-1] ^ 1])])
def test_a_damaged_file_proves_nothing(walks, own_cache, harm):
    as_another_process(calling(noting(1), (16, 8)))
    for file in own_cache.glob("*.kernel"):
        file.write_bytes(harm(file.read_bytes()))
    with pytest.warns(CacheWarning):
        as_another_process(calling(noting(1), (16, 8)))
    assert walks == ["one", "one"]


def test_the_error_of_a_proof_is_passed_on():
    def fails():
        raise UnprovenError("no")

    with pytest.raises(UnprovenError):
        proven("a claim", fails)
    proven("a claim", lambda: None)
