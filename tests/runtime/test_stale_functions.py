"""A cached kernel with a user's function is used where all that the function reaches is the same, and nowhere else."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))
from function_kinds import KINDS, SHORT

RUN = """
import json, sys
from pathlib import Path
import rosetta_jit as rj
from rosetta_jit.pipeline.build import Build
from rosetta_jit.runtime.functions.identity import identify

files = {
    "s.bottle-schema": '"sensor" (("raw" :double))',
    "r.proto": 'syntax = "proto2"; message R { required double value = 1; }',
    "m.mapping": 'import "s.bottle-schema"\\nimport "r.proto"\\nfunction f(float64): float64\\n'
    "data-holder: R\\nwire-schema: sensor\\nunpack-rules:\\n  .value = f(.raw)\\n",
}
encode = rj.Encoder.of("sensor", schema=files, imports=["s.bottle-schema"], encoding="yarp4", backend="interpreter")
message = encode(encode.holder_type.from_dict({"raw": 1.0}))
compiled, image = [], Build.image
Build.image = lambda build: compiled.append(build) or image(build)


def decoded(name, function):
    own = {**files, "m.mapping": f"# {name}\\n" + files["m.mapping"]}
    before = len(compiled)
    decode = rj.Decoder("m.mapping", schema=own, encoding="yarp4", functions={"f": function})
    return identified(name, function), decode(message).value, len(compiled) - before


def identified(name, function):
    return identify(function, name).digest


answer = globals()[sys.argv[1]]
found = {}
for name, texts in json.load(sys.stdin).items():
    folder = Path(name).absolute()
    for file, text in texts.items():
        (folder / file).parent.mkdir(parents=True, exist_ok=True)
        (folder / file).write_text(text)
    sys.path.insert(0, str(folder))
    import fn
    found[name] = answer(name, fn.f)
    del sys.path[0]
    for module in [each for each, module in sys.modules.items() if (getattr(module, "__file__", None) or "").startswith(str(folder))]:
        del sys.modules[module]
json.dump(found, sys.stdout)
"""


def run(folder, answer, version, names):
    """What a process says of the functions of one version of the files."""
    texts = {name: {file: text.replace("$", str(version)) for file, text in KINDS[name].files.items()} for name in names}
    environment = {**os.environ, "ROSETTA_JIT_CACHE_DIR": str(folder / "cache"), "PYTHONDONTWRITEBYTECODE": "1"}
    command = [sys.executable, "-c", RUN, answer]
    ran = subprocess.run(command, env=environment, cwd=folder, input=json.dumps(texts), capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr
    return json.loads(ran.stdout)


def check_programs(folder, names):
    """Each program is compiled of the functions as they are, and again only where it must; those that come to the same share a kernel."""
    for version in (2, 3):
        found = run(folder, "decoded", version, names)
        once = {digest: name for name, (digest, *_) in reversed(found.items()) if digest is not None}
        assert {name: rest for name, (_, *rest) in found.items()} == {
            name: [float(version), int(digest is None or once[digest] == name)] for name, (digest, *_) in found.items()
        }
    again = run(folder, "decoded", 2, names)
    assert {name: rest for name, (_, *rest) in again.items()} == {name: [2.0, int(not KINDS[name].is_kept)] for name in names}


def test_no_kernel_is_stale(tmp_path):
    check_programs(tmp_path, SHORT)


@pytest.mark.campaign
def test_no_kernel_of_any_kind_is_stale(tmp_path):
    check_programs(tmp_path, list(KINDS))


def test_versions_are_told_apart_or_not_identified(tmp_path):
    kept = [name for name, kind in KINDS.items() if kind.is_kept]
    before, after, again = (
        run(tmp_path, "identified", 2, KINDS),
        run(tmp_path, "identified", 3, KINDS),
        run(tmp_path, "identified", 3, kept),
    )
    assert [name for name in KINDS if after[name] is not None] == kept
    assert {name: after[name] for name in kept} == again
    assert [name for name in kept if after[name] == before[name]] == []
