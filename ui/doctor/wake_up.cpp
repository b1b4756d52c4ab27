#include "ui/doctor/wake_up.hpp"

#include <chrono>
#include <ctime>
#include <thread>

#include "engine/device/device.hpp"
#include "engine/realtime/thread_servo.hpp"
#include "engine/rendering/scene.hpp"
#include "stimuli/two_curve.hpp"

namespace palpate::ui {
namespace {

class NoDevice : public engine::Device {
public:
    engine::Reading read() noexcept override { return {.hip = {0.0, 0.06, 0.0}}; }
    engine::AppliedForce write(const engine::Vec3& /*force*/) noexcept override { return {}; }
    [[nodiscard]] std::string name() const override { return "none"; }
};

double processor_s() {
    timespec used{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &used);
    return static_cast<double>(used.tv_sec) + static_cast<double>(used.tv_nsec) * 1e-9;
}

}  // namespace

WakeUps measure_wake_ups(double rate_hz,
                         double seconds,
                         const engine::RealtimeWish& wish,
                         double spin_share) {
    NoDevice device;
    const engine::Scene scene(stimuli::make_outline(stimuli::TwoCurve{}), {});
    engine::ThreadServo servo(device, {.rate_hz = rate_hz,
                                       .limits = {.ramp_step = 1.0},
                                       .realtime = wish,
                                       .spin_share = spin_share});
    servo.begin(scene);
    const double before = processor_s();
    while (servo.elapsed_s() < seconds) {
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    const double used = processor_s() - before;
    const double elapsed = servo.elapsed_s();
    servo.end();
    return {
        .lateness = servo.lateness(), .rights = servo.rights(), .processor_share = used / elapsed};
}

}  // namespace palpate::ui
