// Fast CDR, with which ROS 2's default middleware writes: member by member, as its generated code calls it. Built where its headers are.
#include <array>
#include <cstring>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include <fastcdr/Cdr.h>

#include "timing.hpp"

namespace {

using eprosima::fastcdr::Cdr;
using eprosima::fastcdr::FastBuffer;

// What generated classes have; `members` is all that differs between them.
template <typename Self>
struct Message {
    void serialize(Cdr& cdr) const {
        std::apply([&](auto&... each) { (cdr << ... << each); }, const_cast<Self*>(static_cast<const Self*>(this))->members());
    }
    void deserialize(Cdr& cdr) {
        std::apply([&](auto&... each) { (cdr >> ... >> each); }, static_cast<Self*>(this)->members());
    }
};

struct Header : Message<Header> {
    std::int32_t sec = 0;
    std::uint32_t nanosec = 0;
    std::string frame_id;
    auto members() { return std::tie(sec, nanosec, frame_id); }
};

struct Vector3 : Message<Vector3> {
    double x = 0, y = 0, z = 0;
    auto members() { return std::tie(x, y, z); }
};

struct Quaternion : Message<Quaternion> {
    double x = 0, y = 0, z = 0, w = 0;
    auto members() { return std::tie(x, y, z, w); }
};

struct Imu : Message<Imu> {
    Header header;
    Quaternion orientation;
    std::array<double, 9> orientation_covariance{};
    Vector3 velocity;
    std::array<double, 9> velocity_covariance{};
    Vector3 acceleration;
    std::array<double, 9> acceleration_covariance{};
    auto members() {
        return std::tie(header, orientation, orientation_covariance, velocity, velocity_covariance, acceleration, acceleration_covariance);
    }
};

struct JointState : Message<JointState> {
    Header header;
    std::vector<std::string> name;
    std::vector<double> position, velocity, effort;
    auto members() { return std::tie(header, name, position, velocity, effort); }
};

struct LaserScan : Message<LaserScan> {
    Header header;
    float angle_min = 0, angle_max = 0, angle_increment = 0, time_increment = 0, scan_time = 0, range_min = 0, range_max = 0;
    std::vector<float> ranges, intensities;
    auto members() {
        return std::tie(header, angle_min, angle_max, angle_increment, time_increment, scan_time, range_min, range_max, ranges, intensities);
    }
};

struct Pose : Message<Pose> {
    Vector3 position;
    Quaternion orientation;
    auto members() { return std::tie(position, orientation); }
};

struct PoseArray : Message<PoseArray> {
    Header header;
    std::vector<Pose> poses;
    auto members() { return std::tie(header, poses); }
};

struct Image : Message<Image> {
    Header header;
    std::uint32_t height = 0, width = 0;
    std::string encoding;
    std::uint8_t is_bigendian = 0;
    std::uint32_t step = 0;
    std::vector<std::uint8_t> data;
    auto members() { return std::tie(header, height, width, encoding, is_bigendian, step, data); }
};

struct PointField : Message<PointField> {
    std::string name;
    std::uint32_t offset = 0;
    std::uint8_t datatype = 0;
    std::uint32_t count = 0;
    auto members() { return std::tie(name, offset, datatype, count); }
};

struct PointCloud2 : Message<PointCloud2> {
    Header header;
    std::uint32_t height = 0, width = 0;
    std::vector<PointField> fields;
    bool is_bigendian = false;
    std::uint32_t point_step = 0, row_step = 0;
    std::vector<std::uint8_t> data;
    bool is_dense = false;
    auto members() { return std::tie(header, height, width, fields, is_bigendian, point_step, row_step, data, is_dense); }
};

using Job = double (*)(const Messages&, std::int64_t);

template <typename Value>
void read(const Messages& messages, std::int64_t number, Value& value) {
    FastBuffer buffer(reinterpret_cast<char*>(messages.at(number)), messages.size(number));
    Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
    cdr.read_encapsulation();
    cdr >> value;
}

template <typename Value>
double decode(const Messages& messages, std::int64_t iterations) {
    Value value;
    publish(value);
    return nanoseconds_in_turn(messages.count, iterations, [&](std::int64_t number) {
        read(messages, number, value);
        return true;
    });
}

template <typename Value>
double encode(const Messages& messages, std::int64_t iterations) {
    std::vector<Value> values(static_cast<std::size_t>(messages.count));
    std::vector<char> target(messages.longest());
    publish(target);
    const auto write = [&](std::int64_t number) {
        FastBuffer buffer(target.data(), messages.size(number));
        Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
        cdr.serialize_encapsulation();
        cdr << values[static_cast<std::size_t>(number)];
        return cdr.getSerializedDataLength() == messages.size(number);
    };
    for (std::int64_t number = 0; number < messages.count; ++number) {
        read(messages, number, values[static_cast<std::size_t>(number)]);
        if (!write(number) || std::memcmp(target.data(), messages.at(number), messages.size(number)) != 0) {
            return -1;
        }
    }
    return nanoseconds_in_turn(messages.count, iterations, write);
}

const std::map<std::string, std::pair<Job, Job>> JOBS = {
    {"sensor_msgs/msg/Imu", {decode<Imu>, encode<Imu>}},
    {"sensor_msgs/msg/JointState", {decode<JointState>, encode<JointState>}},
    {"sensor_msgs/msg/LaserScan", {decode<LaserScan>, encode<LaserScan>}},
    {"geometry_msgs/msg/PoseArray", {decode<PoseArray>, encode<PoseArray>}},
    {"sensor_msgs/msg/Image", {decode<Image>, encode<Image>}},
    {"sensor_msgs/msg/PointCloud2", {decode<PointCloud2>, encode<PointCloud2>}},
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
