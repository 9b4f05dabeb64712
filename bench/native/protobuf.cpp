// protobuf's generated C++, parsing into a message that is used again and serialising into a buffer that is given.
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include "angles.pb.h"
#include "rst/vision/Image.pb.h"
#include "timing.hpp"

namespace {

using Job = double (*)(const unsigned char*, int, std::int64_t);

template <typename Message>
double decode(const unsigned char* data, int size, std::int64_t iterations) {
    Message message;
    publish(message);
    return nanoseconds(iterations, [&] { return message.ParseFromArray(data, size); });
}

template <typename Message>
double encode(const unsigned char* data, int size, std::int64_t iterations) {
    Message message;
    if (!message.ParseFromArray(data, size)) {
        return -1;
    }
    std::vector<unsigned char> buffer(static_cast<std::size_t>(size));
    publish(buffer);
    const double took = nanoseconds(iterations, [&] { return message.SerializeToArray(buffer.data(), size); });
    return std::memcmp(buffer.data(), data, buffer.size()) == 0 ? took : -1;
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

double decode_ns(const char* type, const unsigned char* message, std::int64_t size, std::int64_t iterations) {
    const auto found = JOBS.find(type);
    return found == JOBS.end() ? -1 : found->second.first(message, static_cast<int>(size), iterations);
}

double encode_ns(const char* type, const unsigned char* message, std::int64_t size, std::int64_t iterations) {
    const auto found = JOBS.find(type);
    return found == JOBS.end() ? -1 : found->second.second(message, static_cast<int>(size), iterations);
}

}  // extern "C"
