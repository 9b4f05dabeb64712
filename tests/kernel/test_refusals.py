"""Each refusal that the proof can give has an unsafe kernel that provokes it: a new one without a kernel fails here."""

from __future__ import annotations

import ast
import inspect
import re

import pytest

from rosetta_jit.kernel import shape
from rosetta_jit.kernel.proof import claims, contracts, effects, loops, paths, symbolic, verify
from rosetta_jit.kernel.proof.record import Record
from tests.kernel import kernels
from tests.kernel.unsafe import ACCEPTED, REFUSED

DEMANDS = {"oblige", "certify", "demand"}
"""The functions that refuse where what they are given does not hold."""


def refusals():
    """Where a refusal is given: in which file, and from which line to which."""
    for module in (contracts, effects, loops, paths, symbolic, verify):
        for node in ast.walk(ast.parse(inspect.getsource(module))):
            match node:
                case ast.Call(func=ast.Name(id=name)) if name in DEMANDS:
                    yield module.__file__, node.lineno, node.end_lineno
                case ast.Raise(exc=ast.Call(func=ast.Name(id="UnprovenError"))):
                    yield module.__file__, node.lineno, node.end_lineno


def wordings():
    """What is said of a kernel's text: of each f-string what stands between the braces may be anything."""
    for node in ast.walk(ast.parse(inspect.getsource(shape))):
        if isinstance(node, ast.FunctionDef) and node.name.endswith("_error"):
            for inner in ast.walk(node):
                if isinstance(inner, ast.Return):
                    yield from map(pattern, texts(inner.value))


def texts(node):
    match node:
        case ast.Constant(value=str()) | ast.JoinedStr():
            yield node
        case ast.IfExp():
            yield from texts(node.body)
            yield from texts(node.orelse)


def pattern(node):
    parts = node.values if isinstance(node, ast.JoinedStr) else [node]
    return "".join(re.escape(part.value) if isinstance(part, ast.Constant) else ".+" for part in parts)


def refusal(kernel):
    with pytest.raises(verify.VerificationError) as caught:
        verify.verify(kernel)
    return caught.value


def place(error):
    """The file and line where the innermost obligation was demanded."""
    while error.__context__ is not None:
        error = error.__context__
    trace = error.__traceback__
    places = []
    while trace is not None:
        places.append((trace.tb_frame.f_code.co_filename, trace.tb_lineno, trace.tb_frame.f_code.co_name))
        trace = trace.tb_next
    return next((file, line) for file, line, name in reversed(places) if name not in DEMANDS)


@pytest.mark.parametrize("name", REFUSED)
def test_unsafe_kernels_are_refused(name):
    words, kernel = REFUSED[name]
    assert str(refusal(kernel)).splitlines()[0].partition(": ")[2].endswith(words)


@pytest.mark.parametrize("name", ACCEPTED)
def test_their_safe_twins_are_not(name):
    verify.verify(ACCEPTED[name])


def test_every_refusal_has_a_kernel():
    provoked = {place(refusal(kernel)) for _, kernel in REFUSED.values()}
    every = set(refusals())
    assert len(every) > 50
    missing = sorted(
        f"{file}:{first}" for file, first, last in every if not any((file, line) in provoked for line in range(first, last + 1))
    )
    assert not missing, "\n".join(missing)


def test_everything_said_of_a_text_has_a_kernel():
    said = [str(refusal(kernel)).splitlines()[0] for _, kernel in REFUSED.values()]
    found = list(wordings())
    assert len(found) > 10
    missing = [each for each in found if not any(re.search(rf": {each}$", words) for words in said)]
    assert not missing, missing


def test_words_of_two_refusals_are_told_apart():
    """Where one line gives two refusals, each of them is provoked."""
    words = {words for words, _ in REFUSED.values()}
    assert {"y is not visible here", "begin is no i32"} <= words


def test_every_claim_is_owed_by_a_kernel():
    """What the proof infers is written down as well, each kind of inference."""
    record = Record()
    for kernel in (*kernels.ALL.values(), *ACCEPTED.values()):
        verify.verify(kernel, record)
    every = {each for each in vars(claims).values() if isinstance(each, claims.Claim)}
    owed = {each.claim for each in record.obligations}
    assert every - owed <= {claims.RETURNS}
    assert claims.NO_WRAP["i64"] in owed
