"""Schemas of captured messages, by the framework whose encoding they have."""

from __future__ import annotations

from collections.abc import Iterable

from rosetta_jit.catalogue import pipeline as words
from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.installed import installed


def infer(messages: Iterable[bytes], *, name: str, encoding: str) -> str:
    """A schema of a type of that name that describes every one of the messages, as text.

    Raises
    ------
    DecodeError
        One is no message of the encoding.
    SchemaError
        There is no such encoding, it does not tell fields apart, or messages have no type in common.
    """
    frameworks = installed().values()
    owner = next((each for each in frameworks if encoding in each.encodings), None)
    able = [known for each in frameworks if each.infer for known in each.encodings]
    draft = None if owner is None else owner.drafts()
    if draft is None:
        raise SchemaError((words.cannot_infer(encoding, able, known_itself=owner is not None),))
    return draft(messages, name=name, encoding=encoding)
