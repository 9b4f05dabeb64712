// What real YARP makes of bytes and of text: a process of its own, because some of them end it.
//
// A question is a line that says what is to be done, the size of the data as int32, and the data. The answer is its size, or -1, and the answer.
#include <cstdint>
#include <cstdio>
#include <map>
#include <string>

#include <unistd.h>

#include <yarp/conf/version.h>
#include <yarp/os/Bottle.h>
#include <yarp/os/DummyConnector.h>
#include <yarp/os/Property.h>
#include <yarp/os/Stamp.h>
#include <yarp/sig/Image.h>
#include <yarp/sig/Matrix.h>
#include <yarp/sig/PointCloud.h>
#include <yarp/sig/Sound.h>
#include <yarp/sig/Vector.h>

namespace {

using Work = bool (*)(const std::string& data, std::string& answer);

bool version(const std::string&, std::string& answer) {
    answer = YARP_VERSION;
    return true;
}

// How a bottle is printed.
bool text(const std::string& data, std::string& answer) {
    yarp::os::Bottle bottle;
    bottle.fromBinary(data.data(), data.size());
    answer = bottle.toString();
    return true;
}

// What is written of a bottle that was parsed.
bool bytes(const std::string& data, std::string& answer) {
    yarp::os::Bottle bottle;
    bottle.fromString(data);
    std::size_t size = 0;
    const char* written = bottle.toBinary(&size);
    answer.assign(written, size);
    return true;
}

// Read by one class and written again.
template <typename Readable>
bool rewritten(const std::string& data, std::string& answer) {
    Readable value;
    yarp::os::DummyConnector in;
    in.setTextMode(false);
    in.getWriter().appendBlock(data.data(), data.size());
    yarp::os::DummyConnector out;
    out.setTextMode(false);
    if (!value.read(in.getReader()) || !value.write(out.getWriter())) {
        return false;
    }
    yarp::os::ConnectionReader& reader = out.getReader();
    answer.resize(reader.getSize());
    return reader.expectBlock(&answer[0], answer.size());
}

template <typename Pixel>
using Image = yarp::sig::ImageOf<Pixel>;

template <typename Point>
using Cloud = yarp::sig::PointCloud<Point>;

const std::map<std::string, Work> WORKS = {
    {"version", version},
    {"text", text},
    {"bytes", bytes},
    {"yarp.os.Bottle", rewritten<yarp::os::Bottle>},
    {"yarp.os.Property", rewritten<yarp::os::Property>},
    {"yarp.os.Stamp", rewritten<yarp::os::Stamp>},
    {"yarp.sig.Vector", rewritten<yarp::sig::Vector>},
    {"yarp.sig.VectorOfInt", rewritten<yarp::sig::VectorOf<int>>},
    {"yarp.sig.Matrix", rewritten<yarp::sig::Matrix>},
    {"yarp.sig.Sound", rewritten<yarp::sig::Sound>},
    {"yarp.sig.SoundImage", rewritten<yarp::sig::Sound>},
    {"yarp.sig.FlexImage", rewritten<yarp::sig::FlexImage>},
    {"yarp.sig.ImageOfPixelMono", rewritten<Image<yarp::sig::PixelMono>>},
    {"yarp.sig.ImageOfPixelMono16", rewritten<Image<yarp::sig::PixelMono16>>},
    {"yarp.sig.ImageOfPixelRgb", rewritten<Image<yarp::sig::PixelRgb>>},
    {"yarp.sig.ImageOfPixelRgba", rewritten<Image<yarp::sig::PixelRgba>>},
    {"yarp.sig.ImageOfPixelBgr", rewritten<Image<yarp::sig::PixelBgr>>},
    {"yarp.sig.ImageOfPixelBgra", rewritten<Image<yarp::sig::PixelBgra>>},
    {"yarp.sig.ImageOfPixelHsv", rewritten<Image<yarp::sig::PixelHsv>>},
    {"yarp.sig.ImageOfPixelInt", rewritten<Image<yarp::sig::PixelInt>>},
    {"yarp.sig.ImageOfPixelFloat", rewritten<Image<yarp::sig::PixelFloat>>},
    {"yarp.sig.ImageOfPixelRgbInt", rewritten<Image<yarp::sig::PixelRgbInt>>},
    {"yarp.sig.ImageOfPixelRgbFloat", rewritten<Image<yarp::sig::PixelRgbFloat>>},
    {"yarp.sig.ImageOfPixelHsvFloat", rewritten<Image<yarp::sig::PixelHsvFloat>>},
    {"yarp.sig.ImageOfPixelMonoSigned", rewritten<Image<yarp::sig::PixelMonoSigned>>},
    {"yarp.sig.ImageOfPixelRgbSigned", rewritten<Image<yarp::sig::PixelRgbSigned>>},
    {"yarp.sig.PointCloudXY", rewritten<Cloud<yarp::sig::DataXY>>},
    {"yarp.sig.PointCloudXYZ", rewritten<Cloud<yarp::sig::DataXYZ>>},
    {"yarp.sig.PointCloudXYZI", rewritten<Cloud<yarp::sig::DataXYZI>>},
    {"yarp.sig.PointCloudXYZRGBA", rewritten<Cloud<yarp::sig::DataXYZRGBA>>},
    {"yarp.sig.PointCloudNormal", rewritten<Cloud<yarp::sig::DataNormal>>},
    {"yarp.sig.PointCloudXYZNormal", rewritten<Cloud<yarp::sig::DataXYZNormal>>},
    {"yarp.sig.PointCloudXYZNormalRGBA", rewritten<Cloud<yarp::sig::DataXYZNormalRGBA>>},
    {"yarp.sig.PointCloudInterestPointXYZ", rewritten<Cloud<yarp::sig::DataInterestPointXYZ>>},
};

}  // namespace

int main() {
    std::FILE* answers = fdopen(dup(STDOUT_FILENO), "wb");
    dup2(STDERR_FILENO, STDOUT_FILENO);  // where YARP may talk
    char name[64];
    while (std::fgets(name, sizeof name, stdin) != nullptr) {
        std::int32_t size = 0;
        if (std::fread(&size, sizeof size, 1, stdin) != 1) {
            return 1;
        }
        std::string data(static_cast<std::size_t>(size), '\0');
        if (std::fread(&data[0], 1, data.size(), stdin) != data.size()) {
            return 1;
        }
        std::string answer;
        const auto found = WORKS.find(std::string(name, std::string(name).find('\n')));
        const bool done = found != WORKS.end() && found->second(data, answer);
        size = done ? static_cast<std::int32_t>(answer.size()) : -1;
        std::fwrite(&size, sizeof size, 1, answers);
        std::fwrite(answer.data(), 1, done ? answer.size() : 0, answers);
        std::fflush(answers);
    }
    return 0;
}
