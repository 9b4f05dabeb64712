// A YARP image by hand: its header checked, then its rows copied, or their channels swapped, or each channel put into a plane of its own.
#include <cstring>

#include "timing.hpp"

namespace {

constexpr std::int64_t HEADER = 60;
constexpr std::int64_t CHANNELS = 3;
constexpr std::int64_t QUANTUM = 8;
constexpr std::int32_t IMAGE[] = {256, 4, 9, 0x0074616d, 9, 0x00626772, 257, 5, 3};

struct Image {
    const unsigned char* pixels;
    std::int64_t width, height, row;
};

bool open(const unsigned char* message, std::int64_t size, Image& image) {
    std::int32_t head[15];
    if (size < HEADER) {
        return false;
    }
    std::memcpy(head, message, sizeof head);
    image = {message + HEADER, head[11], head[12], (head[11] * CHANNELS + QUANTUM - 1) / QUANTUM * QUANTUM};
    return std::memcmp(head, IMAGE, sizeof IMAGE) == 0 && image.width >= 0 && image.height >= 0 && head[14] == image.row * image.height &&
           size == HEADER + head[14];
}

template <typename Row>
double each_row(const unsigned char* message, std::int64_t size, std::int64_t iterations, Row row) {
    return nanoseconds(iterations, [=] {
        Image image;
        if (!open(message, size, image)) {
            return false;
        }
        for (std::int64_t y = 0; y < image.height; ++y) {
            row(image, y, image.pixels + y * image.row);
        }
        return true;
    });
}

}  // namespace

extern "C" {

double image_unpad_ns(const unsigned char* message, std::int64_t size, unsigned char* target, std::int64_t iterations) {
    return each_row(message, size, iterations, [=](const Image& image, std::int64_t y, const unsigned char* from) {
        std::memcpy(target + y * image.width * CHANNELS, from, static_cast<std::size_t>(image.width * CHANNELS));
    });
}

double image_swap_ns(const unsigned char* message, std::int64_t size, unsigned char* target, std::int64_t iterations) {
    return each_row(message, size, iterations, [=](const Image& image, std::int64_t y, const unsigned char* from) {
        unsigned char* to = target + y * image.width * CHANNELS;
        for (std::int64_t x = 0; x < image.width; ++x) {
            to[CHANNELS * x] = from[CHANNELS * x + 2];
            to[CHANNELS * x + 1] = from[CHANNELS * x + 1];
            to[CHANNELS * x + 2] = from[CHANNELS * x];
        }
    });
}

double image_planar_ns(const unsigned char* message, std::int64_t size, unsigned char* target, std::int64_t iterations) {
    return each_row(message, size, iterations, [=](const Image& image, std::int64_t y, const unsigned char* from) {
        const std::int64_t plane = image.width * image.height;
        unsigned char* to = target + y * image.width;
        for (std::int64_t x = 0; x < image.width; ++x) {
            to[x] = from[CHANNELS * x];
            to[plane + x] = from[CHANNELS * x + 1];
            to[2 * plane + x] = from[CHANNELS * x + 2];
        }
    });
}

}  // extern "C"
