"""Arrays of numbers whose count a message tells, for generated modules that have some: part of those."""

from struct import Struct
from typing import Any

_KEPT = 128


class _ByCount(dict[int, Any]):  # pyright: ignore[reportUnusedClass]
    """What reads or writes so many numbers of one type by one call, by their count: the struct module makes it where it is not kept."""

    def __init__(self, code: str, method: str) -> None:
        super().__init__()
        self.code, self.method = code, method

    def __missing__(self, count: int) -> Any:
        if len(self) >= _KEPT:
            self.clear()
        found = self[count] = getattr(Struct(self.code.format(count)), self.method)
        return found
