"""While programs are made, garbage is looked for seldom; afterwards as the process had it."""

from __future__ import annotations

import gc

import pytest

from rosetta_jit.garbage import SELDOM, seldom_collected


@pytest.fixture(autouse=True)
def as_it_was():
    before = gc.get_threshold()
    yield
    gc.set_threshold(*before)


def test_thresholds_come_back():
    before = gc.get_threshold()
    with seldom_collected():
        assert gc.get_threshold() == (SELDOM, *before[1:])
        with seldom_collected():
            assert gc.get_threshold() == (SELDOM, *before[1:])
        assert gc.get_threshold() == (SELDOM, *before[1:])
    assert gc.get_threshold() == before


def test_thresholds_come_back_from_a_failure():
    before = gc.get_threshold()
    with pytest.raises(KeyError), seldom_collected():
        raise KeyError
    assert gc.get_threshold() == before


@pytest.mark.parametrize("threshold", [0, SELDOM, 10 * SELDOM])
def test_who_collects_seldom_or_never_is_left_alone(threshold):
    gc.set_threshold(threshold, 5, 5)
    with seldom_collected():
        assert gc.get_threshold() == (threshold, 5, 5)
    assert gc.get_threshold() == (threshold, 5, 5)
