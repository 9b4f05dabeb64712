"""A function is identified if all is known that it can reach, and has another digest as soon as one thing of that is another."""

from __future__ import annotations

import array
import collections
import ctypes
import datetime as dt
import decimal
import enum
import fractions
import functools
import gc
import json
import math
import operator
import threading
import types
import weakref
import zipfile

import numba
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rosetta_jit.runtime.functions import registered
from rosetta_jit.runtime.functions.content import content_of
from rosetta_jit.runtime.functions.identity import identify, settle
from rosetta_jit.runtime.limits import MAX_FUNCTIONS

OFFSET = 0.25


def digest_of(function):
    return identify(function, "f").digest


def reaching(value):
    """A function that reaches a value."""
    return lambda x: x if value else -x


def reasons(value):
    return identify(reaching(value), "f").uncertain


def outer(value, table=(1, 2)):
    def inner(x):
        return x * value + table[0] + OFFSET

    return inner


@numba.njit
def recursive(x):
    return recursive(x - 1) if x else 0


def test_what_a_digest_covers():
    alike = digest_of(outer(1.0)), digest_of(outer(1.0)), digest_of(numba.njit(outer(1.0)).py_func)
    assert len(set(alike)) == 1
    given = (
        outer(2.0),
        outer(1),
        outer(1.0, (3, 2)),
        outer(np.float32(1)),
        outer(np.arange(2)),
        outer(np.arange(3)),
        outer(-0.0),
        outer(0.0),
    )
    assert len({*map(digest_of, given), alike[0]}) == 9
    assert digest_of(numba.njit(fastmath=True)(outer(1.0))) not in (alike[0], None)
    assert digest_of(outer(recursive)) == digest_of(outer(recursive)) is not None
    assert digest_of(recursive) is not None


def test_options_that_a_user_gave_to_a_function_of_numbas():
    function = numba.np.arraymath._early_return
    made = numba.njit(function), numba.njit(error_model="numpy")(function)
    assert len({content_of(reaching(each), "f").digest for each in made}) == 2


class Colour(enum.Enum):
    RED = 1

    def describe(self):
        return "red"


Point = collections.namedtuple("Point", "x y")

KNOWN = [
    *(None, True, 7, -(10**5000), 0.1, math.nan, 1j, "text", b"bytes", ..., (), (1, (2.0, "a")), frozenset({1, 2}), slice(1, None, 2)),
    *(
        math.sin,
        abs,
        len,
        operator.add,
        int,
        float,
        complex,
        range,
        ValueError,
        np.sin,
        np.sum,
        np.dot,
        np.float32,
        np.linalg.norm,
        np.mean,
    ),
    *(
        np.float32(1),
        np.bool_(1),
        np.datetime64("2020-01-01"),
        np.dtype("f4"),
        np.dtype([("a", "f4")]),
        np.arange(4),
        np.zeros((2, 3), order="F"),
    ),
    *(np.zeros(2, [("a", "f4"), ("b", "i2", 3)]), np.array(["a", "b"]), Colour, Colour.RED, Point, Point(1, 2.0), json.JSONDecodeError),
    *(numba.float64, numba.prange, numba.literal_unroll, recursive, (recursive, recursive)),
]


@pytest.mark.parametrize("value", KNOWN, ids=lambda value: type(value).__name__)
def test_what_is_known(value):
    assert reasons(value) == ()
    assert digest_of(reaching(value)) == digest_of(reaching(value))


def test_what_is_known_is_told_apart():
    assert len({content_of(reaching(value), "f").digest for value in KNOWN}) == len(KNOWN)


class Number(int):
    pass


class Text(str):
    __slots__ = ()


class Place(Point):
    @property
    def z(self):
        return 1


class Valued(enum.Enum):
    RED = 1

    @property
    def value(self):
        return 2


class Mixed(Number, enum.Enum):
    RED = 1


class Meta(type):
    pass


class Module(types.ModuleType):
    pass


class FakeFloat(np.float64):
    pass


FakeFloat.__module__, FakeFloat.__qualname__ = "numpy", "float64"

