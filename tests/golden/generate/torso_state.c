/* Made by rosetta-jit. Changes will be lost. */
/* decode: yarp.icub.torso.state, yarp3 -> rst.kinematics.JointAngles, by torso_state.mapping */
/* 10: len(.angles) <-> 3 */
/* 11: .angles[0] <-> float32(radians(.yaw)) */
/* 12: .angles[1] <-> float32(radians(.roll)) */
/* 13: .angles[2] <-> float32(radians(.pitch)) */
/* encode: yarp.icub.torso.state, yarp3 <- rst.kinematics.JointAngles, by torso_state.mapping */
/* 10: len(.angles) <-> 3 */
/* 11: .angles[0] <-> float32(radians(.yaw)) */
/* 12: .angles[1] <-> float32(radians(.roll)) */
/* 13: .angles[2] <-> float32(radians(.pitch)) */
#include "torso_state.h"

#include <float.h>
#include <string.h>

_Static_assert((unsigned char)-1 == 255 && sizeof(int) >= 4, "bytes of eight bits, and an int of 32 at least, are needed");
_Static_assert(sizeof(float) == 4 && sizeof(double) == 8, "floating-point numbers of IEEE 754 are needed");
_Static_assert(FLT_EVAL_METHOD != 2, "floating-point numbers must not be computed with more digits: use SSE, not x87");
_Static_assert(-1 >> 1 == -1 && (int8_t)255u == -1, "integers must be two's complement throughout");
_Static_assert(sizeof(torso_state_JointAngles) == 32, "no padding is added");

/* Where and why a message cannot be read or written. `site` is a row of the table of sites, as wide as the machine counts best; 0 stands for a lane without room. */
struct failure {
    ptrdiff_t site;
    int64_t offset;
    int64_t indices[4];
};

static int64_t fail(struct failure *failure, ptrdiff_t site, int64_t offset)
{
    failure->site = site;
    failure->offset = offset;
    return -1 - site;
}

/* A lane lacks room. */
static int64_t full(struct failure *failure, ptrdiff_t lane, int64_t missing)
{
    failure->site = 0;
    failure->offset = lane;
    failure->indices[0] = missing;
    return -1;
}

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

static inline uint32_t load_u32_le(const unsigned char *at)
{
#if HAS_ORDER
    uint32_t number;
    memcpy(&number, at, sizeof number);
    return IN_ORDER_le(32, number);
#else
    uint64_t number = 0;
    for (int byte = 32 / 8 - 1; byte >= 0; byte--) {
        number = number << 8 | at[byte];
    }
    return (uint32_t)number;
#endif
}

static inline uint64_t load_u64_le(const unsigned char *at)
{
#if HAS_ORDER
    uint64_t number;
    memcpy(&number, at, sizeof number);
    return IN_ORDER_le(64, number);
#else
    uint64_t number = 0;
    for (int byte = 64 / 8 - 1; byte >= 0; byte--) {
        number = number << 8 | at[byte];
    }
    return (uint64_t)number;
#endif
}

static inline int32_t load_i32_le(const unsigned char *at)
{
    return (int32_t)load_u32_le(at);
}

static inline double float64_of(uint64_t bits)
{
    double number;
    memcpy(&number, &bits, sizeof number);
    return number;
}

static inline double load_f64_le(const unsigned char *at)
{
    return float64_of(load_u64_le(at));
}

static inline void store_u32_le(unsigned char *at, uint32_t number)
{
#if HAS_ORDER
    const uint32_t ordered = IN_ORDER_le(32, number);
    memcpy(at, &ordered, sizeof ordered);
#else
    for (int byte = 0; byte < 32 / 8; byte++) {
        at[byte] = (unsigned char)(number >> (8 * byte) & 255u);
    }
#endif
}

static inline void store_u64_le(unsigned char *at, uint64_t number)
{
#if HAS_ORDER
    const uint64_t ordered = IN_ORDER_le(64, number);
    memcpy(at, &ordered, sizeof ordered);
#else
    for (int byte = 0; byte < 64 / 8; byte++) {
        at[byte] = (unsigned char)(number >> (8 * byte) & 255u);
    }
#endif
}

static inline void store_i32_le(unsigned char *at, int32_t number)
{
    store_u32_le(at, (uint32_t)number);
}

