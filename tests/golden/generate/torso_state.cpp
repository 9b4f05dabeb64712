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
#include "torso_state.hpp"

#include <algorithm>
#include <cfloat>
#include <cstring>
#include <optional>
#include <variant>

#define restrict __restrict /* as C has it */

static_assert(static_cast<unsigned char>(-1) == 255 && sizeof(int) >= 4, "bytes of eight bits, and an int of 32 at least, are needed");
static_assert(sizeof(float) == 4 && sizeof(double) == 8, "floating-point numbers of IEEE 754 are needed");
static_assert(FLT_EVAL_METHOD != 2, "floating-point numbers must not be computed with more digits: use SSE, not x87");
#if !defined(__BYTE_ORDER__) || __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "numbers must have their low byte first; source in C runs on any machine"
#endif
static_assert(-1 >> 1 == -1 && static_cast<std::int8_t>(255u) == -1, "integers must be two's complement throughout");

namespace torso_state {
namespace {

using rosetta_jit::detail::part;
using rosetta_jit::detail::site;
using rosetta_jit::status;

/* Elements of an array or text: rows `start` to `start + count` of a lane. A negative count: -1 - count bytes of the message, at `start`. */
struct torso_state_span {
    int64_t start;
    int64_t count;
};

/* rst.kinematics.JointAngles */
typedef struct torso_state_JointAngles {
    torso_state_span unknown; /* fields that the schema does not know, as they came; in `unknown` */
    torso_state_span angles; /* Joint angles, in rad; in `angles` */
} torso_state_JointAngles;

static_assert(sizeof(torso_state_JointAngles) == 32, "no padding is added");

/* A message, and the elements of its arrays and texts. */
struct torso_state_holder {
    torso_state_JointAngles message = {};
    rosetta_jit::detail::lane<uint8_t> unknown;
    rosetta_jit::detail::field_lane<float, std::remove_const_t<std::remove_reference_t<decltype((*std::declval<holder &>().mutable_angles()))>>> angles;
    int64_t most = 0; /* rows that a message may ask for */
    int64_t now = 0;
    int64_t number = 0;
};
/* What a message is written from: elements where an object has them, and those that are put together in the codec's memory. */
struct torso_state_source {
    rosetta_jit::detail::lane<uint8_t> &unknown;
    int64_t most;
    int64_t now;
    int64_t number;
    rosetta_jit::detail::shown<float> angles = {};

