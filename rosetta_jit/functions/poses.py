"""Poses: a position, and an orientation as a quaternion. `position` and `orientation` are also called `translation` and `rotation`."""

from __future__ import annotations

from rosetta_jit.functions.groups import called, group_function, inverted, product, rotated, row, square
from rosetta_jit.functions.rotations import QUATERNION, VECTOR
from rosetta_jit.language.function import SEVERAL
from rosetta_jit.language.groups import Group, Member

POSE = Group("a pose", (Member(("position", "translation"), group=VECTOR), Member(("orientation", "rotation"), group=QUATERNION)))

POSITION_OF = "\n".join(f"{each} = p.position.{each}" for each in "xyz")
ORIENTATION_OF = "\n".join(f"{each} = p.orientation.{each}" for each in "xyzw")
OF_BOTH = "\n".join((*(f"position.{each} = p.{each}" for each in "xyz"), *(f"orientation.{each} = q.{each}" for each in "xyzw")))

COMPOSED = (
    square("a.orientation")
    + rotated("a.orientation", "b.position", "r")
    + "\n".join(f"position.{each} = a.position.{each} + r.{each}" for each in "xyz")
    + product("a.orientation", "b.orientation", "orientation.")
)

INVERTED = (
    square("p.orientation")
    + inverted("p.orientation", "i.")
    + inverted("p.orientation", "orientation.")
    + "\n".join(f"back.{each} = -p.position.{each}" for each in "xyz")
    + square("i")
    + rotated("i", "back", "position")
)

MOVED = square("p.orientation") + rotated("p.orientation", "v", "r") + "\n".join(f"{each} = p.position.{each} + r.{each}" for each in "xyz")

GROUP_FUNCTIONS = (
    group_function(
        "pose",
        {"p": VECTOR, "q": QUATERNION},
        POSE,
        OF_BOTH,
        (lambda _, value: called("position", value), lambda _, value: called("orientation", value)),
        "",
        row("`pose(p, q)`", "a position and a quaternion", "the pose of both"),
        separates=True,
    ),
    group_function(
        "position",
        {"p": POSE},
        VECTOR,
        POSITION_OF,
        (SEVERAL,),
        "",
        row("`position(p)`, `orientation(p)`", "a pose", "its position; its orientation"),
    ),
    group_function(
        "orientation",
        {"p": POSE},
        QUATERNION,
        ORIENTATION_OF,
        (SEVERAL,),
        "",
        row("`position(p)`, `orientation(p)`", "a pose", "its position; its orientation"),
    ),
    group_function(
        "compose_poses",
        {"a": POSE, "b": POSE},
        POSE,
        COMPOSED,
        (
            lambda arguments, value: called("compose_poses", value, called("invert_pose", arguments[1])),
            lambda arguments, value: called("compose_poses", called("invert_pose", arguments[0]), value),
        ),
        "",
        row(
            "`compose_poses(a, b)`",
            "two poses",
            "the pose that `b` is in the frame in which `a` stands, where `b` is given in the frame that `a` is of",
        ),
    ),
    group_function(
        "invert_pose",
        {"p": POSE},
        POSE,
        INVERTED,
        (lambda _, value: called("invert_pose", value),),
        "",
        row("`invert_pose(p)`", "a pose of a frame in another", "the pose of that other one in it"),
    ),
    group_function(
        "transform_point",
        {"p": POSE, "v": VECTOR},
        VECTOR,
        MOVED,
        (SEVERAL, lambda arguments, value: called("transform_point", called("invert_pose", arguments[0]), value)),
        "",
        row(
            "`transform_point(p, v)`",
            "the pose of a frame, and a point in it",
            "the point in the frame in which the pose is given: x, y, z",
        ),
    ),
)

FUNCTIONS = tuple(each for function in GROUP_FUNCTIONS for each in function.components)
