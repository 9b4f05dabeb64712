// The joints of a bottle into protoc's class: by the C++ that `rosetta-jit generate` writes, and by hand in two ways. The unit is compiled by itself.
#include "joints.hpp"
#include "timing.hpp"

#include <cstdint>
#include <cstring>

namespace {

using Angles = rst::kinematics::JointAngles;
constexpr double RADIANS = 0.017453292519943295;
constexpr std::size_t HEAD = 8;

// The count of a bottle of doubles, or -1.
std::int32_t head(const unsigned char* message, std::size_t size) {
    std::int32_t tag, count;
    if (size < HEAD) {
        return -1;
    }
    std::memcpy(&tag, message, sizeof tag);
    std::memcpy(&count, message + sizeof tag, sizeof count);
    const bool whole = tag == 266 && count >= 0 && size == HEAD + sizeof(double) * static_cast<std::size_t>(count);
    return whole ? count : -1;
}

double element(const unsigned char* message, std::int32_t index) {
    double value;
    std::memcpy(&value, message + HEAD + sizeof value * static_cast<std::size_t>(index), sizeof value);
    return value * RADIANS;
}

bool by_adding(const unsigned char* message, std::size_t size, Angles& angles) {
    const std::int32_t count = head(message, size);
    if (count < 0) {
        return false;
    }
    angles.Clear();
    angles.mutable_angles()->Reserve(count);
    for (std::int32_t index = 0; index < count; ++index) {
        angles.add_angles(static_cast<float>(element(message, index)));
    }
    return true;
}

bool by_resizing(const unsigned char* message, std::size_t size, Angles& angles) {
    const std::int32_t count = head(message, size);
    if (count < 0) {
        return false;
    }
    angles.mutable_angles()->Resize(count, 0);
    float* const target = angles.mutable_angles()->mutable_data();
    for (std::int32_t index = 0; index < count; ++index) {
        target[index] = static_cast<float>(element(message, index));
    }
    return true;
}

template <class Decode> double timed(Decode decode, float* angles, std::int64_t iterations) {
    Angles message;
    const double took = nanoseconds(iterations, [&] { return decode(message); });
    for (int index = 0; index < message.angles_size(); ++index) {
        angles[index] = message.angles(index);
    }
    return took;
}

}  // namespace

extern "C" double protobuf_codec_ns(const unsigned char* message, std::int64_t size, float* angles, std::int64_t iterations) {
    joints::codec codec;
    return timed([&](Angles& target) { return codec.try_decode(message, static_cast<std::size_t>(size), target).has_value(); }, angles, iterations);
}

extern "C" double protobuf_add_ns(const unsigned char* message, std::int64_t size, float* angles, std::int64_t iterations) {
    return timed([&](Angles& target) { return by_adding(message, static_cast<std::size_t>(size), target); }, angles, iterations);
}

extern "C" double protobuf_resize_ns(const unsigned char* message, std::int64_t size, float* angles, std::int64_t iterations) {
    return timed([&](Angles& target) { return by_resizing(message, static_cast<std::size_t>(size), target); }, angles, iterations);
}
