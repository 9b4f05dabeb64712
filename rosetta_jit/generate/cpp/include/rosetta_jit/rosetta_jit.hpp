// What generated C++ shares: results, errors, and how the fields of classes are reached. Part of rosetta_jit; it depends on the standard
// library alone. Messages never make these functions fail but by the errors that they return; memory that is lacking is std::bad_alloc.
#ifndef ROSETTA_JIT_HPP
#define ROSETTA_JIT_HPP

#define ROSETTA_JIT_VERSION_MAJOR 0
#define ROSETTA_JIT_VERSION_MINOR 1
#define ROSETTA_JIT_VERSION_PATCH 0
#define ROSETTA_JIT_VERSION "0.1.0"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>
#if defined(__SSE2__)
#include <emmintrin.h>
#endif
#if __cplusplus >= 202002L
#include <span>
#endif

/* INLINE: code that is as quick as what it stands for only where a compiler sees both. COLD: code that seldom runs, which must not slow down what is around it.
   APART: code that is called, so that what calls it is short. LIKELY, UNLIKELY: a condition that holds nearly always, or hardly ever.
   MAY_ALIAS: a struct through which objects of another class are written that lie in memory as it does; where there is no such word, it is not done. */
#if defined(__GNUC__)
#define ROSETTA_JIT_MAY_ALIAS __attribute__((may_alias))
#define ROSETTA_JIT_INLINE __attribute__((always_inline)) inline
#define ROSETTA_JIT_COLD __attribute__((noinline, cold))
#define ROSETTA_JIT_APART __attribute__((noinline))
#define ROSETTA_JIT_LIKELY(condition) __builtin_expect(condition, true)
#define ROSETTA_JIT_UNLIKELY(condition) __builtin_expect(condition, false)
#else
#define ROSETTA_JIT_MAY_ALIAS
#define ROSETTA_JIT_INLINE inline
#define ROSETTA_JIT_COLD
#define ROSETTA_JIT_APART
#define ROSETTA_JIT_LIKELY(condition) (condition)
#define ROSETTA_JIT_UNLIKELY(condition) (condition)
#endif

/* Where exceptions are disabled, what would throw ends the program; `try_` functions do not. */
#if defined(__cpp_exceptions)
#define ROSETTA_JIT_THROW(exception) throw exception
#else
#define ROSETTA_JIT_THROW(exception) std::abort()
#endif

/* Whether a field of a class lies where a member of a row does, and is the same number. */
#define ROSETTA_JIT_LIES(CLASS, FIELD, ROW, MEMBER) \
    (offsetof(CLASS, FIELD) == offsetof(ROW, MEMBER) && \
     rosetta_jit::detail::same_numbers<decltype(std::declval<CLASS &>().FIELD), decltype(std::declval<ROW &>().MEMBER)>)
/* The same of a number in a message, at a byte of the element. */
#define ROSETTA_JIT_LIES_AT(CLASS, FIELD, OFFSET, NUMBER) \
    (offsetof(CLASS, FIELD) == OFFSET && rosetta_jit::detail::same_numbers<decltype(std::declval<CLASS &>().FIELD), NUMBER>)

#define ROSETTA_JIT_OTHER_ELEMENTS \
    "the class has elements of another type than the schema; one whose arrays of bools are bool or std::vector<bool> is one as of `--holder ros2`"

namespace rosetta_jit {

/* What is wrong with a message. */
enum class status {
    ok,
    full,
    truncated,
    trailing,
    tag,
    constant,
    count,
    length,
    nesting,
    text,
    varint,
    range,
    index,
    missing,
    image,
    rejected,
    union_,
};

/* A status as a word. */
inline const char *text_of(status what) noexcept
{
    switch (what) {
    case status::ok:
        return "ok";
    case status::full:
        return "full";
    case status::truncated:
        return "truncated";
    case status::trailing:
        return "trailing";
    case status::tag:
        return "tag";
    case status::constant:
        return "constant";
    case status::count:
        return "count";
    case status::length:
        return "length";
    case status::nesting:
        return "nesting";
    case status::text:
        return "text";
    case status::varint:
        return "varint";
    case status::range:
        return "range";
    case status::index:
        return "index";
    case status::missing:
        return "missing";
    case status::image:
        return "image";
    case status::rejected:
        return "rejected";
    case status::union_:
        return "union";
    }
    return "unknown";
}

/* What is wrong, and where. */
struct error {
    status kind = status::ok;
    std::string path;         /* the field: `.joints[3].name` */
    std::int64_t offset = 0;  /* of the message's byte; -1 where there is none, as in what is written */
    std::string detail;       /* one sentence for a person */
    std::string line;         /* of the mapping, where one of its rules is to blame */

    /* All of it as one line. */
    std::string what() const
    {
        std::string text = std::string(text_of(kind)) + (path.empty() ? "" : " at " + path);
        text += offset < 0 ? "" : ", byte " + std::to_string(offset);
        return text + ": " + detail + (line.empty() ? "" : " (" + line + ")");
    }
};

/* An error as an exception. */
class failure : public std::runtime_error {
public:
    explicit failure(rosetta_jit::error found) : std::runtime_error(found.what()), found_(std::make_shared<rosetta_jit::error>(std::move(found))) {}
    const rosetta_jit::error &error() const noexcept { return *found_; }

private:
    std::shared_ptr<const rosetta_jit::error> found_;
};

/* What nothing but its success can be said of. */
struct done {};

namespace detail {

/* A value or an error as a function returns it in registers: a `result` is made of it, which then has the error. */
template <class Value> struct [[nodiscard]] outcome {
    Value value{};
    const rosetta_jit::error *failed = nullptr;

    outcome(Value found) noexcept : value(found) {}
    ROSETTA_JIT_COLD outcome(rosetta_jit::error found) : failed(new rosetta_jit::error(std::move(found))) {}
};

template <> struct [[nodiscard]] outcome<done> {
    static constexpr done value = {};
    const rosetta_jit::error *failed = nullptr;

    outcome(done) noexcept {}
    ROSETTA_JIT_COLD outcome(rosetta_jit::error found) : failed(new rosetta_jit::error(std::move(found))) {}
};
} // namespace detail

/* A value or an error, as std::expected of C++23. It is moved, not copied; what it was moved from has a value. */
template <class Value> class [[nodiscard]] result {
public:
    result(Value value) : value_(std::move(value)) {}
    result(rosetta_jit::error found) : error_(new rosetta_jit::error(std::move(found))) {}
    ROSETTA_JIT_INLINE result(detail::outcome<Value> found) noexcept : value_(found.value), error_(found.failed) {}
    ROSETTA_JIT_INLINE result(result &&other) noexcept : value_(std::move(other.value_)), error_(other.error_) { other.error_ = nullptr; }
    result &operator=(result &&other) noexcept
    {
        std::swap(value_, other.value_);
        std::swap(error_, other.error_);
        return *this;
    }
    ROSETTA_JIT_INLINE ~result()
    {
        if (ROSETTA_JIT_UNLIKELY(error_ != nullptr)) {
            forget(error_);
        }
    }

    bool has_value() const noexcept { return error_ == nullptr; }
    explicit operator bool() const noexcept { return has_value(); }
    const rosetta_jit::error &error() const { return *error_; }

    /* The value, or the error thrown as a `failure`. */
    const Value &value() const
    {
        if (!has_value()) {
            ROSETTA_JIT_THROW(failure(*error_));
        }
        return value_;
    }
    const Value &operator*() const { return value_; }

private:
    ROSETTA_JIT_COLD static void forget(const rosetta_jit::error *found) noexcept { delete found; }

    Value value_{};
    const rosetta_jit::error *error_ = nullptr;
};

namespace detail {

/* --- errors --- */

/* Where several fields are checked at once, each of them. */
struct part {
    std::int64_t offset;
    std::int64_t size;
    std::int64_t step;
    const char *path;
};

/* One thing that can be wrong. A `{}` in a path stands for an index. */
struct site {
    status kind;
    const char *path;
    const char *detail;
    const char *line;
    int scratch;
    int parts;
    const part *each;
};

inline std::size_t indices_in(const char *path) noexcept
{
    std::size_t found = 0;
    for (; *path != 0; path++) {
        found += path[0] == '{' && path[1] == '}' ? 1u : 0u;
    }
    return found;
}

inline std::string path_of(const char *path, const std::int64_t (&indices)[4])
{
    std::string text;
    std::size_t index = 0;
    for (const char *at = path; *at != 0; at++) {
        if (at[0] == '{' && at[1] == '}' && index < 4) {
            text += std::to_string(indices[index++]);
            at++;
        } else {
            text += *at;
        }
    }
    return text;
}

/* The error of a site. `available` is how many bytes there are behind `offset`. */
inline error error_of(const site &where, std::int64_t offset, const std::int64_t (&at)[4], std::int64_t available)
{
    std::int64_t indices[4] = {at[0], at[1], at[2], at[3]};
    const char *path = where.path;
    for (int number = 0; number < where.parts; number++) {
        const part &each = where.each[number];
        std::int64_t element = 0;
        if (each.step != 0 && available - each.offset - each.size >= 0) {
            element = (available - each.offset - each.size) / each.step + 1;
        }
        if (each.step != 0 || each.offset + each.size > available) {
            const std::size_t count = indices_in(each.path);
            path = each.path;
            offset += each.offset + element * each.step;
            if (each.step != 0 && count > 0) {
                indices[count - 1] = element;
            }
            break;
        }
    }
    return error{where.kind, path_of(path, indices), offset, where.detail, where.line};
}

/* --- numbers of a message, and whether they are there --- */

/* Whether some of `size` bytes from `at` are missing before `end`, which is not negative: without a sign, negative numbers are large. */
inline bool lacks(std::int64_t at, std::int64_t size, std::int64_t end) noexcept
{
    return static_cast<std::uint64_t>(at) > static_cast<std::uint64_t>(end) ||
           static_cast<std::uint64_t>(size) > static_cast<std::uint64_t>(end) - static_cast<std::uint64_t>(at);
}

/* The same where `at` is known to lie in the message, or to be its end. */
inline bool lacks_behind(std::int64_t at, std::int64_t size, std::int64_t end) noexcept
{
    return static_cast<std::uint64_t>(size) > static_cast<std::uint64_t>(end - at);
}

/* A number with its low byte first, as the machine has it. */
template <class Number> Number load_le(const unsigned char *at) noexcept
{
    Number number;
    std::memcpy(&number, at, sizeof number);
    return number;
}

/* Bytes in the other order. */
#if defined(__GNUC__)
inline std::uint16_t turned(std::uint16_t bytes) noexcept { return __builtin_bswap16(bytes); }
inline std::uint32_t turned(std::uint32_t bytes) noexcept { return __builtin_bswap32(bytes); }
inline std::uint64_t turned(std::uint64_t bytes) noexcept { return __builtin_bswap64(bytes); }
#else
template <class Bytes> Bytes turned(Bytes bytes) noexcept
{
    Bytes found = 0;
    for (std::size_t byte = 0; byte < sizeof bytes; byte++) {
        found = static_cast<Bytes>(found << 8 | (bytes >> 8 * byte & 255u));
    }
    return found;
}
#endif

template <class Number>
using bytes_of = std::conditional_t<sizeof(Number) == 2, std::uint16_t, std::conditional_t<sizeof(Number) == 4, std::uint32_t, std::uint64_t>>;

/* One with its high byte first. */
template <class Number> Number load_be(const unsigned char *at) noexcept
{
    const bytes_of<Number> bytes = turned(load_le<bytes_of<Number>>(at));
    Number number;
    static_assert(sizeof number == sizeof bytes, "numbers have two, four or eight bytes");
    std::memcpy(&number, &bytes, sizeof number);
    return number;
}

inline bool load_bool(const unsigned char *at) noexcept { return *at != 0; }
inline std::uint8_t load_u8(const unsigned char *at) noexcept { return *at; }
inline std::int8_t load_i8(const unsigned char *at) noexcept { return static_cast<std::int8_t>(*at); }
inline std::uint16_t load_u16_le(const unsigned char *at) noexcept { return load_le<std::uint16_t>(at); }
inline std::uint16_t load_u16_be(const unsigned char *at) noexcept { return load_be<std::uint16_t>(at); }
inline std::int16_t load_i16_le(const unsigned char *at) noexcept { return load_le<std::int16_t>(at); }
inline std::int16_t load_i16_be(const unsigned char *at) noexcept { return load_be<std::int16_t>(at); }
inline std::uint32_t load_u32_le(const unsigned char *at) noexcept { return load_le<std::uint32_t>(at); }
inline std::uint32_t load_u32_be(const unsigned char *at) noexcept { return load_be<std::uint32_t>(at); }
inline std::int32_t load_i32_le(const unsigned char *at) noexcept { return load_le<std::int32_t>(at); }
inline std::int32_t load_i32_be(const unsigned char *at) noexcept { return load_be<std::int32_t>(at); }
inline std::uint64_t load_u64_le(const unsigned char *at) noexcept { return load_le<std::uint64_t>(at); }
inline std::uint64_t load_u64_be(const unsigned char *at) noexcept { return load_be<std::uint64_t>(at); }
inline std::int64_t load_i64_le(const unsigned char *at) noexcept { return load_le<std::int64_t>(at); }
inline std::int64_t load_i64_be(const unsigned char *at) noexcept { return load_be<std::int64_t>(at); }
inline float load_f32_le(const unsigned char *at) noexcept { return load_le<float>(at); }
inline float load_f32_be(const unsigned char *at) noexcept { return load_be<float>(at); }
inline double load_f64_le(const unsigned char *at) noexcept { return load_le<double>(at); }
inline double load_f64_be(const unsigned char *at) noexcept { return load_be<double>(at); }

/* A number as a message has it. */
template <class Number> void store_le(unsigned char *at, Number number) noexcept { std::memcpy(at, &number, sizeof number); }
template <class Number> void store_be(unsigned char *at, Number number) noexcept
{
    bytes_of<Number> bytes;
    static_assert(sizeof number == sizeof bytes, "numbers have two, four or eight bytes");
    std::memcpy(&bytes, &number, sizeof number);
    store_le(at, turned(bytes));
}

inline void store_bool(unsigned char *at, bool holds) noexcept { *at = holds ? 1 : 0; }
inline void store_u8(unsigned char *at, std::uint8_t number) noexcept { *at = number; }
inline void store_i8(unsigned char *at, std::int8_t number) noexcept { *at = static_cast<unsigned char>(number); }
inline void store_u16_le(unsigned char *at, std::uint16_t number) noexcept { store_le(at, number); }
inline void store_u16_be(unsigned char *at, std::uint16_t number) noexcept { store_be(at, number); }
inline void store_i16_le(unsigned char *at, std::int16_t number) noexcept { store_le(at, number); }
inline void store_i16_be(unsigned char *at, std::int16_t number) noexcept { store_be(at, number); }
inline void store_u32_le(unsigned char *at, std::uint32_t number) noexcept { store_le(at, number); }
inline void store_u32_be(unsigned char *at, std::uint32_t number) noexcept { store_be(at, number); }
inline void store_i32_le(unsigned char *at, std::int32_t number) noexcept { store_le(at, number); }
inline void store_i32_be(unsigned char *at, std::int32_t number) noexcept { store_be(at, number); }
inline void store_u64_le(unsigned char *at, std::uint64_t number) noexcept { store_le(at, number); }
inline void store_u64_be(unsigned char *at, std::uint64_t number) noexcept { store_be(at, number); }
inline void store_i64_le(unsigned char *at, std::int64_t number) noexcept { store_le(at, number); }
inline void store_i64_be(unsigned char *at, std::int64_t number) noexcept { store_be(at, number); }
inline void store_f32_le(unsigned char *at, float number) noexcept { store_le(at, number); }
inline void store_f32_be(unsigned char *at, float number) noexcept { store_be(at, number); }
inline void store_f64_le(unsigned char *at, double number) noexcept { store_le(at, number); }
inline void store_f64_be(unsigned char *at, double number) noexcept { store_be(at, number); }

/* --- lanes: the elements of all arrays of one field --- */

/* Rows for one message of `bytes`; a mapping that asks for more takes a length from what the message says. */
constexpr std::int64_t most_rows(std::size_t bytes) noexcept
{
    const std::size_t most = std::size_t{1} << 40;
    return (std::int64_t{1} << 20) + 64 * static_cast<std::int64_t>(bytes < most ? bytes : most);
}

/* Rows of its own; to write a message, it may show the elements of a container instead. */
template <class Row> struct lane {
    Row *rows = nullptr;
    std::int64_t capacity = 0;
    std::int64_t used = 0;
    std::int64_t room = 0; /* of the memory */
    std::unique_ptr<Row[]> memory;
    std::unique_ptr<Row[]> saved;
    std::int64_t saved_room = 0;

    /* Copies the rows in use, which `restore` brings back. */
    void save()
    {
        if (saved_room < used) {
            saved.reset(new Row[static_cast<std::size_t>(capacity)]);
            saved_room = capacity;
        }
        if (used > 0) {
            std::memcpy(static_cast<void *>(saved.get()), rows, static_cast<std::size_t>(used) * sizeof(Row));
        }
    }

    void restore()
    {
        if (used > 0) {
            std::memcpy(static_cast<void *>(rows), saved.get(), static_cast<std::size_t>(used) * sizeof(Row));
        }
    }

    /* No rows: `clear` where no elements of a container have been shown, which `reset` changes for its own memory. */
    void clear() noexcept { used = 0; }

    void reset() noexcept
    {
        rows = memory.get();
        capacity = room;
        used = 0;
    }

    void show(const Row *elements, std::int64_t count)
    {
        rows = const_cast<Row *>(elements); /* the functions that write messages change no row */
        capacity = count;
        used = count;
    }

    /* Makes room for more rows; false where that would be more than `most`. */
    ROSETTA_JIT_COLD bool grow(std::int64_t missing, std::int64_t most)
    {
        if (missing > most - capacity) {
            return false;
        }
        const std::int64_t wanted = std::max(capacity + missing, std::min(most, capacity * 2));
        std::unique_ptr<Row[]> more(new Row[static_cast<std::size_t>(wanted)]);
        if (capacity > 0) {
            std::memcpy(static_cast<void *>(more.get()), rows, static_cast<std::size_t>(capacity) * sizeof(Row));
        }
        memory = std::move(more);
        rows = memory.get();
        capacity = wanted;
        room = wanted;
        return true;
    }
};

/* Bytes for the functions themselves, or words of eight. */
struct scratch {
    unsigned char *bytes = nullptr;
    std::int64_t size = 0;
    std::int64_t words = 0;
    std::unique_ptr<std::int64_t[]> memory;

