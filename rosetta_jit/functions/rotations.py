"""Rotations as quaternions, as angles about fixed axes, and as matrices.

Angles are those of ROS (REP 103): roll about x, then pitch about the fixed y, then yaw about the fixed z. A quaternion of any length but 0
stands for the rotation of the one of length 1. Formulas: Diebel, Representing attitude (2006), equations 125, 193, 290 and 297; from a
matrix after Shepperd, Quaternion from rotation matrix (1978).
"""

from __future__ import annotations

from rosetta_jit.functions.groups import called, group_function, inverted, product, rotated, row, square
from rosetta_jit.language.function import SEVERAL
from rosetta_jit.language.groups import numbers

ANGLES = numbers("a triple of angles", "roll|x", "pitch|y", "yaw|z", unit="radian")
QUATERNION = numbers("a quaternion", "x|qx", "y|qy", "z|qz", "w|qw")
MATRIX = numbers("a rotation matrix", *(f"m{row_}{column}" for row_ in range(3) for column in range(3)))
VECTOR = numbers("a vector", "x", "y", "z")

ONE_ROTATION = "a quaternion comes back with length 1, and perhaps as its negative, which is the same rotation"
RANGES = "angles come back within half a turn, the pitch within a quarter; where that is 90 degrees, the roll comes back as part of the yaw"

TO_QUATERNION = """
    sr = sin(angles.roll / 2)
    cr = cos(angles.roll / 2)
    sp = sin(angles.pitch / 2)
    cp = cos(angles.pitch / 2)
    sy = sin(angles.yaw / 2)
    cy = cos(angles.yaw / 2)
    x = sr * cp * cy - cr * sp * sy
    y = cr * sp * cy + sr * cp * sy
    z = cr * cp * sy - sr * sp * cy
    w = cr * cp * cy + sr * sp * sy
"""

TO_ANGLES = """
    n = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w
    forward = n - 2 * (q.y * q.y + q.z * q.z)
    left = 2 * (q.x * q.y + q.w * q.z)
    level = sqrt(forward * forward + left * left)
    locked = level <= 1e-10 * n
    roll = 0.0 if locked else atan2(2 * (q.w * q.x + q.y * q.z), n - 2 * (q.x * q.x + q.y * q.y))
    pitch = atan2(2 * (q.w * q.y - q.z * q.x), level)
    yaw = atan2(2 * q.w * q.z, q.w * q.w - q.z * q.z) if locked else atan2(left, forward)
"""

TO_MATRIX = (
    square("q")
    + """
    m00 = 1 - double * (q.y * q.y + q.z * q.z)
    m01 = double * (q.x * q.y - q.w * q.z)
    m02 = double * (q.x * q.z + q.w * q.y)
    m10 = double * (q.x * q.y + q.w * q.z)
    m11 = 1 - double * (q.x * q.x + q.z * q.z)
    m12 = double * (q.y * q.z - q.w * q.x)
    m20 = double * (q.x * q.z - q.w * q.y)
    m21 = double * (q.y * q.z + q.w * q.x)
    m22 = 1 - double * (q.x * q.x + q.y * q.y)
"""
)

OF_MATRIX = """
    tw = 1 + m.m00 + m.m11 + m.m22
    tx = 1 + m.m00 - m.m11 - m.m22
    ty = 1 - m.m00 + m.m11 - m.m22
    tz = 1 - m.m00 - m.m11 + m.m22
    most = max(tw, tx, ty, tz)
    by_w = tw == most
    by_x = tx == most
    by_y = ty == most
    half = 0.5 / sqrt(most)
    x = half * (m.m21 - m.m12 if by_w else tx if by_x else m.m01 + m.m10 if by_y else m.m02 + m.m20)
    y = half * (m.m02 - m.m20 if by_w else m.m01 + m.m10 if by_x else ty if by_y else m.m12 + m.m21)
    z = half * (m.m10 - m.m01 if by_w else m.m02 + m.m20 if by_x else m.m12 + m.m21 if by_y else tz)
    w = half * (tw if by_w else m.m21 - m.m12 if by_x else m.m02 - m.m20 if by_y else m.m10 - m.m01)
"""

GROUP_FUNCTIONS = (
    group_function(
        "quaternion",
        {"angles": ANGLES},
        QUATERNION,
        TO_QUATERNION,
        (lambda _, value: called("euler", value),),
        ONE_ROTATION,
        row(
            "`quaternion(roll, pitch, yaw)`",
            "three angles about the fixed axes x, y and z, in this order, in radians",
            "a quaternion: x, y, z, w",
        ),
    ),
    group_function(
        "euler",
        {"q": QUATERNION},
        ANGLES,
        TO_ANGLES,
        (lambda _, value: called("quaternion", value),),
        RANGES,
        row("`euler(q)`", "a quaternion", "roll, pitch and yaw in radians: pitch within ±π/2, the others within ±π"),
    ),
    group_function(
        "rotation_matrix",
        {"q": QUATERNION},
        MATRIX,
        TO_MATRIX,
        (lambda _, value: called("quaternion_of_matrix", value),),
        "a matrix that is no rotation comes back as one",
        row("`rotation_matrix(q)`", "a quaternion", "nine numbers, row by row"),
    ),
    group_function(
        "quaternion_of_matrix",
        {"m": MATRIX},
        QUATERNION,
        OF_MATRIX,
        (lambda _, value: called("rotation_matrix", value),),
        ONE_ROTATION,
        row("`quaternion_of_matrix(m)`", "nine numbers of a rotation, row by row", "a quaternion"),
    ),
    group_function(
        "compose_rotations",
        {"a": QUATERNION, "b": QUATERNION},
        QUATERNION,
        product("a", "b"),
        (
            lambda arguments, value: called("compose_rotations", value, called("invert_rotation", arguments[1])),
            lambda arguments, value: called("compose_rotations", called("invert_rotation", arguments[0]), value),
        ),
        "",
        row("`compose_rotations(a, b)`", "two quaternions", "the rotation `b` and then `a`, as a quaternion"),
    ),
    group_function(
        "invert_rotation",
        {"q": QUATERNION},
        QUATERNION,
        square("q") + inverted("q"),
        (lambda _, value: called("invert_rotation", value),),
        "",
        row("`invert_rotation(q)`", "a quaternion", "the one that turns back"),
    ),
    group_function(
        "rotate_vector",
        {"q": QUATERNION, "v": VECTOR},
        VECTOR,
        square("q") + rotated("q", "v", "r") + "\n x = r.x\n y = r.y\n z = r.z\n",
        (SEVERAL, lambda arguments, value: called("rotate_vector", called("invert_rotation", arguments[0]), value)),
        "",
        row("`rotate_vector(q, v)`", "a quaternion and a vector", "the vector turned: x, y, z"),
    ),
)

FUNCTIONS = tuple(each for function in GROUP_FUNCTIONS for each in function.components)
