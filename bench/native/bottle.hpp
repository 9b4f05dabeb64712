// A model of how YARP decodes a bottle: one heap object an element behind a virtual base class, and a virtual read from a stream for each number.
//
// It is written from a description of YARP's behaviour, not from its source, and stands in for it where YARP is not installed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace model {

// YARP 3: the tag of a float64 is 10; YARP 4: 20.
enum Tag : std::int32_t { INT32 = 1, STRING = 4, VOCAB32 = 9, FLOAT64_V3 = 10, BLOB = 12, INT64 = 17, FLOAT64_V4 = 20, LIST = 256 };

// A place to read to; its accessors are calls into another translation unit, as in YARP.
class Target {
public:
    Target(char* data, std::size_t size);
    char* data() const;
    std::size_t size() const;

private:
    char* data_;
    std::size_t size_;
};

class Stream {
public:
    virtual ~Stream() = default;
    virtual std::ptrdiff_t read(Target& target) = 0;
    virtual bool is_ok() const = 0;
};

class MemoryStream : public Stream {
public:
    void add(const std::string& data) { data_ += data; }
    std::ptrdiff_t read(Target& target) override;
    bool is_ok() const override;

private:
    std::string data_;
    std::size_t at_ = 0;
};

class Reader {
public:
    virtual ~Reader() = default;
    virtual std::int32_t expect_int32() = 0;
    virtual std::int64_t expect_int64() = 0;
    virtual double expect_float64() = 0;
    virtual bool expect_block(char* target, std::size_t size) = 0;
    virtual bool is_error() const = 0;
};

struct Route {
    std::string from, to, carrier;
};

class Element;

// Like YARP's, it is made anew for each message and knows the route, the carrier's configuration and a second stream.
class StreamReader : public Reader {
public:
    StreamReader(Stream& stream, const Route& route, std::size_t size);
    ~StreamReader() override;
    std::int32_t expect_int32() override;
    std::int64_t expect_int64() override;
    double expect_float64() override;
    bool expect_block(char* target, std::size_t size) override;
    bool is_error() const override;

private:
    bool is_active() const;
    bool is_good() const;
    template <typename Number>
    Number expect();

    Stream* stream_;
    Route route_;
    std::size_t left_;
    std::unique_ptr<Element> configuration_;
    MemoryStream text_;
    bool valid_ = true;
    bool error_ = false;
};

class Element {
public:
    virtual ~Element() = default;
    virtual bool read(Reader& reader) = 0;
    virtual double as_float64() const { return 0; }
};

class Bottle : public Element {
public:
    explicit Bottle(std::int32_t element_tag = 0) : element_tag_(element_tag) {}
    bool from_binary(const char* data, std::size_t size);
    bool read(Reader& reader) override;  // the body of a list: count, then elements
    const Element& get(std::size_t index) const { return *elements_[index]; }
    std::size_t size() const { return elements_.size(); }

private:
    bool read_element(Reader& reader);

    std::int32_t element_tag_;
    std::vector<std::unique_ptr<Element>> elements_;
};

std::unique_ptr<Element> make_element(std::int32_t tag);

}  // namespace model
