"""Types made through C: created and freed like any other, and with a Python class in their place where CPython is another one."""

from __future__ import annotations

import gc
import resource
import weakref

import numpy as np
import pytest

from rosetta_jit.runtime.callable import STATE, Context, bind_call, bind_state, callable_class, is_native, message_base


class Program:
    """A base with methods and attributes."""

    def __init__(self, name):
        self.name = name

    def greet(self):
        return f"I am {self.name}"


def context(slow):
    return Context(slow, object)


@pytest.mark.parametrize("native", [False, None])
def test_instances_are_ordinary(native):
    made = callable_class(Program, native=native)
    instance = made("x")
    assert isinstance(instance, Program)
    assert (made.__name__, made.__qualname__, made.__module__) == ("Program", "Program", __name__)
    assert instance.greet() == "I am x"
    instance.note = 1
    assert instance.__dict__["note"] == 1
    assert weakref.ref(instance)() is instance


def test_the_fallback_calls_the_slow_path():
    instance = callable_class(Program, native=False)("x")
    bind_call(instance, 0, context(lambda *arguments, **named: (arguments, named)))
    assert instance(1, two=2) == ((1,), {"two": 2})
    holder = message_base(native=False)()
    bind_state(holder, np.zeros(16, np.int64).ctypes.data)


@pytest.mark.skipif(not is_native(), reason="no native types")
def test_an_unbound_callable_says_so():
    with pytest.raises(TypeError, match="vectorcall"):
        callable_class(Program)("x")(1)


@pytest.mark.skipif(not is_native(), reason="no native types")
def test_holders_carry_the_address_of_their_state():
    import ctypes

    class Holder(message_base()):
        pass

    holder, state = Holder(), np.zeros(16, np.int64)
    bind_state(holder, state.ctypes.data)
    holder.more = 1
    assert ctypes.c_uint64.from_address(id(holder) + STATE).value == state.ctypes.data


def test_cycles_are_collected():
    instance = callable_class(Program)("x")
    instance.self = instance
    bind_call(instance, 0, context(instance.greet))
    seen = weakref.ref(instance)
    del instance
    gc.collect()
    assert seen() is None


def test_a_hundred_thousand_come_and_go():
    made = callable_class(Program)

    class Holder(message_base()):
        pass

    def churn(count):
        for number in range(count):
            made("x").extra = number
            Holder().extra = number

    churn(10_000)
    gc.collect()
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    churn(100_000)
    gc.collect()
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 1024  # KiB
