// roscpp's generated code, decoding into an object that is used again and encoding into a buffer that is given. Built where ROS's headers are.
#include <cstring>
#include <map>
#include <string>
#include <vector>

#if __has_include(<diagnostic_msgs/DiagnosticArray.h>)
#include <diagnostic_msgs/DiagnosticArray.h>
#endif
#include <geometry_msgs/PoseArray.h>
#include <geometry_msgs/TransformStamped.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/JointState.h>
#include <sensor_msgs/LaserScan.h>
#include <sensor_msgs/PointCloud2.h>

#include "timing.hpp"

namespace {

using Job = double (*)(const Messages&, std::int64_t);

template <typename Message>
void read(const Messages& messages, std::int64_t number, Message& message) {
    ros::serialization::IStream stream(messages.at(number), static_cast<std::uint32_t>(messages.size(number)));
    ros::serialization::deserialize(stream, message);
}

template <typename Message>
double decode(const Messages& messages, std::int64_t iterations) {
    Message message;
    publish(message);
    return nanoseconds_in_turn(messages.count, iterations, [&](std::int64_t number) {
        read(messages, number, message);
        return true;
    });
}

template <typename Message>
double encode(const Messages& messages, std::int64_t iterations) {
    std::vector<Message> read_ones(static_cast<std::size_t>(messages.count));
    std::vector<unsigned char> buffer(messages.longest());
    publish(buffer);
    const auto write = [&](std::int64_t number) {
        ros::serialization::OStream stream(buffer.data(), static_cast<std::uint32_t>(messages.size(number)));
        ros::serialization::serialize(stream, read_ones[static_cast<std::size_t>(number)]);
        return true;
    };
    for (std::int64_t number = 0; number < messages.count; ++number) {
        read(messages, number, read_ones[static_cast<std::size_t>(number)]);
        write(number);
        if (std::memcmp(buffer.data(), messages.at(number), messages.size(number)) != 0) {
            return -1;
        }
    }
    return nanoseconds_in_turn(messages.count, iterations, write);
}

using Transforms = std::vector<geometry_msgs::TransformStamped>;  // all that tf2_msgs::TFMessage has

const std::map<std::string, std::pair<Job, Job>> JOBS = {
    {"sensor_msgs/Imu", {decode<sensor_msgs::Imu>, encode<sensor_msgs::Imu>}},
    {"sensor_msgs/JointState", {decode<sensor_msgs::JointState>, encode<sensor_msgs::JointState>}},
    {"sensor_msgs/LaserScan", {decode<sensor_msgs::LaserScan>, encode<sensor_msgs::LaserScan>}},
    {"geometry_msgs/PoseArray", {decode<geometry_msgs::PoseArray>, encode<geometry_msgs::PoseArray>}},
    {"sensor_msgs/Image", {decode<sensor_msgs::Image>, encode<sensor_msgs::Image>}},
    {"sensor_msgs/PointCloud2", {decode<sensor_msgs::PointCloud2>, encode<sensor_msgs::PointCloud2>}},
    {"tf2_msgs/TFMessage", {decode<Transforms>, encode<Transforms>}},
#if __has_include(<diagnostic_msgs/DiagnosticArray.h>)
    {"diagnostic_msgs/DiagnosticArray", {decode<diagnostic_msgs::DiagnosticArray>, encode<diagnostic_msgs::DiagnosticArray>}},
#endif
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