static inline uint64_t bits_of_f64(double number)
{
    uint64_t bits;
    memcpy(&bits, &number, sizeof bits);
    return bits;
}

static inline void store_f64_le(unsigned char *at, double number)
{
    store_u64_le(at, bits_of_f64(number));
}

/* Without texts an error has its status, its offset and the number of its site, a row of the tables below. */
#ifdef TORSO_STATE_NO_TEXTS
#define TEXT(text) ""
#else
#define TEXT(text) text
#endif

/* What can be wrong with a message, and where. A `{}` in a path stands for an index; parts tell fields apart that are checked at once. */
struct part {
    int16_t offset;
    int16_t size;
    const char *path;
};

struct site {
    unsigned char status;
    int16_t parts;
    const char *path;
    const char *detail;
    const char *line;
    const struct part *part;
};

static const char *const lanes[] = {
    "",
    TEXT(".(unknown)"),
    TEXT(".angles")
};

/* The field among those of a site that lacks bytes, of which `available` are there. */
static void locate(torso_state_error *error, const struct site *site, int64_t available)
{
    for (int number = 0; number < site->parts; number++) {
        const struct part *part = &site->part[number];
        if ((int64_t)part->offset + part->size > available) {
            error->path = part->path;
            error->offset += part->offset;
            return;
        }
    }
}

static size_t length_of(const char *text)
{
    size_t length = 0;
    while (text[length] != 0) {
        length++;
    }
    return length;
}

/* Tells the caller of a failure, and forgets what the function did before. */
static torso_state_status report(torso_state_error *error, const struct site *sites, const struct failure *failure, int64_t available,
                             const torso_state_holder *holder)
{
    const struct site *site = &sites[failure->site];
    const torso_state_status status = (torso_state_status)site->status;
    (void)holder;
    if (error == NULL) {
        return status;
    }
    memset(error, 0, sizeof *error);
    error->status = status;
    error->site = (int)failure->site;
    error->path = site->path;
    error->detail = site->detail;
    error->line = site->line;
    if (failure->site == 0) {
        error->lane = failure->offset;
        error->missing = failure->indices[0];
        error->path = lanes[failure->offset];
    } else {
        error->offset = failure->offset;
        memcpy(error->indices, failure->indices, sizeof error->indices);
        locate(error, site, available);
    }
    error->detail_size = length_of(error->detail);
    return status;
}

void torso_state_clear(torso_state_holder *holder)
{
    memset(&holder->message, 0, sizeof holder->message);
    holder->unknown.used = 0;
    holder->angles.used = 0;
}

/* As an offset; no object is larger than this. */
static int64_t reach(size_t size)
{
    const uint64_t given = size;
    return given < (UINT64_C(1) << 60) ? (int64_t)given : (INT64_C(1) << 60);
}

static const struct part decode_parts_5[] = {
    {0, 4, ""},
    {4, 8, TEXT(".yaw")},
    {12, 8, TEXT(".roll")},
    {20, 8, TEXT(".pitch")},
};

static const struct part decode_parts_8[] = {
    {0, 4, ""},
    {4, 4, TEXT(".yaw")},
    {8, 8, TEXT(".yaw")},
    {16, 4, TEXT(".roll")},
    {20, 8, TEXT(".roll")},
    {28, 4, TEXT(".pitch")},
    {32, 8, TEXT(".pitch")},
};

static const struct site decode_sites[] = {
    {TORSO_STATE_FULL, 0, "", TEXT("a lane is too small"), "", NULL},
    {TORSO_STATE_TRAILING, 0, "", TEXT("not of the usual length"), "", NULL},
    {TORSO_STATE_TAG, 0, "", TEXT("must be 266"), "", NULL},
    {TORSO_STATE_COUNT, 0, "", TEXT("must be 3"), "", NULL},
    {TORSO_STATE_TRUNCATED, 0, "", TEXT("the message ends here"), "", NULL},
    {TORSO_STATE_TRUNCATED, 4, "", TEXT("the message ends here"), "", decode_parts_5},
    {TORSO_STATE_TRAILING, 0, "", TEXT("bytes are left over"), "", NULL},
    {TORSO_STATE_TAG, 0, "", TEXT("must be one of 266, 256"), "", NULL},
    {TORSO_STATE_TRUNCATED, 7, "", TEXT("the message ends here"), "", decode_parts_8},
    {TORSO_STATE_TAG, 0, TEXT(".yaw"), TEXT("must be 10"), "", NULL},
    {TORSO_STATE_TAG, 0, TEXT(".roll"), TEXT("must be 10"), "", NULL},
    {TORSO_STATE_TAG, 0, TEXT(".pitch"), TEXT("must be 10"), "", NULL},
};

