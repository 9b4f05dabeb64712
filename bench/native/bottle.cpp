// The elements of a bottle, and the bottle.
#include "bottle.hpp"

namespace model {

namespace {

constexpr std::int32_t SCALARS = 0xFF;  // bits of a list's tag that name the type of all its elements
constexpr std::int32_t MAX_BYTES = 64 << 20;

class Int32 : public Element {
public:
    bool read(Reader& reader) override {
        value_ = reader.expect_int32();
        return !reader.is_error();
    }
    double as_float64() const override { return value_; }

private:
    std::int32_t value_ = 0;
};

class Int64 : public Element {
public:
    bool read(Reader& reader) override {
        value_ = reader.expect_int64();
        return !reader.is_error();
    }
    double as_float64() const override { return static_cast<double>(value_); }

private:
    std::int64_t value_ = 0;
};

class Float64 : public Element {
public:
    bool read(Reader& reader) override {
        value_ = reader.expect_float64();
        return !reader.is_error();
    }
    double as_float64() const override { return value_; }

private:
    double value_ = 0;
};

class Bytes : public Element {
public:
    bool read(Reader& reader) override {
        const std::int32_t size = reader.expect_int32();
        if (reader.is_error() || size < 0 || size > MAX_BYTES) {
            return false;
        }
        value_.resize(static_cast<std::size_t>(size));
        return reader.expect_block(value_.data(), value_.size());
    }

private:
    std::string value_;
};

}  // namespace

std::unique_ptr<Element> make_element(std::int32_t tag) {
    switch (tag) {
        case INT32:
        case VOCAB32:
            return std::make_unique<Int32>();
        case INT64:
            return std::make_unique<Int64>();
        case FLOAT64_V3:
        case FLOAT64_V4:
            return std::make_unique<Float64>();
        case STRING:
        case BLOB:
            return std::make_unique<Bytes>();
        default:
            return tag & LIST ? std::make_unique<Bottle>(tag & SCALARS) : nullptr;
    }
}

bool Bottle::from_binary(const char* data, std::size_t size) {
    const std::string message(data, size);
    MemoryStream stream;
    stream.add(message);
    const Route route;
    StreamReader reader(stream, route, size);
    element_tag_ = reader.expect_int32() & SCALARS;
    return !reader.is_error() && read(reader);
}

bool Bottle::read(Reader& reader) {
    elements_.clear();
    const std::int32_t count = reader.expect_int32();
    for (std::int32_t index = 0; index < count; ++index) {
        if (!read_element(reader)) {
            return false;
        }
    }
    return !reader.is_error();
}

bool Bottle::read_element(Reader& reader) {
    if (reader.is_error()) {
        return false;
    }
    const std::int32_t tag = element_tag_ != 0 ? element_tag_ : reader.expect_int32();
    std::unique_ptr<Element> element = make_element(tag);
    if (!element || !element->read(reader)) {
        return false;
    }
    elements_.push_back(std::move(element));
    return true;
}

}  // namespace model
