"""Any assignments and changes: holders behave as dicts and lists do."""

from __future__ import annotations

import sys
from pathlib import Path

from hypothesis import given, settings
from hypothesis import strategies as st

sys.path.insert(0, str(Path(__file__).parent))
from schemas import flat, whole

_PART = st.fixed_dictionaries(
    {"name": st.text(max_size=9), "values": st.lists(st.floats(allow_nan=False), max_size=4)},
    optional={"x": st.integers(-(2**63), 2**63 - 1)},
)
_FLAT = {
    "small": st.integers(-128, 127), "single": st.floats(width=32, allow_nan=False), "flag": st.booleans(), "kind": st.sampled_from("AB"),
    "angles": st.lists(st.floats(width=32, allow_nan=False), max_size=30), "text": st.text(), "data": st.binary(), "part": _PART,
    "parts": st.lists(_PART, max_size=4), "names": st.lists(st.text(max_size=5), max_size=4),
    "matrix": st.lists(st.lists(st.integers(0, 65535), max_size=3), max_size=3),
    "fixed": st.lists(st.integers(0, 9), min_size=3, max_size=3),
    "by_name": st.dictionaries(st.text(max_size=3), _PART, max_size=3),
    "counts": st.dictionaries(st.integers(-9, 9), st.integers(0, 9), max_size=3),
}  # fmt: skip


@settings(max_examples=60, deadline=None)
@given(st.lists(st.one_of([st.tuples(st.just(name), values) for name, values in _FLAT.items()]), max_size=25))
def test_any_assignments_behave_as_a_dict(assignments):
    holder, model = flat()(), flat()().to_dict()
    for name, value in assignments:
        setattr(holder, name, value)
        model[name] = value
        assert holder.to_dict() == model
    holder.lanes_.unsettle()
    holder.materialise()
    assert holder.to_dict() == model


_STEPS = ("append", "insert", "delete", "swap", "deepen", "settle", "replace", "rename")


@settings(max_examples=60, deadline=None)
@given(st.lists(st.tuples(st.sampled_from(_STEPS), st.integers(0, 5), st.integers(0, 5)), max_size=30))
def test_any_changes_of_a_tree_behave_as_lists(steps):
    """The same changes to recursive messages and to lists of ``[name, children]``."""
    holder, model = whole()(), ["", []]

    def child(index):
        at = index % len(model[1])
        return holder.children[at], model[1][at]

    for step, first, second in steps:
        if step == "append":
            holder.children.append({"text": str(first)})
            model[1].append([str(first), []])
        elif step == "insert":
            holder.children.insert(first, {"text": "i"})
            model[1].insert(first, ["i", []])
        elif step == "settle":
            holder.lanes_.unsettle()
            holder.materialise()
        elif model[1]:
            view, mirror = child(first)
            if step == "delete":
                del holder.children[first % len(model[1])]
                del model[1][first % len(model[1])]
            elif step == "swap":
                holder.children.reverse()
                model[1].reverse()
            elif step == "deepen":
                view.children.append({"text": f"{second}{'x' * second}"})
                mirror[1].append([f"{second}{'x' * second}", []])
            elif step == "replace":
                view.children = [{"text": "r"}] * second
                mirror[1][:] = [["r", []] for _ in range(second)]
            else:
                view.text = mirror[0] = "n" * (first * 7 + second)
        assert tree_of(holder) == model


def tree_of(message):
    return [message.text, [tree_of(each) for each in message.children]]