static int64_t decode_1(torso_state_holder *holder, const unsigned char *restrict bytes, int64_t end, struct failure *failure)
{
    torso_state_JointAngles *restrict const message = &holder->message;
    float *restrict const angles = holder->angles.rows;
    int64_t angles_used = 0;
    if (32 != end) {
        return fail(failure, 1, -1); /* trailing: not of the usual length */
    }
    memset(message, 0, 32);
    if (load_i32_le(bytes + 0) != 266) {
        return fail(failure, 2, 0); /* tag: must be 266 */
    }
    if (load_i32_le(bytes + 4) != 3) {
        return fail(failure, 3, 4); /* count: must be 3 */
    }
    if (3 > holder->angles.capacity - angles_used) {
        return full(failure, 2, 3 - (holder->angles.capacity - angles_used));
    }
    const int64_t start = angles_used;
    angles_used += 3;
    message->angles.start = start; /* torso_state.mapping:10: len(.angles) <-> 3 */
    message->angles.count = 3; /* torso_state.mapping:10: len(.angles) <-> 3 */
    angles[start] = (float)(load_f64_le(bytes + 8) * 0.017453292519943295); /* torso_state.mapping:11: .angles[0] <-> float32(radians(.yaw)) */
    angles[start + 1] = (float)(load_f64_le(bytes + 16) * 0.017453292519943295); /* torso_state.mapping:12: .angles[1] <-> float32(radians(.roll)) */
    angles[start + 2] = (float)(load_f64_le(bytes + 24) * 0.017453292519943295); /* torso_state.mapping:13: .angles[2] <-> float32(radians(.pitch)) */
    holder->unknown.used = 0;
    holder->angles.used = angles_used;
    return 32;
}

static int64_t decode_2(torso_state_holder *holder, const unsigned char *restrict bytes, int64_t end, struct failure *failure)
{
    torso_state_JointAngles *restrict const message = &holder->message;
    float *restrict const angles = holder->angles.rows;
    int64_t angles_used = 0;
    memset(message, 0, 32);
    if (end < 4) {
        return fail(failure, 4, 0); /* truncated: the message ends here */
    }
    const int64_t code = (int64_t)load_i32_le(bytes + 0);
    if (code == 266) {
        if (end < 32) {
            return fail(failure, 5, 4); /* truncated: the message ends here */
        }
        if (load_i32_le(bytes + 4) != 3) {
            return fail(failure, 3, 4); /* count: must be 3 */
        }
        if (32 != end) {
            return fail(failure, 6, 32); /* trailing: bytes are left over */
        }
        return fail(failure, 1, -1); /* trailing: not of the usual length */
    }
    if (code != 256) {
        return fail(failure, 7, 0); /* tag: must be one of 266, 256 */
    }
    if (end < 44) {
        return fail(failure, 8, 4); /* truncated: the message ends here */
    }
    if (load_i32_le(bytes + 4) != 3) {
        return fail(failure, 3, 4); /* count: must be 3 */
    }
    if (load_i32_le(bytes + 8) != 10) {
        return fail(failure, 9, 8); /* tag .yaw: must be 10 */
    }
    if (load_i32_le(bytes + 20) != 10) {
        return fail(failure, 10, 20); /* tag .roll: must be 10 */
    }
    if (load_i32_le(bytes + 32) != 10) {
        return fail(failure, 11, 32); /* tag .pitch: must be 10 */
    }
    if (3 > holder->angles.capacity - angles_used) {
        return full(failure, 2, 3 - (holder->angles.capacity - angles_used));
    }
    const int64_t start_2 = angles_used;
    angles_used += 3;
    message->angles.start = start_2; /* torso_state.mapping:10: len(.angles) <-> 3 */
    message->angles.count = 3; /* torso_state.mapping:10: len(.angles) <-> 3 */
    angles[start_2] = (float)(load_f64_le(bytes + 12) * 0.017453292519943295); /* torso_state.mapping:11: .angles[0] <-> float32(radians(.yaw)) */
    angles[start_2 + 1] = (float)(load_f64_le(bytes + 24) * 0.017453292519943295); /* torso_state.mapping:12: .angles[1] <-> float32(radians(.roll)) */
    angles[start_2 + 2] = (float)(load_f64_le(bytes + 36) * 0.017453292519943295); /* torso_state.mapping:13: .angles[2] <-> float32(radians(.pitch)) */
    if (44 != end) {
        return fail(failure, 6, 44); /* trailing: bytes are left over */
    }
    holder->unknown.used = 0;
    holder->angles.used = angles_used;
    return 44;
}

