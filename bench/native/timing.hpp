// How every native peer is timed: by itself, in a loop of its own, so that ctypes costs nothing.
#pragma once

#include <chrono>
#include <cstdint>

// The compiler must believe that somebody else reads and writes all memory between two messages.
inline void forget() { asm volatile("" ::: "memory"); }

// Nanoseconds a message, or -1 where `work` says that it failed.
template <typename Work>
double nanoseconds(std::int64_t iterations, Work work) {
    const auto started = std::chrono::steady_clock::now();
    for (std::int64_t turn = 0; turn < iterations; ++turn) {
        forget();
        if (!work()) {
            return -1;
        }
    }
    const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - started;
    return took.count() / static_cast<double>(iterations);
}
