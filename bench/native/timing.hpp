// How every native peer is timed: by itself, in a loop of its own, so that ctypes costs nothing.
#pragma once

#include <time.h>

#include <cstddef>
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

// Messages one behind another, which come in turn; `ends` says where each of them ends.
struct Messages {
    unsigned char* data;
    const std::int64_t* ends;
    std::int64_t count;

    unsigned char* at(std::int64_t number) const { return data + (number == 0 ? 0 : ends[number - 1]); }
    std::size_t size(std::int64_t number) const {
        return static_cast<std::size_t>(ends[number] - (number == 0 ? 0 : ends[number - 1]));
    }
    std::size_t longest() const {
        std::size_t found = 0;
        for (std::int64_t number = 0; number < count; ++number) {
            found = size(number) > found ? size(number) : found;
        }
        return found;
    }
};

// The same as `nanoseconds`; `work` is given the number of the message whose turn it is.
template <typename Work>
double nanoseconds_in_turn(std::int64_t count, std::int64_t iterations, Work work) {
    std::int64_t number = 0;
    return nanoseconds(iterations, [&] {
        const bool done = work(number);
        number = number + 1 == count ? 0 : number + 1;
        return done;
    });
}
