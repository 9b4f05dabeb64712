"""Small mappings that have every construct of the language between them, in both directions: what they unpack is packed, and so is seen.

The wire and the holder are of one type, and `same names` maps what a mapping says nothing of.
"""

from __future__ import annotations

FIELDS = """int8 ONE=1
float64 a
float64 b
float64 c
float64 d
float32 f
int64 i
int64 j
int32 k
int16 h
uint8 u
uint32 w
bool p
bool q
string s
string t
float64[] xs
int32[] ks
int32[] ns
bool[] flags
uint8[] data
uint8[8] frame
string[] names
t/Pt[] ps
"""
FILES = {
    "t/Pt.msg": "float64 x\nint32 n\nstring name\n",
    "t/All.msg": FIELDS,
    "t/pt.mapping": """import "t/Pt.msg"
data-holder: t/Pt
wire-schema: t/Pt
rules:
  same names with .x <-> .x except .n
  .n <-> int32(-.n)
""",
}
HEAD = 'import "t/All.msg"\ndata-holder: t/All\nwire-schema: t/All\n'
REST = "  same names\n  ignore rest\n"


def both(unpack: str, pack: str = "", top: str = "") -> str:
    """A mapping of the rules to unpack and to pack; fields that they leave alone stay as they are."""
    return f"{HEAD}{top}unpack-rules:\n{unpack}{REST}pack-rules:\n{pack}{REST}"


Q, P = "[.a, .b, .c, .d]", "[.a, .b, .c, .d, .a, .b, .c]"

