"""Places on the Earth: latitude, longitude and altitude above the ellipsoid of WGS84, and metres from an origin.

The way between goes through metres from the middle of the Earth (ECEF). The formulas of that: Hofmann-Wellenhof, Lichtenegger and Wasle,
GNSS (2008), section 8.2; back with Bowring's formula for the latitude, applied three times.
"""

from __future__ import annotations

from rosetta_jit.functions.groups import called, group_function, row
from rosetta_jit.language.function import SEVERAL
from rosetta_jit.language.groups import Group, Member, numbers

SEMI_MAJOR = 6378137.0
FLATTENING = 1 / 298.257223563
SEMI_MINOR = SEMI_MAJOR * (1 - FLATTENING)
ECCENTRICITY = FLATTENING * (2 - FLATTENING)
"""The square of the first eccentricity."""
SECOND = ECCENTRICITY / (1 - ECCENTRICITY)
"""The square of the second one."""

GEODETIC = Group(
    "a place on the Earth",
    (Member(("latitude", "lat"), "degree"), Member(("longitude", "lon"), "degree"), Member(("altitude", "alt", "height"), "meter")),
)
LOCAL = numbers("a place east, north and up of the origin", "east|x", "north|y", "up|z", unit="meter")


def _angles(place: str) -> str:
    """Sines and cosines of a latitude and a longitude: `sl`, `cl`, `so` and `co` behind the name of the place."""
    return f"""
        {place}.sl = sin(radians({place}.latitude))
        {place}.cl = cos(radians({place}.latitude))
        {place}.so = sin(radians({place}.longitude))
        {place}.co = cos(radians({place}.longitude))
    """


def _from_middle(place: str) -> str:
    """The metres from the middle of the Earth, of a place with `_angles`; `v` is the radius of curvature in the prime vertical."""
    return f"""
        {place}.v = {SEMI_MAJOR!r} / sqrt(1 - {ECCENTRICITY!r} * {place}.sl * {place}.sl)
        {place}.x = ({place}.v + {place}.altitude) * {place}.cl * {place}.co
        {place}.y = ({place}.v + {place}.altitude) * {place}.cl * {place}.so
        {place}.z = ({place}.v * {1 - ECCENTRICITY!r} + {place}.altitude) * {place}.sl
    """


TO_LOCAL = (
    _angles("place")
    + _angles("origin")
    + _from_middle("place")
    + _from_middle("origin")
    + """
        dx = place.x - origin.x
        dy = place.y - origin.y
        dz = place.z - origin.z
        away = origin.co * dx + origin.so * dy
        nan = sqrt(-1.0)
        there = abs(place.latitude) <= 90 and abs(origin.latitude) <= 90
        east = origin.co * dy - origin.so * dx if there else nan
        north = origin.cl * dz - origin.sl * away if there else nan
        up = origin.cl * away + origin.sl * dz if there else nan
    """
)

_BOWRING = "".join(
    f"""
        s{turn} = sin(b{turn})
        c{turn} = cos(b{turn})
        rise{turn} = z + {SECOND * SEMI_MINOR!r} * s{turn} * s{turn} * s{turn}
        run{turn} = level - {ECCENTRICITY * SEMI_MAJOR!r} * c{turn} * c{turn} * c{turn}
        b{turn + 1} = atan2({1 - FLATTENING!r} * rise{turn}, run{turn})
    """
    for turn in range(3)
)

TO_GEODETIC = (
    _angles("origin")
    + _from_middle("origin")
    + """
        away = origin.cl * local.up - origin.sl * local.north
        x = origin.x + origin.co * away - origin.so * local.east
        y = origin.y + origin.so * away + origin.co * local.east
        z = origin.z + origin.cl * local.north + origin.sl * local.up
        level = sqrt(x * x + y * y)
    """
    + f"""
        b0 = atan2(z, {1 - FLATTENING!r} * level)
    """
    + _BOWRING
    + f"""
        angle = atan2(rise2, run2)
        sine = sin(angle)
        nan = sqrt(-1.0)
        there = abs(origin.latitude) <= 90
        latitude = degrees(angle) if there else nan
        longitude = degrees(atan2(y, x)) if there else nan
        altitude = level * cos(angle) + z * sine - {SEMI_MAJOR!r} * sqrt(1 - {ECCENTRICITY!r} * sine * sine) if there else nan
    """
)

POLES = "longitudes come back within half a turn, at a pole as any, and beyond it as NaN"

GROUP_FUNCTIONS = (
    group_function(
        "enu",
        {"place": GEODETIC, "origin": GEODETIC},
        LOCAL,
        TO_LOCAL,
        (lambda arguments, value: called("geodetic", value, arguments[1]), SEVERAL),
        "",
        row(
            "`enu(place, origin)`",
            "latitude and longitude in degrees, and altitude in metres (WGS84), of a place and of an origin",
            "east, north and up of the origin, in metres; NaN beyond the poles",
        ),
    ),
    group_function(
        "geodetic",
        {"local": LOCAL, "origin": GEODETIC},
        GEODETIC,
        TO_GEODETIC,
        (lambda arguments, value: called("enu", value, arguments[1]), SEVERAL),
        POLES,
        row("`geodetic(local, origin)`", "east, north and up of an origin, in metres, and that origin", "latitude, longitude and altitude"),
    ),
)

FUNCTIONS = tuple(each for function in GROUP_FUNCTIONS for each in function.components)
