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
#ifndef TORSO_STATE_HPP
#define TORSO_STATE_HPP

#include <cstddef>
#include <cstdint>
#include <memory>

#include <rosetta_jit/rosetta_jit.hpp>
#include <rst/kinematics/JointAngles.pb.h>

namespace torso_state {

/* What is filled and read. */
using holder = ::rst::kinematics::JointAngles;

/* Reads and writes messages. It keeps memory from one message to the next, so that none is allocated in the long run; each thread needs its own. */
class codec {
public:
    codec();
    ~codec();
    codec(codec &&) noexcept;
    codec &operator=(codec &&) noexcept;

    /* Reads a message. After a failure the holder is in a valid state, and what it has is not said. */
    rosetta_jit::result<rosetta_jit::done> try_decode(const void *bytes, std::size_t size, holder &target)
    {
        return decode_any(bytes, size, target);
    }

    /* The same; throws rosetta_jit::failure. */
    void decode(const void *bytes, std::size_t size, holder &target) { static_cast<void>(try_decode(bytes, size, target).value()); }
#if __cplusplus >= 202002L
    void decode(std::span<const std::byte> bytes, holder &target) { decode(bytes.data(), bytes.size(), target); }
#endif

    /* How many bytes the message takes. */
    rosetta_jit::result<std::size_t> try_size(const holder &source);

    /* Writes the message to `bytes`, which has `capacity` of them, and says how many it took. */
    rosetta_jit::result<std::size_t> try_encode(const holder &source, void *bytes, std::size_t capacity)
    {
        const std::int64_t size = put_at_once(source, static_cast<unsigned char *>(bytes), static_cast<std::int64_t>(capacity));
        if (ROSETTA_JIT_LIKELY(size >= 0)) {
            return static_cast<std::size_t>(size);
        }
        return encode_any(source, bytes, capacity);
    }

    /* Makes a string the message. */
    rosetta_jit::result<rosetta_jit::done> try_encode(const holder &source, std::string &bytes);

    /* The message; throws rosetta_jit::failure. */
    std::string encode(const holder &source)
    {
        std::string bytes;
        static_cast<void>(try_encode(source, bytes).value());
        return bytes;
    }
#if __cplusplus >= 202002L
    std::size_t encode(const holder &source, std::span<std::byte> bytes) { return try_encode(source, bytes.data(), bytes.size()).value(); }
#endif

    /* What `now()` (ns since 1970) and `counter()` say in the mapping. */
    std::int64_t now = 0;
    std::int64_t number = 0;

private:
    /* Reads any message, and says what is wrong with it. */
    rosetta_jit::detail::outcome<rosetta_jit::done> decode_any(const void *bytes, std::size_t size, holder &target);

    /* Writes a message where a compiler sees the object, too, and says how many bytes it took; a negative number where anything is wrong. */
    static std::int64_t put_at_once(const holder &given_object, unsigned char *__restrict bytes, std::int64_t end)
    {
        const float *const angles = rosetta_jit::detail::shown_rows<float>(given_object.angles());
        const int64_t count = rosetta_jit::detail::count_of(given_object.angles());
        if (ROSETTA_JIT_UNLIKELY(0 >= count)) {
            return -1;
        }
        if (ROSETTA_JIT_UNLIKELY(1 >= count)) {
            return -1;
        }
        if (ROSETTA_JIT_UNLIKELY(2 >= count)) {
            return -1;
        }
        if (ROSETTA_JIT_UNLIKELY(count != 3)) {
            return -1;
        }
        if (ROSETTA_JIT_UNLIKELY(end < 32)) {
            return -1;
        }
        rosetta_jit::detail::store_i32_le(bytes + 0, 266);
        rosetta_jit::detail::store_i32_le(bytes + 4, 3);
        const float element = angles[0];
        const double yaw = static_cast<double>(element) * 57.29577951308232;
        rosetta_jit::detail::store_f64_le(bytes + 8, yaw);
        const float element_2 = angles[1];
        const double roll = static_cast<double>(element_2) * 57.29577951308232;
        rosetta_jit::detail::store_f64_le(bytes + 16, roll);
        const float element_3 = angles[2];
        const double pitch = static_cast<double>(element_3) * 57.29577951308232;
        rosetta_jit::detail::store_f64_le(bytes + 24, pitch);
        return 32;
    }

    /* Writes any message, and says what is wrong with it. */
    rosetta_jit::detail::outcome<std::size_t> encode_any(const holder &source, void *bytes, std::size_t capacity);

    struct memory;
    std::unique_ptr<memory> memory_;
};

} // namespace torso_state

#endif
