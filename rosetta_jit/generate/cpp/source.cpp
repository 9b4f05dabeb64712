$made
$roundings#include "$name.hpp"

$includes

#define restrict __restrict /* as C has it */

static_assert(static_cast<unsigned char>(-1) == 255 && sizeof(int) >= 4, "bytes of eight bits, and an int of 32 at least, are needed");
static_assert(sizeof(float) == 4 && sizeof(double) == 8, "floating-point numbers of IEEE 754 are needed");
static_assert(FLT_EVAL_METHOD != 2, "floating-point numbers must not be computed with more digits: use SSE, not x87");
#if !defined(__BYTE_ORDER__) || __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "numbers must have their low byte first; source in C runs on any machine"
#endif
static_assert(-1 >> 1 == -1 && static_cast<std::int8_t>(255u) == -1, "integers must be two's complement throughout");

namespace $name {
namespace {

using rosetta_jit::detail::part;
using rosetta_jit::detail::site;
using rosetta_jit::status;

/* Elements of an array or text: rows `start` to `start + count` of a lane. A negative count: -1 - count bytes of the message, at `start`. */
struct ${name}_span {
    int64_t start;
    int64_t count;
};

$structs

$asserts

$holder
$support

$kernels

$walks
/* As an offset; no object is larger than this. */
int64_t reach(std::size_t size)
{
    return size < (std::size_t{1} << 60) ? static_cast<int64_t>(size) : int64_t{1} << 60;
}

const char *const lanes[] = {
    $lanes
};

/* The error of a failure. `available` is how many bytes there are behind its offset. */
ROSETTA_JIT_COLD rosetta_jit::error report(const site *sites, const struct failure &failure, int64_t available, const ${name}_holder &holder)
{
    static_cast<void>(holder);
    const site &where = sites[failure.site];
    if (failure.site == 0) {
        return {status::count, lanes[failure.offset], 0, "the message asks for more memory than its size allows", ""};
    }
    rosetta_jit::error found = rosetta_jit::detail::error_of(where, failure.offset, failure.indices, available);
$said    return found;
}

} // namespace

struct codec::memory : ${name}_holder {};

codec::codec() : memory_(new memory)$written {}
codec::~codec() = default;
codec::codec(codec &&) noexcept = default;
codec &codec::operator=(codec &&) noexcept = default;

$functions
} // namespace $name
