// The stream and its reader; a translation unit of its own, because in YARP no call through them can be inlined either.
#include <cstring>

#include "bottle.hpp"

namespace model {

Target::Target(char* data, std::size_t size) : data_(data), size_(size) {}

char* Target::data() const { return data_; }

std::size_t Target::size() const { return size_; }

bool MemoryStream::is_ok() const { return true; }

std::ptrdiff_t MemoryStream::read(Target& target) {
    const std::size_t left = data_.size() - at_;
    const std::size_t size = target.size() < left ? target.size() : left;
    if (size > 0) {
        std::memcpy(target.data(), data_.data() + at_, size);
        at_ += size;
    }
    return static_cast<std::ptrdiff_t>(size);
}

StreamReader::StreamReader(Stream& stream, const Route& route, std::size_t size)
    : stream_(&stream), route_(route), left_(size), configuration_(make_element(LIST)) {}

StreamReader::~StreamReader() = default;

bool StreamReader::is_active() const { return valid_ && stream_ != nullptr && stream_->is_ok(); }

bool StreamReader::is_error() const { return error_ || !is_active(); }

// YARP, too, asks the stream twice for each number.
bool StreamReader::is_good() const { return is_active() && valid_ && !is_error(); }

template <typename Number>
Number StreamReader::expect() {
    if (!is_good()) {
        return 0;
    }
    Number value = 0;
    Target target(reinterpret_cast<char*>(&value), sizeof value);
    const std::ptrdiff_t size = stream_->read(target);
    if (size < 0 || static_cast<std::size_t>(size) < target.size()) {
        error_ = true;
        return 0;
    }
    left_ -= target.size();
    return value;
}

std::int32_t StreamReader::expect_int32() { return expect<std::int32_t>(); }

std::int64_t StreamReader::expect_int64() { return expect<std::int64_t>(); }

double StreamReader::expect_float64() { return expect<double>(); }

bool StreamReader::expect_block(char* data, std::size_t size) {
    if (!is_good()) {
        return false;
    }
    Target target(data, size);
    error_ = stream_->read(target) != static_cast<std::ptrdiff_t>(size);
    return !error_;
}

}  // namespace model
