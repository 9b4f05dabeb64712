/* What generated functions call. Each section becomes part of a file that needs it; `$name` stands for each of the words behind `name:`, `$static` for what functions are. */

/* == failure == */
/* Where and why a message cannot be read or written. `site` is a row of the table of sites, as wide as the machine counts best; 0 stands for a lane without room. */
struct failure {
    ptrdiff_t site;
    int64_t offset;
    int64_t indices[4];
};

/* == fail | needs: failure == */
static int64_t fail(struct failure *failure, ptrdiff_t site, int64_t offset)
{
    failure->site = site;
    failure->offset = offset;
    return -1 - site;
}

/* == fail_here | needs: failure == */
/* Where a message cannot be read, in a function that many places share: they know what its sites are. */
static int64_t fail_here(struct failure *failure, ptrdiff_t site, int64_t offset)
{
    failure->offset = offset;
    return site;
}

/* == full | needs: failure == */
/* A lane lacks room. */
static int64_t full(struct failure *failure, ptrdiff_t lane, int64_t missing)
{
    failure->site = 0;
    failure->offset = lane;
    failure->indices[0] = missing;
    return -1;
}

/* == lacks == */
/* Whether some of `size` bytes from `at` are missing before `end`, which is not negative: without a sign, negative numbers are large. */
static inline bool lacks(int64_t at, int64_t size, int64_t end)
{
    return (uint64_t)at > (uint64_t)end || (uint64_t)size > (uint64_t)end - (uint64_t)at;
}

/* == lacks_behind == */
/* Whether some of `size` bytes from `at` are missing before `end`: `at` is known to lie in the message, or to be its end. */
static inline bool lacks_behind(int64_t at, int64_t size, int64_t end)
{
    return (uint64_t)size > (uint64_t)(end - at);
}

/* == bytes_of == */
static inline int64_t bytes_of(int64_t rows, int64_t stride)
{
    return rows > INT64_MAX / stride ? INT64_MAX : rows * stride;
}

/* == host_order == */
/* The order of bytes in this machine's numbers, where the compiler says it; elsewhere they are put together one by one. */
#if defined(__GNUC__) && defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
#define IN_ORDER_le(bits, number) (number)
#define IN_ORDER_be(bits, number) (__builtin_bswap##bits(number))
#define HAS_ORDER 1
#elif defined(__GNUC__) && defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
#define IN_ORDER_le(bits, number) (__builtin_bswap##bits(number))
#define IN_ORDER_be(bits, number) (number)
#define HAS_ORDER 1
#else
#define HAS_ORDER 0
#endif

/* == load_u8 == */
static inline uint8_t load_u8(const unsigned char *at)
{
    return *at;
}

/* == load_i8 == */
static inline int8_t load_i8(const unsigned char *at)
{
    return (int8_t)*at;
}

/* == load_bool == */
static inline bool load_bool(const unsigned char *at)
{
    return *at != 0;
}

/* == load_u${bits}_le | bits: 16 32 64 | needs: host_order == */
${static} uint${bits}_t load_u${bits}_le(const unsigned char *at)
{
#if HAS_ORDER
    uint${bits}_t number;
    memcpy(&number, at, sizeof number);
    return IN_ORDER_le(${bits}, number);
#else
    uint64_t number = 0;
    for (int byte = ${bits} / 8 - 1; byte >= 0; byte--) {
        number = number << 8 | at[byte];
    }
    return (uint${bits}_t)number;
#endif
}

/* == load_u${bits}_be | bits: 16 32 64 | needs: host_order == */
${static} uint${bits}_t load_u${bits}_be(const unsigned char *at)
{
#if HAS_ORDER
    uint${bits}_t number;
    memcpy(&number, at, sizeof number);
    return IN_ORDER_be(${bits}, number);
#else
    uint64_t number = 0;
    for (int byte = 0; byte < ${bits} / 8; byte++) {
        number = number << 8 | at[byte];
    }
    return (uint${bits}_t)number;
#endif
}

/* == load_i${bits}_${order} | bits: 16 32 64 | order: le be | needs: load_u${bits}_${order} == */
static inline int${bits}_t load_i${bits}_${order}(const unsigned char *at)
{
    return (int${bits}_t)load_u${bits}_${order}(at);
}