MAPPINGS = {
    "angles": both(
        "  .a = sin(.a)\n  .b = cos(.b)\n  .c = tan(.c)\n  .d = atan2(.a, .b)\n  .f = float32(asin(min(max(.c, -1.0), 1.0)))\n",
        "  .a = acos(min(max(.a, -1.0), 1.0))\n  .b = atan(.b)\n  .c = radians(.c)\n  .d = degrees(.d)\n",
    ),
    "numbers": both(
        "  .a = floor(.a)\n  .b = ceil(.b)\n  .c = round(.c)\n  .d = sqrt(abs(.d))\n  .p = isfinite(.a) and not isnan(.b)\n"
        "  .i = floor_divide(.k, 7) + modulo(.h, 5)\n  .j = align(abs(.h), 8)\n",
        "  .a = 2.0 * -.a / 3.0 - .b % 0.75\n  .k = .k if .p or .q else int32(others(3, 1, 2))\n  .b = divide(.b, 4.0)\n"
        "  .q = .a < .b and .k <= 7 or .c > .d and .h >= 3 or false\n",
    ),
    "integers": both(
        "  .i = (.i & 255) | (.j & 3) << 2\n  .j = .j >> 3\n  .k = int32(.i ^ .j, wrap)\n  .h = int16(.k, saturate)\n"
        "  .u = uint8(.a, saturate)\n  .f = float32(.d)\n",
        "  .i = int64(.a, round)\n  .j = int64(.b, truncate)\n  .p = .i == t/All.ONE\n  .q = .i != .j\n  .f = float32(.a * 0.0, exact)\n",
    ),
    "choices": both(
        '  .s = table(.h) { 0 = "zero", 1 = "one", otherwise "many" }\n  .p = true\n  .h = names[1] if .u > 3 else names[0]\n'
        '  reject "{.k} is too large" when .k > 1000000\n',
        "  when .p\n    .k = 1\n  else\n    .k = 2\n  end\n  .w = most\n  .f = .d\n  default .t\n",
        "parameter names: list of int16\nparameter most: uint32 = 3\nlimit: 4000000\nrounding: float32\n",
    ),
    "texts": both(
        '  .s = upper(strip(.s)) + "|" + lower(.t)\n  .t = replace(.t, "x", "yz")\n  .i = len(upper(.s))\n  .names = split(.s, "x")\n'
        '  .p = starts_with(.s, "x") or ends_with(.s, "y") or contains(.t, "z")\n',
        '  .s = join(.names, ",")\n  .t = slice(.t, 0, 1) if len(.t) > 0 else "no"\n  .q = .s == "x"\n',
    ),
    "parts": both(
        '  .s = before(text(.a) + ":", ":") if .p else "-"\n  .t = behind("x:" + .t, "x:")\n  .i = parts(.t, ";")\n',
        '  .s = text(.i) + ":" + text(.f, 3)\n  .i = integer(text(.k))\n  .a = number(text(.b))\n  .t = part(.t + ";x", ";", 0)\n',
    ),
    "bytes": both(
        '  .data = bytes(.s, "utf-16le")\n  .i = signal(.frame, "12|13@1-")\n  .j = int8_at(.frame, 0) + uint16_at(.frame, 1, true)\n'
        '  .w = crc(.data, "CRC-32")\n  .k = int32(xor(.frame[]))\n',
        '  .frame = signal_bytes(8, "0|8@1+", .u, "8|8@1+", .u)\n  .data = until_nul(padded(.t, 64))\n  .u = byte(.i, 2)\n',
    ),
    "moments": both(
        "  .s = iso8601(.k * 1000)\n  .a = timestamp(.i)\n  .j = seconds(.f)\n",
        '  .i = seconds("2026-11-21T10:08:42.5Z") + fraction(.f)\n  .j = nanoseconds(.f)\n',
    ),
    "reductions": both(
        "  .a = sum(.xs[])\n  .b = min(.xs[] where .xs[] > 0) if any(.xs[] > 0) else 0.0\n  .p = all(.xs[] > 0)\n"
        "  .i = count(.ks[] > 1)\n  .c = mean(.xs[]) if len(.xs) > 0 else 0.0\n  .d = max(.xs[]) if len(.xs) > 0 else 0.0\n",
        "  .xs[] = .xs[] * 2.0 where .xs[] > 0\n  .ps = .ps where index() % 2 == 0\n",
    ),
    "arrays": both(
        "  .xs[] = .ps[].x * 2.0\n  .ks[] = .ps[].n\n  .names = .names where len(.names[]) > 0\n",
        "  len(.ks) = 3\n  for n from 0 to 3\n    .ks[n] = int32(n)\n  end\n  .xs = .xs[0 to len(.xs) by 2]\n",
    ),
    "sequences": both(
        "  .ks = deltas(.ks)\n  .flags = bits(.data)\n  .ns = run_lengths(.ks)\n",
        "  .ks = running_sums(.ks)\n  .data = bit_bytes(.flags)\n  .ns = run_values(.ks)\n",
    ),
    "runs": both("  .xs = repeated(.xs, .ns)\n", "  .ns = run_lengths(.xs)\n  .xs = run_values(.xs)\n"),
    "keys": both(
        '  .a = .ps[.name = "x"].x if has(.ps[.name = "x"]) else 0.0\n', '  .ps = .ps via "t/pt.mapping"\n', 'import "t/pt.mapping"\n'
    ),
    "orders": both(
        "  .xs = reversed(.xs)\n  .frame = permuted(.frame, [1, 0])\n  .ks = transposed(.frame, 2, 4)\n",
        "  .frame = planar(.frame, 2)\n  .ks = rows(.frame, 2, 2, 3)\n  .ns = padded_rows(.frame, 2, 4, 5)\n"
        "  .data = interleaved(.frame, 2)\n",
    ),
    "views": both(
        "  .ks = numbers(.frame, int32)\n  .ns = upper_triangle(.frame[0 to 4], 2)\n",
        "  .data = number_bytes(.ks, int32)\n  .ks = symmetric(.frame[0 to 3], 2)\n",
    ),
    "rotations": both(
        f"  .a, .b, .c = euler({Q})\n  .d = compose_rotations({Q}, [0.0, 0.0, 0.0, 1.0]).w\n",
        f"  .a = rotation_matrix({Q}).m01\n  .b = quaternion(.a, .b, .c).x\n  .c = invert_rotation({Q}).x\n"
        f"  .d = rotate_vector({Q}, [.a, .b, .c]).y\n  .f = float32(quaternion_of_matrix(rotation_matrix({Q})).w)\n",
    ),
    "poses": both(
        f"  .a = compose_poses({P}, {P}).position.x\n  .b, .c, .d = position({P})\n  .f = float32(orientation({P}).w)\n",
        f"  .a = invert_pose({P}).position.y\n  .b = transform_point({P}, [.a, .b, .c]).z\n  .c = pose([.a, .b, .c], {Q}).orientation.x\n",
    ),
    "places": both(
        "  .a, .b, .c = enu([.a, .b, .c], [48.0, 11.0, 500.0])\n  .d = utm([.d, 11.0], 32).easting\n",
        "  .a, .b, .c = geodetic([.a, .b, .c], [48.0, 11.0, 500.0])\n  .d = geodetic_of_utm([.d, 5e6], 32).latitude\n",
    ),
    "colours": both('  .data = rgb_of(.frame, "bayer_rggb8", 4, 2)\n', '  .data = yuv_of(.data, "yuv422_yuy2", 4, 2)\n'),
    "relations": f"""{HEAD}rules:
  .a <-> .a * 2.0 + 1.0
  .s <-> .t
  .t <-> .s
  same names
""",
    "state": both(
        "  .a = .a - last\n  state last = .a\n  .i = .i + total\n  state total = total + 1\n",
        "  .a = .a + last\n  state last = .a\n",
        "state last: float64 = 0.5\nstate total: int64 = 0\n",
    ),
    "old": f"{HEAD}edition: 2012\nunpack-rules:\n  .f = .d\n  .f = .a\n  same names\npack-rules:\n  same names\n",
}
