"""Functions whose meaning changes between two versions of their files: each multiplies by 2, and later by 3.

A kind is *kept* if the cache may keep its programs, and *anew* if nobody can tell one version from the other.
"""

from __future__ import annotations

from typing import NamedTuple


class Kind(NamedTuple):
    """Files, where ``$`` stands for the version's number, and whether the cache may keep programs that call their `f`."""

    is_kept: bool
    files: dict[str, str]


def kept(text, **modules):
    return Kind(True, {"fn.py": text, **{f"{name.replace('__', '/')}.py": module for name, module in modules.items()}})


def anew(text, **modules):
    return Kind(False, kept(text, **modules).files)


NJIT = "import numba\n@numba.njit\ndef {}\n"
F = "def f(x): return x * {}\n"
TABLE = "import numpy as np\nT = {}\ndef f(x): return x * T{}\n"

KINDS = {
    "constant in the code": kept("def f(x): return x * $.0\n"),
    "global": kept("K = $.0\n" + F.format("K")),
    "module constant": kept("import consts\n" + F.format("consts.K"), consts="K = $.0\n"),
    "constant of a module in a package": kept("import pkg.consts\n" + F.format("pkg.consts.K"), pkg__consts="K = $.0\n"),
    "constant five modules deep": kept("import a.b.c.d\n" + F.format("a.b.c.d.K"), a__b__c__d="K = $.0\n"),
    "function of a module in a package": kept(
        "import pkg.consts\ndef f(x): return pkg.consts.g(x)\n", pkg__consts=NJIT.format("g(x): return $.0 * x")
    ),
    "constant of a module that a callee uses": kept(
        "import pkg.a\ndef f(x): return pkg.a.g(x)\n", pkg__a="import pkg.b\n" + NJIT.format("g(x): return pkg.b.K * x"), pkg__b="K = $.0\n"
    ),
    "IntEnum member": kept("import enum\nclass M(enum.IntEnum):\n  A = $\ndef f(x): return x * (2.0 if M.A == 2 else 3.0)\n"),
    "IntEnum member's value": kept("import enum\nclass M(enum.IntEnum):\n  A = $\ndef f(x): return x * M.A.value\n"),
    "Enum member of a module": kept(
        "import pkg.m\ndef f(x): return x * pkg.m.M.A.value\n", pkg__m="import enum\nclass M(enum.Enum):\n  A = $.0\n"
    ),
    "a member as a global": kept("import enum\nclass M(enum.Enum):\n  A = $.0\nA = M.A\n" + F.format("A.value")),
    "numpy table": kept(TABLE.format("np.array([$.0])", "[0]")),
    "numpy scalar": kept(TABLE.format("np.float64($.0)", "")),
    "names of a record's fields": kept(
        TABLE.format("np.array([(2.0, 3.0)], [(name, 'f8') for name in ('ab' if $ == 2 else 'ba')])", "[0].a")
    ),
    "order of a table": kept(
        "import numpy as np\nT = np.array([[1.0, $.0], [2.0 if $ == 2 else 3.0, 4.0]])\ndef f(x): return x * T[0, 1]\n"
    ),
    "dtype of a table": kept(
        "import numpy as np\nT = np.array([200 + $]).astype('ui'[$ - 2] + '1')\ndef f(x): return x * (2.0 if T[0] > 0 else 3.0)\n"
    ),
    "closure": kept("def mk(k):\n  def f(x): return x * k\n  return f\nf = mk($.0)\n"),
    "module in a closure": kept("import consts\ndef mk(m):\n  def f(x): return x * m.K\n  return f\nf = mk(consts)\n", consts="K = $.0\n"),
    "inner function": kept("K = $.0\ndef f(x):\n  def g(y): return y * K\n  return g(x)\n"),
    "default of a callee": kept(NJIT.format("g(x, k=$.0): return x * k") + "def f(x): return g(x)\n"),
    "namedtuple": kept("from collections import namedtuple\nP = namedtuple('P', 'k')($.0)\ndef f(x): return x * P.k\n"),
    "fields of a namedtuple": kept(
        "from collections import namedtuple\nP = namedtuple('P', 'ab' if $ == 2 else 'ba')\n"
        "P = namedtuple('P', ['k', 'l'] if $ == 2 else ['l', 'k'])(2.0, 3.0)\ndef f(x): return x * P.k\n"
    ),
    "typing.NamedTuple": kept("from typing import NamedTuple\nclass P(NamedTuple):\n  k: float\nP = P($.0)\ndef f(x): return x * P.k\n"),
    "njit callee twice removed": kept(NJIT.format("h(x): return $.0 * x") + NJIT.format("g(x): return h(x)") + "def f(x): return g(x)\n"),
    "njit options": kept(
        "import numba\n@numba.njit(error_model='numpy' if $ == 3 else 'python')\n"
        "def f(x):\n  try:\n    return x * (3.0 if 1.0 / (x - 1.0) > 0 else 4.0)\n  except Exception:\n    return 2.0 * x\n"
    ),
    "njit options of a callee": kept(
        "import numba\n@numba.njit(error_model='numpy' if $ == 3 else 'python')\ndef g(x): return 1.0 / x\n"
        "def f(x):\n  try:\n    return x * (3.0 if g(x - 1.0) > 0 else 4.0)\n  except Exception:\n    return 2.0 * x\n"
    ),
    "types of locals of a callee": kept(
        "import numba\n@numba.njit(locals={'y': numba.int8 if $ == 3 else numba.int64})\ndef g(x):\n  y = int(x) + 255\n  return y\n"
        "def f(x): return x * (2.0 if g(x) == 256 else 3.0)\n"
    ),
    "types of locals": kept(
        "import numba\n@numba.njit(locals={'y': numba.int8 if $ == 3 else numba.int64})\n"
        "def f(x):\n  y = int(x) + 255\n  return x * (2.0 if y == 256 else 3.0)\n"
    ),
    "tuple": kept(
        "from numba import literal_unroll\nT = ($.0, 0)\ndef f(x):\n  s = 0.0\n  for t in literal_unroll(T): s += t * x\n  return s\n"
    ),
    "tuple of functions": kept(NJIT.format("g(x): return $.0 * x") + "T = (g, g)\ndef f(x): return T[1](x)\n"),
    "text": kept("S = 'xx' if $ == 2 else 'xxx'\n" + F.format("len(S)")),
    "bytes": kept("S = b'xx' if $ == 2 else b'xxx'\n" + F.format("len(S)")),
    "type of numba's": kept(
        "import numba\nT = numba.int8 if $ == 2 else numba.float64\ndef f(x): return x * (2.0 if T(2.5) == 2.0 else 3.0)\n"
    ),
    "class of numpy's": kept(
        "import numpy as np\nT = np.int8 if $ == 2 else np.float64\ndef f(x): return x * (2.0 if T(2.5) == 2.0 else 3.0)\n"
    ),
    "function of numpy's in the place of another": kept(
        "import numpy as np\nnp.isscalar_ = np.minimum if $ == 2 else np.maximum\ndef f(x): return x * np.isscalar_(2.0, 3.0)\n"
    ),
    "function of ours in the place of numpy's": kept(
        "import math\n" + NJIT.format("g(x): return x * $.0") + "math.twice = g\ndef f(x): return math.twice(x)\n"
    ),
    "a constant of numpy's, changed": kept("import math\nmath.own = $.0\n" + F.format("math.own")),
    "a built-in function, shadowed": kept(NJIT.format("abs(x): return x * $.0") + "def f(x): return abs(x)\n"),
    "a file called like a module of Python's": kept(
        "import pkg.math\ndef f(x): return pkg.math.g(x)\n", pkg__math=NJIT.format("g(x): return x * $.0")
    ),
    "exception": kept("class E(ValueError): pass\ndef f(x):\n  if x < 0:\n    raise E('no')\n  return x * $.0\n"),
    "not a number": kept(
        "import struct\nK = struct.unpack('<d', struct.pack('<Q', 0x7FF8000000000000 + $))[0]\n" + F.format("(K != K) * $.0")
    ),
    "vectorize": anew("import numba\n@numba.vectorize(['float64(float64)'])\ndef g(x): return x * $.0\ndef f(x): return g(x)\n"),
    "vectorize, dynamic": anew("import numba\n@numba.vectorize\ndef g(x): return x * $.0\ndef f(x): return g(x)\n"),
    "overload": anew(
        "import ext\ndef f(x): return ext.g(x)\n",
        ext="from numba.extending import overload\ndef g(x): return x * $.0\n@overload(g)\ndef o(x):\n  return lambda x: x * $.0\n",
    ),
    "register_jitable": anew(
        "from numba.extending import register_jitable\n@register_jitable\ndef g(x): return x * $.0\ndef f(x): return g(x)\n"
    ),
    "intrinsic": anew(
        "import numba\nfrom numba.extending import intrinsic\n@intrinsic\ndef g(context, x):\n"
        "  return x(x), lambda c, b, s, a: b.fmul(a[0], c.get_constant(numba.float64, $.0))\ndef f(x): return g(x)\n"
    ),
    "types that were chosen beforehand": anew("import numba\n@numba.njit('f8(f8)')\ndef g(x): return x * $.0\ndef f(x): return g(x)\n"),
    "a global that changed after numba compiled": anew(
        "import numba\nK = $.0\n@numba.njit('f8(f8)')\ndef g(x): return x * K\nK = 4.0\ndef f(x): return g(x)\n"
    ),
    "a function that was called before": anew(
        NJIT.format("g(x): return x * K").replace("@", "K = $.0\n@") + "g(1.0)\nK = 4.0\ndef f(x): return g(x)\n"
    ),
    "C function": anew("import ctypes\ng = ctypes.CFUNCTYPE(ctypes.c_double, ctypes.c_double)(lambda x: x * $.0)\ndef f(x): return g(x)\n"),
    "C function of a library": anew(
        "import ctypes\ng = getattr(ctypes.CDLL(None), 'floor' if $ == 2 else 'ceil')\ng.restype = ctypes.c_double\n"
        "g.argtypes = [ctypes.c_double]\ndef f(x): return x * g(2.5)\n"
    ),
    "a table that numba does not copy": anew(TABLE.format("np.full(200_000, $.0)", "[7]")),
    "a table with gaps": anew(TABLE.format("np.full(20, $.0)[::2]", "[7]")),
    "a file cache of numba's": anew(
        "import numba\nimport k\n@numba.njit(cache=True)\ndef g(x): return x * $.0\ndef f(x): return g(x)\n", k="K = $\n"
    ),
    "an enumeration with a value of its own": anew(
        "import enum\nclass M(enum.Enum):\n  A = 1\n  @property\n  def value(self): return $.0\ndef f(x): return x * M.A.value\n"
    ),
    "a module as a value": anew("import consts\ndef f(x):\n  m = consts\n  return x * m.K\n", consts="K = $.0\n"),
    "a module of a class of its own": anew(
        "import consts\n" + F.format("consts.K"),
        consts="import sys\nfrom types import ModuleType\nclass M(ModuleType):\n  @property\n  def K(self): return $.0\n"
        "sys.modules[__name__].__class__ = M\n",
    ),
    "a module of numpy's that makes attributes": anew(
        "import numpy as np\nmakes = np.__getattr__\nnp.__getattr__ = lambda name: $.0 if name == 'own' else makes(name)\n"
        + F.format("np.own")
    ),
    "a member in the place of another": anew(
        "import enum\nclass N(enum.Enum):\n  A = $.0\nclass M(enum.Enum):\n  A = 1.0\ntype.__setattr__(M, 'A', N.A)\n"
        + F.format("M.A.value")
    ),
    "a function in the namespace of numpy": kept(
        "import numba\nimport numpy as np\nexec('def own(x): return x * $.0', vars(np))\ng = numba.njit(np.own)\ndef f(x): return g(x)\n"
    ),
    "a wrapped function": anew(
        "import functools\ndef g(x): return x\ndef wrap(inner):\n  @functools.wraps(inner)\n  def f(x): return x * $.0\n"
        "  return f\nf = wrap(g)\n"
    ),
    "a function with attributes of one of numba's": kept(
        "import numba\n@numba.njit\ndef g(x): return x * 9.0\ndef f(x): return x * $.0 * 1.0\nf.py_func, f.targetoptions = g.py_func, {}\n"
    ),
    "closures in closures": kept(
        "import numba\ndef make(k):\n  def outer(m):\n    return numba.njit(lambda x: x * k * m)\n  return outer\n"
        "def around(g):\n  def f(x): return g(x)\n  return f\nf = around(make($.0)(1.0))\n"
    ),
    "a function that a text was made into": kept("exec(compile('def f(x): return x * %s + 0.0' % $.0, 'same.py', 'exec'))\n"),
    "names of all names of a module": kept(
        "from names import *\ndef f(x): return g(x)\n",
        names="from others import *\n",
        others="K = $.0\n" + NJIT.format("g(x): return x * K"),
    ),
    "a constant that another module has put there": kept(
        "import consts\nimport patch\n" + F.format("consts.K"), consts="K = 9.0\n", patch="import consts\nconsts.K = $.0\n"
    ),
    "a decorator of another module": kept(
        "import deco\n@deco.times\ndef f(x): return x\n",
        deco="import numba\ndef times(g):\n  g = numba.njit(g)\n  def f(x): return g(x) * $.0\n  return f\n",
    ),
    "another function's code": kept("def f(x): return x * 9.0\ndef h(x): return $.0 * x\nf.__code__ = h.__code__\n"),
    "a variable of a closure, changed": kept(
        "def make():\n  k = 9.0\n  def f(x): return x * k\n  def change(v):\n    nonlocal k\n    k = v\n  return f, change\n"
        "f, change = make()\nchange($.0)\n"
    ),
    "a table changed in place": kept(TABLE.format("np.array([9.0])", "[0]") + "T[0] = $.0\n"),
    "where the fields of a record lie": kept(
        "import numpy as np\nD = {'names': 'ab', 'formats': ['f8'] * 2, 'offsets': [0, 8] if $ == 2 else [8, 16], 'itemsize': 24}\n"
        "T = np.frombuffer(np.array([2.0, 3.0, 4.0]), D)\ndef f(x): return x * T[0].a\n"
    ),
    "a field of a record by its name": kept(
        TABLE.format("np.array([(2.0, 3.0)], [('a', 'f8'), ('b', 'f8')])", "[0]").replace("x * T[0]", "x * getattr(T[0], N)")
        + "N = 'ab'[$ - 2]\n"
    ),
    "a function of numba's as a default": kept(
        NJIT.format("h(x): return x * $.0") + "@numba.njit\ndef g(x, k=h): return k(x)\ndef f(x): return g(x)\n"
    ),
    "a generator": kept(
        "K = $.0\n" + NJIT.format("each(x):\n  yield x * K") + "def f(x):\n  for y in each(x):\n    return y\n  return 0.0\n"
    ),
    "what a compiler shows and what it compiles": anew(
        NJIT.format("g(x): return x * $.0") + "def h(x): return x * 9.0\ng.py_func = h\ndef f(x): return g(x)\n"
    ),
    "an attribute that a module makes": anew(
        "import consts\n" + F.format("consts.K"),
        consts="def __getattr__(name):\n  if name != 'K':\n    raise AttributeError(name)\n  return $.0\n",
    ),
    "a module that is executed when it is used": anew(
        "import importlib.util\nspec = importlib.util.find_spec('consts')\nspec.loader = importlib.util.LazyLoader(spec.loader)\n"
        "consts = importlib.util.module_from_spec(spec)\nspec.loader.exec_module(consts)\n" + F.format("consts.K"),
        consts="K = $.0\n",
    ),
    "an attribute by its name": anew("import consts\ndef f(x): return x * getattr(consts, 'K')\n", consts="K = $.0\n"),
    "a number of a class of the user's": anew("class Number(float): pass\nK = Number($)\n" + F.format("K")),
}

SHORT = ("function of a module in a package", "IntEnum member's value", "overload")
"""Those of which programs are made each time that the tests run; `make campaign` makes those of all."""
