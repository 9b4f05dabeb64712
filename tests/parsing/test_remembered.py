"""A file is parsed once as long as it, and all that it imports, stays as it is."""

from __future__ import annotations

import pytest

from rosetta_jit.errors import SchemaError
from rosetta_jit.model.types import Schema
from rosetta_jit.parsing.limits import MAX_REMEMBERED, MAX_REMEMBERED_CHARACTERS
from rosetta_jit.parsing.remembered import parsed
from rosetta_jit.source import Source


class FrontEnd:
    """Reads a file whose lines are the files that it imports; counts how often."""

    def __init__(self):
        self.times = 0

    def __call__(self, source, load):
        self.times += 1
        for name in source.text.split():
            load(name)
        if source.text == "wrong":
            raise SchemaError(())
        return Schema({})


class Files(dict):
    """Finds files; notes which were asked for."""

    def __init__(self, **texts):
        super().__init__(texts)
        self.asked = []

    def __call__(self, name):
        self.asked.append(name)
        return Source(name, self[name]) if name in self else None


@pytest.fixture
def read():
    return FrontEnd()


def test_the_same_file_is_parsed_once(read):
    files = Files(b="text")
    first = parsed(read, Source("a", "b c"), files)
    assert parsed(read, Source("a", "b c"), files) is first
    assert read.times == 1
    assert files.asked == ["b", "c"] * 2  # whoever keeps an account of what is read gets all of it


@pytest.mark.parametrize("changed", [{"b": "other"}, {"b": "text", "c": "has come"}, {}])
def test_another_import_makes_another_schema(read, changed):
    first = parsed(read, Source("a", "b c"), Files(b="text"))
    assert parsed(read, Source("a", "b c"), Files(**changed)) is not first
    assert read.times == 2


@pytest.mark.parametrize("other", [Source("a", "text!"), Source("b", "text")])
def test_another_text_or_place_is_another_file(read, other):
    parsed(read, Source("a", "text"), Files())
    parsed(read, other, Files())
    assert read.times == 2


def test_front_ends_share_nothing(read):
    other = FrontEnd()
    assert parsed(read, Source("a", ""), Files()) is not parsed(other, Source("a", ""), Files())
    assert (read.times, other.times) == (1, 1)


def test_a_mistake_is_reported_again(read):
    for _ in range(2):
        with pytest.raises(SchemaError):
            parsed(read, Source("a", "wrong"), Files())
    assert read.times == 2


def test_what_cannot_be_loaded_is_reported(read):
    def refuse(name):
        raise SchemaError(())

    parsed(read, Source("a", "b"), Files())
    with pytest.raises(SchemaError):
        parsed(read, Source("a", "b"), refuse)


@pytest.mark.parametrize(("imported", "times"), [(MAX_REMEMBERED_CHARACTERS - 1, 1), (MAX_REMEMBERED_CHARACTERS, 2)])
def test_long_texts_are_not_remembered(read, imported, times):
    for _ in range(2):
        parsed(read, Source("a", "b"), Files(b="x" * imported))
    assert read.times == times


def test_so_many_files_are_remembered(read):
    for number in range(MAX_REMEMBERED + 1):
        parsed(read, Source(f"a{number}", ""), Files())
    parsed(read, Source("a1", ""), Files())
    assert read.times == MAX_REMEMBERED + 1
    parsed(read, Source("a0", ""), Files())
    assert read.times == MAX_REMEMBERED + 2