/* == load_f${bits}_${order} | bits: 32 64 | order: le be | needs: load_u${bits}_${order} float${bits}_of == */
static inline ${real} load_f${bits}_${order}(const unsigned char *at)
{
    return float${bits}_of(load_u${bits}_${order}(at));
}

/* == store_u8 == */
static inline void store_u8(unsigned char *at, uint8_t number)
{
    *at = number;
}

/* == store_i8 == */
static inline void store_i8(unsigned char *at, int8_t number)
{
    *at = (unsigned char)number;
}

/* == store_bool == */
static inline void store_bool(unsigned char *at, bool holds)
{
    *at = holds ? 1 : 0;
}

/* == store_u${bits}_le | bits: 16 32 64 | needs: host_order == */
${static} void store_u${bits}_le(unsigned char *at, uint${bits}_t number)
{
#if HAS_ORDER
    const uint${bits}_t ordered = IN_ORDER_le(${bits}, number);
    memcpy(at, &ordered, sizeof ordered);
#else
    for (int byte = 0; byte < ${bits} / 8; byte++) {
        at[byte] = (unsigned char)(number >> (8 * byte) & 255u);
    }
#endif
}

/* == store_u${bits}_be | bits: 16 32 64 | needs: host_order == */
${static} void store_u${bits}_be(unsigned char *at, uint${bits}_t number)
{
#if HAS_ORDER
    const uint${bits}_t ordered = IN_ORDER_be(${bits}, number);
    memcpy(at, &ordered, sizeof ordered);
#else
    for (int byte = 0; byte < ${bits} / 8; byte++) {
        at[byte] = (unsigned char)(number >> (${bits} - 8 - 8 * byte) & 255u);
    }
#endif
}

/* == store_i${bits}_${order} | bits: 16 32 64 | order: le be | needs: store_u${bits}_${order} == */
static inline void store_i${bits}_${order}(unsigned char *at, int${bits}_t number)
{
    store_u${bits}_${order}(at, (uint${bits}_t)number);
}

/* == store_f${bits}_${order} | bits: 32 64 | order: le be | needs: store_u${bits}_${order} bits_of_f${bits} == */
static inline void store_f${bits}_${order}(unsigned char *at, ${real} number)
{
    store_u${bits}_${order}(at, bits_of_f${bits}(number));
}

/* == float${bits}_of | bits: 32 64 == */
static inline ${real} float${bits}_of(uint${bits}_t bits)
{
    ${real} number;
    memcpy(&number, &bits, sizeof number);
    return number;
}

/* == bits_of_f${bits} | bits: 32 64 == */
static inline uint${bits}_t bits_of_f${bits}(${real} number)
{
    uint${bits}_t bits;
    memcpy(&bits, &number, sizeof bits);
    return bits;
}

/* == get_${scalar} | scalar: i8 u8 i16 u16 i32 u32 i64 u64 f32 f64 == */
/* A number in a lane's bytes, as this machine has it. */
static inline ${ctype} get_${scalar}(const void *lane, int64_t at)
{
    ${ctype} number;
    memcpy(&number, (const unsigned char *)lane + at, sizeof number);
    return number;
}

/* == get_bool == */
static inline bool get_bool(const void *lane, int64_t at)
{
    return ((const unsigned char *)lane)[at] != 0;
}

/* == set_${scalar} | scalar: i8 u8 i16 u16 i32 u32 i64 u64 f32 f64 == */
static inline void set_${scalar}(void *lane, int64_t at, ${ctype} number)
{
    memcpy((unsigned char *)lane + at, &number, sizeof number);
}

/* == set_bool == */
static inline void set_bool(void *lane, int64_t at, bool holds)
{
    ((unsigned char *)lane)[at] = holds ? 1 : 0;
}

/* == copy_bytes == */
static inline void copy_bytes(void *target, int64_t to, const void *source, int64_t from, int64_t size)
{
    if (size > 0) {
        memcpy((unsigned char *)target + to, (const unsigned char *)source + from, (size_t)size);
    }
}

/* == fill_bytes == */
static inline void fill_bytes(void *target, int64_t to, int64_t size, int byte)
{
    if (size > 0) {
        memset((unsigned char *)target + to, byte, (size_t)size);
    }
}

