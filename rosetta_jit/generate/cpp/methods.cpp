/* == decode == */
rosetta_jit::detail::outcome<rosetta_jit::done> codec::decode_any(const void *data, std::size_t size, ::$name::holder &target)
{
    ${name}_holder *const filled = memory_.get();
    const unsigned char *const bytes = static_cast<const unsigned char *>(data);
    const int64_t end = reach(size);
    auto &row = filled->message;
    struct failure failure$unset;
$begin
$kept
$reset
$bind
    int64_t result = $first;
$others
    if (result < 0) {
        row = {};
$empty
        return report(borrow_sites, failure, end - failure.offset, *filled);
    }
$finish
    fill(*filled, bytes, row, target);
    return rosetta_jit::done{};
}
/* == wire == */
rosetta_jit::result<rosetta_jit::done> codec::try_decode_$wire(const void *data, std::size_t size, ::$name::holder &target)
{
    ${name}_holder *const filled = memory_.get();
    const unsigned char *const bytes = static_cast<const unsigned char *>(data);
    const int64_t end = reach(size);
    const auto before = filled->message;
    struct failure failure$unset;
    filled->now = now;
    filled->number = number;
$kept
    filled->most = rosetta_jit::detail::most_rows(size);
$save
    int64_t result = $first;
$others
    if (result < 0) {
        filled->message = before;
$restore
        return report(decode_${wire}_sites, failure, end - failure.offset, *filled);
    }
    share_$wire(*filled, bytes, filled->message, target);
    return rosetta_jit::done{};
}
/* == reset == */
void codec::reset()
{
    kept = state();
    memory_.reset(new memory);
}
/* == other == */
    if (result < 0 && failure.site != 0) {
        struct failure other = {0, 0, {0, 0, 0, 0}};
        result = $call;
        if (result < 0 && (other.site == 0 || other.offset > failure.offset)) {
            failure = other;
        }
    }
/* == encode == */
namespace {

/* What is written has no byte that is wrong. */
rosetta_jit::error unplaced(rosetta_jit::error found)
{
    found.offset = -1;
    return found;
}

${inline}void gather(const ::$name::holder &source, ${name}_source *holder, $row &row)
{
    static_cast<void>(holder);
$clear
$reset
$bind
    collect(source, *holder, row);
}

/* The bytes of the message. Where parts of it have lengths, these are left in the scratch memory. */
rosetta_jit::detail::outcome<std::size_t> measured(${name}_source *holder, const $row &given_row, const ${name}_holder &memory)
{
    struct failure failure$unsized;
    const int64_t end = INT64_MAX;
    static_cast<void>(end);
    static_cast<void>(holder);
    static_cast<void>(given_row);
    const int64_t size = $size;
    if (size < 0) {
        return unplaced(report(size_sites, failure, 0, memory));
    }
$known
    return static_cast<std::size_t>(size);
}

${inline}rosetta_jit::detail::outcome<std::size_t> written(${name}_source *holder, const $row &given_row, const ${name}_holder &memory, void *target, std::size_t capacity)
{
    unsigned char *const bytes = static_cast<unsigned char *>(target);
    const int64_t end = reach(capacity);
    struct failure failure$unset;
    static_cast<void>(holder);
    static_cast<void>(given_row);
    static_cast<void>(bytes);
    static_cast<void>(end);
    const int64_t result = $run;
    if (result < 0) {
        return unplaced(report(encode_sites, failure, 0, memory));
    }
    return static_cast<std::size_t>(result);
}
$tried
} // namespace

rosetta_jit::result<std::size_t> codec::try_size(const ::$name::holder &source)
{
    ${name}_source given(*$memory, *this);
    gather(source, &given, $memory->message);
    return measured(&given, $memory->message, *$memory);
}

rosetta_jit::detail::outcome<std::size_t> codec::encode_any(const ::$name::holder &source, void *bytes, std::size_t capacity)
{
    ${name}_source given(*$memory, *this);
$local
    gather(source, &given, row);
$unmeasured
$measure
    return written(&given, row, *$memory, bytes, capacity);
}

rosetta_jit::result<rosetta_jit::done> codec::try_encode(const ::$name::holder &source, std::string &bytes)
{
    ${name}_source given(*$memory, *this);
    gather(source, &given, $memory->message);
$soon
    const rosetta_jit::result<std::size_t> size = measured(&given, $memory->message, *$memory);
    if (!size) {
        return size.error();
    }
$later
    bytes.resize(*size);
    const rosetta_jit::result<std::size_t> found = $again;
    if (!found) {
        return found.error();
    }
    bytes.resize(*found);
    return rosetta_jit::done{};
}
/* == tried == */

constexpr std::size_t LARGEST_PLACE = std::size_t{1} << 20;
constexpr int MEASURED_FIRST = 50; /* messages behind one that could not be written at once */

/* How many bytes are written where no length is known; negative where there is no room, or parts move too often. */
int64_t tried(${name}_source *holder, const $row &given_row, ${name}_holder &memory, void *target, std::size_t capacity)
{
    if (memory.given_waits > 0) {
        memory.given_waits--;
        return -1;
    }
    unsigned char *const bytes = static_cast<unsigned char *>(target);
    const int64_t end = reach(capacity);
    struct failure failure$unset;
    holder->given_lengths.left = 1024;
    holder->given_lengths.late = &memory.given_longer;
    const int64_t result = $run;
    memory.given_waits = holder->given_lengths.left < 0 ? MEASURED_FIRST : 0;
    return result;
}
/* == unmeasured == */
    const int64_t found = tried(&given, row, *$memory, bytes, capacity);
    if (found >= 0) {
        return static_cast<std::size_t>(found);
    }
/* == soon == */
    auto &place = $memory->given_place; /* so that bytes get no memory before their number is known */
    const int64_t soon = tried(&given, $memory->message, *$memory, place.data(), place.size());
    if (soon >= 0) {
        bytes.assign(reinterpret_cast<const char *>(place.data()), static_cast<std::size_t>(soon));
        return rosetta_jit::done{};
    }
/* == later == */
    if (*size <= LARGEST_PLACE) {
        place.resize(std::max(place.size(), *size));
    } else {
        $memory->given_waits = MEASURED_FIRST;
    }
/* == measure == */
    const auto size = measured(&given, row, *$memory);
    if (size.failed != nullptr) {
        return size;
    }
    if (size.value > capacity) {
        return unplaced(report(encode_sites, {$no_room, 0, {0, 0, 0, 0}}, 0, *$memory));
    }
