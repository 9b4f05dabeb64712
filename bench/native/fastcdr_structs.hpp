// What rosidl_typesupport_fastrtps_cpp generates for rclcpp's structs: they are read and written field by field, in the order of the message.
#pragma once

#include <fastcdr/Cdr.h>

#include <geometry_msgs/msg/pose_array.hpp>
#include <sensor_msgs/msg/image.hpp>
#include <sensor_msgs/msg/imu.hpp>
#include <sensor_msgs/msg/joint_state.hpp>
#include <sensor_msgs/msg/laser_scan.hpp>

#include <cstdint>
#include <type_traits>
#include <utility>
#include <vector>

namespace fastcdr_structs {

// The fields of a struct, for both directions.
template <class Each> void walk(builtin_interfaces::msg::Time& message, Each each) { each(message.sec, message.nanosec); }

template <class Each> void walk(std_msgs::msg::Header& message, Each each) { each(message.stamp, message.frame_id); }

template <class Each> void walk(geometry_msgs::msg::Point& message, Each each) { each(message.x, message.y, message.z); }

template <class Each> void walk(geometry_msgs::msg::Vector3& message, Each each) { each(message.x, message.y, message.z); }

template <class Each> void walk(geometry_msgs::msg::Quaternion& message, Each each) { each(message.x, message.y, message.z, message.w); }

template <class Each> void walk(geometry_msgs::msg::Pose& message, Each each) { each(message.position, message.orientation); }

template <class Each> void walk(geometry_msgs::msg::PoseArray& message, Each each) { each(message.header, message.poses); }

template <class Each> void walk(sensor_msgs::msg::Imu& message, Each each) {
    each(message.header, message.orientation, message.orientation_covariance, message.angular_velocity, message.angular_velocity_covariance,
         message.linear_acceleration, message.linear_acceleration_covariance);
}

template <class Each> void walk(sensor_msgs::msg::JointState& message, Each each) {
    each(message.header, message.name, message.position, message.velocity, message.effort);
}

template <class Each> void walk(sensor_msgs::msg::LaserScan& message, Each each) {
    each(message.header, message.angle_min, message.angle_max, message.angle_increment, message.time_increment, message.scan_time, message.range_min,
         message.range_max, message.ranges, message.intensities);
}

template <class Each> void walk(sensor_msgs::msg::Image& message, Each each) {
    each(message.header, message.height, message.width, message.encoding, message.is_bigendian, message.step, message.data);
}

struct ignore {
    template <class... Fields> void operator()(Fields&...) const {}
};

template <class Value, class = void> struct is_struct : std::false_type {};
template <class Value> struct is_struct<Value, std::void_t<decltype(walk(std::declval<Value&>(), ignore()))>> : std::true_type {};

template <class Value> struct is_list : std::false_type {};
template <class Struct, class Memory> struct is_list<std::vector<Struct, Memory>> : is_struct<Struct> {};

template <class Value> void read(eprosima::fastcdr::Cdr& cdr, Value& value) {
    if constexpr (is_struct<Value>::value) {
        walk(value, [&](auto&... each) { (read(cdr, each), ...); });
    } else if constexpr (is_list<Value>::value) {
        std::uint32_t size = 0;
        cdr >> size;
        value.resize(size);
        for (auto& each : value) {
            read(cdr, each);
        }
    } else {
        cdr >> value;
    }
}

template <class Value> void write(eprosima::fastcdr::Cdr& cdr, const Value& value) {
    if constexpr (is_struct<Value>::value) {
        walk(const_cast<Value&>(value), [&](const auto&... each) { (write(cdr, each), ...); });
    } else if constexpr (is_list<Value>::value) {
        cdr << static_cast<std::uint32_t>(value.size());
        for (const auto& each : value) {
            write(cdr, each);
        }
    } else {
        cdr << value;
    }
}

}  // namespace fastcdr_structs