/* == ${least}_${scalar} | least: min | scalar: bool i8 u8 i16 u16 i32 u32 i64 u64 f32 f64 == */
static inline ${ctype} ${least}_${scalar}(${ctype} left, ${ctype} right)
{
    return left < right ? left : right;
}

/* == ${most}_${scalar} | most: max | scalar: bool i8 u8 i16 u16 i32 u32 i64 u64 f32 f64 == */
static inline ${ctype} ${most}_${scalar}(${ctype} left, ${ctype} right)
{
    return left > right ? left : right;
}

/* == abs_i${bits} | bits: 8 16 32 64 == */
static inline int${bits}_t abs_i${bits}(int${bits}_t number)
{
    return (int${bits}_t)(number < 0 ? -number : number);
}

/* == fits_add == */
static inline bool fits_add(int64_t left, int64_t right)
{
    return right >= 0 ? left <= INT64_MAX - right : left >= INT64_MIN - right;
}

/* == fits_sub == */
static inline bool fits_sub(int64_t left, int64_t right)
{
    return right >= 0 ? left >= INT64_MIN + right : left <= INT64_MAX + right;
}

/* == fits_mul == */
static inline bool fits_mul(int64_t left, int64_t right)
{
    if (left == 0 || right == 0) {
        return true;
    }
    if (left == -1) {
        return right != INT64_MIN;
    }
    if (right == -1) {
        return left != INT64_MIN;
    }
    if ((left > 0) == (right > 0)) {
        return left > 0 ? left <= INT64_MAX / right : left >= INT64_MAX / right;
    }
    return left > 0 ? right >= INT64_MIN / left : left >= INT64_MIN / right;
}

/* == i${bits}_of_f${float} | bits: 8 16 32 | float: 32 64 == */
/* Truncated; the nearest that there is, and 0 for what is no number. */
static inline int${bits}_t i${bits}_of_f${float}(${real} number)
{
    const double value = number;
    if (!(value >= (double)INT${bits}_MIN)) {
        return value < 0.0 ? INT${bits}_MIN : 0;
    }
    return value >= (double)INT${bits}_MAX ? INT${bits}_MAX : (int${bits}_t)value;
}

/* == u${bits}_of_f${float} | bits: 8 16 32 | float: 32 64 == */
static inline uint${bits}_t u${bits}_of_f${float}(${real} number)
{
    const double value = number;
    if (!(value > 0.0)) {
        return 0;
    }
    return value >= (double)UINT${bits}_MAX ? UINT${bits}_MAX : (uint${bits}_t)value;
}

/* == i64_of_f${float} | float: 32 64 == */
static inline int64_t i64_of_f${float}(${real} number)
{
    const double value = number;
    if (!(value >= -9223372036854775808.0)) {
        return value < 0.0 ? INT64_MIN : 0;
    }
    return value >= 9223372036854775808.0 ? INT64_MAX : (int64_t)value;
}

/* == u64_of_f${float} | float: 32 64 == */
static inline uint64_t u64_of_f${float}(${real} number)
{
    const double value = number;
    if (!(value > 0.0)) {
        return 0;
    }
    return value >= 18446744073709551616.0 ? UINT64_MAX : (uint64_t)value;
}

/* == follows == */
/* Whether a byte of a character lies between two others. */
static inline bool follows(unsigned char byte, unsigned char low, unsigned char high)
{
    return byte >= low && byte <= high;
}

/* == is_text | needs: follows == */
/* Whether bytes are valid UTF-8 (Unicode 15, table 3-7). */
static bool is_text(const void *memory, int64_t start, int64_t size)
{
    if (size <= 0) {
        return true;
    }
    const unsigned char *text = (const unsigned char *)memory + start;
    int64_t at = 0;
    while (at < size) {
        uint64_t eight;
        if (size - at >= 8) {
            memcpy(&eight, text + at, sizeof eight);
            if ((eight & UINT64_C(0x8080808080808080)) == 0) {
                at += 8;
                continue;
            }
        } else if (size >= 8) { /* the last eight, some of which have been looked at */
            memcpy(&eight, text + size - 8, sizeof eight);
            if ((eight & UINT64_C(0x8080808080808080)) == 0) {
                return true;
            }
        }
        const unsigned char first = text[at];
        if (first < 0x80) {
            at += 1;
            continue;
        }
        const int64_t more = first < 0xe0 ? 1 : first < 0xf0 ? 2 : 3;
        if (first < 0xc2 || first > 0xf4 || size - at <= more) {
            return false;
        }
        const unsigned char low = first == 0xe0 ? 0xa0 : first == 0xf0 ? 0x90 : 0x80;
        const unsigned char high = first == 0xed ? 0x9f : first == 0xf4 ? 0x8f : 0xbf;
        if (!follows(text[at + 1], low, high)) {
            return false;
        }
        for (int64_t next = 2; next <= more; next++) {
            if (!follows(text[at + next], 0x80, 0xbf)) {
                return false;
            }
        }
        at += 1 + more;
    }
    return true;
}

