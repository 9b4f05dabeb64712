"""Code written against protobuf's repeated fields and maps, run on them and on ours."""

from __future__ import annotations

import numpy as np
import pytest


def test_repeated_numbers(everything):
    message = everything()
    message.ints.append(1)
    message.ints.extend([2, 3, 4])
    message.ints.insert(1, 9)
    assert list(message.ints) == [1, 9, 2, 3, 4]
    assert message.ints.pop() == 4
    message.ints.remove(9)
    del message.ints[0]
    assert list(message.ints) == [2, 3]
    message.ints[0] = 5
    message.ints.sort()
    assert (list(message.ints), list(message.ints[:1]), message.ints[-1]) == ([3, 5], [3], 5)
    assert message.ints
    assert 5 in message.ints
    message.ints.MergeFrom([7])
    message.ints.reverse()
    assert list(message.ints) == [7, 5, 3]
    del message.ints[:]
    assert not message.ints
    message.colors.append(1)
    message.flags.extend([True, False])
    message.floats.extend([0.1, 2])
    assert (list(message.colors), list(message.flags)) == ([1], [True, False])
    assert list(message.floats) == [np.float32(0.1), 2.0]


@pytest.mark.parametrize(
    ("name", "value", "error"),
    [("ints", "a", TypeError), ("ints", 2**31, ValueError), ("ints", 1.5, TypeError), ("colors", 2, ValueError), ("texts", 1, TypeError),
     ("datas", "a", TypeError), ("inners", 1, TypeError), ("flags", "x", TypeError), ("floats", None, TypeError)],
)  # fmt: skip
def test_wrong_elements_are_refused(everything, name, value, error):
    message = everything()
    with pytest.raises(error):
        getattr(message, name).append(value)
    with pytest.raises(error):
        getattr(message, name).extend([value])
    assert len(getattr(message, name)) == 0


def test_repeated_strings(everything):
    message = everything()
    message.texts.extend(["a", "b", "c"])
    message.texts[1] = "longer than before"
    message.texts.insert(0, "z")
    del message.texts[1]
    assert message.texts == ["z", "longer than before", "c"]
    assert (message.texts[-1], message.texts[:2], message.texts.pop(0)) == ("c", ["z", "longer than before"], "z")
    message.texts.sort()
    assert list(message.texts) == ["c", "longer than before"]
    message.datas.append(b"\0")
    assert list(message.datas) == [b"\0"]
    with pytest.raises(IndexError):
        _ = message.texts[2]
    with pytest.raises(IndexError):
        message.texts[5] = "x"


def test_repeated_messages(everything):
    message = everything()
    added = message.inners.add(x=1)
    added.names.append("n")
    message.inners.extend([everything.Inner(x=2), everything.Inner(x=3)])
    message.inners.append(added)
    assert [each.x for each in message.inners] == [1, 2, 3, 1]
    message.inners[3].x = 4
    assert message.inners[0].x == 1
    message.inners.insert(0, everything.Inner(x=9))
    del message.inners[1:3]
    assert [each.x for each in message.inners] == [9, 3, 4]
    message.inners.sort(key=lambda each: each.x)
    message.inners.reverse()
    assert [each.x for each in message.inners] == [9, 4, 3]
    message.inners.remove(everything.Inner(x=3))
    message.inners.add(x=10)
    assert message.inners.pop().x == 10
    assert message.inners == [everything.Inner(x=9), everything.Inner(x=4, names=["n"])]
    with pytest.raises(TypeError):
        message.inners[0] = everything.Inner()
    with pytest.raises(TypeError):
        message.inners.append(everything())


def test_maps(everything):
    message = everything()
    message.counts["a"] = 1
    message.counts["b"] = 2
    message.counts["a"] = 3
    assert dict(message.counts) == {"a": 3, "b": 2}
    assert "a" in message.counts
    assert message.counts.get("z") is None
    assert len(message.counts) == 2
    del message.counts["a"]
    assert list(message.counts) == ["b"]
    message.by_id[7].x = 1
    message.by_id.get_or_create(8).x = 2
    assert sorted((key, value.x) for key, value in message.by_id.items()) == [(7, 1), (8, 2)]
    with pytest.raises(ValueError, match=r"assigned|directly"):
        message.by_id[7] = everything.Inner()
    with pytest.raises(TypeError):
        message.counts[1] = 1
    with pytest.raises(TypeError):
        message.counts["x"] = "y"
    assert message.counts["new"] == 0
    assert "new" in message.counts
    with pytest.raises(KeyError):
        del message.counts["zz"]
    assert (message.counts.setdefault("five", 5), message.counts.setdefault("five", 6)) == (5, 5)
    with pytest.raises(ValueError, match="must be set"):
        message.counts.setdefault("six")
    with pytest.raises(NotImplementedError):
        message.by_id.setdefault(7)


def test_a_list_in_place_of_a_slice(everything):
    message = everything(ints=[1, 2, 3])
    message.ints[0:2] = [7]
    assert list(message.ints) == [7, 3]
    message.ints[1:] = (8, 9)
    assert list(message.ints) == [7, 8, 9]
    message.ints[:0] = [5, 6]
    assert list(message.ints) == [5, 6, 7, 8, 9]
