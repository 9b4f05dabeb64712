"""Calls are compiled from the message or the holder to the result: an interpreter that looked in would cost more than the kernel."""

from __future__ import annotations

import sys
from functools import partial

import pytest

import rosetta_jit as rj


@pytest.mark.parametrize("backend", [None, "numba"])
def test_calls_that_run_no_python(backend):
    """What is usual is compiled from the call to its result, in each of its forms."""
    encode, decode = (made.of("geometry_msgs/Point", encoding="ros1", backend=backend) for made in (rj.Encoder, rj.Decoder))
    holder, own = encode.holder_type(x=1.0), decode.holder_type()
    message, buffer = encode(holder), bytearray(30)
    run: list[str] = []
    for call in (
        partial(encode, holder),
        partial(encode, holder, buffer),
        partial(encode, holder, buffer, 3),
        partial(encode.into, holder, buffer),
        partial(encode.into, holder, buffer, 3),
        partial(decode, message),
        partial(decode, message, own),
        partial(decode.into, message, own),
    ):
        call()
        sys.setprofile(lambda frame, event, _: run.append(frame.f_code.co_qualname) if event == "call" else None)
        call()
        sys.setprofile(None)
    assert run == []
