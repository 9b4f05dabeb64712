"""Reading ahead: while one block is decoded, a thread reads and decompresses the next. Both do their work without the interpreter lock."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Generator, Iterator
from threading import Condition, Thread
from typing import Generic, TypeVar

from rosetta_jit.startup.dataclass import dataclass

Item = TypeVar("Item")

WAITING_BYTES = 6 << 20
"""The most that waits: a table is made of about as many bytes, and while that lasts nobody asks for more."""


@dataclass(frozen=True, slots=True)
class _Failed:
    """What the iterator raised."""

    error: BaseException


class _End:
    """There is no more."""


class _Waiting(Generic[Item]):
    """Items between the thread that makes them and the one that uses them: of at most `WAITING_BYTES` together, or a single one."""

    def __init__(self) -> None:
        self._items = deque[tuple[Item | _Failed | _End, int]]()
        self._changed, self._bytes, self._is_wanted = Condition(), 0, True

    def put(self, item: Item | _Failed | _End, size: int) -> bool:
        """Let an item wait when there is room for it; whether anybody still wants more."""
        with self._changed:
            self._changed.wait_for(lambda: not self._items or self._bytes + size <= WAITING_BYTES or not self._is_wanted)
            self._items.append((item, size))
            self._bytes += size
            self._changed.notify_all()
            return self._is_wanted

    def get(self) -> Item | _Failed | _End:
        """The item that waits longest."""
        with self._changed:
            self._changed.wait_for(lambda: self._items)
            item, size = self._items.popleft()
            self._bytes -= size
            self._changed.notify_all()
            return item

    def leave(self) -> None:
        """Want no more."""
        with self._changed:
            self._is_wanted = False
            self._changed.notify_all()


def ahead(items: Iterator[Item], size: Callable[[Item], int]) -> Generator[Item]:
    """The same items, which are made while others are used. What the iterator raises is raised here.

    ``size`` says how many bytes an item has.
    """
    waiting = _Waiting[Item]()

    def make() -> None:
        try:
            for item in items:
                if not waiting.put(item, size(item)):
                    return
            waiting.put(_End(), 0)
        except BaseException as error:  # noqa: BLE001 - it is raised where the items are used
            waiting.put(_Failed(error), 0)

    thread = Thread(target=make, name="rosetta_jit reads ahead", daemon=True)
    thread.start()
    try:
        while True:
            match waiting.get():
                case _Failed(error):
                    raise error
                case _End():
                    return
                case item:
                    yield item
    finally:
        waiting.leave()
        thread.join()
