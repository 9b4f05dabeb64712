// What the kernels are measured against, each function timing its own loop: nanoseconds a message, or -1 where the message is refused.
#include <cstdint>
#include <cstring>

#include "timing.hpp"

namespace {

constexpr float DEGREE = 0.017453292519943295F;
constexpr std::int64_t HEADER = 8;  // tag of the list, count
constexpr std::int64_t WIDTH = 8;   // of a float64
constexpr std::int32_t LIST = 256;  // the tag of a list whose elements have tags of their own

// The check that a person writes by hand: a list of float64, and as long as it says.
inline bool header_is_good(const unsigned char* message, std::int64_t size, std::int32_t tag, std::int64_t* count) {
    std::int32_t head[2];
    if (size < HEADER) {
        return false;
    }
    std::memcpy(head, message, sizeof head);
    *count = head[1];
    return head[0] == tag && head[1] >= 0 && size == HEADER + WIDTH * static_cast<std::int64_t>(head[1]);
}

// As Python's PyMethodDef.
struct Method {
    const char* name;
    void* (*function)(void*, void*);
    int flags;
    const char* documentation;
};

// Gives back its argument; an object begins with the number of those who hold it.
void* empty(void*, void* argument) {
    ++*static_cast<std::intptr_t*>(argument);
    return argument;
}

}  // namespace

extern "C" {

double loop_decode_ns(const unsigned char* message, std::int64_t size, std::int32_t tag, float* angles, std::int64_t iterations) {
    return nanoseconds(iterations, [=] {
        std::int64_t count = 0;
        if (!header_is_good(message, size, tag, &count)) {
            return false;
        }
        for (std::int64_t index = 0; index < count; ++index) {
            double degrees = 0;
            std::memcpy(&degrees, message + HEADER + WIDTH * index, WIDTH);
            angles[index] = static_cast<float>(degrees) * DEGREE;
        }
        return true;
    });
}

// A tag before each double.
double tagged_decode_ns(const unsigned char* message, std::int64_t size, std::int32_t tag, float* angles, std::int64_t iterations) {
    constexpr std::int64_t element = static_cast<std::int64_t>(sizeof tag) + WIDTH;
    return nanoseconds(iterations, [=] {
        std::int32_t head[2];
        if (size < HEADER) {
            return false;
        }
        std::memcpy(head, message, sizeof head);
        if (head[0] != LIST || head[1] < 0 || size != HEADER + element * static_cast<std::int64_t>(head[1])) {
            return false;
        }
        for (std::int64_t index = 0; index < head[1]; ++index) {
            std::int32_t found = 0;
            double degrees = 0;
            std::memcpy(&found, message + HEADER + element * index, sizeof found);
            std::memcpy(&degrees, message + HEADER + element * index + sizeof found, WIDTH);
            if (found != tag) {
                return false;
            }
            angles[index] = static_cast<float>(degrees) * DEGREE;
        }
        return true;
    });
}

double copy_decode_ns(const unsigned char* message, std::int64_t size, std::int32_t tag, double* angles, std::int64_t iterations) {
    return nanoseconds(iterations, [=] {
        std::int64_t count = 0;
        if (!header_is_good(message, size, tag, &count)) {
            return false;
        }
        std::memcpy(angles, message + HEADER, static_cast<std::size_t>(WIDTH * count));
        return true;
    });
}

// What describes a built-in function of one argument to Python; made without its headers, so that any compiler will do.
void* empty_method() {
    static Method method = {"empty", empty, 0x0008, nullptr};
    return &method;
}

double memmove_ns(unsigned char* target, const unsigned char* source, std::int64_t size, std::int64_t iterations) {
    return nanoseconds(iterations, [=] {
        std::memmove(target, source, static_cast<std::size_t>(size));
        return true;
    });
}

}  // extern "C"
