"""Names of Lisp: in lower case, of letters, digits and hyphens, none a symbol of the language or of the runtime."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

from rosetta_jit.startup.dataclass import dataclass, field

HERE = Path(__file__).parent
API = HERE / "api.lisp"
NAME = "[a-z][a-z0-9-]*"
"""Of what may be called as something of a schema."""
PARTS = ("errors", "numbers", "kernels", "texts", "objects", "decimals", "host")
"""Of the runtime, in the order in which they need each other."""
MAX_NAME = 60
CONSTANT = re.compile(r"t|nil|pi|(most|least|boole|internal)-.*|.*-(limit|epsilon|keywords)")
"""Symbols of the language that no variable may be called."""

LISP_TYPES = {
    "bool": "boolean",
    **{f"{kind}{bits}": f"{kind}{bits}" for kind in "iu" for bits in (8, 16, 32, 64)},
    "f32": "f32",
    "f64": "f64",
}
"""By the kernel's names; the runtime defines those of numbers."""

PACKAGES = frozenset(
    {"cl", "cl-user", "common-lisp", "common-lisp-user", "keyword", "sequence"}
    | {"asdf", "asdf-action", "asdf-user", "asdf-utilities", "uiop"}
)
"""Names of packages and of systems that SBCL has already."""


@cache
def symbols() -> frozenset[str]:
    """The external symbols of the package `common-lisp` (ANSI INCITS 226, 1.9)."""
    return frozenset((HERE / "symbols.txt").read_text("utf-8").split())


@cache
def constants() -> frozenset[str]:
    """Those of them that are constants, which nothing can bind."""
    return frozenset(each for each in symbols() if CONSTANT.fullmatch(each))


@cache
def runtime_text() -> str:
    """What all units have, of a package that is not named yet."""
    return "\n".join((HERE / "runtime" / f"{part}.lisp").read_text("utf-8") for part in PARTS)


@cache
def runtime_names() -> frozenset[str]:
    """What the runtime and the functions that a program calls define, export, or make out of the names of numbers."""
    text = f"{runtime_text()}\n{API.read_text('utf-8')}"
    defined = re.findall(rf"\((?:def[a-z-]+|:constructor) \(?(?:setf )?({NAME})", text)
    exported = " ".join(re.findall(r"\(export '\(([^)]*)\)", text)).split()
    pairs = re.findall(rf"\(define-(?:rounding|saturating) {NAME} ({NAME})", text)
    numbers = [name for name in LISP_TYPES if name != "bool"]
    made = {form.format(name) for name in numbers for form in ("{}s", "append-{}s", "{}-rem", "{}-neg", "{}-abs")}
    structs = re.findall(rf"\(defstruct \(({NAME})", text)
    of_structs = {f"make-{struct}" for struct in structs} | {f"{struct}-{slot}" for struct in structs for slot in _slots(struct)}
    return frozenset((*defined, *exported, *pairs, *numbers, *made, *of_structs))


@cache
def codec_slots() -> frozenset[str]:
    """What the codecs of all units have."""
    return frozenset(_slots("codec-state"))


def _slots(struct: str) -> list[str]:
    """The slots of a structure: one a line with its type, or several names in a line."""
    found = re.search(rf"\(defstruct \({struct}\b.*?\n\n", runtime_text(), re.DOTALL)
    assert found is not None, struct
    lines = re.findall(rf"^  (?:\(({NAME}) .*|((?:{NAME} ?)+)\))$", found.group(), re.MULTILINE)
    return [name for one, several in lines for name in (one or several).split()]


@dataclass(slots=True)
class Names:
    """Symbols for names that come from schemas: of each name another, none that is reserved."""

    reserved: frozenset[str]
    found: dict[str, str] = field(default_factory=dict[str, str])
    taken: set[str] = field(default_factory=set[str])

    def symbol(self, key: str, *derived: str, wanted: str = "") -> str:
        """The symbol of a name, always the same one. ``derived`` are formats whose symbols are taken, too, as ``make-{}``."""
        if key not in self.found:
            start = hyphenated(wanted or key)
            candidate, number = start, 2
            while not self._are_free(every := [each.format(candidate) for each in derived or ("{}",)]):
                candidate = f"{start}-{number}"
                number += 1
            self.found[key] = candidate
            self.taken.update(every)
        return self.found[key]

    def _are_free(self, some: list[str]) -> bool:
        return not any(each in self.taken or each in self.reserved for each in some)


def hyphenated(name: str) -> str:
    """``JointState`` and ``joint_state`` as ``joint-state``; what is no letter or digit of ASCII becomes a hyphen."""
    apart = re.sub(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", "-", name)
    plain = re.sub(r"[^a-z0-9]+", "-", apart.lower())[:MAX_NAME].strip("-")
    return plain if plain[:1].isalpha() else f"v{plain}"


def package_of(name: str) -> str:
    """The package of a unit."""
    wanted = hyphenated(name)
    return f"{wanted}-messages" if wanted in PACKAGES or wanted.startswith("sb-") else wanted
