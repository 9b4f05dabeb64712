// roscpp's generated decoder into an object that is used again, timing its own loop: nanoseconds a message. Built where ROS's headers are.
#include <chrono>
#include <cstdint>

#include <sensor_msgs/JointState.h>

extern "C" double joint_state_decode_ns(unsigned char* message, std::int64_t size, std::int64_t iterations) {
    sensor_msgs::JointState state;
    const auto started = std::chrono::steady_clock::now();
    for (std::int64_t turn = 0; turn < iterations; ++turn) {
        asm volatile("" ::: "memory");
        ros::serialization::IStream stream(message, static_cast<std::uint32_t>(size));
        ros::serialization::deserialize(stream, state);
    }
    const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - started;
    return state.position.empty() ? -1 : took.count() / static_cast<double>(iterations);
}
