"""Programs that answer requests: from the cache where it has them, else from the compiler."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager, suppress
from functools import lru_cache, partial
from typing import Any

from rosetta_jit.errors import CacheWarning, warn
from rosetta_jit.kernel.entries import HOST, NEXT, NEXT_CALL, NEXT_KERNEL, ON_DEMAND, REST, SYMBOLS
from rosetta_jit.runtime import run
from rosetta_jit.runtime.cache.kernels import Cache
from rosetta_jit.runtime.cache.names import entry_name, request_name
from rosetta_jit.runtime.cache.texts import known
from rosetta_jit.runtime.code import native
from rosetta_jit.runtime.code.allowed import ForeignCodeError
from rosetta_jit.runtime.rest import Rest
from rosetta_jit.startup.garbage import imported, seldom_collected

RECENT = 8
"""How many programs of the cache are kept loaded though nobody uses them, for who makes the same one again and again."""

Linked = Any
"""What a process needs of a program: `rosetta_jit.runtime.program.Loaded`, or `rosetta_jit.runtime.bridge.LoadedBridge`."""


def answer(
    request: Any,
    backend: str | None,
    build_of: Callable[[Any], Any],
    link: Callable[[Mapping[str, Any], bytes], Linked],
    interpreted: Callable[[Any], Linked],
) -> Linked:
    """The program that answers a request, compiled at most once a machine if all is identified that it depends on.

    Parameters
    ----------
    build_of
        What compiles it: gives a `rosetta_jit.pipeline.build.Build`, or what is like it.
    link
        A program from the header and the object code that the cache keeps.
    interpreted
        One that runs in Python.
    """
    if backend is not None and _runs_in_python(backend):
        build = build_of(request)
        with _within_stack():
            return interpreted(build)
    cache = Cache.default()
    may_be_known = request.is_identified() and not cache.keeps_nothing
    name = cache.get_manifest(request_name(request.key())) if may_be_known else None
    if name is not None:
        with suppress(KeyError):
            return _shared(name, cache, link)
    build = build_of(request)
    with seldom_collected(), _within_stack():
        return _compiled(build, cache, link)


def _runs_in_python(name: str) -> bool:
    """Whether a backend compiles nothing."""
    from rosetta_jit.backends.installed import backend_named

    found = backend_named(name)
    return found is not None and bool(found.runner)


def _within_stack() -> AbstractContextManager[None]:
    from rosetta_jit.pipeline.depth import within_stack

    return within_stack()


def _compiled(build: Any, cache: Cache, link: Callable[[Mapping[str, Any], bytes], Linked]) -> Linked:
    from rosetta_jit.api import cacheable as certainty

    doubts = certainty.doubts(build.called)
    name = None if doubts or cache.keeps_nothing else entry_name(build.text)
    if name is not None:
        with suppress(KeyError):
            return _answered(build, cache, name, _shared(name, cache, link))
    addressing = build.check_functions()
    image = build.image()
    doubts = (*doubts, *certainty.doubts_of_compiled(build.called, addressing))
    certainty.note(build.request, cache, doubts)
    header = build.header
    if header.get("rare"):
        header = {**header, "name": name or entry_name(build.text)}
    if name is None or doubts:
        return link(header, image)
    cache.put(name, build.header, image)
    return _answered(build, cache, name, link(header, image))


def is_as_before(request: Any, name: str, build_of: Callable[[Any], Any]) -> bool:
    """Whether a program of this name would answer a request now: none of the files that it depends on has changed."""
    known = Cache.default().get_manifest(request_name(request.key())) if request.is_identified() else None
    return (known or entry_name(build_of(request).text)) == name


def _answered(build: Any, cache: Cache, name: str, loaded: Linked) -> Linked:
    """A program that the cache has, as the answer to its request from now on, if the request says all."""
    if build.request.is_identified():
        cache.put_manifest(request_name(build.request.key()), build.files(), name, by_search_path=bool(build.offered))
    return loaded


@lru_cache(maxsize=RECENT)
def _shared(name: str, cache: Cache, link: Callable[[Mapping[str, Any], bytes], Linked]) -> Linked:
    """A cached program: its code is loaded once, however many decoders it serves. KeyError if the cache has none that can be used."""
    entry = cache.get(name)
    if entry is None:
        raise KeyError(name)
    try:
        return link({**entry.header, "name": name}, entry.image)
    except ForeignCodeError as error:
        _warn(str(error))
        raise KeyError(name) from error


def library(image: bytes, header: Mapping[str, Any]) -> native.Library:
    """The code of a program, with the functions of ours that it calls, and with the places for what is made when it is needed.

    Those are the rest of its calls, and the program to which it leaves rare messages.
    """
    called, wanted, rest = header["host"], SYMBOLS[header["entry"]], header.get("rest")
    later = None
    if rest is not None and native.is_prelinked(image):
        following = (NEXT, NEXT_KERNEL) if NEXT_CALL in rest["symbols"] else ()
        wanted = (*(each for each in wanted if each not in rest["symbols"]), REST, *following)
        later = partial(_rest, rest)
    prepare = partial(_host_functions, called) if called else len
    wanted = (*wanted, HOST) if called else wanted
    if not header.get("rare"):
        return native.load(image, wanted, prepare, later=later)
    from rosetta_jit.runtime.on_demand import Place

    def prepared(addresses: Mapping[str, int]) -> Place:
        return Place(addresses[ON_DEMAND], prepare(addresses))

    return native.load(image, (*wanted, ON_DEMAND), prepared, header["name"], later=later)


def _rest(rest: Mapping[str, Any], addresses: Mapping[str, int]) -> Callable[[], native.Library]:
    """What makes the rest of a program's calls."""
    return Rest(addresses, tuple(rest["symbols"]), partial(_compiled_rest, rest)).made


def _compiled_rest(rest: Mapping[str, Any]) -> bytes:
    """The code of the rest of a program's calls: the cache may have it."""
    from rosetta_jit.backends.entry.texts import EntryText

    text = EntryText.of_plain(rest).alone
    code = known(text)
    if code is not None:
        return code
    with seldom_collected():
        imported("rosetta_jit.backends.entry.link")
        from rosetta_jit.backends.entry.link import compile_rest

        return compile_rest(text)


def _host_functions(called: Sequence[str], addresses: Mapping[str, int]) -> object:
    """Give code the functions of ours that it calls."""
    from rosetta_jit.runtime.code.host_table import fill
    from rosetta_jit.runtime.images import image_functions

    return fill(addresses[HOST], called, image_functions())


def interpreted_kernel(build: Any, number: int) -> run.Run:
    """A kernel of a program that runs in Python: slowly, but anywhere."""
    from rosetta_jit.backends.backend import runner_of
    from rosetta_jit.kernel.host import in_python

    kernel = build.kernels[number]
    functions = {each.name: in_python(each) for each in build.functions}
    if build.header["host"]:
        from rosetta_jit.runtime.images import image_functions

        functions |= image_functions()
    return run.python_run(runner_of(build.backend)(kernel, functions), keeps=bool(kernel.registers))


def sites_of(header: Mapping[str, Any], kernel: int) -> run.Sites:
    """Where a kernel can fail, by number."""
    sites = header["sites"]
    return run.Sites(sites[kernel]) if kernel < len(sites) else run.NO_SITES


def _warn(why: str) -> None:
    warn(f"a cached kernel could not be loaded and is compiled again: {why}", CacheWarning)
