"""Attributes that compiled code finds by their names are those that Python would find, whatever somebody does to a class."""

from __future__ import annotations

import pytest

import rosetta_jit as rj

TYPES = {"holder": "geometry_msgs/msg/Vector3", "view": "geometry_msgs/msg/Twist"}


@pytest.fixture(scope="module")
def types():
    return {name: rj.Decoder.of(type_, encoding="cdr").holder_type for name, type_ in TYPES.items()}


@pytest.fixture(params=TYPES)
def message(types, request):
    made = types[request.param]()
    return made if request.param == "holder" else made.linear


def not_interned(name):
    return bytearray(name, "ascii").decode()


def test_names_that_are_made_are_found(types):
    message = types["view"]().linear
    stamped = rj.Decoder.of("geometry_msgs/msg/Vector3Stamped", encoding="cdr").new()
    for name in ("x", "y", "z"):
        setattr(message, not_interned(name), 2.5)
        assert getattr(message, not_interned(name)) == 2.5
    setattr(stamped.header.stamp, not_interned("nanosec"), 7)
    assert getattr(stamped.header.stamp, not_interned("nanosec")) == 7


def test_what_is_no_attribute_is_none(message):
    for name in ("w", "xx", "", "\u00fc", "x" * 300):
        assert not hasattr(message, name)
        with pytest.raises(AttributeError):
            setattr(message, name, 1.0)
    with pytest.raises(AttributeError):
        del message.x
    with pytest.raises(TypeError):
        getattr(message, b"x")
    with pytest.raises((TypeError, ValueError)):
        message.x = "far"
    assert message.x == 0.0


def test_methods_and_class_attributes_are_found(message):
    assert message.to_dict() == {"x": 0.0, "y": 0.0, "z": 0.0}
    assert message.has("x")
    assert message.__class__ is type(message)
    assert message.access_.record is not None


@pytest.mark.parametrize("of", ["its class", "the class above"])
def test_a_class_that_is_changed_has_what_it_is_given(message, of):
    owner = type(message) if of == "its class" else next(each for each in type(message).__mro__ if "x" in vars(each))
    before, told = vars(owner).get("x"), []
    message.x = 1.0
    owner.x = property(lambda _: 9.0, lambda _, value: told.append(value))
    try:
        message.x = 3.0
        assert (message.x, told) == (9.0, [3.0])
    finally:
        if before is None:
            del owner.x
        else:
            owner.x = before
    assert message.x == 1.0
    message.x = 4.0
    assert (message.x, message.y) == (4.0, 0.0)


def test_what_a_derived_class_says_counts(types):
    class Derived(types["holder"]):
        @property
        def x(self):
            return 10.0 + super().x

        @x.setter
        def x(self, value):
            types["holder"].x.__set__(self, 2 * value)

        def __getattr__(self, name):
            return f"no {name}"

    made = Derived()
    made.x = 1.0
    made.more = 5
    made.y = 3.0
    assert (made.x, made.y, made.more, made.less) == (12.0, 3.0, 5, "no less")


def test_many_attributes_are_told_apart():
    fields = [f"field_{number}" for number in range(150)]
    made = rj.Decoder.of("test_msgs/Many", encoding="ros1", schema="\n".join(f"int32 {name}" for name in fields)).new()
    for number, name in enumerate(fields):
        setattr(made, name, number)
    assert [getattr(made, name) for name in fields] == list(range(150))
    assert made.to_dict() == {name: number for number, name in enumerate(fields)}
