"""Types as plain data and back: what a cached program keeps so that a warm process rebuilds its holder without an IDL.

    {"declared": {name: Node}, "type": Node}          only what the type reaches
    Node  = {"is": class, attribute: Value, ...}      a class of the model; attributes that have their default are left out
    Value = Node | [Value, ...] | {"hex": bytes} | number | text | bool | null

All keys stand in the order of the alphabet: equal types are equal to the byte, however these data are written. Documentation and spans stay
behind: only the compiler reads them.
"""

from __future__ import annotations

from functools import cache
from itertools import repeat
from typing import Any, cast, get_args

from rosetta_jit.model import types
from rosetta_jit.model.limits import MAX_SERIAL_DEPTH

Plain = dict[str, Any]
"""What JSON can carry."""

LEFT_OUT = ("doc", "span")
NO_VALUE = object()
IS = "is"
SCALARS = frozenset((type(None), bool, int, float, str))
TYPES = {each.__name__: each for each in (*get_args(types.Type), types.Field, types.NamedConstant)}


def to_plain(type_: types.Type, schema: types.Schema) -> Plain:
    """The type and every declaration that it reaches, as plain data.

    Raises
    ------
    ValueError
        If types are written inside each other more than `MAX_SERIAL_DEPTH` deep.
    """
    pending: list[str] = []
    root = _plain(type_, pending, 0)
    declared: dict[str, object] = {}
    while pending:
        name = pending.pop()
        if name not in declared:
            declared[name] = _plain(schema.types[name], pending, 0)
    return {"declared": dict(sorted(declared.items())), "type": root}


def declared_in(plain: Plain, name: str, known: dict[str, list[str]]) -> Plain:
    """What `to_plain` gives for a declaration that a type reaches, out of the data of that type.

    ``known`` are the names that its declarations refer to, of those that were looked at.
    """
    every, pending, declared = plain["declared"], [name], dict[str, object]()
    while pending:
        each = pending.pop()
        if each not in declared:
            declared[each] = every[each]
            if each not in known:
                known[each] = _referred(every[each])
            pending += known[each]
    return {"declared": dict(sorted(declared.items())), "type": {IS: types.Ref.__name__, "name": name}}


def _referred(plain: object) -> list[str]:
    """The names that a declaration refers to."""
    names, pending = list[str](), [plain]
    for each in pending:  # which grows
        if isinstance(each, list):
            pending += cast("list[object]", each)
        elif isinstance(each, dict):
            node = cast("Plain", each)
            if node.get(IS) == types.Ref.__name__:
                names.append(node["name"])
            else:
                pending += node.values()
    return names


def from_plain(plain: Plain) -> tuple[types.Type, types.Schema]:
    """The type, and a schema of the declarations that it reaches; raises ValueError if the data is not what `to_plain` makes."""
    try:
        declared = {name: _value(each, 0) for name, each in plain["declared"].items()}
        root = _value(plain["type"], 0)
    except (KeyError, TypeError, AttributeError) as problem:
        raise ValueError(f"not a type: {problem}") from None
    if not isinstance(root, types.Type):
        raise ValueError(f"not a type: {root!r:.80}")  # noqa: TRY004 - a value of data, not of an argument
    return root, types.Schema({name: each for name, each in declared.items() if isinstance(each, types.Struct | types.Enum)})


def _plain(value: object, pending: list[str], depth: int) -> object:
    """A value of the model as plain data; to ``pending`` come the names that it refers to."""
    kind = type(value)
    if kind in SCALARS:
        return value
    if isinstance(value, int | float | str):
        return value
    if isinstance(value, bytes):
        return {"hex": value.hex()}
    if isinstance(value, tuple):
        return list(map(_plain, cast("tuple[object, ...]", value), repeat(pending), repeat(depth)))
    inner = _deeper(depth, kind)
    if isinstance(value, types.Ref):
        pending.append(value.name)
    plain: dict[str, object] = {}
    for name, default in _attributes(kind):
        if name == IS:
            plain[name] = kind.__name__
            continue
        attribute = cast("object", getattr(value, name))
        if attribute is not default and attribute != default:
            plain[name] = attribute if type(attribute) in SCALARS else _plain(attribute, pending, inner)
    return plain


def _value(plain: Any, depth: int) -> Any:
    """The value of the model that plain data stands for."""
    if isinstance(plain, list):
        return tuple(map(_value, cast("list[Any]", plain), repeat(depth)))
    if not isinstance(plain, dict):
        return plain
    attributes = cast("Plain", plain).copy()
    if "hex" in attributes:
        return bytes.fromhex(attributes["hex"])
    node = _class(attributes.pop(IS))
    inner = _deeper(depth, node)
    for name, each in attributes.items():
        if type(each) not in SCALARS:
            attributes[name] = _value(each, inner)
    return node(**attributes)


def _deeper(depth: int, node: type) -> int:
    """How deep the attributes of a node stand; a field is no level of its own."""
    if depth > MAX_SERIAL_DEPTH:
        raise ValueError(f"types nest more than {MAX_SERIAL_DEPTH} deep")
    return depth if node is types.Field else depth + 1


@cache
def _attributes(node: Any) -> tuple[tuple[str, object], ...]:
    """The names of what is kept of a class of the model, each with its default, or with `NO_VALUE`; `IS` among them, in order."""
    names: tuple[str, ...] = node.__match_args__
    defaults: tuple[object, ...] = node.__init__.__defaults__ or ()
    required = len(names) - len(defaults)
    kept = {name: NO_VALUE if at < required else defaults[at - required] for at, name in enumerate(names) if name not in LEFT_OUT}
    return tuple(sorted({IS: NO_VALUE, **kept}.items()))


@cache
def _class(word: str) -> Any:
    """The class of the model with that name. Few types have expressions: who reads none does not import them."""
    if word in TYPES:
        return TYPES[word]
    from rosetta_jit.model import expr

    found = vars(expr)[word]
    if found.__module__ != expr.__name__:
        raise KeyError(word)
    return found
