"""Places on the Earth as metres east and north within a zone of UTM (the universal transverse Mercator projection), and back.

The projection is Krüger's series to the sixth order in the third flattening of WGS84, as in Karney, Transverse Mercator with an accuracy
of a few nanometers (2011), equations 7 to 36. In the definitions `t` is the tangent of the latitude, `tc` that of the conformal latitude;
`xi` and `eta` are northing and easting in units of the sphere, and `xip` and `etap` the same before the series is added.

Hyperbolic functions are made of square roots and short power series: arguments are halved until the series reach the last bit of a float64.
"""

from __future__ import annotations

from math import factorial, sqrt

from rosetta_jit.functions.geodesy import ECCENTRICITY, FLATTENING, POLES, SEMI_MAJOR
from rosetta_jit.functions.groups import called, group_function, row
from rosetta_jit.language.function import SEVERAL
from rosetta_jit.language.groups import Group, Member

THIRD = FLATTENING / (2 - FLATTENING)
"""The third flattening, (a - b) / (a + b)."""
RADIUS = SEMI_MAJOR / (1 + THIRD) * (1 + THIRD**2 / 4 + THIRD**4 / 64 + THIRD**6 / 256)
"""The radius of the sphere that has a meridian of the ellipsoid's length, in metres."""
SCALE = 0.9996 * RADIUS
FALSE_EASTING = 500000.0
FALSE_NORTHING = 10000000.0
"""What is added in the southern hemisphere, in metres."""
FARTHEST = 0.9
"""How far from the zone's meridian places are computed, in units of the sphere: about 5700 km."""

FORWARD = (
    (1 / 2, -2 / 3, 5 / 16, 41 / 180, -127 / 288, 7891 / 37800),
    (13 / 48, -3 / 5, 557 / 1440, 281 / 630, -1983433 / 1935360),
    (61 / 240, -103 / 140, 15061 / 26880, 167603 / 181440),
    (49561 / 161280, -179 / 168, 6601661 / 7257600),
    (34729 / 80640, -3418889 / 1995840),
    (212378941 / 319334400,),
)
"""Karney's equation 35: row j has the coefficients of n^j, n^(j + 1), …, which make alpha j."""
BACKWARD = (
    (1 / 2, -2 / 3, 37 / 96, -1 / 360, -81 / 512, 96199 / 604800),
    (1 / 48, 1 / 15, -437 / 1440, 46 / 105, -1118711 / 3870720),
    (17 / 480, -37 / 840, -209 / 4480, 5569 / 90720),
    (4397 / 161280, -11 / 504, -830251 / 7257600),
    (4583 / 161280, -108847 / 3991680),
    (20648693 / 638668800,),
)
"""Karney's equation 36: beta, in the same way."""

PLACE = Group("a latitude and a longitude", (Member(("latitude", "lat"), "degree"), Member(("longitude", "lon"), "degree")))
GRID = Group("a place in a zone", (Member(("easting", "east", "x"), "meter"), Member(("northing", "north", "y"), "meter")))
ZONE = Group("a zone of UTM", (Member(("zone",)),))

FAR = "; NaN far from the zone, and of a number that is none"
NOWHERE = "; NaN far from the zone, beyond the poles, and of a number that is none"


def _polynomial(x: str, coefficients: list[float]) -> str:
    """The text of a polynomial in Horner's scheme, from the constant on."""
    *rest, text = [repr(each) for each in coefficients]
    for each in reversed(rest):
        text = f"({each} + {x} * {text})"
    return text


def _sum_of_sines(coefficients: tuple[tuple[float, ...], ...]) -> str:
    """The sum of c j * sin(2 j z) over j, z complex, by Clenshaw's recurrence: its real part `re`, its imaginary part `im`.

    `s2`, `c2`, `sh2` and `ch2` are the sine and cosine of twice the real part of z, and the hyperbolic ones of twice the imaginary part.
    """
    summed = [sum(each * THIRD ** (number + power) for power, each in enumerate(row)) for number, row in enumerate(coefficients, 1)]
    lines = ["ar = 2 * c2 * ch2", "ai = -2 * s2 * sh2", f"r6 = {summed[5]!r}", "i6 = 0.0", "r7 = 0.0", "i7 = 0.0"]
    for j in range(5, 0, -1):
        lines.append(f"r{j} = {summed[j - 1]!r} + ar * r{j + 1} - ai * i{j + 1} - r{j + 2}")
        lines.append(f"i{j} = ar * i{j + 1} + ai * r{j + 1} - i{j + 2}")
    lines += ["re = r1 * s2 * ch2 - i1 * c2 * sh2", "im = r1 * c2 * sh2 + i1 * s2 * ch2"]
    return "\n".join(lines)


def _conformal(t: str, to: str) -> str:
    """The tangent of the conformal latitude, of that of the latitude (equations 7 to 9).

    Below, `g` is e artanh(e sin(latitude)), at most 0.0067, as a power series, and `sg` its hyperbolic sine.
    """
    g = _polynomial(f"{to}.q", [1 / (2 * power + 1) for power in range(8)])
    sg = _polynomial(f"{to}.g2", [1 / factorial(2 * power + 1) for power in range(4)])
    return f"""
        {to}.h = sqrt(1 + {t} * {t})
        {to}.s = {t} / {to}.h
        {to}.q = {ECCENTRICITY!r} * {to}.s * {to}.s
        {to}.g = {ECCENTRICITY!r} * {to}.s * {g}
        {to}.g2 = {to}.g * {to}.g
        {to}.sg = {to}.g * {sg}
        {to} = {t} * sqrt(1 + {to}.sg * {to}.sg) - {to}.sg * {to}.h
    """


