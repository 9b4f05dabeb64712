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

using Job = double (*)(unsigned char*, std::uint32_t, std::int64_t);

template <typename Message>
void read(unsigned char* data, std::uint32_t size, Message& message) {
    ros::serialization::IStream stream(data, size);
    ros::serialization::deserialize(stream, message);
}

template <typename Message>
double decode(unsigned char* data, std::uint32_t size, std::int64_t iterations) {
    Message message;
    publish(message);
    return nanoseconds(iterations, [&] {
        read(data, size, message);
        return true;
    });
}

template <typename Message>
double encode(unsigned char* data, std::uint32_t size, std::int64_t iterations) {
    Message message;
    read(data, size, message);
    std::vector<unsigned char> buffer(size);
    publish(buffer);
    const double took = nanoseconds(iterations, [&] {
        ros::serialization::OStream stream(buffer.data(), size);
        ros::serialization::serialize(stream, message);
        return true;
    });
    return std::memcmp(buffer.data(), data, size) == 0 ? took : -1;
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

double decode_ns(const char* type, unsigned char* message, std::int64_t size, std::int64_t iterations) {
    const auto found = JOBS.find(type);
    return found == JOBS.end() ? -1 : found->second.first(message, static_cast<std::uint32_t>(size), iterations);
}

double encode_ns(const char* type, unsigned char* message, std::int64_t size, std::int64_t iterations) {
    const auto found = JOBS.find(type);
    return found == JOBS.end() ? -1 : found->second.second(message, static_cast<std::uint32_t>(size), iterations);
}

}  // extern "C"
