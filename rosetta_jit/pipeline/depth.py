"""What texts and types may nest, as deep as Python's stack is."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager

from rosetta_jit.catalogue import pipeline as words
from rosetta_jit.errors import SchemaError


@contextmanager
def within_stack() -> Generator[None]:
    """Around work on texts and types: what nests within the limits may still be too deep for a caller who has little stack left.

    Raises
    ------
    SchemaError
        It is.
    """
    try:
        yield
    except RecursionError as error:
        raise SchemaError((words.too_deep(),)) from error