    ROSETTA_JIT_COLD bool grow(std::int64_t missing, std::int64_t most)
    {
        if (missing > 4096 * (most / 64) - size) {
            return false;
        }
        const std::int64_t wanted = (std::max(size + missing, size * 2) + 7) / 8;
        std::unique_ptr<std::int64_t[]> more(new std::int64_t[static_cast<std::size_t>(wanted)]);
        if (size > 0) {
            std::memcpy(more.get(), bytes, static_cast<std::size_t>(size));
        }
        memory = std::move(more);
        bytes = reinterpret_cast<unsigned char *>(memory.get());
        words = wanted;
        size = words * 8;
        return true;
    }
};

/* Sets bytes, of which there are fewer than eight nearly always: a call takes longer than to set them. */
inline void fill_few(void *target, std::int64_t to, std::int64_t size, int byte) noexcept
{
    unsigned char *const at = static_cast<unsigned char *>(target) + to;
    if (size >= 8) {
        std::memset(at, byte, static_cast<std::size_t>(size));
    } else if (size >= 4) { /* the first ones and the last ones, which may be the same */
        std::memset(at, byte, 4);
        std::memset(at + size - 4, byte, 4);
    } else if (size > 0) {
        at[0] = at[size / 2] = at[size - 1] = static_cast<unsigned char>(byte);
    }
}

/* Copies bytes, if there are any. */
inline void copy_bytes(void *target, std::int64_t to, const void *source, std::int64_t from, std::int64_t size) noexcept
{
    if (size > 0) {
        std::memcpy(static_cast<unsigned char *>(target) + to, static_cast<const unsigned char *>(source) + from, static_cast<std::size_t>(size));
    }
}

/* Copies 32 to 64 bytes: the first ones and the last ones, some of which may be the same. */
ROSETTA_JIT_INLINE void copy_halves(unsigned char *at, const unsigned char *begin, std::int64_t size) noexcept
{
    unsigned char first[16], second[16], third[16], last[16];
    std::memcpy(first, begin, 16);
    std::memcpy(second, begin + 16, 16);
    std::memcpy(third, begin + size - 32, 16);
    std::memcpy(last, begin + size - 16, 16);
    std::memcpy(at, first, 16);
    std::memcpy(at + 16, second, 16);
    std::memcpy(at + size - 32, third, 16);
    std::memcpy(at + size - 16, last, 16);
}

/* Copies more than 32 bytes: a call within the program takes less time than one of the C library. */
ROSETTA_JIT_APART inline void copy_more(unsigned char *at, const unsigned char *begin, std::int64_t size) noexcept
{
    if (size <= 64) {
        copy_halves(at, begin, size);
    } else {
        std::memcpy(at, begin, static_cast<std::size_t>(size));
    }
}

/* Copies bytes, of which there are few nearly always, as in texts. */
inline void copy_few(void *target, std::int64_t to, const void *source, std::int64_t from, std::int64_t size) noexcept
{
    unsigned char *const at = static_cast<unsigned char *>(target) + to;
    const unsigned char *const begin = static_cast<const unsigned char *>(source) + from;
    const unsigned char *const end = begin + size;
    if (size <= 0) {
        return;
    }
    if (size > 32) {
        copy_more(at, begin, size);
    } else if (size >= 16) {
        unsigned char first[16], last[16];
        std::memcpy(first, begin, 16);
        std::memcpy(last, end - 16, 16);
        std::memcpy(at, first, 16);
        std::memcpy(at + size - 16, last, 16);
    } else if (size >= 8) { /* the first ones and the last ones, which may be the same */
        std::uint64_t first, last;
        std::memcpy(&first, begin, 8);
        std::memcpy(&last, end - 8, 8);
        std::memcpy(at, &first, 8);
        std::memcpy(at + size - 8, &last, 8);
    } else if (size >= 4) {
        std::uint32_t first, last;
        std::memcpy(&first, begin, 4);
        std::memcpy(&last, end - 4, 4);
        std::memcpy(at, &first, 4);
        std::memcpy(at + size - 4, &last, 4);
    } else {
        at[0] = begin[0];
        at[size / 2] = begin[size / 2];
        at[size - 1] = end[-1];
    }
}

/* Copies an array of numbers, of which there may be few, too, as of a joint or a pose: a call takes longer than to copy them. */
inline void copy_numbers(void *target, std::int64_t to, const void *source, std::int64_t from, std::int64_t size) noexcept
{
    unsigned char *const at = static_cast<unsigned char *>(target) + to;
    const unsigned char *const begin = static_cast<const unsigned char *>(source) + from;
    if (size > 64) {
        std::memcpy(at, begin, static_cast<std::size_t>(size));
    } else if (size > 32) {
        copy_halves(at, begin, size);
    } else {
        copy_few(target, to, source, from, size);
    }
}

/* Copies bytes by the function of the C library. */
ROSETTA_JIT_APART inline void copy_apart(unsigned char *target, const unsigned char *source, std::size_t size) noexcept
{
    std::memcpy(target, source, size);
}

/* Copies bytes whose number compilers know: of some hundred they make an instruction that starts slowly, and is slow where addresses are odd. */
template <std::int64_t Size> ROSETTA_JIT_INLINE void copy_known(void *target, std::int64_t to, const void *source, std::int64_t from) noexcept
{
    constexpr std::int64_t FEW = 256;
    unsigned char *const at = static_cast<unsigned char *>(target) + to;
    const unsigned char *const begin = static_cast<const unsigned char *>(source) + from;
    if constexpr (Size <= FEW) {
        std::memcpy(at, begin, static_cast<std::size_t>(Size));
    } else {
        copy_apart(at, begin, static_cast<std::size_t>(Size));
    }
}

/* Sets bytes whose number compilers know, for the same reason. */
template <std::int64_t Size> ROSETTA_JIT_INLINE void fill_known(void *target, std::int64_t to, int byte) noexcept
{
    constexpr std::int64_t AT_ONCE = 32, FEW = 4 * AT_ONCE, MANY = 1024;
    unsigned char *const at = static_cast<unsigned char *>(target) + to;
    if constexpr (Size <= AT_ONCE || Size > MANY) {
        std::memset(at, byte, static_cast<std::size_t>(Size));
    } else if constexpr (Size <= FEW) {
        std::memset(at, byte, AT_ONCE);
        fill_known<Size - AT_ONCE>(target, to + AT_ONCE, byte);
    } else {
        for (std::int64_t done = 0; done < Size - AT_ONCE; done += AT_ONCE) {
            std::memset(at + done, byte, AT_ONCE);
        }
        std::memset(at + Size - AT_ONCE, byte, AT_ONCE); /* some of them again, if there are fewer */
    }
}

/* --- protobuf's integers, of which each byte has seven bits and says whether another one follows --- */

constexpr std::uint64_t GOES_ON = 0x8080808080808080u; /* of each of eight bytes */

inline std::uint64_t word_at(const unsigned char *bytes) noexcept
{
    std::uint64_t word;
    std::memcpy(&word, bytes, sizeof word);
    return word;
}

/* Sixteen bytes, of which machines can join several at once. */
#if defined(__SSE2__) || defined(__ARM_NEON)
typedef std::uint64_t pair __attribute__((vector_size(16)));
#else
struct pair {
    std::uint64_t words[2];
    std::uint64_t operator[](std::size_t word) const noexcept { return words[word]; }
    friend pair operator|(const pair &one, const pair &other) noexcept { return {{one[0] | other[0], one[1] | other[1]}}; }
};
#endif

inline pair pair_at(const unsigned char *bytes) noexcept
{
    pair found;
    std::memcpy(&found, bytes, sizeof found);
    return found;
}

/* Whether bytes are ASCII, as most texts are: the first ones and the last ones, which may be the same, and those between. */
inline bool is_ascii(const void *memory, std::int64_t start, std::int64_t size) noexcept
{
    const unsigned char *const text = static_cast<const unsigned char *>(memory) + start;
    if (size <= 0) {
        return true;
    }
    if (size >= 16) {
        pair any = pair_at(text) | pair_at(text + size - 16);
        if (size > 32) {
            const unsigned char *const last = text + size - 32;
            const unsigned char *at = text + 32;
            any = any | (pair_at(text + 16) | pair_at(last));
            for (; last - at > 32; at += 64) {
                any = any | ((pair_at(at) | pair_at(at + 16)) | (pair_at(at + 32) | pair_at(at + 48)));
            }
            if (at < last) {
                any = any | (pair_at(at) | pair_at(at + 16));
            }
        }
        return ((any[0] | any[1]) & GOES_ON) == 0;
    }
    if (size >= 8) {
        return ((word_at(text) | word_at(text + size - 8)) & GOES_ON) == 0;
    }
    if (size >= 4) {
        std::uint32_t first, last;
        std::memcpy(&first, text, sizeof first);
        std::memcpy(&last, text + size - 4, sizeof last);
        return ((first | last) & 0x80808080u) == 0;
    }
    return (text[0] | text[size / 2] | text[size - 1]) < 128;
}

/* Whether a byte of a character lies between two others. */
inline bool follows(unsigned char byte, unsigned char low, unsigned char high) noexcept
{
    return byte >= low && byte <= high;
}

/* Whether bytes are valid UTF-8 (Unicode 15, table 3-7). */
ROSETTA_JIT_APART inline bool is_text(const void *memory, std::int64_t start, std::int64_t size) noexcept
{
    if (size <= 0) {
        return true;
    }
    const unsigned char *text = static_cast<const unsigned char *>(memory) + start;
    std::int64_t at = 0;
    while (at < size) {
        std::uint64_t eight;
        if (size - at >= 8) {
            std::memcpy(&eight, text + at, sizeof eight);
            if ((eight & GOES_ON) == 0) {
                at += 8;
                continue;
            }
        } else if (size >= 8) { /* the last eight, some of which have been looked at */
            std::memcpy(&eight, text + size - 8, sizeof eight);
            if ((eight & GOES_ON) == 0) {
                return true;
            }
        }
        const unsigned char first = text[at];
        if (first < 0x80) {
            at += 1;
            continue;
        }
        const std::int64_t more = first < 0xe0 ? 1 : first < 0xf0 ? 2 : 3;
        if (first < 0xc2 || first > 0xf4 || size - at <= more) {
            return false;
        }
        const unsigned char low = first == 0xe0 ? 0xa0 : first == 0xf0 ? 0x90 : 0x80;
        const unsigned char high = first == 0xed ? 0x9f : first == 0xf4 ? 0x8f : 0xbf;
        if (!follows(text[at + 1], low, high)) {
            return false;
        }
        for (std::int64_t next = 2; next <= more; next++) {
            if (!follows(text[at + next], 0x80, 0xbf)) {
                return false;
            }
        }
        at += 1 + more;
    }
    return true;
}

/* The number of the highest bit that is set; of 0 and 1 it is 0. */
inline unsigned highest_bit(std::uint64_t number) noexcept
{
#if defined(__GNUC__)
    return 63u ^ static_cast<unsigned>(__builtin_clzll(number | 1u));
#else
    unsigned found = 0;
    for (; number > 1; number >>= 1) {
        found++;
    }
    return found;
#endif
}

/* The number of the lowest bit that is set, where one is. */
inline unsigned lowest_bit(std::uint64_t number) noexcept
{
#if defined(__GNUC__)
    return static_cast<unsigned>(__builtin_ctzll(number));
#else
    unsigned found = 0;
    for (; (number & 1u) == 0; number >>= 1) {
        found++;
    }
    return found;
#endif
}

/* The bytes that a number takes: 9/64 is near enough to 1/7. */
inline std::int64_t varint_size(std::uint64_t number) noexcept
{
    return static_cast<std::int64_t>((highest_bit(number) * 9u + 73u) / 64u);
}

/* The lower seven bits of eight bytes as a number, and a number of 56 bits as such bytes: by halves, quarters, and eighths. */
inline std::uint64_t bits_joined(std::uint64_t bytes) noexcept
{
    bytes -= (bytes & 0x7f007f007f007f00u) >> 1;
    bytes = (bytes & 0x00003fff00003fffu) | ((bytes & 0x3fff00003fff0000u) >> 2);
    return (bytes & 0x0fffffffu) | ((bytes & 0x0fffffff00000000u) >> 4);
}

inline std::uint64_t bits_apart(std::uint64_t number) noexcept
{
    number += (number & 0x00fffffff0000000u) * 15u;
    number += (number & 0x0fffc0000fffc000u) * 3u;
    return number + (number & 0x3f803f803f803f80u);
}

/* What is set in the bytes of a number of one to eight bytes, but for the last one. */
inline constexpr std::uint64_t VARINT_MORE[9] = {
    0, 0, 0x80, 0x8080, 0x808080, 0x80808080, 0x8080808080, 0x808080808080, 0x80808080808080};

/* Writes a number where there is room for ten bytes, and says how many it has taken. Those behind it may be set, too. */
inline std::int64_t write_varint(unsigned char *target, std::uint64_t number) noexcept
{
    if (number < std::uint64_t{1} << 56) {
        const std::int64_t size = varint_size(number);
        const std::uint64_t word = bits_apart(number) | VARINT_MORE[size];
        std::memcpy(target, &word, sizeof word);
        return size;
    }
    const std::uint64_t word = bits_apart(number & 0x00ffffffffffffffu) | GOES_ON;
    const unsigned high = static_cast<unsigned>(number >> 56), last = high >> 7;
    std::memcpy(target, &word, sizeof word);
    target[8] = static_cast<unsigned char>(high);
    target[9] = static_cast<unsigned char>(last);
    return 9 + static_cast<std::int64_t>(last);
}

/* The same where other parts of the message are behind it already. */
inline std::int64_t write_varint_exactly(unsigned char *target, std::uint64_t number) noexcept
{
    unsigned char *at = target;
    for (; number >= 128u; number >>= 7) {
        *at++ = static_cast<unsigned char>(number | 128u);
    }
    *at++ = static_cast<unsigned char>(number);
    return at - target;
}

/* How many bytes more than one lengths of each kind get: as many as the longest of late. Shorter ones change that once there were four. */
struct longer {
    unsigned char more[256] = {};
    unsigned char shorter[256] = {};