torso_state_status torso_state_decode(torso_state_holder *holder, const void *bytes, size_t size, torso_state_error *error)
{
    struct failure failure = {0, 0, {0, 0, 0, 0}};
    const int64_t end = reach(size);
    int64_t result = decode_1(holder, bytes, end, &failure);
    if (result < 0 && failure.site != 0) {
        struct failure other = {0, 0, {0, 0, 0, 0}};
        result = decode_2(holder, bytes, end, &other);
        if (result < 0 && (other.site == 0 || other.offset > failure.offset)) {
            failure = other;
        }
    }
    if (result >= 0) {
        return TORSO_STATE_OK;
    }
    torso_state_clear(holder);
    return report(error, decode_sites, &failure, end - failure.offset, holder);
}

static const struct site size_sites[] = {
    {TORSO_STATE_FULL, 0, "", TEXT("a lane is too small"), "", NULL},
    {TORSO_STATE_LENGTH, 0, TEXT(".angles"), TEXT("the holder is damaged"), "", NULL},
};

static int64_t size_message(const torso_state_holder *holder, struct failure *failure)
{
    const torso_state_JointAngles *restrict const message = &holder->message;
    const int64_t angles_used = holder->angles.used;
    const int64_t start = message->angles.start;
    const int64_t count = message->angles.count;
    if (!((count >= 0) && (count <= angles_used))) {
        return fail(failure, 1, 0); /* length .angles: the holder is damaged */
    }
    if (!((start >= 0) && (start <= (angles_used - count)))) {
        return fail(failure, 1, 0); /* length .angles: the holder is damaged */
    }
    return 32;
}

torso_state_status torso_state_size(const torso_state_holder *holder, size_t *size, torso_state_error *error)
{
    struct failure failure = {0, 0, {0, 0, 0, 0}};
    const int64_t result = size_message(holder, &failure);
    if (result < 0) {
        return report(error, size_sites, &failure, 0, holder);
    }
    *size = (size_t)result;
    return TORSO_STATE_OK;
}

static const struct part encode_parts_2[] = {
    {0, 4, ""},
    {4, 4, ""},
    {8, 8, TEXT(".yaw")},
    {16, 8, TEXT(".roll")},
    {24, 8, TEXT(".pitch")},
};

static const struct site encode_sites[] = {
    {TORSO_STATE_FULL, 0, "", TEXT("a lane is too small"), "", NULL},
    {TORSO_STATE_LENGTH, 0, TEXT(".angles"), TEXT("the holder is damaged"), "", NULL},
    {TORSO_STATE_LENGTH, 5, "", TEXT("no room for the message"), "", encode_parts_2},
    {TORSO_STATE_INDEX, 0, TEXT(".angles[{}]"), TEXT("no such element"), TEXT("torso_state.mapping:11:3"), NULL},
    {TORSO_STATE_INDEX, 0, TEXT(".angles[{}]"), TEXT("no such element"), TEXT("torso_state.mapping:12:3"), NULL},
    {TORSO_STATE_INDEX, 0, TEXT(".angles[{}]"), TEXT("no such element"), TEXT("torso_state.mapping:13:3"), NULL},
    {TORSO_STATE_REJECTED, 0, "", TEXT("`len(.angles)` is not `3`, as the mapping says"), TEXT("torso_state.mapping:10:3"), NULL},
    {TORSO_STATE_LENGTH, 0, "", TEXT("no room for the message"), "", NULL},
};

