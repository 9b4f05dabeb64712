"""What numba was taught by others: a function that may use it is not identified."""

from __future__ import annotations

import json
import subprocess
import sys

REGISTER = """
import json, math, operator, sys
import numba
from numba.core import types
from numba.core.imputils import lower_cast, lower_constant
from numba.core.rewrites import Rewrite, register_rewrite
from numba.core.typing.templates import AttributeTemplate, ConcreteTemplate, infer_getattr, infer_global, signature
from numba.extending import (
    intrinsic, lower_builtin, lower_getattr, models, overload, overload_attribute, overload_method, register_jitable, register_model,
    type_callable, typeof_impl,
)
from numba.experimental import jitclass
from rosetta_jit.backends.numba import function as ours, user_functions as functions
from rosetta_jit.runtime.functions.registered import doubts

class Own(types.Type): pass
class Value: pass
class Cases(ConcreteTemplate): cases = [signature(types.float64, types.float64)]
class Attributes(AttributeTemplate):
    key = types.Complex
    def resolve_own(self, value): return types.float64
class Anew(Rewrite):
    def match(self, *_): return False
class Model(models.OpaqueModel): pass
class Record:
    def __init__(self): self.a = 1.0
def mine(x): return x
def implemented(*_): return lambda x: x

@numba.njit
def used(x): return numba.typed.Dict.empty(types.int64, types.float64).get(1, x)
used(1.0)

everybodys = {
    "overload of C": lambda: overload(math.sin)(lambda x: implemented),
    "overload of an operator": lambda: overload(operator.add)(lambda a, b: None),
    "method": lambda: overload_method(types.Float, "own")(lambda x: implemented),
    "attribute": lambda: overload_attribute(types.Boolean, "own")(lambda x: implemented),
    "template": lambda: infer_global(math.cos)(Cases),
    "typer": lambda: type_callable(math.tan)(lambda context: implemented),
    "code": lambda: lower_builtin(math.exp, types.Float)(lambda *_: None),
    "conversion": lambda: lower_cast(types.Float, types.Integer)(lambda *_: None),
    "constant": lambda: lower_constant(types.UnicodeType)(lambda *_: None),
    "code of an attribute": lambda: lower_getattr(types.Array, "own")(lambda *_: None),
    "template of attributes": lambda: infer_getattr(Attributes),
    "type of an object": lambda: typeof_impl.register(int)(lambda *_: None),
    "layout": lambda: register_model(types.NoneType)(Model),
    "rewrite": lambda: register_rewrite("before-inference")(Anew),
}
own = {
    "function": lambda: overload(mine)(lambda x: implemented),
    "jitable": lambda: register_jitable(mine),
    "intrinsic": lambda: intrinsic(mine),
    "class": lambda: jitclass([("a", types.float64)])(Record)(),
    "type": lambda: register_model(Own)(Model),
    "method": lambda: overload_method(Own, "own")(lambda x: implemented),
    "object": lambda: typeof_impl.register(Value)(lambda *_: None),
}
found, known = {}, set(doubts())
found["none"] = sorted(known)
for name, register in (*((f"own {name}", each) for name, each in own.items()), *everybodys.items()):
    register()
    found[name] = sorted(set(doubts()) - known)
    known |= set(doubts())
json.dump(found, sys.stdout)
"""


def test_what_numba_was_taught():
    ran = subprocess.run([sys.executable, "-c", REGISTER], capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr
    found = json.loads(ran.stdout)
    assert {name for name, new in found.items() if not new} == {"none", *(name for name in found if name.startswith("own "))}
    assert found["overload of C"] == ["numba was taught in the process: `sin`"]


def test_nothing_is_asked_of_numba_that_is_not_imported():
    imports = "import sys; from rosetta_jit.runtime.functions.identity import identify"
    program = f"{imports}; print(identify(lambda x: x, 'f').digest, 'numba' in sys.modules)"
    ran = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    digest, imported = ran.stdout.split()
    assert (len(digest), imported) == (64, "False")