    void learn(std::int64_t kind, std::int64_t width, bool is_shorter) noexcept
    {
        unsigned char &count = shorter[kind & 255];
        count = static_cast<unsigned char>(is_shorter ? (count + 1) % 4 : 0);
        if (count == 0) {
            more[kind & 255] = static_cast<unsigned char>(width - 1);
        }
    }
};

/* The lengths in a message that is written. If it was measured first, they are known in the order in which they come; else each has as many bytes as others
   of its kind had, and what it is of moves where that takes more or fewer. As often as messages lie within each other, as often they may move: where no byte is
   left of those that may, as more than measuring would take, writing ends. */
struct lengths {
    const unsigned char *known = nullptr;
    std::int64_t next = 0;
    std::int64_t left = 0;
    longer *late = nullptr;

    /* Where something begins whose length is `at` a position. */
    ROSETTA_JIT_INLINE std::int64_t opened(std::int64_t at, std::int64_t kind) noexcept
    {
        if (ROSETTA_JIT_UNLIKELY(known != nullptr)) {
            std::int64_t size;
            std::memcpy(&size, known + next++ * 8, sizeof size);
            return at + varint_size(static_cast<std::uint64_t>(size));
        }
        left += 128;
        return at + 1 + late->more[kind & 255];
    }

    /* Where it ends; -1 where no byte is left. */
    ROSETTA_JIT_INLINE std::int64_t closed(unsigned char *bytes, std::int64_t end, std::int64_t at, std::int64_t begin, std::int64_t behind, std::int64_t kind) noexcept
    {
        const std::int64_t size = behind - begin;
        if (size < 128 && begin - at == 1) {
            bytes[at] = static_cast<unsigned char>(size);
            return behind;
        }
        if (size >= 128 && size < 1 << 14 && begin - at == 2) {
            bytes[at] = static_cast<unsigned char>(size | 128);
            bytes[at + 1] = static_cast<unsigned char>(size >> 7);
            return behind;
        }
        return closed_long(bytes, end, at, begin, behind, kind);
    }

