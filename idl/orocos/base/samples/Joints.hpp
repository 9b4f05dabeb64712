#pragma once

#include <orocos/base/JointState.hpp>
#include <orocos/base/Time.hpp>
#include <string>
#include <vector>

namespace base {
namespace samples {

/// The elements are in the order of their names.
struct Joints {
    std::vector<std::string> names;
    std::vector<JointState> elements;
    Time time;
};

}  // namespace samples
}  // namespace base
