#pragma once
#include <cstddef>
#include <cstring>
#include <string>

namespace yarp::os {
class Portable;

class ConnectionReader {
public:
    explicit ConnectionReader(std::string bytes) : bytes_(std::move(bytes)), said_(bytes_.size()) {}
    ConnectionReader(std::string bytes, std::size_t said) : bytes_(std::move(bytes)), said_(said) {}
    bool expectBlock(char *target, std::size_t size)
    {
        if (size > bytes_.size()) {
            return false;
        }
        std::memcpy(target, bytes_.data(), size);
        bytes_.erase(0, size);
        return true;
    }
    std::size_t getSize() const { return said_; }
    bool isTextMode() const { return false; }
    bool isValid() const { return true; }
    Portable *getReference() const { return nullptr; }

private:
    std::string bytes_;
    std::size_t said_;
};
} // namespace yarp::os