    ROSETTA_JIT_APART std::int64_t closed_long(unsigned char *bytes, std::int64_t end, std::int64_t at, std::int64_t begin, std::int64_t behind, std::int64_t kind) noexcept
    {
        const std::int64_t size = behind - begin, width = varint_size(static_cast<std::uint64_t>(size)), by = at + width - begin;
        if (by != 0) {
            if (known != nullptr) {
                return -1;
            }
            late->learn(kind, width, by < 0);
            left -= size;
            if (by > end - behind || left < 0) {
                return -1;
            }
            std::memmove(bytes + begin + by, bytes + begin, static_cast<std::size_t>(size));
        }
        write_varint_exactly(bytes + at, static_cast<std::uint64_t>(size));
        return behind + by;
    }
};

/* The same of a number below 1 << 14, where there is room for two bytes. */
inline std::int64_t write_varint_of_two(unsigned char *target, std::uint64_t number) noexcept
{
    const std::uint64_t more = (number + 0x3f80u) >> 14;
    const std::uint16_t both = static_cast<std::uint16_t>(number + (number & 0x3f80u) + (more << 7));
    std::memcpy(target, &both, sizeof both);
    return 1 + static_cast<std::int64_t>(more);
}

/* Two numbers below 1 << 42 are written where there is room for 16 bytes, and the bytes of several numbers are counted, as many as come in groups. */
#if defined(__SSE2__)
/* The exponents, from bit 52 on, of two numbers below 1 << 52 as floats that are four times as large: 1025 and the number of the highest bit. */
ROSETTA_JIT_INLINE pair exponents(pair numbers) noexcept
{
    typedef double floats __attribute__((vector_size(16)));
    constexpr std::uint64_t HUGE_FLOAT = std::uint64_t{1023 + 54} << 52; /* 1 << 54, whose fraction counts fours */
    const floats sums = reinterpret_cast<floats>(numbers | pair{HUGE_FLOAT | 1, HUGE_FLOAT | 1});
    return reinterpret_cast<pair>(sums - floats{0x1p54, 0x1p54});
}

ROSETTA_JIT_INLINE std::int64_t write_two_varints(unsigned char *target, std::uint64_t first, std::uint64_t second) noexcept
{
    constexpr std::uint64_t LOW = 0x3fff, MIDDLE = LOW << 16, HIGH = LOW << 32, UPPER = 0x3f803f803f80u;
    const pair numbers = {first, second};
    const pair halves = (numbers & pair{LOW, LOW}) | ((numbers << 2) & pair{MIDDLE, MIDDLE}) | ((numbers << 4) & pair{HIGH, HIGH});
    const pair apart = halves + (halves & pair{UPPER, UPPER}), sizes = exponents(apart) >> 55; /* an eighth of them: 128 and the number of the last byte */
    const std::uint64_t one = sizes[0] - 127, other = sizes[1] - 127;
    const pair words = apart | pair{VARINT_MORE[one], VARINT_MORE[other]};
    const std::uint64_t written[2] = {words[0], words[1]};
    std::memcpy(target, &written[0], sizeof written[0]);
    std::memcpy(target + one, &written[1], sizeof written[1]);
    return static_cast<std::int64_t>(one + other);
}

template <class Value> ROSETTA_JIT_INLINE std::int64_t size_of_several(std::int64_t &number, std::int64_t count, Value value)
{
    constexpr std::int64_t EXCESS = 143; /* 9/64 of the exponent are so many bytes more than the number has */
    const __m128i nine_of_64 = _mm_set1_epi16(9 << 10);
    std::int64_t size = 0;
    pair sizes = {0, 0};
    const auto of_two = [&](pair each) { return reinterpret_cast<pair>(_mm_mulhi_epu16(reinterpret_cast<__m128i>(exponents(each) >> 52), nine_of_64)); };
    const auto longer = [](pair each) { return (each + pair{0x3f80, 0x3f80}) >> 14; }; /* 1 if they take two bytes, not one */
    for (; count - number >= 8; number += 8) {
        const pair a = {value(number), value(number + 1)}, b = {value(number + 2), value(number + 3)};
        const pair c = {value(number + 4), value(number + 5)}, d = {value(number + 6), value(number + 7)};
        const pair any = (a | b) | (c | d);
        const std::uint64_t all = any[0] | any[1];
        if (all < std::uint64_t{1} << 14) {
            sizes += (longer(a) + longer(b)) + (longer(c) + longer(d));
            size += 8;
        } else if (all < std::uint64_t{1} << 52) {
            sizes += (of_two(a) + of_two(b)) + (of_two(c) + of_two(d));
            size -= 8 * EXCESS;
        } else {
            for (std::int64_t each = number; each < number + 8; each++) {
                size += varint_size(value(each));
            }
        }
    }
    return size + static_cast<std::int64_t>(sizes[0] + sizes[1]);
}
#else
inline std::int64_t write_two_varints(unsigned char *target, std::uint64_t first, std::uint64_t second) noexcept
{
    const std::int64_t size = write_varint(target, first);
    return size + write_varint(target + size, second);
}

template <class Value> ROSETTA_JIT_INLINE std::int64_t size_of_several(std::int64_t &number, std::int64_t count, Value value)
{
    std::int64_t size = 0;
    for (; count - number >= 4; number += 4) {
        size += varint_size(value(number)) + varint_size(value(number + 1)) + varint_size(value(number + 2)) + varint_size(value(number + 3));
    }
    return size;
}
#endif

/* The bytes that numbers take from `number` on; `value` says which they are. */
template <class Value> ROSETTA_JIT_INLINE std::int64_t size_of_varints(std::int64_t &number, std::int64_t count, Value value)
{
    std::int64_t size = size_of_several(number, count, value);
    for (; number < count; number++) {
        size += varint_size(value(number));
    }
    return size;
}

/* The same of bools, which take a byte each. */
template <class Value> std::int64_t size_of_flags(std::int64_t number, std::int64_t count, Value) noexcept
{
    return count - number;
}

/* Writes those numbers as long as there is room; it says where, and which one is next. Of four numbers the largest says how they are written. */
template <class Value>
ROSETTA_JIT_INLINE std::int64_t write_varints(unsigned char *bytes, std::int64_t end, std::int64_t at, std::int64_t &number, std::int64_t count, Value value)
{
    for (; count - number >= 4; number += 4) {
        const std::uint64_t each[4] = {value(number), value(number + 1), value(number + 2), value(number + 3)};
        const std::uint64_t all = each[0] | each[1] | each[2] | each[3];
        unsigned char *const target = bytes + at;
        std::int64_t size = 4;
        if (all < 128u && end - at >= 4) {
            const std::uint32_t four = static_cast<std::uint32_t>(each[0] | each[1] << 8 | each[2] << 16 | each[3] << 24);
            std::memcpy(target, &four, sizeof four);
        } else if (all < 1u << 14 && end - at >= 8) {
            size = write_varint_of_two(target, each[0]);
            size += write_varint_of_two(target + size, each[1]);
            size += write_varint_of_two(target + size, each[2]);
            size += write_varint_of_two(target + size, each[3]);
        } else if (all < std::uint64_t{1} << 42 && end - at >= 32) {
            size = write_two_varints(target, each[0], each[1]);
            size += write_two_varints(target + size, each[2], each[3]);
        } else if (end - at >= 40) {
            size = write_varint(target, each[0]);
            size += write_varint(target + size, each[1]);
            size += write_varint(target + size, each[2]);
            size += write_varint(target + size, each[3]);
        } else {
            break;
        }
        at += size;
    }
    for (; number < count; number++) {
        std::uint64_t rest = value(number);
        if (end - at >= 10) {
            at += rest < 128u ? (bytes[at] = static_cast<unsigned char>(rest), 1) : write_varint(bytes + at, rest);
            continue;
        }
        if (varint_size(rest) > end - at) {
            break;
        }
        for (; rest >= 128u; rest >>= 7) {
            bytes[at++] = static_cast<unsigned char>(rest | 128u);
        }
        bytes[at++] = static_cast<unsigned char>(rest);
    }
    return at;
}

/* Four bytes as bools: 1 for all but 0. And eight, and sixteen. */
inline void copy_four_flags(unsigned char *target, const unsigned char *rows) noexcept
{
    std::uint32_t four;
    std::memcpy(&four, rows, sizeof four);
    const std::uint32_t set = (((four & 0x7f7f7f7fu) + 0x7f7f7f7fu) | four) >> 7 & 0x01010101u;
    std::memcpy(target, &set, sizeof set);
}

inline void copy_eight_flags(unsigned char *target, const unsigned char *rows) noexcept
{
    const std::uint64_t eight = word_at(rows);
    const std::uint64_t set = (((eight & ~GOES_ON) + ~GOES_ON) | eight) >> 7 & 0x0101010101010101u;
    std::memcpy(target, &set, sizeof set);
}

inline void copy_sixteen_flags(unsigned char *target, const unsigned char *rows) noexcept
{
#if defined(__SSE2__) || defined(__ARM_NEON)
    typedef std::uint8_t sixteen __attribute__((vector_size(16)));
    constexpr sixteen NONE = {}, ONES = {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1};
    sixteen bytes;
    std::memcpy(&bytes, rows, sizeof bytes);
    bytes = reinterpret_cast<sixteen>(bytes != NONE) & ONES;
    std::memcpy(target, &bytes, sizeof bytes);
#else
    copy_eight_flags(target, rows);
    copy_eight_flags(target + 8, rows + 8);
#endif
}

/* Four bytes or more as bools, of which the last ones may be set twice. */
inline void copy_more_flags(unsigned char *to, const unsigned char *from, std::int64_t count) noexcept
{
    if (count >= 16) {
        std::int64_t done = 0;
        for (; count - done > 32; done += 32) {
            copy_sixteen_flags(to + done, from + done);
            copy_sixteen_flags(to + done + 16, from + done + 16);
        }
        if (count - done > 16) {
            copy_sixteen_flags(to + done, from + done);
        }
        copy_sixteen_flags(to + count - 16, from + count - 16);
        return;
    }
    if (count >= 8) {
        copy_eight_flags(to, from);
        copy_eight_flags(to + count - 8, from + count - 8);
        return;
    }
    copy_four_flags(to, from);
    copy_four_flags(to + count - 4, from + count - 4);
}

/* Bytes as bools. A call takes longer than to set a few. */
ROSETTA_JIT_INLINE void copy_flags(void *target, const void *rows, std::int64_t count) noexcept
{
    unsigned char *const to = static_cast<unsigned char *>(target);
    const unsigned char *const from = static_cast<const unsigned char *>(rows);
    if (count >= 4) {
        copy_more_flags(to, from, count);
        return;
    }
    for (std::int64_t done = 0; done < count; done++) {
        to[done] = from[done] != 0 ? 1 : 0;
    }
}

/* Bytes that are bools of a message, from one place and another one, which may be the same in part: false where any is neither 0 nor 1. */
template <class Bytes> ROSETTA_JIT_INLINE bool read_flags_at(std::uint8_t *rows, const unsigned char *bytes, std::int64_t at, std::int64_t other) noexcept
{
    constexpr std::uint64_t OTHERS = ~UINT64_C(0x0101010101010101);
    Bytes first, second;
    std::memcpy(&first, bytes + at, sizeof first);
    std::memcpy(&second, bytes + other, sizeof second);
    const auto any = first | second;
    if constexpr (sizeof(Bytes) > 8) {
        if (((any[0] | any[1]) & OTHERS) != 0) {
            return false;
        }
    } else if ((any & static_cast<Bytes>(OTHERS)) != 0) {
        return false;
    }
    std::memcpy(rows + at, &first, sizeof first);
    std::memcpy(rows + other, &second, sizeof second);
    return true;
}

/* Bools of a message, up to one that is neither 0 nor 1, or some before it: says how many they are. */
ROSETTA_JIT_INLINE std::int64_t read_flags(std::uint8_t *rows, const unsigned char *bytes, std::int64_t count) noexcept
{
    if (count >= 16) {
        std::int64_t done = 0;
        for (; count - done > 32; done += 32) {
            if (!read_flags_at<pair>(rows, bytes, done, done + 16)) {
                return done;
            }
        }
        return read_flags_at<pair>(rows, bytes, std::min(done, count - 16), count - 16) ? count : done;
    }
    if (count >= 8) {
        return read_flags_at<std::uint64_t>(rows, bytes, 0, count - 8) ? count : 0;
    }
    if (count >= 4) {
        return read_flags_at<std::uint32_t>(rows, bytes, 0, count - 4) ? count : 0;
    }
    if (count > 0 && (bytes[0] | bytes[count / 2] | bytes[count - 1]) < 2) {
        const std::uint8_t first = bytes[0], middle = bytes[count / 2], last = bytes[count - 1];
        rows[0] = first;
        rows[count / 2] = middle;
        rows[count - 1] = last;
        return count;
    }
    return 0;
}

/* The same into elements of a list, which are bytes one behind the other, or not. */
template <class Elements> ROSETTA_JIT_INLINE std::int64_t read_flags_of(Elements elements, std::int64_t row, const unsigned char *bytes, std::int64_t count) noexcept
{
    if constexpr (std::is_pointer_v<Elements> && sizeof(*elements) == 1) {
        return read_flags(reinterpret_cast<std::uint8_t *>(elements + row), bytes, count);
    } else {
        return 0;
    }
}

/* Writes bools as long as there is room. */
inline std::int64_t write_flags(unsigned char *bytes, std::int64_t end, std::int64_t at, std::int64_t &number, std::int64_t count, const std::uint8_t *rows) noexcept
{
    const std::int64_t several = std::min(count - number, end - at);
    if (several > 0) {
        copy_flags(bytes + at, rows + number, several);
        number += several;
        at += several;
    }
    return at;
}

/* How many bools an array of protobuf's has: 0 where one takes several bytes, as none does that is written. */
inline std::int64_t count_of_flags(const unsigned char *bytes, std::int64_t at, std::int64_t stop) noexcept
{
    return is_ascii(bytes, at, stop - at) ? stop - at : 0;
}

/* Reads them, and says how many. */
inline std::int64_t read_flags_of_varints(const unsigned char *bytes, std::int64_t &at, std::int64_t stop, std::uint8_t *rows) noexcept
{
    const std::int64_t count = stop - at;
    copy_flags(rows, bytes + at, count);
    at = stop;
    return count;
}

constexpr std::int64_t FEW_BYTES = 32; /* of an array whose integers are not worth to be counted */

#if defined(__SSE2__)
/* Sixteen bytes for instructions that change each of them, and eight. */
inline __m128i sixteen_at(const unsigned char *bytes) noexcept { return _mm_loadu_si128(reinterpret_cast<const __m128i *>(bytes)); }
inline __m128i eight_at(const unsigned char *bytes) noexcept { return _mm_loadl_epi64(reinterpret_cast<const __m128i *>(bytes)); }
#endif

/* How many integers end between two places of a message; 0 where it is not worth to count them. */
inline std::int64_t count_of_varints(const unsigned char *bytes, std::int64_t at, std::int64_t stop, std::int64_t end) noexcept
{
    if (stop - at < FEW_BYTES || stop > end || at < 1) {
        return 0;
    }
    std::int64_t count = 0;
#if defined(__SSE2__)
    __m128i counts = _mm_setzero_si128();
    while (stop - at >= 16) {
        __m128i each = _mm_setzero_si128(); /* a byte for each of the sixteen */
        for (const std::int64_t last = std::min(stop - 15, at + 255 * 16); at < last; at += 16) {
            each = _mm_sub_epi8(each, _mm_cmpgt_epi8(sixteen_at(bytes + at), _mm_set1_epi8(-1)));
        }
        counts = _mm_add_epi64(counts, _mm_sad_epu8(each, _mm_setzero_si128()));
    }
    std::int64_t both[2];
    std::memcpy(both, &counts, sizeof both);
    count = both[0] + both[1];
#endif
    while (stop - at >= 8) {
        std::uint64_t each = 0; /* a byte for each of the eight */
        for (const std::int64_t last = std::min(stop - 7, at + 255 * 8); at < last; at += 8) {
            each += (~word_at(bytes + at) & GOES_ON) >> 7;
        }
        const std::uint64_t pairs = (each & 0x00ff00ff00ff00ffu) + (each >> 8 & 0x00ff00ff00ff00ffu);
        count += static_cast<std::int64_t>((pairs * 0x0001000100010001u) >> 48);
    }
    const std::uint64_t others = GOES_ON >> 8 * (stop - at); /* of the last eight bytes, those that are counted already */
    return count + static_cast<std::int64_t>((((~word_at(bytes + stop - 8) & GOES_ON & ~others) >> 7) * 0x0101010101010101u) >> 56);
}

/* Which of up to 64 bytes end an integer: a bit each. There are as many whole words. */
inline std::uint64_t last_bytes(const unsigned char *bytes, std::int64_t size) noexcept
{
    std::uint64_t found = 0;
    std::int64_t at = 0;
#if defined(__SSE2__)
    for (; size - at >= 16; at += 16) {
        found |= static_cast<std::uint64_t>(_mm_movemask_epi8(sixteen_at(bytes + at)) ^ 0xffff) << at;
    }
#endif
    for (; at < size; at += 8) {
        found |= (((~word_at(bytes + at) & GOES_ON) * 0x0002040810204081u) >> 56) << at;
    }
    return size < 64 ? found & ((std::uint64_t{1} << size) - 1) : found;
}

/* Integers of one or two bytes, by the last byte of each; of longer ones the last two bytes. There are as many whole words of bytes, and one before them. */
struct short_varints {
#if defined(__SSE2__)
    std::uint16_t each[64];