UNKNOWN = [
    *(object(), [1], {1: 2}, {1}, bytearray(b"1"), memoryview(b"1"), range(3), array.array("d"), collections.deque(), Number(1), Text("1")),
    *(Place(1, 2), Place, Valued, Valued.RED, Mixed, Mixed.RED, Meta("M", (), {}), Meta("E", (ValueError,), {})),
    *(lambda x: x, functools.partial(abs), [].append, "".join, Number(1).bit_length, property(abs), staticmethod(abs), classmethod(abs)),
    *(math, np, types.ModuleType("math"), Module("m"), weakref.ref(Number), threading.Lock(), types.MappingProxyType({}), iter([1])),
    *(decimal.Decimal(1), fractions.Fraction(1), dt.date(2020, 1, 1), types.SimpleNamespace(), (i for i in "a"), reaching.__code__),
    *(np.array([None]), np.ma.masked_array([1]), np.zeros(2, [("a", "f4")]).view(np.recarray), np.arange(9)[::2], np.zeros(200_000)),
    *(
        np.frompyfunc(abs, 1, 1),
        np.vectorize(abs),
        np.random.default_rng(),
        np.random.rand,
        np.errstate(),
        FakeFloat,
        FakeFloat(1),
        np.array([object()])[0],
    ),
    *(ctypes.CDLL(None).cos, ctypes.CFUNCTYPE(ctypes.c_double)(lambda: 1.0), ctypes.c_int(1), numba.vectorize(reaching(1)), numba.objmode),
    *(
        numba.typed.List([1]),
        numba.types.float64[:],
        numba.njit(cache=True)(recursive.py_func),
    ),
    *((1, (2, [3])), Point(1, [2]), frozenset({1, (2,)}), functools.reduce(lambda inner, _: (inner,), range(200), ()), slice(object())),
    functools.reduce(lambda inner, _: (inner, inner), range(60), ()),
]


@pytest.mark.parametrize("value", UNKNOWN, ids=lambda value: type(value).__name__)
def test_the_world_is_closed(value):
    """What no rule knows is uncertain, and so is whatever has it as a part."""
    assert reasons(value)
    assert digest_of(reaching((value,))) is None


PLAIN = st.none() | st.booleans() | st.integers() | st.floats() | st.complex_numbers() | st.text() | st.binary()
VALUES = st.recursive(PLAIN, lambda inner: st.lists(inner, max_size=3).map(tuple), max_leaves=6)


@given(VALUES, VALUES)
def test_digests_are_as_different_as_values(one, other):
    assert (content_of(reaching(one), "f").digest == content_of(reaching(other), "f").digest) == (to_bits(one) == to_bits(other))


def to_bits(value):
    """A value as text, with types and signs: 1 is not True, and 0.0 is not -0.0."""
    return [to_bits(each) for each in value] if isinstance(value, tuple) else f"{type(value)} {value!r}"


def test_attributes_of_functions(monkeypatch):
    function = reaching(1)
    before = digest_of(function)
    function.unit = object()
    assert digest_of(function) == before
    for name in ("__wrapped__", "__signature__", "__numba__"):
        monkeypatch.setattr(function, name, function, raising=False)
        assert digest_of(function) is None
        monkeypatch.undo()
    assert digest_of(function) == before


def test_globals_that_are_no_plain_dictionary():
    class Globals(dict):
        def __missing__(self, name):
            return 1

    assert digest_of(types.FunctionType(reaching(1).__code__, {}, closure=reaching(1).__closure__)) is not None
    assert digest_of(types.FunctionType((lambda x: x * ANY).__code__, Globals())) is None  # noqa: F821 - nobody defines it


def test_empty_cells_and_names_that_are_not_there():
    assert digest_of(lambda x: x * later) is None
    assert digest_of(lambda x: x + nowhere) is None  # noqa: F821 - as it says
    later = 1


def test_too_many_functions():
    function = recursive
    for _ in range(MAX_FUNCTIONS + 1):
        function = numba.njit(outer(function))
    assert digest_of(function) is None


