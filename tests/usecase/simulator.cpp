// A torso of three joints and a camera, as the iCub's simulator has them: joint angles in degrees on torso/state:o, images on cam/left,
// and commands `[set] [poss] (yaw roll pitch)` on torso/rpc:i.

#include <cmath>
#include <mutex>

#include <yarp/os/Bottle.h>
#include <yarp/os/BufferedPort.h>
#include <yarp/os/Network.h>
#include <yarp/os/PortReader.h>
#include <yarp/os/RpcServer.h>
#include <yarp/os/Time.h>
#include <yarp/os/Vocab.h>
#include <yarp/sig/Image.h>
#include <yarp/sig/Vector.h>

static const double STEP_S = 0.02, SPEED_DEG = 40.0;

class Torso : public yarp::os::PortReader {
public:
    double angles[3] = {0, 0, 0}, wanted[3] = {0, 0, 0};
    std::mutex lock;

    bool read(yarp::os::ConnectionReader& connection) override {
        yarp::os::Bottle command, reply;
        if (!command.read(connection)) {
            return false;
        }
        const bool known = command.get(0).asString() == "set" && command.get(1).asString() == "poss" && command.get(2).isList();
        if (known) {
            std::lock_guard<std::mutex> held(lock);
            for (int joint = 0; joint < 3; ++joint) {
                wanted[joint] = command.get(2).asList()->get(joint).asFloat64();
            }
        }
        reply.addVocab32(yarp::os::Vocab32::encode(known ? "ok" : "fail"));
        yarp::os::ConnectionWriter* writer = connection.getWriter();
        return writer == nullptr || reply.write(*writer);
    }

    void move() {
        std::lock_guard<std::mutex> held(lock);
        for (int joint = 0; joint < 3; ++joint) {
            const double left = wanted[joint] - angles[joint], most = SPEED_DEG * STEP_S;
            angles[joint] += std::fabs(left) <= most ? left : std::copysign(most, left);
        }
    }
};

int main() {
    yarp::os::NetworkBase::initMinimum();
    Torso torso;
    yarp::os::BufferedPort<yarp::sig::Vector> state;
    yarp::os::BufferedPort<yarp::sig::ImageOf<yarp::sig::PixelRgb>> camera;
    yarp::os::Port commands;
    commands.setReader(torso);
    if (!state.open("/icub/torso/state:o") || !camera.open("/icub/cam/left") || !commands.open("/icub/torso/rpc:i")) {
        return 1;
    }
    for (int step = 0;; ++step) {
        torso.move();
        yarp::sig::Vector& angles = state.prepare();
        angles.resize(3);
        for (int joint = 0; joint < 3; ++joint) {
            angles[joint] = torso.angles[joint];
        }
        state.write();
        if (step % 5 == 0) {
            auto& image = camera.prepare();
            image.resize(160, 120);
            const int column = static_cast<int>(80 + torso.angles[0]);
            for (int y = 0; y < 120; ++y) {
                for (int x = 0; x < 160; ++x) {
                    const bool arm = std::abs(x - column) < 6;
                    image.pixel(x, y) = yarp::sig::PixelRgb(arm ? 255 : x, arm ? 120 : y, arm ? 0 : 90);
                }
            }
            camera.write();
        }
        yarp::os::Time::delay(STEP_S);
    }
}