    short_varints(const unsigned char *bytes, std::int64_t size) noexcept
    {
        for (std::int64_t at = 0; at < size; at += 8) {
            const __m128i last = eight_at(bytes + at), before = eight_at(bytes + at - 1), two = _mm_cmpgt_epi8(_mm_setzero_si128(), before);
            const __m128i low = _mm_or_si128(_mm_and_si128(two, before), _mm_andnot_si128(two, last)), high = _mm_and_si128(two, last);
            const __m128i joined = _mm_srli_epi16(_mm_unpacklo_epi8(_mm_add_epi8(low, low), high), 1);
            std::memcpy(each + at, &joined, sizeof joined);
        }
    }
    std::uint64_t operator[](unsigned at) const noexcept { return each[at]; }
#else
    const unsigned char *bytes;

    short_varints(const unsigned char *from, std::int64_t) noexcept : bytes(from) {}
    std::uint64_t operator[](unsigned at) const noexcept
    {
        const std::uint64_t before = bytes[std::ptrdiff_t{at} - 1], byte = bytes[at], longer = (before >> 7) * 127u;
        return byte * (longer + 1u) + (before & longer);
    }
#endif
};

/* The same where all have a number of bytes. */
inline constexpr std::uint64_t ALIKE[8] = {
    0xffffffffffffffff, 0xaaaaaaaaaaaaaaaa, 0x4924924924924924, 0x8888888888888888,
    0x0842108421084210, 0x0820820820820820, 0x4081020408102040, 0x8080808080808080,
};
/* The bits of an integer of a number of bytes. */
inline constexpr std::uint64_t VARINT_BITS[8] = {
    0x7f, 0x7f7f, 0x7f7f7f, 0x7f7f7f7f, 0x7f7f7f7f7f, 0x7f7f7f7f7f7f, 0x7f7f7f7f7f7f7f, 0x7f7f7f7f7f7f7f7f,
};

/* The integer that eight bytes from `at` on begin with, or are all of, and where it ends; `stops` are the bytes that end one. */
ROSETTA_JIT_INLINE std::uint64_t read_eight(std::int64_t at, std::uint64_t word, std::int64_t *next, std::uint64_t *stops) noexcept
{
    *stops = ~word & GOES_ON;
    const unsigned more = *stops == 0 ? 7 : lowest_bit(*stops) / 8;
    *next = at + 1 + more;
    return bits_joined(word & VARINT_BITS[more]);
}

/* Reads integers of one number of bytes each, whose words are in the message. */
template <class Row, class Number> void read_alike(const unsigned char *bytes, std::int64_t width, std::int64_t count, Row *rows, Number number)
{
    std::int64_t each = 0;
    switch (width) {
    case 1:
        for (; count - each >= 8; each += 8) {
            const std::uint64_t word = word_at(bytes + each);
            rows[each] = static_cast<Row>(number(word & 255u));
            rows[each + 1] = static_cast<Row>(number(word >> 8 & 255u));
            rows[each + 2] = static_cast<Row>(number(word >> 16 & 255u));
            rows[each + 3] = static_cast<Row>(number(word >> 24 & 255u));
            rows[each + 4] = static_cast<Row>(number(word >> 32 & 255u));
            rows[each + 5] = static_cast<Row>(number(word >> 40 & 255u));
            rows[each + 6] = static_cast<Row>(number(word >> 48 & 255u));
            rows[each + 7] = static_cast<Row>(number(word >> 56));
        }
        for (; each < count; each++) {
            rows[each] = static_cast<Row>(number(std::uint64_t{bytes[each]}));
        }
        return;
    case 2:
        for (; count - each >= 4; each += 4) {
            const std::uint64_t word = word_at(bytes + 2 * each) & ~GOES_ON, four = word - ((word & 0x7f007f007f007f00u) >> 1);
            rows[each] = static_cast<Row>(number(four & 0x3fffu));
            rows[each + 1] = static_cast<Row>(number(four >> 16 & 0x3fffu));
            rows[each + 2] = static_cast<Row>(number(four >> 32 & 0x3fffu));
            rows[each + 3] = static_cast<Row>(number(four >> 48));
        }
        for (; each < count; each++) {
            const std::uint64_t low = bytes[2 * each], high = bytes[2 * each + 1];
            rows[each] = static_cast<Row>(number((low & 127u) | high << 7));
        }
        return;
    case 3:
    case 4:
        for (; each < count; each++) {
            const std::uint64_t four = word_at(bytes + width * each) & VARINT_BITS[width - 1], pairs = four - ((four & 0x7f007f00u) >> 1);
            rows[each] = static_cast<Row>(number((pairs & 0x3fffu) | (pairs >> 2 & 0x0fffc000u)));
        }
        return;
    default:
        for (; each < count; each++) {
            rows[each] = static_cast<Row>(number(bits_joined(word_at(bytes + width * each) & VARINT_BITS[width - 1])));
        }
    }
}

/* Integers that end where bits are set, as far as they are not too long. */
template <class Row, class Number>
ROSETTA_JIT_INLINE Row *read_long(const unsigned char *bytes, std::int64_t &start, std::uint64_t &last, Row *next, Number number)
{
    for (; last != 0; last &= last - 1) {
        const std::int64_t ends = lowest_bit(last), longer = ends - start;
        std::uint64_t value = 0;
        if (longer < 8) {
            value = bits_joined(word_at(bytes + start) & VARINT_BITS[longer]);
        } else if (longer < 10) {
            value = bits_joined(word_at(bytes + start) & VARINT_BITS[7]) | std::uint64_t{bytes[start + 8] & 127u} << 56;
            value |= longer == 9 ? std::uint64_t{bytes[ends]} << 63 : 0;
        } else {
            break;
        }
        *next++ = static_cast<Row>(number(value));
        start = ends + 1;
    }
    return next;
}

/* The same where they have up to four bytes. */
template <class Row, class Number>
ROSETTA_JIT_INLINE Row *read_middle(const unsigned char *bytes, std::int64_t &start, std::uint64_t &last, Row *next, Number number)
{
    for (; last != 0; last &= last - 1) {
        const std::int64_t ends = lowest_bit(last);
        const std::uint32_t four = static_cast<std::uint32_t>(word_at(bytes + start) & VARINT_BITS[ends - start]), pairs = four - ((four & 0x7f007f00u) >> 1);
        *next++ = static_cast<Row>(number(std::uint64_t{(pairs & 0x3fffu) | (pairs >> 2 & 0x0fffc000u)}));
        start = ends + 1;
    }
    return next;
}

/* And where they have one or two. */
template <class Row, class Number>
ROSETTA_JIT_INLINE Row *read_short(const unsigned char *bytes, std::int64_t size, std::int64_t &start, std::uint64_t &last, Row *next, Number number)
{
    const short_varints values(bytes, size);
    start = last == 0 ? start : std::int64_t{highest_bit(last)} + 1;
    for (; last != 0; last &= last - 1) {
        *next++ = static_cast<Row>(number(values[lowest_bit(last)]));
    }
    return next;
}

/* How many bytes the longest of some integers has, as far as it matters: up to two, up to four, or more. `more` are the bytes that end none, a bit each,
   and `open` is how many of the first integer are before them. */
inline int longest_varint(std::uint64_t more, std::int64_t open) noexcept
{
    const std::uint64_t before = open < 4 ? 0xfu >> open ^ 0xfu : 0xfu; /* the highest of its four bits is the last byte */
    const std::uint64_t three = more & (more << 1 | before >> 3);
    if (three == 0 && open < 2) {
        return 2;
    }
    return open < 4 && (three & (more << 2 | before >> 2) & (more << 3 | before >> 1)) == 0 ? 4 : 10;
}

/* Reads the integers of an array as `count_of_varints` has counted them, and says how many. It stops before an integer that is too long, and
   eight bytes before the message's end. `number` says what an integer stands for. */
template <class Row, class Number>
std::int64_t read_varints(const unsigned char *bytes, std::int64_t &at, std::int64_t stop, std::int64_t end, Row *rows, Number number)
{
    constexpr std::int64_t BLOCK = 64;
    const std::int64_t limit = std::min(stop, end - 8);
    Row *next = rows;
    if (bytes[at - 1] >= 128u) {
        return 0;
    }
    for (std::int64_t block = at; block < limit;) {
        const std::int64_t size = std::min(BLOCK, limit - block), open = block - at; /* the bytes before of an integer that ends here */
        const unsigned char *const here = bytes + block;
        const std::uint64_t inside = ~std::uint64_t{0} >> (BLOCK - size);
        std::uint64_t last = last_bytes(here, size);
        const std::int64_t width = last == 0 ? BLOCK : lowest_bit(last) + 1;
        if (open == 0 && width <= 8 && last == (ALIKE[width - 1] & inside)) {
            const std::int64_t count = size / width;
            read_alike(here, width, count, next, number);
            next += count;
            at = block + count * width;
            block = size < BLOCK ? limit : at;
            continue;
        }
        const int longest = longest_varint(~last & inside, open);
        std::int64_t start = -open;
        if (longest == 2) {
            next = read_short(here, size, start, last, next, number);
        } else if (longest == 4) {
            next = read_middle(here, start, last, next, number);
        } else {
            next = read_long(here, start, last, next, number);
        }
        at = block + start;
        if (last != 0) {
            break;
        }
        block += size;
    }
    return next - rows;
}

/* --- containers --- */

template <class Container, class = void> struct is_repeated : std::false_type {};
/* Those of protobuf: RepeatedField and RepeatedPtrField. */
template <class Container>
struct is_repeated<Container, std::void_t<decltype(std::declval<Container &>().Mutable(0)), decltype(std::declval<Container &>().RemoveLast())>>
    : std::true_type {};

template <class Container, class = void> struct can_resize : std::false_type {};
template <class Container> struct can_resize<Container, std::void_t<decltype(std::declval<Container &>().resize(std::size_t{}))>> : std::true_type {};

template <class Container> std::int64_t count_of(const Container &from)
{
    return static_cast<std::int64_t>(std::size(from));
}

/* The same of a list of messages or texts, which has another number of them. */
template <class Container> ROSETTA_JIT_APART void resize_elements(Container &target, std::int64_t count)
{
    target.Reserve(static_cast<int>(count));
    while (target.size() < count) {
        target.Add();
    }
    while (target.size() > count) {
        target.RemoveLast();
    }
}

template <class Container> ROSETTA_JIT_INLINE void resize_to(Container &target, std::int64_t count)
{
    if constexpr (is_repeated<Container>::value) {
        if constexpr (std::is_arithmetic_v<typename Container::value_type>) {
            const int more = static_cast<int>(count) - target.size();
            if (more > 0) {
                target.Reserve(static_cast<int>(count));
                target.AddNAlreadyReserved(more); /* they are written next: to set them before would take as long */
            } else {
                target.Truncate(static_cast<int>(count));
            }
        } else if (target.size() != count) {
            resize_elements(target, count);
        }
    } else if constexpr (can_resize<Container>::value) {
        target.resize(static_cast<std::size_t>(count));
    }
}

template <class Container> struct is_vector : std::false_type {};
template <class Element, class Memory> struct is_vector<std::vector<Element, Memory>> : std::true_type {};

/* How many elements a container gets that lacks one: protobuf's arrays come one by one, so that more will follow. A bounded one may take no more. */
template <class Container> std::int64_t enlarged(const Container &target)
{
    if constexpr (is_repeated<Container>::value || is_vector<Container>::value) {
        return std::max<std::int64_t>(8, 2 * count_of(target));
    } else {
        return count_of(target) + 1;
    }
}

/* Whether more elements will follow those that a container lacks: protobuf's packed integers come by up to eight. */
template <class Container> bool comes_in_parts(std::int64_t missing)
{
    return missing == 1 || (is_repeated<Container>::value && missing <= 8);
}

/* An element for writing; of protobuf's containers they are pointers. */
template <class Container> decltype(auto) element(Container &target, std::int64_t index)
{
    if constexpr (is_repeated<Container>::value) {
        return (*target.Mutable(static_cast<int>(index)));
    } else {
        return target[static_cast<std::size_t>(index)];
    }
}

/* Around a vector, which rosidl's BoundedVector does not show by data(). */
template <class Container, class = void> struct holds_vector : std::false_type {};
template <class Container>
struct holds_vector<Container, std::void_t<typename Container::allocator_type, typename Container::iterator, typename Container::value_type>>
    : std::bool_constant<!std::is_same_v<typename Container::value_type, bool> &&
                         std::is_same_v<typename Container::iterator,
                                        typename std::vector<typename Container::value_type, typename Container::allocator_type>::iterator>> {};

template <class Container, class = void> struct shows_data : std::false_type {};
template <class Container> struct shows_data<Container, std::void_t<decltype(*std::data(std::declval<Container &>()))>> : std::true_type {};

/* The first element, behind which the others lie. */
template <class Container> auto *data_of(Container &target)
{
    if constexpr (is_repeated<Container>::value) {
        return target.mutable_data();
    } else if constexpr (shows_data<Container>::value) {
        return std::data(target);
    } else {
        return std::size(target) == 0 ? nullptr : &*std::begin(target);
    }
}

/* A number as one of another type, a byte as a bool. */
template <class Target, class Number> Target as(Number number)
{
    if constexpr (std::is_same_v<std::decay_t<Target>, bool>) {
        return number != Number{};
    } else {
        return static_cast<Target>(number);
    }
}

template <class Target, class Number> void set(Target &&target, Number number)
{
    if constexpr (std::is_class_v<std::decay_t<Target>>) {
        target = number != Number{}; /* an element of vector<bool> */
    } else {
        target = as<std::decay_t<Target>>(number);
    }
}

/* A row for a number of a class. */
template <class Row, class Number> void put(Row &row, const Number &number)
{
    row = static_cast<Row>(number);
}

/* Whether numbers can be copied as they lie in memory. */
template <class One, class Other>
constexpr bool same_numbers = std::is_same_v<One, Other> ||
                              (sizeof(One) == sizeof(Other) && std::is_integral_v<One> && std::is_integral_v<Other> &&
                               !std::is_same_v<One, bool> && !std::is_same_v<Other, bool>);

/* Whether rows are the bytes of bools, which are read where they lie. */
template <class Number, class Row> constexpr bool are_flags = std::is_same_v<Number, bool> && std::is_same_v<Row, std::uint8_t> && sizeof(bool) == 1;

/* Whether the elements lie one behind the other: those of vector<bool> do not. */
template <class Container>
struct has_data : std::bool_constant<is_repeated<Container>::value || shows_data<Container>::value || holds_vector<std::remove_const_t<Container>>::value> {};

constexpr std::size_t SHORT_TEXT = 16; /* below which strings need no memory of their own */

/* A number of a loop that copies few: a compiler would call the C library's function in place of the loop. */
template <class Number> ROSETTA_JIT_INLINE Number one_of_few(Number number) noexcept
{
#if defined(__GNUC__)
    if constexpr (sizeof(Number) <= sizeof(void *)) {
        __asm__("" : "+r"(number));
    }
#endif
    return number;
}

/* Numbers, or the bytes of a text, into a container. One of a fixed length takes as many as it has. */
template <class Container, class Row> void assign(Container &&target, const Row *rows, std::int64_t count)
{
    using Plain = std::remove_cv_t<std::remove_reference_t<Container>>;
    resize_to(target, count);
    count = std::min(count, count_of(target));
    if constexpr (has_data<Plain>::value) {
        using Number = std::remove_cv_t<std::remove_reference_t<decltype(*data_of(target))>>;
        if constexpr (same_numbers<Number, Row>) {
            if (count > 0) {
                std::memcpy(data_of(target), rows, static_cast<std::size_t>(count) * sizeof(Row));
            }
            return;
        }
        if constexpr (are_flags<Number, Row>) {
            copy_flags(data_of(target), rows, count);
            return;
        }
    }
    for (std::int64_t index = 0; index < count; index++) {
        set(element(target, index), rows[index]);
    }
}

constexpr bool HAS_SHORT_TEXTS = sizeof(std::string) == 2 * sizeof(void *) + SHORT_TEXT; /* in the string itself */

/* A text of another length, which becomes shorter, or needs memory. */
ROSETTA_JIT_APART inline void assign_other(std::string &target, const char *first, std::size_t size)
{
    if (size < target.size()) {
        target.erase(size);
        copy_few(&target[0], 0, first, 0, static_cast<std::int64_t>(size));
    } else {
        target.assign(first, size);
    }
}

/* Bytes that nothing has to make room for first. A text of the same length, as names have again and again, is written where it is. A short one
   that has no memory of its own is made anew in its place, which compilers see into: that takes no memory, and so never fails. */
ROSETTA_JIT_INLINE void assign(std::string &target, const unsigned char *bytes, std::int64_t count)
{
    const char *const first = reinterpret_cast<const char *>(bytes);
    const std::size_t size = static_cast<std::size_t>(count);
    if (size == 0) { /* as frames often are not named */
        target.clear();
    } else if (target.size() == size) {
        copy_few(&target[0], 0, bytes, 0, count);
    } else if (HAS_SHORT_TEXTS && target.capacity() < SHORT_TEXT) {
        if (size < SHORT_TEXT) {
            std::destroy_at(&target);
            ::new (static_cast<void *>(&target)) std::string(first, size);
        } else {
            std::string made(first, size);
            std::destroy_at(&target);
            ::new (static_cast<void *>(&target)) std::string(std::move(made));
        }
    } else {
        assign_other(target, first, size);
    }
}

/* Bytes of another number. */
template <class Memory> ROSETTA_JIT_APART void assign_other(std::vector<std::uint8_t, Memory> &target, const unsigned char *bytes, std::int64_t count)
{
    target.assign(bytes, bytes + count);
}

/* As many as there were are written where they are. */
template <class Memory> ROSETTA_JIT_INLINE void assign(std::vector<std::uint8_t, Memory> &target, const unsigned char *bytes, std::int64_t count)
{
    if (count == 0) {
        target.clear();
    } else if (count_of(target) == count) {
        copy_few(target.data(), 0, bytes, 0, count);
    } else {
        assign_other(target, bytes, count);
    }
}

/* A text of the message that is not empty, if its bytes are one. A compiler calls this where a message has many texts. */
template <class Text> bool read_other_text(Text &target, const unsigned char *bytes, std::int64_t size)
{
    if (!is_ascii(bytes, 0, size) && !is_text(bytes, 0, size)) {
        return false;
    }
    assign(target, bytes, size);
    return true;
}

/* A text of the message, if its bytes are one: nothing is called for one that is empty. */
template <class Text> ROSETTA_JIT_INLINE bool read_text(Text &target, const unsigned char *bytes, std::int64_t size)
{
    if (size == 0) {
        target.clear();
        return true;
    }
    return read_other_text(target, bytes, size);
}

/* The rows of a span. Where its count is negative its bytes lie in the message. */
template <class Container, class Lane, class Span>
void assign_span(Container &&target, const Lane &from, const Span &span, const unsigned char *message)
{
    if constexpr (sizeof(*from.rows) == 1) {
        if (span.count < 0) {
            assign(target, message + span.start, -1 - span.count);
            return;
        }
    }
    static_cast<void>(message);
    assign(target, from.rows + (span.count > 0 ? span.start : 0), span.count);
}

/* Whether elements can be made of characters at the end of a container. */
template <class Container, class = void> struct appends_texts : std::false_type {};
template <class Container>
struct appends_texts<Container, std::void_t<typename Container::value_type::traits_type, decltype(std::declval<Container &>().reserve(std::size_t{}))>>
    : std::bool_constant<is_vector<Container>::value && sizeof(typename Container::value_type::value_type) == 1> {};

/* The texts of a list: those that the container has are set, those that it lacks are made of their characters. */
template <class Container, class Rows, class Lane, class Span>
void assign_texts(Container &target, const Rows &rows, const Span &span, const Lane &from, const unsigned char *message)
{
    const auto *const texts = rows.rows + (span.count > 0 ? span.start : 0);
    std::int64_t index = 0;
    if constexpr (appends_texts<Container>::value && sizeof(*from.rows) == 1) {
        const std::int64_t there = count_of(target);
        if (span.count > there) {
            target.reserve(static_cast<std::size_t>(span.count));
            for (; index < there; index++) {
                assign_span(target[static_cast<std::size_t>(index)], from, texts[index], message);
            }
            for (; index < span.count; index++) {
                const auto &text = texts[index];
                const bool in_message = text.count < 0;
                const auto *const first = reinterpret_cast<const char *>(in_message ? message + text.start : from.rows + (text.count > 0 ? text.start : 0));
                const std::int64_t size = in_message ? -1 - text.count : text.count;
                if (size > 0) {
                    target.emplace_back(first, static_cast<std::size_t>(size));
                } else {
                    target.emplace_back();
                }
            }
            return;
        }
    }
    if constexpr (is_repeated<Container>::value) {
        const std::int64_t there = count_of(target);
        if (span.count > there) {
            target.Reserve(static_cast<int>(span.count));
            for (; index < there; index++) {
                assign_span(element(target, index), from, texts[index], message);
            }
            for (; index < span.count; index++) {
                assign_span(*target.Add(), from, texts[index], message);
            }
            return;
        }
    }
    resize_to(target, span.count);
    const std::int64_t count = std::min(span.count, count_of(target)); /* one of a fixed length has as many as it has */
    for (; index < count; index++) {
        assign_span(element(target, index), from, texts[index], message);
    }
}

/* Takes rows for `count` elements, and says which is the first. */
template <class Lane> ROSETTA_JIT_INLINE std::int64_t take(Lane &to, std::int64_t count)
{
    if (count > to.capacity - to.used && !to.grow(count - (to.capacity - to.used), std::int64_t{1} << 48)) {
        ROSETTA_JIT_THROW(std::bad_alloc());
    }
    to.used += count;
    return to.used - count;
}

/* The same, all of them empty. One call for all: to set each takes a compiler an instruction that starts slowly. */
template <class Lane> ROSETTA_JIT_INLINE std::int64_t take_empty(Lane &to, std::int64_t count)
{
    using Row = std::remove_reference_t<decltype(*to.rows)>;
    static_assert(std::is_trivially_copyable_v<Row>);
    const std::int64_t start = take(to, count);
    if (count > 0) {
        std::memset(static_cast<void *>(to.rows + start), 0, static_cast<std::size_t>(count) * sizeof(Row));
    }
    return start;
}

/* Empties what a row has of an object. */
template <class Row> ROSETTA_JIT_INLINE void empty(Row &row) noexcept
{
    static_assert(std::is_trivially_copyable_v<Row>);
    fill_known<static_cast<std::int64_t>(sizeof(Row))>(&row, 0, 0);
}

/* Numbers, or the bytes of a text, as rows. */
template <class Lane, class Span, class Container> void take_span(Lane &to, Span &span, const Container &from)
{
    using Row = std::remove_reference_t<decltype(*to.rows)>;
    span.count = count_of(from);
    span.start = take(to, span.count);
    Row *rows = to.rows + span.start;
    if constexpr (has_data<const Container>::value) {
        using Number = std::remove_cv_t<std::remove_reference_t<decltype(*data_of(from))>>;
        if constexpr (same_numbers<Number, Row>) {
            if (span.count > 0) {
                std::memcpy(rows, data_of(from), static_cast<std::size_t>(span.count) * sizeof(Row));
            }
            return;
        }
        if constexpr (are_flags<Number, Row>) {
            copy_flags(rows, data_of(from), span.count);
            return;
        }
    }
    for (const auto &each : from) {
        put(*rows++, each);
    }
}

/* The same of what a message has once: numbers that lie as rows do are not copied. */
template <class Lane, class Span, class Container> void show_span(Lane &to, Span &span, const Container &from)
{
    using Row = std::remove_reference_t<decltype(*to.rows)>;
    if constexpr (has_data<const Container>::value) {
        using Number = std::remove_cv_t<std::remove_reference_t<decltype(*data_of(from))>>;
        if constexpr (same_numbers<Number, Row> || are_flags<Number, Row>) {
            span = {0, count_of(from)};
            to.show(reinterpret_cast<const Row *>(data_of(from)), span.count);
            return;
        }
    }
    take_span(to, span, from);
}

/* The same by the address of the elements. */
template <class Row, class Span, class Container> void point_span(Span &span, const Container &from)
{
    using Number = std::remove_cv_t<std::remove_reference_t<decltype(*data_of(from))>>;
    static_assert(same_numbers<Number, Row> || sizeof(Number) + sizeof(Row) == 2, ROSETTA_JIT_OTHER_ELEMENTS);
    span.start = static_cast<std::int64_t>(reinterpret_cast<std::uintptr_t>(data_of(from)));
    span.count = count_of(from);
}

/* The type of an element of a container. */
template <class Container> using element_type = std::remove_cv_t<std::remove_reference_t<decltype(*std::begin(std::declval<const Container &>()))>>;

/* Whether a pointer says where the elements of a list lie, one behind the other: that of some lists is to pointers. */
template <class Container, class = void> struct lie_in_order : std::false_type {};
template <class Container>
struct lie_in_order<Container, std::enable_if_t<has_data<const Container>::value>>
    : std::is_same<std::remove_cv_t<std::remove_reference_t<decltype(*data_of(std::declval<const Container &>()))>>, element_type<Container>> {};

/* The elements of a list, by their index. */
template <class Container> ROSETTA_JIT_INLINE auto elements_of(Container &source) noexcept
{
    if constexpr (lie_in_order<Container>::value) {
        return data_of(source);
    } else {
        return std::begin(source);
    }
}

/* The address of a list: that of its elements, where they lie so, else its own. */
template <class Container> ROSETTA_JIT_INLINE std::int64_t address_of_list(const Container &from) noexcept
{
    const void *at = std::addressof(from);
    if constexpr (lie_in_order<Container>::value) {
        at = elements_of(from);
    }
    return static_cast<std::int64_t>(reinterpret_cast<std::uintptr_t>(at));
}

/* The elements of a list by that address. */
template <class Container> struct pointed {
    static constexpr bool IN_ORDER = lie_in_order<Container>::value;
    using Elements = decltype(elements_of(std::declval<const Container &>()));
    Elements elements = {};

    ROSETTA_JIT_INLINE static pointed at(std::int64_t address)
    {
        pointed found;
        const std::uintptr_t start = static_cast<std::uintptr_t>(address);
        if constexpr (IN_ORDER) {
            found.elements = reinterpret_cast<Elements>(start);
        } else {
            found.elements = std::begin(*reinterpret_cast<const Container *>(start));
        }
        return found;
    }

    ROSETTA_JIT_INLINE decltype(auto) operator[](std::int64_t index) const { return elements[static_cast<std::ptrdiff_t>(index)]; }
};

/* A list as a span by its address. */
template <class Span, class Container> ROSETTA_JIT_INLINE void point_list(Span &span, const Container &from)
{
    span.start = address_of_list(from);
    span.count = count_of(from);
}

/* A message within another, by its address. */
template <class Span, class Object> ROSETTA_JIT_INLINE void point_object(Span &span, const Object &from)
{
    span.start = static_cast<std::int64_t>(reinterpret_cast<std::uintptr_t>(std::addressof(from)));
    span.count = 1;
}

/* The messages of a list that `point_list` has pointed to. */
template <class Container> struct objects {
    using type = element_type<Container>;

    ROSETTA_JIT_INLINE static const type &at(std::int64_t address, std::int64_t index) { return pointed<Container>::at(address)[index]; }
};

/* Messages of a list are made before they are read. Where a count that a message only says would take too much memory, some are made at first, and then more:
   of lists that are left open within each other each takes no more than half of what the one around it may, and the outermost one a message for each byte, or as
   many as take 64 bytes for each. */
constexpr std::int64_t BYTES_FOR_EACH = 64, BYTES_AT_FIRST = 65536;

template <class Container>
ROSETTA_JIT_APART void make_messages(Container &target, std::int64_t count, std::int64_t size, std::int64_t depth)
{
    constexpr std::int64_t WHOLE = sizeof(element_type<Container>);
    const std::int64_t most = (size >> std::min(depth, std::int64_t{62})) / (1 + WHOLE / BYTES_FOR_EACH);
    resize_to(target, std::min(count, std::max({count_of(target), most, 1 + BYTES_AT_FIRST / WHOLE})));
}

/* Makes the first of so many, for which so many bytes are left, and that lie so deep. */
template <class Container>
ROSETTA_JIT_INLINE void begin_messages(Container &target, std::int64_t count, std::int64_t size, std::int64_t depth)
{
    if (count_of(target) != count) {
        make_messages(target, count, size, depth);
    }
}

template <class Container> ROSETTA_JIT_COLD void more_messages(Container &target, std::int64_t count)
{
    resize_to(target, std::min(count, 4 * count_of(target)));
}

/* One of so many, before which all others have been read. */
template <class Container> ROSETTA_JIT_INLINE auto &message_of(Container &target, std::int64_t index, std::int64_t count)
{
    if (ROSETTA_JIT_UNLIKELY(std::begin(target) + static_cast<std::ptrdiff_t>(index) == std::end(target))) {
        more_messages(target, count);
    }
    return std::begin(target)[static_cast<std::ptrdiff_t>(index)];
}

/* The one that `point_object` has pointed to. */
template <class Object> struct object {
    using type = Object;

    ROSETTA_JIT_INLINE static const type &at(std::int64_t address, std::int64_t index)
    {
        return reinterpret_cast<const type *>(static_cast<std::uintptr_t>(address))[index];
    }
};

/* To write a message: rows that are the elements of a container; or anywhere in memory, by their addresses. */
template <class Row> struct shown {
    Row *rows = nullptr;
    std::int64_t used = INT64_MAX;
    std::int64_t capacity = INT64_MAX;

    template <class Container> void read(const Container &from)
    {
        static_assert(same_numbers<std::remove_cv_t<std::remove_reference_t<decltype(*data_of(from))>>, Row>,
                      ROSETTA_JIT_OTHER_ELEMENTS);
        rows = const_cast<Row *>(reinterpret_cast<const Row *>(data_of(from))); /* the functions that write messages change no row */
        capacity = used = count_of(from);
    }
};

/* Whether a class may lie in memory as a row of numbers does; if so, ROSETTA_JIT_LIES says it of each of them. */
#if defined(__GNUC__)
template <class Class, class Row>
constexpr bool may_lie = std::is_standard_layout_v<Class> && std::is_trivially_copyable_v<Class> && sizeof(Class) == sizeof(Row);
#else
template <class Class, class Row> constexpr bool may_lie = false;
#endif

/* Elements as they lie in a message; of an empty list there may be no place. Those that an iterator reaches never lie so. */
template <class Elements>
void copy_elements([[maybe_unused]] Elements target, [[maybe_unused]] const unsigned char *from, [[maybe_unused]] std::int64_t size)
{
    if constexpr (std::is_pointer_v<Elements>) {
        if (ROSETTA_JIT_LIKELY(size > 0)) {
            std::memcpy(static_cast<void *>(target), from, static_cast<std::size_t>(size));
        }
    }
}

/* What elements are that lie one behind the other: those that an iterator reaches do not. */
struct not_in_order {};
template <class Elements> using in_order = std::conditional_t<std::is_pointer_v<Elements>, std::remove_pointer_t<Elements>, not_in_order>;

/* Numbers of a message that an iterator reaches. */
template <class Elements>
std::enable_if_t<!std::is_pointer_v<Elements>> copy_numbers(Elements target, std::int64_t to, const unsigned char *source, std::int64_t from, std::int64_t size)
{
    using Number = typename std::iterator_traits<Elements>::value_type;
    constexpr std::int64_t STEP = sizeof(Number);
    for (std::int64_t at = 0; at < size; at += STEP) {
        std::memcpy(&target[static_cast<std::ptrdiff_t>((to + at) / STEP)], source + from + at, STEP);
    }
}

template <std::int64_t Size, class Elements>
std::enable_if_t<!std::is_pointer_v<Elements>> copy_known(Elements target, std::int64_t to, const unsigned char *source, std::int64_t from)
{
    copy_numbers(target, to, source, from, Size);
}

/* To write a message: rows that are made of the elements of a container when they are read. `Rows` says how. */
template <class Row, class Container, class Rows> struct view {
    static constexpr bool IN_ORDER = pointed<Container>::IN_ORDER;
    static constexpr bool LIES = IN_ORDER && Rows::template lies<element_type<Container>>();
    typename pointed<Container>::Elements elements = {};
    std::int64_t used = 0;
    std::int64_t capacity = 0;

    void read(const Container &from)
    {
        elements = elements_of(from);
        capacity = used = count_of(from);
    }

    /* The list that `point_list` has put there. */
    ROSETTA_JIT_INLINE static view at(std::int64_t address)
    {
        view found;
        found.elements = pointed<Container>::at(address).elements;
        return found;
    }

    ROSETTA_JIT_INLINE Row operator[](std::int64_t index) const { return Rows::of(elements[static_cast<std::ptrdiff_t>(index)]); }
};

/* Copies bytes of rows, from byte `offset` of row `row` on. */
template <class View> ROSETTA_JIT_INLINE void copy_rows(unsigned char *target, std::int64_t to, const View &from, std::int64_t row, std::int64_t offset, std::int64_t size)
{
    if (size <= 0) {
        return;
    }
    unsigned char *at = target + to;
    if constexpr (View::LIES) {
        std::memcpy(at, reinterpret_cast<const unsigned char *>(&from.elements[static_cast<std::ptrdiff_t>(row)]) + offset, static_cast<std::size_t>(size));
    } else {
        using Row = decltype(from[row]);
        constexpr std::int64_t WHOLE = sizeof(Row);
        while (size > 0) {
            const Row each = from[row];
            const std::int64_t part = size < WHOLE - offset ? size : WHOLE - offset;
            std::memcpy(at, reinterpret_cast<const unsigned char *>(&each) + offset, static_cast<std::size_t>(part));
            at += part;
            size -= part;
            offset = 0;
            row++;
        }
    }
}

/* Bools from one on, as bytes that are 0 or 1. */
template <class View> ROSETTA_JIT_INLINE void copy_flags_of(unsigned char *target, const View &from, std::int64_t row, std::int64_t count)
{
    if constexpr (View::IN_ORDER && sizeof(*from.elements) == 1) {
        copy_flags(target, from.elements + row, count);
    } else {
        for (std::int64_t done = 0; done < count; done++) {
            target[done] = from[row + done] != 0 ? 1 : 0;
        }
    }
}

/* Rows that are the elements of a container, so that nothing is copied. */
template <class Row, class Container> struct container_lane {
    Row *rows = nullptr;
    std::int64_t capacity = 0;
    std::int64_t used = 0;
    Container *container = nullptr;

    void fill(Container &target)
    {
        container = &target;
        look();
    }

    ROSETTA_JIT_COLD bool grow(std::int64_t missing, std::int64_t most)
    {
        if (missing > most - capacity) {
            return false;
        }
        const std::int64_t wanted = capacity + missing;
        resize_to(*container, comes_in_parts<Container>(missing) && sizeof(Row) > 1 ? std::max(wanted, std::min(most, enlarged(*container))) : wanted);
        look();
        return capacity >= wanted; /* one of a fixed length has the room that it has */
    }

    /* Leaves the elements of a span alone. Where its count is negative they are bytes of the message. */
    template <class Span> void finish(const Span &span, const unsigned char *message)
    {
        if constexpr (sizeof(Row) == 1) {
            if (span.count < 0) {
                assign(*container, message + span.start, -1 - span.count);
                return;
            }
        }
        static_cast<void>(message);
        if (span.start > 0 && span.count > 0) {
            std::memmove(rows, rows + span.start, static_cast<std::size_t>(span.count) * sizeof(Row));
        }
        if (span.count != capacity) {
            resize_to(*container, span.count);
        }
    }

private:
    void look()
    {
        capacity = count_of(*container);
        rows = reinterpret_cast<Row *>(data_of(*container));
    }
};

/* The same of numbers and of the bytes of a text. */
template <class Row, class Container> struct field_lane : container_lane<Row, Container> {
    using Number = std::remove_cv_t<std::remove_reference_t<decltype(*data_of(std::declval<Container &>()))>>;
    static_assert(same_numbers<Number, Row>, ROSETTA_JIT_OTHER_ELEMENTS);
};

/* The same of structs, where they lie in memory as rows do. */
template <class Row, class Container, bool Lies> struct list_lane : container_lane<Row, Container> {
    static constexpr bool LIES = true;
};

/* Where they do not, the elements are set after the rows are. */
template <class Row, class Container> struct list_lane<Row, Container, false> : lane<Row> {
    static constexpr bool LIES = false;
    void fill(Container &) { this->reset(); }
    template <class Span> void finish(const Span &, const unsigned char *) const noexcept {}
};

/* A number of an object as a row would have it. */
template <class Row, class Number> ROSETTA_JIT_INLINE Row got(const Number &number)
{
    Row row;
    put(row, number);
    return row;
}

/* The numbers of a container as rows, to write a message. */
template <class Row, class Container> ROSETTA_JIT_INLINE const Row *shown_rows(const Container &source) noexcept
{
    static_assert(same_numbers<std::remove_cv_t<std::remove_reference_t<decltype(*data_of(source))>>, Row>,
                  ROSETTA_JIT_OTHER_ELEMENTS);
    return reinterpret_cast<const Row *>(data_of(source));
}

/* Where numbers are, to copy their bytes. */
template <class Row, class Container> ROSETTA_JIT_INLINE std::int64_t address_of(const Container &source) noexcept
{
    return static_cast<std::int64_t>(reinterpret_cast<std::uintptr_t>(shown_rows<Row>(source)));
}

/* The numbers of an array that has a fixed count of them, as rows. */
template <class Row, std::size_t Count, class Container> ROSETTA_JIT_INLINE Row *rows_of(Container &target) noexcept
{
    static_assert(same_numbers<std::remove_reference_t<decltype(*data_of(target))>, Row>, ROSETTA_JIT_OTHER_ELEMENTS);
    static_assert(sizeof(Container) == Count * sizeof(Row), "the class has another number of elements than the schema");
    return reinterpret_cast<Row *>(data_of(target));
}

/* The same of an array that gets as many as are said. */
template <class Row, class Container> ROSETTA_JIT_INLINE Row *sized(Container &target, std::int64_t count)
{
    static_assert(same_numbers<std::remove_reference_t<decltype(*data_of(target))>, Row>, ROSETTA_JIT_OTHER_ELEMENTS);
    static_assert(can_resize<Container>::value, "the class has an array of a fixed length where the schema has none");
    if (count != count_of(target)) {
        resize_to(target, count);
    }
    return reinterpret_cast<Row *>(data_of(target));
}

/* Makes an object whose fields are all set afterwards: where a class can be made without initial values, as rclcpp's can, it is. */
struct without_values {
    template <class Choice, class = decltype(Choice::SKIP)> constexpr operator Choice() const noexcept { return Choice::SKIP; }
};

/* Lists whose elements are set where they are as a message is read: they have no rows, and no more elements than rows may be. */
template <class Elements> struct lane_in_object {
    Elements rows = {};
    std::int64_t capacity = 0;
    std::int64_t used = 0;

    void reset(std::int64_t most) noexcept
    {
        rows = {};
        capacity = most;
        used = 0;
    }

    bool grow(std::int64_t, std::int64_t) const noexcept { return false; }
};

/* What reaches the elements of a list: a pointer those that lie one behind the other, an iterator those of other lists, as of std::deque. */
template <class Container> using elements_reached = decltype(elements_of(std::declval<Container &>()));

/* Such a list of structs or numbers. */
template <class Container, std::size_t Fixed = 0> struct open_lane : lane_in_object<elements_reached<Container>> {
    using Element = element_type<Container>;
    static_assert(Fixed == 0 || can_resize<Container>::value || sizeof(Container) == Fixed * sizeof(Element),
                  "the class has another number of elements than the schema");
    static_assert(std::is_base_of_v<std::random_access_iterator_tag, typename std::iterator_traits<elements_reached<Container>>::iterator_category>,
                  "the elements of a list must be reached by their index");
};

/* Gives a list as many elements as follow in the message, where it has another number of them. */
template <class Container> ROSETTA_JIT_APART void open_other(Container &target, std::int64_t count)
{
    if constexpr (can_resize<Container>::value && std::is_constructible_v<element_type<Container>, without_values>) {
        const std::size_t wanted = static_cast<std::size_t>(count);
        if (wanted > target.size()) {
            if constexpr (lie_in_order<Container>::value) {
                target.reserve(wanted);
            }
            while (target.size() < wanted) {
                target.emplace_back(without_values{});
            }
        }
    }
    resize_to(target, count);
}

template <class Container> ROSETTA_JIT_INLINE auto opened(Container &target, std::int64_t count)
{
    if (count != count_of(target)) { /* as hardly ever when messages come again and again */
        open_other(target, count);
    }
    return elements_of(target);
}

/* The same of numbers, of which there may be a fixed count: an array has as many, or a vector gets them, as lcm-gen has both. */
template <class Container, class Row, std::size_t Fixed> struct number_lane : open_lane<Container, Fixed> {
    static_assert(same_numbers<typename open_lane<Container>::Element, Row>, ROSETTA_JIT_OTHER_ELEMENTS);
};

/* The texts of a list, of which some are there. Those that it lacks are made of their characters where that can be. */
template <class Container> struct texts_of {
    Container *container = nullptr;
    std::int64_t there = 0;

    ROSETTA_JIT_INLINE void put(std::int64_t index, const unsigned char *bytes, std::int64_t size) const
    {
        if constexpr (appends_texts<Container>::value) {
            if (index >= there) {
                append(*container, bytes, size);
                return;
            }
        }
        assign(element(*container, index), bytes, size);
    }

    /* The same of bytes that may not be a text. */
    ROSETTA_JIT_INLINE bool read(std::int64_t index, const unsigned char *bytes, std::int64_t size) const
    {
        if constexpr (appends_texts<Container>::value) {
            if (index >= there) {
                return is_text(bytes, 0, size) && (append(*container, bytes, size), true);
            }
        }
        return read_text(element(*container, index), bytes, size);
    }

private:
    ROSETTA_JIT_APART static void append(Container &target, const unsigned char *bytes, std::int64_t size)
    {
        target.emplace_back(reinterpret_cast<const char *>(bytes), static_cast<std::size_t>(size));
    }
};

/* Gives a list of texts as many as follow in the message, or room for them, where it has another number of them. */
template <class Container> ROSETTA_JIT_APART std::int64_t texts_there(Container &target, std::int64_t count)
{
    if constexpr (appends_texts<Container>::value) {
        if (count > count_of(target)) {
            target.reserve(static_cast<std::size_t>(count));
            return count_of(target);
        }
    }
    resize_to(target, count);
    return count;
}

template <class Container> ROSETTA_JIT_INLINE texts_of<Container> opened_texts(Container &target, std::int64_t count)
{
    return {&target, count == count_of(target) ? count : texts_there(target, count)};
}

/* The same of lists of texts. */
template <class Container> struct text_lane : lane_in_object<texts_of<Container>> {};

template <class Message, class = void> struct shows_unknown : std::false_type {};
template <class Message> struct shows_unknown<Message, std::void_t<decltype(std::declval<Message &>().mutable_unknown_fields())>> : std::true_type {};

/* The class that declares a function of an object. */
template <class Class, class Result, class... Arguments> Class declaring(Result (Class::*)(Arguments...) const);

/* Where a message of protobuf's has what it keeps besides its fields: its base class shows it to those derived from that. */
template <class Base> struct kept_besides : Base {
    template <class Self> static auto member(int) -> decltype(&Self::_internal_metadata_) { return &Self::_internal_metadata_; }
    template <class> static std::nullptr_t member(long) { return nullptr; }
};
template <class Message> using base_of = decltype(declaring(&Message::FindInitializationErrors));

template <class Message, class = void> struct says_unknown : std::false_type {};
template <class Message>
struct says_unknown<Message, std::void_t<decltype((std::declval<const Message &>().*kept_besides<base_of<Message>>::template member<kept_besides<base_of<Message>>>(0)).have_unknown_fields())>>
    : std::true_type {};

/* The reflection of a class of protobuf's, for which a message looks each time that it is asked. */
template <class Message> const auto &reflection_of(const Message &message)
{
    static const auto *const reflection = message.GetReflection();
    return *reflection;
}

/* The unknown fields of a protobuf message: of proto3 only its reflection has them. */
template <class Message> const auto &unknown_fields(const Message &message)
{
    if constexpr (shows_unknown<Message>::value) {
        return message.unknown_fields();
    } else {
        return reflection_of(message).GetUnknownFields(message);
    }
}

/* Whether it has some: where the message says so itself, no function of another library is called. */
template <class Message> bool has_unknown_fields(const Message &message)
{
    if constexpr (says_unknown<Message>::value) {
        using Besides = kept_besides<base_of<Message>>;
        return (message.*Besides::template member<Besides>(0)).have_unknown_fields();
    } else {
        return !unknown_fields(message).empty();
    }
}

template <class Message> auto &mutable_unknown_fields(Message &message)
{
    if constexpr (shows_unknown<Message>::value) {
        return *message.mutable_unknown_fields();
    } else {
        return *reflection_of(message).MutableUnknownFields(&message);
    }
}

/* Gives a message the unknown fields that a decoder has found in place of its own. */
template <class Message, class Lane, class Span> ROSETTA_JIT_COLD void keep_unknown_fields(Message &message, const Lane &from, const Span &span)
{
    mutable_unknown_fields(message).Clear();
    if (span.count > 0) {
        mutable_unknown_fields(message).ParseFromArray(from.rows + span.start, static_cast<int>(span.count));
    }
}

/* The same where nearly always there are none. */
template <class Message, class Lane, class Span> ROSETTA_JIT_INLINE void keep_unknown(Message &message, const Lane &from, const Span &span)
{
    if (span.count > 0 || has_unknown_fields(message)) {
        keep_unknown_fields(message, from, span);
    }
}

/* Takes the bytes of the unknown fields that a message has. */
template <class Span, class Lane, class Message> ROSETTA_JIT_COLD Span taken_unknown_fields(Lane &to, const Message &message)
{
    Span span = {};
    std::string unknown;
    unknown_fields(message).SerializeToString(&unknown);
    take_span(to, span, unknown);
    return span;
}

template <class Lane, class Span, class Message> ROSETTA_JIT_INLINE void take_unknown(Lane &to, Span &span, const Message &message)
{
    if (has_unknown_fields(message)) {
        span = taken_unknown_fields<Span>(to, message);
    }
}

inline bool is_set(const std::uint64_t *presence, int bit) noexcept
{
    return (presence[bit / 64] >> (bit % 64) & 1u) != 0;
}

inline void set_bit(std::uint64_t *presence, int bit) noexcept
{
    presence[bit / 64] |= std::uint64_t{1} << (bit % 64);
}

} // namespace detail
} // namespace rosetta_jit

#endif
