/* == decode == */
rosetta_jit::result<rosetta_jit::done> codec::try_decode(const void *data, std::size_t size, ::$name::holder &target)
{
    ${name}_holder *const holder = memory_.get();
    const unsigned char *const bytes = static_cast<const unsigned char *>(data);
    const int64_t end = reach(size);
    auto &row = holder->message;
    struct failure failure = {0, 0, {0, 0, 0, 0}};
    holder->now = now;
    holder->number = number;
$kept
    holder->most = rosetta_jit::detail::most_rows(size);
$reset
$bind
    int64_t result = $first;
$others
    if (result < 0) {
        row = {};
$empty
        return report(borrow_sites, failure, end - failure.offset, *holder);
    }
$finish
    fill(*holder, bytes, row, target);
    return rosetta_jit::done{};
}
/* == wire == */
rosetta_jit::result<rosetta_jit::done> codec::try_decode_$wire(const void *data, std::size_t size, ::$name::holder &target)
{
    ${name}_holder *const holder = memory_.get();
    const unsigned char *const bytes = static_cast<const unsigned char *>(data);
    const int64_t end = reach(size);
    const auto before = holder->message;
    struct failure failure = {0, 0, {0, 0, 0, 0}};
    holder->now = now;
    holder->number = number;
$kept
    holder->most = rosetta_jit::detail::most_rows(size);
$save
    int64_t result = $first;
$others
    if (result < 0) {
        holder->message = before;
$restore
        return report(decode_${wire}_sites, failure, end - failure.offset, *holder);
    }
    share_$wire(*holder, bytes, holder->message, target);
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

${inline}void gather(const ::$name::holder &source, ${name}_holder *holder, $row &row)
{
$clear
    holder->most = rosetta_jit::detail::most_rows(std::size_t{1} << 39);
$reset
$bind
    collect(source, *holder, row);
}

int64_t measured(${name}_holder *holder, const $row &given_row, struct failure *failure_of_size)
{
    struct failure &failure = *failure_of_size;
    const int64_t end = INT64_MAX;
    static_cast<void>(end);
    static_cast<void>(holder);
    static_cast<void>(given_row);
    static_cast<void>(failure);
    return $size;
}
/* == sized == */
rosetta_jit::result<std::size_t> codec::try_size(const ::$name::holder &source)
{
    ${name}_holder *const holder = $memory.get();
    struct failure failure = {0, 0, {0, 0, 0, 0}};
    holder->now = now;
    holder->number = number;
$kept
    gather(source, holder, holder->message);
    const int64_t size = measured(holder, holder->message, &failure);
    if (size < 0) {
        return unplaced(report(size_sites, failure, 0, *holder));
    }
    return static_cast<std::size_t>(size);
}

/* == straight == */
} // namespace

$sizedrosetta_jit::result<std::size_t> codec::try_encode(const ::$name::holder &source, void *target, std::size_t capacity)
{
    ${name}_holder *const holder = $memory.get();
    unsigned char *const bytes = static_cast<unsigned char *>(target);
    const int64_t end = reach(capacity);
    struct failure failure = {0, 0, {0, 0, 0, 0}};
    $row given_row;
    static_cast<void>(bytes);
    static_cast<void>(end);
    holder->now = now;
    holder->number = number;
$kept
    gather(source, holder, given_row);
    const int64_t result = $run;
    if (result < 0) {
        return unplaced(report(encode_sites, failure, 0, *holder));
    }
    return static_cast<std::size_t>(result);
}

rosetta_jit::result<rosetta_jit::done> codec::try_encode(const ::$name::holder &source, std::string &bytes)
{
    const auto size = try_size(source);
    if (!size) {
        return size.error();
    }
    bytes.resize(*size);
    const auto found = try_encode(source, &bytes[0], *size);
    if (!found) {
        return found.error();
    }
    bytes.resize(*found);
    return rosetta_jit::done{};
}
/* == gathered == */

rosetta_jit::result<std::size_t> written(${name}_holder *holder, unsigned char *bytes, int64_t end)
{
    struct failure failure = {0, 0, {0, 0, 0, 0}};
    const auto &given_row = holder->message;
    static_cast<void>(given_row);
    static_cast<void>(bytes);
    static_cast<void>(end);
    const int64_t result = $run;
    if (result < 0) {
        return unplaced(report(encode_sites, failure, 0, *holder));
    }
    return static_cast<std::size_t>(result);
}

} // namespace

$sizedrosetta_jit::result<std::size_t> codec::try_encode(const ::$name::holder &source, void *bytes, std::size_t capacity)
{
    ${name}_holder *const holder = $memory.get();
    holder->now = now;
    holder->number = number;
$kept
    gather(source, holder, holder->message);
$measure
    return written(holder, static_cast<unsigned char *>(bytes), reach(capacity));
}

rosetta_jit::result<rosetta_jit::done> codec::try_encode(const ::$name::holder &source, std::string &bytes)
{
    const auto size = try_size(source);
    if (!size) {
        return size.error();
    }
    bytes.resize(*size);
    const auto found = written($memory.get(), reinterpret_cast<unsigned char *>(&bytes[0]), static_cast<int64_t>(*size));
    if (!found) {
        return found.error();
    }
    bytes.resize(*found);
    return rosetta_jit::done{};
}
/* == measure == */
    {
        struct failure failure = {0, 0, {0, 0, 0, 0}};
        const int64_t size = measured(holder, holder->message, &failure); /* which leaves the lengths of the message's parts in the scratch memory */
        if (size < 0) {
            return unplaced(report(size_sites, failure, 0, *holder));
        }
        if (size > reach(capacity)) {
            failure.site = $no_room;
            return unplaced(report(encode_sites, failure, 0, *holder));
        }
    }