def test_settings_of_numba(monkeypatch, tmp_path):
    function = reaching(1)
    before = digest_of(function)
    monkeypatch.setenv("NUMBA_BOUNDSCHECK", "1")
    checked = digest_of(function)
    monkeypatch.undo()
    assert digest_of(function) == before not in (checked, None)
    assert checked is not None
    monkeypatch.setattr(numba.config, "BOUNDSCHECK", 1)
    assert identify(function, "f").uncertain == ("`numba.config.BOUNDSCHECK` was set in the process",)
    monkeypatch.undo()
    monkeypatch.chdir(tmp_path)
    assert digest_of(function) == before
    (tmp_path / ".numba_config.yaml").write_text("developer_mode: 0\n")
    assert digest_of(function) != before


def test_versions(monkeypatch):
    before = digest_of(reaching(1))
    for name in ("rosetta_jit.runtime.functions.environment.numba_version", "numpy.__version__", "sys.version"):
        monkeypatch.setattr(name, (lambda: "1") if name.endswith("numba_version") else "1")
        assert digest_of(reaching(1)) not in (before, None)
        monkeypatch.undo()
    monkeypatch.setattr("rosetta_jit.runtime.functions.environment.numba_version", lambda: "")
    assert digest_of(reaching(1)) is None


def test_packages_that_extend_numba(monkeypatch, tmp_path):
    entry_points = "[numba_extensions]\ninit = ext:init\n"
    (tmp_path / "ext-1.0.dist-info").mkdir()
    (tmp_path / "ext-1.0.dist-info" / "METADATA").write_text("Name: ext\nVersion: 1.0\n")
    monkeypatch.syspath_prepend(tmp_path)
    assert digest_of(reaching(1)) is not None
    (tmp_path / "ext-1.0.dist-info" / "entry_points.txt").write_text(entry_points)
    assert "ext-1.0" in reasons(1)[0]
    monkeypatch.undo()
    with zipfile.ZipFile(tmp_path / "ext.zip", "w") as file:
        file.writestr("ext-1.0.dist-info/METADATA", "Name: ext\nVersion: 1.0\n")
        file.writestr("ext-1.0.dist-info/entry_points.txt", entry_points)
    monkeypatch.syspath_prepend(tmp_path / "ext.zip")
    assert "ext" in reasons(1)[0]


def fresh(constant):
    """A function that calls a dispatcher that has a global, and the globals."""
    variables = {"numba": numba, "K": constant}
    exec("@numba.njit\ndef g(x): return x * K\ndef f(x): return g(x)\n", variables)  # noqa: S102 - as a module of the user's
    return variables["f"], variables


def test_dispatchers_that_numba_compiled():
    function, variables = fresh(2.0)
    before = identify(function, "f")
    assert before.digest == digest_of(fresh(2.0)[0]) != digest_of(fresh(3.0)[0])
    variables["g"](1.0)
    assert digest_of(function) is None
    assert settle(before, function, "f")
    assert digest_of(function) == before.digest  # compiled for us, by its word
    variables["g"](1)
    assert digest_of(function) is None  # and again, not for us


def test_dispatchers_that_show_another_function():
    function, variables = fresh(2.0)
    variables["g"].py_func = fresh(3.0)[1]["g"].py_func
    assert digest_of(function) is None


def test_dispatchers_whose_globals_changed():
    function, variables = fresh(2.0)
    before = identify(function, "f")
    variables["g"](1.0)
    assert settle(before, function, "f")
    variables["K"] = 3.0
    assert "compiled by numba before" in identify(function, "f").uncertain[0]
    assert not settle(before, function, "f")
    variables["K"] = 2.0
    assert digest_of(function) == before.digest


def test_dispatchers_that_are_freed_are_passed_over():
    dispatcher = numba.njit(lambda x: x)
    known = {weakref.ref(test_dispatchers_that_are_freed_are_passed_over): numba.types.Dispatcher(dispatcher)}
    del dispatcher
    gc.collect()
    nothing = types.SimpleNamespace(functions=(), attributes=(), globals=(), _functions={}, _attributes={}, _globals=known)
    assert list(registered._types(nothing, nothing)) == []
