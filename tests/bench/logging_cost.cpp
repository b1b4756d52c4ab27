#include "tests/bench/logging_cost.hpp"

#include "engine/device/simulated_pantograph.hpp"
#include "engine/realtime/thread_servo.hpp"
#include "engine/rendering/scene.hpp"
#include "stimuli/two_curve.hpp"
#include "tests/bench/timing.hpp"

namespace palpate::bench {
namespace {

using namespace engine;

Scene felt() {
    return {stimuli::make_outline({.curvature = 5.0}), {.friction = {.mu_s = 0.7, .mu_d = 0.5}}};
}

/// The recorder's side: empties a ring every 10 ms, as a session does.
class Drain {
public:
    explicit Drain(TickRing& ring) : thread_([this, &ring] { run(ring); }) {}
    Drain(const Drain&) = delete;
    Drain& operator=(const Drain&) = delete;
    ~Drain() {
        quit_.store(true);
        thread_.join();
    }

private:
    void run(TickRing& ring) {
        std::array<TickRecord, 256> some{};
        while (!quit_.load()) {
            while (const std::size_t n = ring.pop(some)) {
                keep(some[n - 1]);
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
    }

    std::atomic<bool> quit_{false};
    std::thread thread_;
};

/// Ticks at 1 kHz, each logged; the logging alone is timed.
std::vector<double> alone(double seconds, const Clock& clock) {
    SimulatedPantograph device({}, 1e-3);
    device.begin({});
    TickLoop loop(device, {});
    const Scene scene = felt();
    loop.begin(scene);
    TickRing ring(kRingTicks);
    const Drain drain(ring);
    FlightRecorder flight;
    LatenessHistogram histogram;
    std::vector<double> costs;
    costs.reserve(static_cast<std::size_t>(seconds * 1000.0) + 1);
    std::int64_t due = monotonic_ns();
    for (std::int64_t k = 0; k < static_cast<std::int64_t>(seconds * 1000.0); ++k) {
        due += 1'000'000;
        sleep_until(due);
        const TickRecord record = loop.tick({.time_ns = k * 1'000'000});
        const std::uint64_t from = Clock::now();
        flight.add(record);
        static_cast<void>(ring.push(record));
        histogram.add(20'000, false);
        const std::uint64_t to = Clock::now();
        costs.push_back(clock.between(from, to));
    }
    keep(histogram.count());
    return costs;
}

class Bare : public Servo {
public:
    using Servo::Servo;
    void begin(const SceneView& scene) override { loop_.begin(scene); }
    ServoStatus advance() override { return ServoStatus::running; }
    void end() override { loop_.silence(); }
    [[nodiscard]] double elapsed_s() const noexcept override { return 0.0; }

    void bare(std::int64_t k) noexcept { keep(loop_.tick({.time_ns = k * period_ns_})); }
    void logged(std::int64_t k) noexcept { run_tick(k * period_ns_, k * period_ns_, 0, true); }
};

void in_turns(LoggingCost& cost, const Clock& clock) {
    constexpr int kTurns = 400;
    constexpr int kTicks = 100;
    SimulatedPantograph device({}, 1e-3);
    device.begin({});
    Bare servo(device, {});
    const Scene scene = felt();
    servo.begin(scene);
    const Drain drain(servo.ring());
    std::int64_t k = 0;
    for (int turn = 0; turn < kTurns; ++turn) {
        for (const bool log : {false, true}) {
            for (int i = 0; i < kTicks; ++i, ++k) {
                const std::uint64_t from = Clock::now();
                log ? servo.logged(k) : servo.bare(k);
                const std::uint64_t to = Clock::now();
                (log ? cost.logged_ns : cost.bare_ns).push_back(clock.between(from, to));
            }
        }
        if (turn % 50 == 49) {  // leave the recorder's side its time: a full ring is another path
            std::this_thread::sleep_for(std::chrono::milliseconds(30));
        }
    }
}

}  // namespace

LoggingCost measure_logging(double seconds) {
    LoggingCost cost;
    // On a thread of its own with a servo's rights, which end with it.
    std::thread thread([&] {
        const Clock clock;
        RealtimeRights rights;
        const ProgramRights program(RealtimeWish::everything(), rights);
        take_thread_rights(RealtimeWish::everything(), rights);
        cost.logging_ns = alone(seconds, clock);
        in_turns(cost, clock);
    });
    thread.join();
    return cost;
}

}  // namespace palpate::bench