static int64_t encode_message(const torso_state_holder *holder, unsigned char *restrict bytes, int64_t end, struct failure *failure)
{
    const torso_state_JointAngles *restrict const message = &holder->message;
    float *restrict const angles = holder->angles.rows;
    const int64_t angles_used = holder->angles.used;
    const int64_t start = message->angles.start;
    const int64_t count = message->angles.count;
    if (!((count >= 0) && (count <= angles_used))) {
        return fail(failure, 1, 0); /* length .angles: the holder is damaged */
    }
    if (!((start >= 0) && (start <= (angles_used - count)))) {
        return fail(failure, 1, 0); /* length .angles: the holder is damaged */
    }
    if (end < 32) {
        return fail(failure, 2, 0); /* length: no room for the message */
    }
    store_i32_le(bytes + 0, 266);
    store_i32_le(bytes + 4, 3);
    if (0 >= count) {
        failure->indices[0] = 0;
        return fail(failure, 3, 8); /* index .angles[{}]: no such element (torso_state.mapping:11:3) */
    }
    const float element = angles[start]; /* torso_state.mapping:11: .angles[0] <-> float32(radians(.yaw)) */
    const double yaw = (double)element * 57.29577951308232;
    store_f64_le(bytes + 8, yaw);
    if (1 >= count) {
        failure->indices[0] = 1;
        return fail(failure, 4, 16); /* index .angles[{}]: no such element (torso_state.mapping:12:3) */
    }
    const float element_2 = angles[start + 1]; /* torso_state.mapping:12: .angles[1] <-> float32(radians(.roll)) */
    const double roll = (double)element_2 * 57.29577951308232;
    store_f64_le(bytes + 16, roll);
    if (2 >= count) {
        failure->indices[0] = 2;
        return fail(failure, 5, 24); /* index .angles[{}]: no such element (torso_state.mapping:13:3) */
    }
    const float element_3 = angles[start + 2]; /* torso_state.mapping:13: .angles[2] <-> float32(radians(.pitch)) */
    const double pitch = (double)element_3 * 57.29577951308232;
    store_f64_le(bytes + 24, pitch);
    if (count != 3) {
        return fail(failure, 6, 32); /* rejected: `len(.angles)` is not `3`, as the mapping says (torso_state.mapping:10:3) */
    }
    return 32;
}

torso_state_status torso_state_encode(const torso_state_holder *holder, void *bytes, size_t capacity, size_t *size, torso_state_error *error)
{
    struct failure failure = {0, 0, {0, 0, 0, 0}};
    const int64_t end = reach(capacity);
    const int64_t result = encode_message(holder, bytes, end, &failure);
    if (result < 0) {
        return report(error, encode_sites, &failure, 0, holder);
    }
    *size = (size_t)result;
    return TORSO_STATE_OK;
}

size_t torso_state_error_path(const torso_state_error *error, char *text, size_t size)
{
    size_t length = 0;
#ifdef TORSO_STATE_NO_TEXTS
    (void)error;
#else
    size_t index = 0;
    for (const char *at = error->path; *at != 0; at++) {
        char digits[24];
        size_t count = 0;
        if (at[0] == '{' && at[1] == '}' && index < 4) {
            const int64_t number = error->indices[index++];
            uint64_t rest = number < 0 ? 0u - (uint64_t)number : (uint64_t)number;
            do {
                digits[count++] = (char)('0' + (int)(rest % 10u));
                rest /= 10u;
            } while (rest != 0);
            if (number < 0) {
                digits[count++] = '-';
            }
            at++;
        } else {
            digits[count++] = *at;
        }
        while (count > 0) {
            count--;
            if (length + 1 < size) {
                text[length] = digits[count];
            }
            length++;
        }
    }
#endif
    if (size > 0) {
        text[length < size ? length : size - 1] = 0;
    }
    return length;
}

const char *torso_state_status_text(torso_state_status status)
{
#ifdef TORSO_STATE_NO_TEXTS
    (void)status;
    return "";
#else
    static const char texts[] =
        "ok\0"
        "full\0"
        "truncated\0"
        "trailing\0"
        "tag\0"
        "constant\0"
        "count\0"
        "length\0"
        "nesting\0"
        "text\0"
        "varint\0"
        "range\0"
        "index\0"
        "missing\0"
        "image\0"
        "rejected\0"
        "union\0"
        "unknown";
    const char *text = texts;
    for (int number = (int)status < 0 || (int)status > 16 ? 17 : (int)status; number > 0; number--) {
        text += length_of(text) + 1;
    }
    return text;
#endif
}
