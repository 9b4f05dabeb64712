// protobuf's generated C++, parsing into a message that is used again and serialising into a buffer that is given.
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include "angles.pb.h"
#include "rst/vision/Image.pb.h"
#include "timing.hpp"

namespace {

using Job = double (*)(const Messages&, std::int64_t);

template <typename Message>
bool read(const Messages& messages, std::int64_t number, Message& message) {
    return message.ParseFromArray(messages.at(number), static_cast<int>(messages.size(number)));
}

template <typename Message>
double decode(const Messages& messages, std::int64_t iterations) {
    Message message;
    publish(message);
    return nanoseconds_in_turn(messages.count, iterations, [&](std::int64_t number) { return read(messages, number, message); });
}

template <typename Message>
double encode(const Messages& messages, std::int64_t iterations) {
    std::vector<Message> read_ones(static_cast<std::size_t>(messages.count));
    std::vector<unsigned char> buffer(messages.longest());
    publish(buffer);
    const auto write = [&](std::int64_t number) {
        return read_ones[static_cast<std::size_t>(number)].SerializeToArray(buffer.data(), static_cast<int>(messages.size(number)));
    };
    for (std::int64_t number = 0; number < messages.count; ++number) {
        const bool done = read(messages, number, read_ones[static_cast<std::size_t>(number)]) && write(number);
        if (!done || std::memcmp(buffer.data(), messages.at(number), messages.size(number)) != 0) {
            return -1;
        }
    }
    return nanoseconds_in_turn(messages.count, iterations, write);
}

const std::map<std::string, std::pair<Job, Job>> JOBS = {
    {"rj.JointAngles", {decode<rj::JointAngles>, encode<rj::JointAngles>}},
    {"rj.PackedJointAngles", {decode<rj::PackedJointAngles>, encode<rj::PackedJointAngles>}},
    {"rj.Integers", {decode<rj::Integers>, encode<rj::Integers>}},
    {"rj.PackedIntegers", {decode<rj::PackedIntegers>, encode<rj::PackedIntegers>}},
    {"rst.vision.Image", {decode<rst::vision::Image>, encode<rst::vision::Image>}},
};

}  // namespace

extern "C" {

double decode_ns(const char* type, unsigned char* data, const std::int64_t* ends, std::int64_t count, std::int64_t iterations) {
    const auto found = JOBS.find(type);
    return found == JOBS.end() ? -1 : found->second.first({data, ends, count}, iterations);
}

double encode_ns(const char* type, unsigned char* data, const std::int64_t* ends, std::int64_t count, std::int64_t iterations) {
    const auto found = JOBS.find(type);
    return found == JOBS.end() ? -1 : found->second.second({data, ends, count}, iterations);
}

}  // extern "C"
