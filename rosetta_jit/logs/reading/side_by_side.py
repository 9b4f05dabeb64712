"""Work on items by several threads, whose results come in the order of the items. The work gives the interpreter lock away.

Whoever asks for the results works on the first item: who wants no more than one starts no thread. For using them a processor is left.
"""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Generator, Iterator
from contextlib import suppress
from functools import partial
from queue import Empty, SimpleQueue
from threading import Lock, Thread
from typing import Generic, TypeVar

Item = TypeVar("Item")
Result = TypeVar("Result")

MOST_THREADS = 8

BYTES = 3 << 20
"""For each thread, and once more: so many bytes are worked on ahead, or a single item. A few chunks of a log: while a table is made, nobody
asks for one."""


def processors() -> int:
    """How many processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class _Task(Generic[Result]):
    """A piece of work, and what came of it."""

    __slots__ = ("_done", "_error", "_result", "_work")

    def __init__(self, work: Callable[[], Result]) -> None:
        self._work, self._done = work, Lock()
        self._result: list[Result] = []
        self._error: BaseException | None = None
        self._done.acquire()

    def run(self) -> None:
        """Do it, in a thread."""
        try:
            self._result.append(self._work())
        except BaseException as error:  # noqa: BLE001 - it is raised where the result is used
            self._error = error
        self._done.release()

    def result(self) -> Result:
        """The result, or the error, when it is there. The task keeps neither."""
        self._done.acquire()
        if self._error is not None:
            raise self._error
        return self._result.pop()


class _Threads(Generic[Result]):
    """Threads that do tasks; each is started when there is a task for it."""

    def __init__(self, most: int) -> None:
        self._tasks = SimpleQueue["_Task[Result] | None"]()
        self._threads, self._most = list[Thread](), most

    def do(self, task: _Task[Result]) -> _Task[Result]:
        """Let a thread do a task."""
        self._tasks.put(task)
        if len(self._threads) < self._most:
            self._threads.append(Thread(target=_work_on, args=(self._tasks,), name="rosetta_jit unpacks a log", daemon=True))
            self._threads[-1].start()
        return task

    def end(self) -> None:
        """Do no task any more that is not begun."""
        with suppress(Empty):
            while True:
                self._tasks.get_nowait()
        for _ in self._threads:
            self._tasks.put(None)
        for each in self._threads:
            each.join()


def _work_on(tasks: SimpleQueue[_Task[Result] | None]) -> None:
    while (task := tasks.get()) is not None:
        task.run()
        del task  # its result is somebody else's now, who may use the memory again


def side_by_side(items: Iterator[Item], work: Callable[[Item], Result], size: Callable[[Item], int]) -> Generator[tuple[Item, Result]]:
    """Each item with what work on it gives. What the items or the work raise is raised in its place, behind the items before.

    ``size`` says how many bytes an item takes with its result; of 0 it is not worth a thread, and none is worked on ahead of it.
    """
    count = min(processors() - 1, MOST_THREADS)
    threads, most = _Threads[Result](count), BYTES * (count + 1)
    begun, sizes, failed = deque[tuple[Item, "_Task[Result]"]](), deque[int](), list[BaseException]()
    try:
        for number, item in enumerate(_until_failed(items, failed)):
            taken = size(item)
            while begun and (not taken or sum(sizes) + taken > most):
                yield _oldest(begun)
                sizes.popleft()
            if taken and number and count:
                begun.append((item, threads.do(_Task(partial(work, item)))))
                sizes.append(taken)
            else:
                yield item, work(item)
            del item  # its memory is free when the next one is made
        while begun:
            yield _oldest(begun)
        for error in failed:
            raise error
    finally:
        threads.end()


def _until_failed(items: Iterator[Item], failed: list[BaseException]) -> Iterator[Item]:
    """The items up to the one that could not be made; why goes to ``failed``."""
    try:
        yield from items
    except BaseException as error:  # noqa: BLE001 - it is raised behind the items before
        failed.append(error)


def _oldest(begun: deque[tuple[Item, _Task[Result]]]) -> tuple[Item, Result]:
    item, task = begun.popleft()
    return item, task.result()
