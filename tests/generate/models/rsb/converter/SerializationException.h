#pragma once
#include <stdexcept>
#include <string>

namespace rsb::converter {
class SerializationException : public std::runtime_error {
public:
    explicit SerializationException(const std::string &message) : std::runtime_error(message) {}
};
} // namespace rsb::converter
