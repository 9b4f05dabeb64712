"""Types whose names are like one that there is not: by the files that lie where its own would."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import suppress
from itertools import islice
from pathlib import Path

from rosetta_jit.errors import ReportError
from rosetta_jit.model.types import name_parts
from rosetta_jit.parsing.idl import FrontEnds
from rosetta_jit.parsing.search import SearchPath, refusal
from rosetta_jit.pipeline.limits import MAX_FILES, MAX_GUESSES, MAX_READ
from rosetta_jit.source import shipped_folders


def similar_types(wanted: str, front_ends: FrontEnds, search: SearchPath) -> list[str]:
    """The names of types that are declared where ``wanted`` would be; for a name without a package, in all packages that are shipped."""
    package = name_parts(wanted)[:-1]
    guesses = tuple(each for each in islice(front_ends.guesses(wanted), MAX_GUESSES) if not refusal(each))
    if not package:
        return list(dict.fromkeys(name for name in _packaged(wanted, guesses, front_ends, search)))
    separator = next(each for each in ("::", ".", "/") if each in wanted)
    stems = [stem for folder in search.folders for guess in guesses for stem in _stems(folder / guess)]
    return [separator.join((*package, stem)) for stem in dict.fromkeys(stems)]


def _stems(path: Path) -> Iterator[str]:
    """The files beside a path, of its suffix."""
    with suppress(OSError, ValueError):  # a name that no folder can have, or one that cannot be read
        yield from [each.stem for each in islice(path.parent.glob(f"*{path.suffix}"), MAX_FILES)]


def _packaged(wanted: str, guesses: Iterable[str], front_ends: FrontEnds, search: SearchPath) -> Iterator[str]:
    """Types with that last name, of any package."""
    for path in islice(_named(wanted, guesses), MAX_READ):
        source, front_end = search.named(str(path)), front_ends.find(str(path))
        if source is not None and front_end is not None:
            with suppress(ReportError):  # of another framework
                types = front_end(source, search.find).types
                yield from [name for name in types if name_parts(name)[-1].casefold() == wanted.casefold()]


def _named(wanted: str, guesses: Iterable[str]) -> Iterator[Path]:
    """Shipped files that are named as the type, whatever the case."""
    folders = dict.fromkeys(((folder / guess).parent, (folder / guess).suffix) for guess in guesses for folder in shipped_folders())
    found = (path for place, suffix in folders for path in islice(place.rglob(f"*{suffix}"), MAX_FILES))
    return (path for path in dict.fromkeys(found) if path.stem.casefold() == wanted.casefold())
