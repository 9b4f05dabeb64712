"""A typed kernel inside a user's own compiled loop."""

from __future__ import annotations

import numpy as np
import pytest
from numba import njit

from rosetta_jit.backends.numba.function import data_pointer, typed
from tests.backends import kernels
from tests.backends.holders import rows
from tests.backends.messages import GOOD


def test_a_users_own_loop():
    definition = kernels.fixed(10)
    kernel = typed(definition)

    @njit
    def total(messages, state, values):
        result = 0.0
        for index in range(messages.shape[0]):
            if kernel(data_pointer(messages[index]), 0, messages.shape[1], data_pointer(state), 0) >= 0:
                result += values[9]
        return result

    (message,) = GOOD["fixed"]
    messages = np.frombuffer(message * 7, np.uint8).reshape(7, -1).copy()
    messages[3, 0] = 99
    holder = rows(definition)
    assert total(messages, holder.state, holder.lanes[0].view(np.float32)) == pytest.approx(6 * np.deg2rad(9.0))


def test_two_kernels_in_one_function():
    first, second = typed(kernels.text()), typed(kernels.tagged())

    @njit
    def both(message, state):
        return first(data_pointer(message), 0, message.size, data_pointer(state), 0), second(
            data_pointer(message), 0, message.size, data_pointer(state), 0
        )

    message = np.frombuffer(b"\xc8hello", np.uint8)
    assert both(message, rows(kernels.tagged()).state) == (-3, 6)