    torso_state_source(torso_state_holder &memory, codec &owner) : unknown(memory.unknown), most(rosetta_jit::detail::most_rows(std::size_t{1} << 39)), now(owner.now), number(owner.number) { static_cast<void>(memory); }
};

/* Where and why a message cannot be read or written. `site` is a row of the table of sites, as wide as the machine counts best; 0 stands for a lane without room. */
struct failure {
    ptrdiff_t site;
    int64_t offset;
    int64_t indices[4];
};

ROSETTA_JIT_COLD static int64_t fail(struct failure *failure, ptrdiff_t site, int64_t offset)
{
    failure->site = site;
    failure->offset = offset;
    return -1 - site;
}

/* A lane lacks room. */
ROSETTA_JIT_COLD static int64_t full(struct failure *failure, ptrdiff_t lane, int64_t missing)
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

const part borrow_parts_5[] = {
    {0, 4, 0, ""},
    {4, 8, 0, ".yaw"},
    {12, 8, 0, ".roll"},
    {20, 8, 0, ".pitch"},
};

const part borrow_parts_8[] = {
    {0, 4, 0, ""},
    {4, 4, 0, ".yaw"},
    {8, 8, 0, ".yaw"},
    {16, 4, 0, ".roll"},
    {20, 8, 0, ".roll"},
    {28, 4, 0, ".pitch"},
    {32, 8, 0, ".pitch"},
};

const site borrow_sites[] = {
    {status::full, "", "a lane is too small", "", -1, 0, nullptr},
    {status::trailing, "", "not of the usual length", "", -1, 0, nullptr},
    {status::tag, "", "must be 266", "", -1, 0, nullptr},
    {status::count, "", "must be 3", "", -1, 0, nullptr},
    {status::truncated, "", "the message ends here", "", -1, 0, nullptr},
    {status::truncated, "", "the message ends here", "", -1, 4, borrow_parts_5},
    {status::trailing, "", "bytes are left over", "", -1, 0, nullptr},
    {status::tag, "", "must be one of 266, 256", "", -1, 0, nullptr},
    {status::truncated, "", "the message ends here", "", -1, 7, borrow_parts_8},
    {status::tag, ".yaw", "must be 10", "", -1, 0, nullptr},
    {status::tag, ".roll", "must be 10", "", -1, 0, nullptr},
    {status::tag, ".pitch", "must be 10", "", -1, 0, nullptr},
};

static int64_t borrow_1(torso_state_holder *holder, const unsigned char *restrict bytes, int64_t end, struct failure *failure)
{
    torso_state_JointAngles *restrict const message = &holder->message;
    float *restrict angles = holder->angles.rows;
    int64_t angles_used = 0;
    if (32 != end) {
        return fail(failure, 1, -1); /* trailing: not of the usual length */
    }
    rosetta_jit::detail::fill_known<32>(message, 0, 0);
    if (load_i32_le(bytes + 0) != 266) {
        return fail(failure, 2, 0); /* tag: must be 266 */
    }
    if (load_i32_le(bytes + 4) != 3) {
        return fail(failure, 3, 4); /* count: must be 3 */
    }
    if (3 > holder->angles.capacity - angles_used) {
        if (!holder->angles.grow(3 - (holder->angles.capacity - angles_used), holder->most)) {
            return full(failure, 2, 3 - (holder->angles.capacity - angles_used));
        }
        angles = holder->angles.rows;
    }
    const int64_t start = angles_used;
    angles_used += 3;
    message->angles.start = start; /* torso_state.mapping:10: len(.angles) <-> 3 */
    message->angles.count = 3; /* torso_state.mapping:10: len(.angles) <-> 3 */
    angles[start] = (float)(load_f64_le(bytes + 8) * 0.017453292519943295); /* torso_state.mapping:11: .angles[0] <-> float32(radians(.yaw)) */
    angles[start + 1] = (float)(load_f64_le(bytes + 16) * 0.017453292519943295); /* torso_state.mapping:12: .angles[1] <-> float32(radians(.roll)) */
    angles[start + 2] = (float)(load_f64_le(bytes + 24) * 0.017453292519943295); /* torso_state.mapping:13: .angles[2] <-> float32(radians(.pitch)) */
    return 32;
}

static int64_t borrow_2(torso_state_holder *holder, const unsigned char *restrict bytes, int64_t end, struct failure *failure)
{
    torso_state_JointAngles *restrict const message = &holder->message;
    float *restrict angles = holder->angles.rows;
    int64_t angles_used = 0;
    rosetta_jit::detail::fill_known<32>(message, 0, 0);
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
        if (!holder->angles.grow(3 - (holder->angles.capacity - angles_used), holder->most)) {
            return full(failure, 2, 3 - (holder->angles.capacity - angles_used));
        }
        angles = holder->angles.rows;
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
    return 44;
}

const site size_sites[] = {
    {status::full, "", "a lane is too small", "", -1, 0, nullptr},
};

static int64_t size_message(void)
{
    return 32;
}

const part encode_parts_1[] = {
    {0, 4, 0, ""},
    {4, 4, 0, ""},
    {8, 8, 0, ".yaw"},
    {16, 8, 0, ".roll"},
    {24, 8, 0, ".pitch"},
};

const site encode_sites[] = {
    {status::full, "", "a lane is too small", "", -1, 0, nullptr},
    {status::length, "", "no room for the message", "", -1, 5, encode_parts_1},
    {status::index, ".angles[{}]", "no such element", "torso_state.mapping:11:3", -1, 0, nullptr},
    {status::index, ".angles[{}]", "no such element", "torso_state.mapping:12:3", -1, 0, nullptr},
    {status::index, ".angles[{}]", "no such element", "torso_state.mapping:13:3", -1, 0, nullptr},
    {status::rejected, "", "`len(.angles)` is not `3`, as the mapping says", "torso_state.mapping:10:3", -1, 0, nullptr},
    {status::length, "", "no room for the message", "", -1, 0, nullptr},
};

static int64_t encode_message(torso_state_source *holder, const torso_state_JointAngles &given_row, unsigned char *restrict bytes, int64_t end, struct failure *failure)
{
    const torso_state_JointAngles *restrict const message = &given_row;
    float *restrict const angles = holder->angles.rows;
    const int64_t start = message->angles.start;
    const int64_t count = message->angles.count;
    if (end < 32) {
        return fail(failure, 1, 0); /* length: no room for the message */
    }
    store_i32_le(bytes + 0, 266);
    store_i32_le(bytes + 4, 3);
    if (0 >= count) {
        failure->indices[0] = 0;
        return fail(failure, 2, 8); /* index .angles[{}]: no such element (torso_state.mapping:11:3) */
    }
    const float element = angles[start]; /* torso_state.mapping:11: .angles[0] <-> float32(radians(.yaw)) */
    const double yaw = (double)element * 57.29577951308232;
    store_f64_le(bytes + 8, yaw);
    if (1 >= count) {
        failure->indices[0] = 1;
        return fail(failure, 3, 16); /* index .angles[{}]: no such element (torso_state.mapping:12:3) */
    }
    const float element_2 = angles[start + 1]; /* torso_state.mapping:12: .angles[1] <-> float32(radians(.roll)) */
    const double roll = (double)element_2 * 57.29577951308232;
    store_f64_le(bytes + 16, roll);
    if (2 >= count) {
        failure->indices[0] = 2;
        return fail(failure, 4, 24); /* index .angles[{}]: no such element (torso_state.mapping:13:3) */
    }
    const float element_3 = angles[start + 2]; /* torso_state.mapping:13: .angles[2] <-> float32(radians(.pitch)) */
    const double pitch = (double)element_3 * 57.29577951308232;
    store_f64_le(bytes + 24, pitch);
    if (count != 3) {
        return fail(failure, 5, 32); /* rejected: `len(.angles)` is not `3`, as the mapping says (torso_state.mapping:10:3) */
    }
    return 32;
}

template <class Target>
void fill(const torso_state_holder &from, const unsigned char *bytes, const torso_state_JointAngles &row, Target &target)
{
    static_cast<void>(from);
    static_cast<void>(bytes);
    static_cast<void>(row);
    static_cast<void>(target);
    rosetta_jit::detail::keep_unknown(target, from.unknown, row.unknown);
}

template <class Source>
void collect(const Source &source, torso_state_source &to, torso_state_JointAngles &row)
{
    static_cast<void>(source);
    static_cast<void>(to);
    static_cast<void>(row);
    rosetta_jit::detail::take_unknown(to.unknown, row.unknown, source);
}

/* As an offset; no object is larger than this. */
int64_t reach(std::size_t size)
{
    return size < (std::size_t{1} << 60) ? static_cast<int64_t>(size) : int64_t{1} << 60;
}

const char *const lanes[] = {
    "",
    ".(unknown)",
    ".angles"
};

/* The error of a failure. `available` is how many bytes there are behind its offset. */
ROSETTA_JIT_COLD rosetta_jit::error report(const site *sites, const struct failure &failure, int64_t available, const torso_state_holder &holder)
{
    static_cast<void>(holder);
    const site &where = sites[failure.site];
    if (failure.site == 0) {
        return {status::count, lanes[failure.offset], 0, "the message asks for more memory than its size allows", ""};
    }
    rosetta_jit::error found = rosetta_jit::detail::error_of(where, failure.offset, failure.indices, available);
    return found;
}

} // namespace

struct codec::memory : torso_state_holder {};

codec::codec() : memory_(new memory) {}
codec::~codec() = default;
codec::codec(codec &&) noexcept = default;
codec &codec::operator=(codec &&) noexcept = default;

rosetta_jit::detail::outcome<rosetta_jit::done> codec::decode_any(const void *data, std::size_t size, ::torso_state::holder &target)
{
    torso_state_holder *const filled = memory_.get();
    const unsigned char *const bytes = static_cast<const unsigned char *>(data);
    const int64_t end = reach(size);
    auto &row = filled->message;
    struct failure failure;
    filled->most = rosetta_jit::detail::most_rows(size);
    filled->angles.fill((*target.mutable_angles()));
    int64_t result = borrow_1(filled, bytes, end, &failure);
    if (result < 0 && failure.site != 0) {
        struct failure other = {0, 0, {0, 0, 0, 0}};
        result = borrow_2(filled, bytes, end, &other);
        if (result < 0 && (other.site == 0 || other.offset > failure.offset)) {
            failure = other;
        }
    }
    if (result < 0) {
        row = {};
        filled->angles.finish(row.angles, bytes);
        return report(borrow_sites, failure, end - failure.offset, *filled);
    }
    filled->angles.finish(row.angles, bytes);
    fill(*filled, bytes, row, target);
    return rosetta_jit::done{};
}

namespace {

/* What is written has no byte that is wrong. */
rosetta_jit::error unplaced(rosetta_jit::error found)
{
    found.offset = -1;
    return found;
}

void gather(const ::torso_state::holder &source, torso_state_source *holder, torso_state_JointAngles &row)
{
    static_cast<void>(holder);
    rosetta_jit::detail::empty(row);
    holder->unknown.clear();
    holder->angles.read(source.angles());
    row.angles = {0, holder->angles.used};
    collect(source, *holder, row);
}

/* The bytes of the message. Where parts of it have lengths, these are left in the scratch memory. */
rosetta_jit::detail::outcome<std::size_t> measured(torso_state_source *holder, const torso_state_JointAngles &given_row, const torso_state_holder &memory)
{
    struct failure failure = {0, 0, {0, 0, 0, 0}};
    const int64_t end = INT64_MAX;
    static_cast<void>(end);
    static_cast<void>(holder);
    static_cast<void>(given_row);
    const int64_t size = size_message();
    if (size < 0) {
        return unplaced(report(size_sites, failure, 0, memory));
    }
    return static_cast<std::size_t>(size);
}

rosetta_jit::detail::outcome<std::size_t> written(torso_state_source *holder, const torso_state_JointAngles &given_row, const torso_state_holder &memory, void *target, std::size_t capacity)
{
    unsigned char *const bytes = static_cast<unsigned char *>(target);
    const int64_t end = reach(capacity);
    struct failure failure;
    static_cast<void>(holder);
    static_cast<void>(given_row);
    static_cast<void>(bytes);
    static_cast<void>(end);
    const int64_t result = encode_message(holder, given_row, bytes, end, &failure);
    if (result < 0) {
        return unplaced(report(encode_sites, failure, 0, memory));
    }
    return static_cast<std::size_t>(result);
}
} // namespace

rosetta_jit::result<std::size_t> codec::try_size(const ::torso_state::holder &source)
{
    torso_state_source given(*memory_, *this);
    gather(source, &given, memory_->message);
    return measured(&given, memory_->message, *memory_);
}

rosetta_jit::detail::outcome<std::size_t> codec::encode_any(const ::torso_state::holder &source, void *bytes, std::size_t capacity)
{
    torso_state_source given(*memory_, *this);
    torso_state_JointAngles &row = memory_->message;
    gather(source, &given, row);
    return written(&given, row, *memory_, bytes, capacity);
}

rosetta_jit::result<rosetta_jit::done> codec::try_encode(const ::torso_state::holder &source, std::string &bytes)
{
    torso_state_source given(*memory_, *this);
    gather(source, &given, memory_->message);
    const rosetta_jit::result<std::size_t> size = measured(&given, memory_->message, *memory_);
    if (!size) {
        return size.error();
    }
    bytes.resize(*size);
    const rosetta_jit::result<std::size_t> found = written(&given, memory_->message, *memory_, &bytes[0], *size);
    if (!found) {
        return found.error();
    }
    bytes.resize(*found);
    return rosetta_jit::done{};
}

} // namespace torso_state
