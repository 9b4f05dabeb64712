// How every native peer is timed: by itself, in a loop of its own, so that ctypes costs nothing.
#pragma once

#include <time.h>

#include <cstdint>

// The compiler must believe that somebody else reads and writes all memory between two messages.
inline void forget() { asm volatile("" ::: "memory"); }

// The compiler must believe that somebody else knows an object: else it may leave out to write what nobody reads.
template <typename Object>
void publish(Object& object) {
    asm volatile("" : : "r"(&object) : "memory");
}

// Nanoseconds that this thread has had a processor: what others do meanwhile does not count.
inline double now_ns() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return 1e9 * static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec);
}

// Nanoseconds a message, or -1 where `work` says that it failed.
template <typename Work>
double nanoseconds(std::int64_t iterations, Work work) {
    const double started = now_ns();
    for (std::int64_t turn = 0; turn < iterations; ++turn) {
        forget();
        if (!work()) {
            return -1;
        }
    }
    return (now_ns() - started) / static_cast<double>(iterations);
}