/* == math == */

/* == decimals == */
/* Decimal numbers by the C library, which rounds correctly. Whatever point its locale writes is passed over. */
enum { DIGITS_KEPT = 800, ROOM = 400 };

struct decimal {
    uint64_t digits;
    int64_t scale;
};

static struct decimal decimal_of(const char *text)
{
    struct decimal found = {0, 0};
    for (; *text != 0 && *text != 'e'; text++) {
        if (*text >= '0' && *text <= '9') {
            found.digits = found.digits * 10u + (uint64_t)(*text - '0');
        }
    }
    if (*text == 'e') {
        found.scale = strtoll(text + 1, NULL, 10);
    }
    return found;
}

static bool reads_back(const char *text, double number, bool is_single)
{
    const double again = strtod(text, NULL);
    return is_single ? (double)(float)again == number : again == number;
}

static struct decimal shortest(double number, bool is_single)
{
    const double value = number < 0.0 ? -number : number;
    struct decimal found = {0, 0};
    char text[ROOM];
    if (!(value > 0.0) || value > DBL_MAX) {
        return found;
    }
    const double least = is_single ? (double)FLT_MIN : DBL_MIN;
    const int last = is_single ? 9 : 17;
    for (int count = value >= least ? (is_single ? 6 : 15) : 1; count <= last; count++) {
        uint64_t bits;
        (void)snprintf(text, sizeof text, "%.*e", count - 1, value);
        found = decimal_of(text);
        found.scale -= count - 1;
        if (count == last || reads_back(text, value, is_single)) {
            break;
        }
        memcpy(&bits, &value, sizeof bits);
        if ((bits & UINT64_C(0xfffffffffffff)) == 0) { /* numbers reach twice as far above a power of two as below */
            (void)snprintf(text, sizeof text, "%" PRIu64 "e%" PRId64, found.digits + 1u, found.scale);
            if (reads_back(text, value, is_single)) {
                found.digits += 1u;
                break;
            }
        }
    }
    return found;
}

static inline uint64_t shortest_digits(double number, bool is_single)
{
    return shortest(number, is_single).digits;
}

static inline int64_t shortest_scale(double number, bool is_single)
{
    return shortest(number, is_single).scale;
}

static inline uint64_t fixed_digits(double number, int places)
{
    char text[ROOM];
    const double value = number < 0.0 ? -number : number;
    if (!(value <= DBL_MAX)) {
        return 0;
    }
    (void)snprintf(text, sizeof text, "%.*f", places, value);
    return decimal_of(text).digits;
}

static inline double nearest(const void *memory, int64_t start, int64_t size, int64_t exponent)
{
    char text[DIGITS_KEPT + 32];
    int64_t kept = 0;
    int64_t dropped = 0;
    bool has_rest = false;
    for (int64_t at = 0; at < size; at++) {
        const unsigned char byte = ((const unsigned char *)memory)[start + at];
        if (byte < '0' || byte > '9' || (byte == '0' && kept == 0)) {
            continue;
        }
        if (kept < DIGITS_KEPT) {
            text[kept++] = (char)byte;
        } else {
            dropped += 1;
            has_rest = has_rest || byte != '0';
        }
    }
    if (kept == 0) {
        return 0.0;
    }
    if (has_rest) {
        text[kept++] = '1';
        dropped -= 1;
    }
    (void)snprintf(text + kept, 30, "e%" PRId64, exponent + dropped);
    return strtod(text, NULL);
}
