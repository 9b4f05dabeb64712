"""Objects of Cyclone DDS's classes as encoders take them and decoders make them: over random types and values."""

from __future__ import annotations

import pytest

from rosetta_jit.model.types import Ref
from rosetta_jit.runtime.holder import holder_class

cyclone_types = pytest.importorskip("tests.frameworks.omg.cyclone_types")


@pytest.mark.parametrize("seed", range(24))
def test_random_objects_there_and_back(seed):
    schema, name, made = cyclone_types.random_types(seed)
    cls = holder_class(Ref(name), schema)
    for _ in range(3):
        theirs, plain = made.value(Ref(name))
        holder = cls()
        cls.family_.takers.take(holder, theirs)
        expected = cls.from_dict(plain)
        assert repr(holder) == repr(expected)  # NaN differs from itself, not from what it is printed as
        again = cls.family_.givers.make(type(theirs), holder)
        assert again.serialize() == theirs.serialize()
        other, _ = made.value(Ref(name))
        cls.family_.givers.fill(other, holder)
        assert other.serialize() == theirs.serialize()