def _hyperbolic(x: str, to: str) -> str:
    """The hyperbolic sine `to.sh` and cosine `to.ch` of at most 1, from those of a quarter of it."""
    series = _polynomial(f"{to}.z", [1 / factorial(2 * power + 1) for power in range(6)])
    return f"""
        {to}.x = 0.25 * {x}
        {to}.z = {to}.x * {to}.x
        {to}.s4 = {to}.x * {series}
        {to}.s2 = 2 * {to}.s4 * sqrt(1 + {to}.s4 * {to}.s4)
        {to}.c2 = sqrt(1 + {to}.s2 * {to}.s2)
        {to}.sh = 2 * {to}.s2 * {to}.c2
        {to}.ch = 1 + 2 * {to}.s2 * {to}.s2
    """


def _halved(number: int) -> str:
    """`h` of the next number: the hyperbolic sine of half of what `h` is that of."""
    return f"h{number + 1} = h{number} / sqrt(2 + 2 * sqrt(1 + h{number} * h{number}))"


ARSINH = [(-1) ** n * factorial(2 * n) / (4**n * factorial(n) ** 2 * (2 * n + 1)) for n in range(9)]
"""The coefficients of the inverse hyperbolic sine, of odd powers from the first on."""

MERIDIAN = """
    number = abs(zone.zone)
    known = number >= 1 and number <= 60 and floor(number) == number
    meridian = 6 * number - 183
"""

TO_GRID = (
    MERIDIAN
    + """
        away = radians(place.longitude - meridian)
        t = tan(radians(place.latitude))
    """
    + _conformal("t", "tc")
    + """
        ca = cos(away)
        level = sqrt(tc * tc + ca * ca)
        h0 = sin(away) / level
        near = known and abs(h0) <= 1 and abs(place.latitude) <= 90
        sx = tc / level
        cx = ca / level
        s2 = 2 * sx * cx
        c2 = 1 - 2 * sx * sx
        sh2 = 2 * h0 * sqrt(1 + h0 * h0)
        ch2 = 1 + 2 * h0 * h0
    """
    + _sum_of_sines(FORWARD)
    + "\n"
    + "\n".join(_halved(number) for number in range(3))
    + f"""
        z = h3 * h3
        etap = 8 * h3 * {_polynomial("z", ARSINH)}
        xip = atan2(tc, ca)
        nan = sqrt(-1.0)
        easting = {FALSE_EASTING!r} + {SCALE!r} * (etap + im) if near else nan
        northing = ({FALSE_NORTHING!r} if zone.zone < 0 else 0.0) + {SCALE!r} * (xip + re) if near else nan
    """
)


def _newton(turn: int) -> str:
    """A step of Newton's method from the tangent of the conformal latitude to that of the latitude (equations 19 to 21)."""
    t, tc = f"t{turn}", f"v{turn}"
    slope = f"(1 + {1 - ECCENTRICITY!r} * {t} * {t}) / ({1 - ECCENTRICITY!r} * sqrt(1 + {t} * {t}))"
    return _conformal(t, tc) + f"\n t{turn + 1} = {t} + (tc - {tc}) / sqrt(1 + {tc} * {tc}) * {slope}\n"


TO_PLACE = (
    MERIDIAN
    + f"""
        eta = (grid.easting - {FALSE_EASTING!r}) / {SCALE!r}
        xi = (grid.northing - ({FALSE_NORTHING!r} if zone.zone < 0 else 0.0)) / {SCALE!r}
        near = known and abs(eta) <= {FARTHEST!r}
        s2 = sin(2 * xi)
        c2 = cos(2 * xi)
    """
    + _hyperbolic("eta", "e")
    + """
        sh2 = 2 * e.sh * e.ch
        ch2 = 1 + 2 * e.sh * e.sh
    """
    + _sum_of_sines(BACKWARD)
    + """
        xip = xi - re
        etap = eta - im
        sx = sin(xip)
        cx = cos(xip)
    """
    + _hyperbolic("etap", "p")
    + f"""
        tc = sx / sqrt(p.sh * p.sh + cx * cx)
        t0 = tc / {sqrt(1 - ECCENTRICITY)!r}
    """
    + "".join(_newton(turn) for turn in range(3))
    + """
        nan = sqrt(-1.0)
        east = meridian + degrees(atan2(p.sh, cx))
        latitude = degrees(atan(t3)) if near else nan
        longitude = (east - 360 if east > 180 else east + 360 if east < -180 else east) if near else nan
    """
)

ZONES = "the number of a zone, 1 to 60, negative in the southern hemisphere"

GROUP_FUNCTIONS = (
    group_function(
        "utm",
        {"place": PLACE, "zone": ZONE},
        GRID,
        TO_GRID,
        (lambda arguments, value: called("geodetic_of_utm", value, arguments[1]), SEVERAL),
        "",
        row("`utm(place, zone)`", f"latitude and longitude in degrees (WGS84), and {ZONES}", f"easting and northing in metres{NOWHERE}"),
    ),
    group_function(
        "geodetic_of_utm",
        {"grid": GRID, "zone": ZONE},
        PLACE,
        TO_PLACE,
        (lambda arguments, value: called("utm", value, arguments[1]), SEVERAL),
        f"{POLES}, as those far from the zone do",
        row("`geodetic_of_utm(grid, zone)`", "easting and northing in a zone, and its number", f"latitude and longitude in degrees{FAR}"),
    ),
)

FUNCTIONS = tuple(each for function in GROUP_FUNCTIONS for each in function.components)
