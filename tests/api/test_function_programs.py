"""Programs that call functions of the user's: which of them the cache keeps, and what it says of the others."""

from __future__ import annotations

import gc
import json

import numba
import numpy as np
import pytest

import rosetta_jit as rj
from rosetta_jit.cli import main
from rosetta_jit.pipeline.build import Build
from rosetta_jit.runtime.cache.kernels import NOTE, Cache
from rosetta_jit.runtime.functions import kinds

HEAD = 'import "s.bottle-schema"\nimport "r.proto"\nfunction f(float64): float64\ndata-holder: R\nwire-schema: sensor\n'
FILES = {
    "s.bottle-schema": '"sensor" (("raw" :double))',
    "r.proto": 'syntax = "proto2"; message R { required double value = 1; }',
    "m.mapping": HEAD + "unpack-rules:\n  .value = f(.raw)\npack-rules:\n  .raw = .value\n",
    "n.mapping": HEAD + "unpack-rules:\n  .value = f(.raw) * 1.0\n",
}


@pytest.fixture
def cache(tmp_path, monkeypatch):
    monkeypatch.setenv("ROSETTA_JIT_CACHE_DIR", str(tmp_path / "cache"))
    return Cache.default()


@pytest.fixture
def compiled(monkeypatch):
    """The programs that were compiled."""
    found, image = [], Build.image
    monkeypatch.setattr(Build, "image", lambda build: found.append(build) or image(build))
    return found


def decoder(function, mapping="m.mapping"):
    return rj.Decoder(mapping, schema=FILES, encoding="yarp4", functions={"f": function})


def message():
    encode = rj.Encoder.of("sensor", schema=FILES, imports=["s.bottle-schema"], encoding="yarp4", backend="interpreter")
    return encode(encode.holder_type.from_dict({"raw": 1.0}))


def module(text, **variables):
    """The variables of a module of the user's."""
    variables |= {"numba": numba, "np": np}
    exec(text, variables)  # noqa: S102 - as a module of the user's
    return variables


CALLS = "@numba.njit\ndef g(x): return x * K\ndef f(x): return g(x)\n"


def test_programs_that_share_a_dispatcher_are_kept(cache, compiled):
    variables = module(CALLS, K=2.0)
    for mapping in ("m.mapping", "n.mapping") * 2:
        assert decoder(variables["f"], mapping)(message()).value == 2.0
    assert len(compiled) == 2
    assert cache.info().compiled_anew == ()
    for mapping in ("m.mapping", "n.mapping"):
        assert decoder(module(CALLS, K=2.0)["f"], mapping)(message()).value == 2.0
    assert len(compiled) == 2


def test_a_global_that_changes_spoils_no_kernel(cache, compiled):
    """Numba goes on with the code of `g` that it has; where `g` is compiled later, it has the later value."""
    variables = module(CALLS, K=2.0)
    assert decoder(variables["f"])(message()).value == 2.0
    variables["K"] = 3.0
    assert decoder(variables["f"])(message()).value == variables["f"](1.0) == 2.0
    assert "`g` was compiled by numba before" in cache.info().compiled_anew[0].reasons[0]
    assert decoder(module(CALLS, K=3.0)["f"])(message()).value == 3.0
    assert len(compiled) == 3
    assert decoder(module(CALLS, K=2.0)["f"])(message()).value == 2.0
    assert len(compiled) == 3


def test_a_function_that_changes_while_it_is_compiled_is_not_kept(cache, compiled, monkeypatch):
    variables = module("def f(x): return x * K\n", K=2.0)
    check = Build.check_functions
    monkeypatch.setattr(Build, "check_functions", lambda build: variables.update(K=3.0) or check(build))
    assert decoder(variables["f"])(message()).value == 3.0
    assert "changed while it was compiled" in cache.info().compiled_anew[0].reasons[0]
    monkeypatch.undo()
    assert decoder(module("def f(x): return x * K\n", K=2.0)["f"])(message()).value == 2.0


def test_a_function_that_is_not_called_does_not_matter(cache, compiled):
    def unknown(x, table=[2.0]):  # noqa: B006 - what nobody can identify
        return x * table[0]

    for _ in range(2):
        encode = rj.Encoder("m.mapping", schema=FILES, encoding="yarp4", functions={"f": unknown})
        assert len(encode(encode.holder_type.from_dict({"value": 1.0}))) == len(message())
    assert len(compiled) == 1
    assert cache.info().compiled_anew == ()


def test_code_with_addresses_is_not_kept(cache, monkeypatch):
    """Should a kind of object be taken for known that numba compiles the address of, its code says so."""
    variables = module("T = np.full(200_000, 2.0)\ndef f(x): return x * T[7]\n")
    monkeypatch.setattr(kinds, "is_at_its_address", lambda _: False)
    assert decoder(variables["f"])(message()).value == 2.0
    assert cache.info().compiled_anew[0].reasons == ("the code of `f` has addresses of the process that compiled it",)
    assert cache.info().entries == 0


def test_what_code_has_addresses_of_stays(cache):
    variables = module("T = np.full(10**6, 2.0)\ndef f(x): return x * T[7]\n")
    decode = decoder(variables["f"])
    variables["T"] = None
    gc.collect()
    other = np.full(10**6, 3.0)
    assert decode(message()).value == 2.0
    assert other[7] == 3.0
    assert cache.info().entries == 0


def test_a_note_says_what_is_not_kept_and_why(cache, capsys):
    text = "T = [2.0]\ndef g(x): return x * 2.0\ndef f(x): return x * 2.0 if x > -1.0 else g(x)\n"
    with pytest.raises(rj.MappingError):
        decoder(module(text)["f"])
    assert cache.info().compiled_anew == ()  # what does not compile is no program
    text = "T = np.full(20, 2.0)[::2]\ndef f(x): return x * T[7]\n"
    decoder(module(text)["f"])
    decoder(module(text)["f"])
    assert main(["cache", "info", "--json"]) == 0
    (noted,) = json.loads(capsys.readouterr().out)["compiled_anew"]
    assert noted["program"] == "m.mapping (decode)"
    assert noted["reasons"][0].startswith("f: `T` is an array")
    assert main(["cache", "info"]) == 0
    assert f"  m.mapping (decode)\n    {noted['reasons'][0]}\n" in capsys.readouterr().out
    assert cache.verify() == ()
    decoder(module(text.replace("[::2]", ""))["f"])
    assert (cache.info().compiled_anew, cache.info().entries) == ((), 1)


def test_a_damaged_note_is_no_note(cache):
    cache.put_note("0" * 64, "m.mapping (decode)", ("f: why",))
    (file,) = cache.folder.glob(f"*{NOTE}")
    file.write_bytes(file.read_bytes()[:-1])
    with pytest.warns(rj.CacheWarning, match="not used"):
        assert cache.info().compiled_anew == ()
    assert [found.name for found in cache.verify()] == [file.name]
    assert cache.clear() == 1


@pytest.mark.parametrize("backend", ["numba", "llvm", "python", "interpreter"])
def test_types_of_locals_count(cache, backend):
    """A program gives what the function gives that numba compiled, where a local is narrower than what is put in it."""

    def narrowed(x):
        y = x + 0.1
        return y * 1.0

    function = numba.njit(locals={"y": numba.float32})(narrowed)
    decode = rj.Decoder("m.mapping", schema=FILES, encoding="yarp4", functions={"f": function}, backend=backend)
    assert decode(message()).value == function(1.0) != narrowed(1.0)
