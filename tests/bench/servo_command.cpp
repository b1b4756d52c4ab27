#include <iostream>
#include <vector>

#include "engine/device/simulated_pantograph.hpp"
#include "engine/realtime/thread_servo.hpp"
#include "engine/rendering/scene.hpp"
#include "stimuli/two_curve.hpp"
#include "ui/doctor/checks.hpp"
#include "tests/bench/commands.hpp"
#include "tests/bench/report.hpp"

namespace palpate::bench {

/// What keeping a tick costs the servo thread: flight recorder, ring, latest value, lateness
/// histogram.
struct LoggingCost {
    std::vector<double>
        logging_ns;  ///< the four alone, once a tick at 1 kHz: caches are as a loop finds them
    std::vector<double>
        bare_ns;  ///< a tick of the warm loop without ring, latest value and histogram
    std::vector<double> logged_ns;  ///< the same with them, in turns of 100 ticks
};

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

/// @param seconds  of the 1 kHz loop
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
namespace {

using namespace palpate::engine;

struct Plan {
    int rounds = 5;
    double seconds = 10.0;
    double spin = 0.3;
};

/// One line of the table and of the CSV.
struct Line {
    std::string part{};
    std::string method{};
    double rate_hz = 1000.0;
    int round = 0;
    std::int64_t ticks = 0;
    double p50_us = 0.0;
    double p99_us = 0.0;
    double p999_us = 0.0;
    double max_us = 0.0;
    std::int64_t late = -1;    ///< ticks more than half a period late; -1: not counted
    std::int64_t missed = -1;  ///< deadlines slept through
    double processor_share = -1.0;
};

double us(std::int64_t ns) {
    return static_cast<double>(ns) * 1e-3;
}

Line line_of(const LatenessHistogram& lateness, double processor_share) {
    return {.ticks = lateness.count(),
            .p50_us = us(lateness.quantile_ns(0.50)),
            .p99_us = us(lateness.quantile_ns(0.99)),
            .p999_us = us(lateness.quantile_ns(0.999)),
            .max_us = us(lateness.max_ns()),
            .late = lateness.late(),
            .missed = lateness.missed(),
            .processor_share = processor_share};
}

Line line_of(const ui::Cyclictest& theirs) {
    return {.ticks = theirs.total(),
            .p50_us = theirs.quantile_us(0.50),
            .p99_us = theirs.quantile_us(0.99),
            .p999_us = theirs.quantile_us(0.999),
            .max_us = theirs.max_us};
}

Line line_of(std::vector<double> ns) {
    return {.ticks = static_cast<std::int64_t>(ns.size()),
            .p50_us = 1e-3 * percentile(ns, 0.50),
            .p99_us = 1e-3 * percentile(ns, 0.99),
            .p999_us = 1e-3 * percentile(ns, 0.999),
            .max_us = 1e-3 * percentile(ns, 1.0)};
}

class Table {
public:
    explicit Table(Output& csv) : csv_(csv) {}

    void heading(const char* text) {
        std::printf("\n%s\n%-26s %6s %5s %8s %9s %9s %9s %10s %6s %6s %6s\n", text, "", "Hz",
                    "round", "ticks", "p50 us", "p99 us", "p99.9", "max", "late", "missed",
                    "cpu %");
    }

    void add(Line line, const char* part, const char* method, double rate_hz, int round) {
        line.part = part;
        line.method = method;
        line.rate_hz = rate_hz;
        line.round = round;
        std::printf("%-26s %6.0f %5d %8lld %9.3f %9.3f %9.3f %10.1f", method, rate_hz, round,
                    static_cast<long long>(line.ticks), line.p50_us, line.p99_us, line.p999_us,
                    line.max_us);
        if (line.late >= 0) {
            std::printf(" %6lld %6lld %6.1f", static_cast<long long>(line.late),
                        static_cast<long long>(line.missed), 100.0 * line.processor_share);
        }
        std::printf("\n");
        std::fflush(stdout);
        write(line);
    }

private:
    void write(const Line& line) {
        csv_ << printed("\"%s\",%s,\"%s\",%.0f,%d,%lld,%.4f,%.4f,%.4f,%.4f,", machine().c_str(),
                        line.part.c_str(), line.method.c_str(), line.rate_hz, line.round,
                        static_cast<long long>(line.ticks), line.p50_us, line.p99_us, line.p999_us,
                        line.max_us);
        if (line.late >= 0) {
            csv_ << line.late << ',' << line.missed << ',' << line.processor_share << '\n';
        } else {
            csv_ << ",,\n";
        }
    }

    Output& csv_;
};

struct Ratios {
    std::vector<double> p50;
    std::vector<double> p99;

    void add(const Line& ours, const Line& theirs) {
        p50.push_back(ours.p50_us / std::max(theirs.p50_us, 1e-3));
        p99.push_back(ours.p99_us / std::max(theirs.p99_us, 1e-3));
    }
    void print(const char* what) const {
        std::printf("%s / cyclictest, median of %zu rounds: p50 %.3f, p99 %.3f\n", what, p50.size(),
                    percentile(p50, 0.5), percentile(p99, 0.5));
    }
};

void wake_ups(const Plan& plan, Table& table) {
    constexpr double kRate = 1000.0;
    table.heading("Wake-up lateness, in turns");
    const bool installed = ui::cyclictest_installed();
    Ratios sleeping;
    Ratios spinning;
    for (int round = 1; round <= plan.rounds; ++round) {
        const auto ours = ui::measure_wake_ups(kRate, plan.seconds, RealtimeWish::everything());
        const Line slept = line_of(ours.lateness, ours.processor_share);
        if (round == 1) {
            for (const auto& [right, granted] : engine::provenance(ours.rights)) {
                std::printf("  %s: %s\n", right.c_str(), granted.c_str());
            }
        }
        table.add(slept, "wake-up", "ours", kRate, round);
        const bool fifo = ours.rights.of(engine::Right::fifo).grant == engine::Grant::given;
        const auto theirs =
            installed ? ui::run_cyclictest(kRate, plan.seconds, fifo) : std::nullopt;
        if (theirs) {
            table.add(line_of(*theirs), "wake-up", "cyclictest", kRate, round);
            sleeping.add(slept, line_of(*theirs));
        }
        const auto spun =
            ui::measure_wake_ups(kRate, plan.seconds, RealtimeWish::everything(), plan.spin);
        const Line watched = line_of(spun.lateness, spun.processor_share);
        table.add(watched, "wake-up", "ours, spinning", kRate, round);
        if (theirs) {
            spinning.add(watched, line_of(*theirs));
        }
    }
    if (sleeping.p50.empty()) {
        std::printf("cyclictest (package rt-tests) is not there, or may not run: no ratios\n");
        return;
    }
    sleeping.print("ours");
    spinning.print("ours, spinning");
}

void logging(const Plan& plan, Table& table) {
    table.heading("Cost of logging a tick on the servo thread");
    const LoggingCost cost = measure_logging(plan.seconds);
    table.add(line_of(cost.logging_ns), "logging", "logging alone, 1 kHz", 1000.0, 1);
    table.add(line_of(cost.bare_ns), "logging", "tick without, warm", 0.0, 1);
    table.add(line_of(cost.logged_ns), "logging", "tick with, warm", 0.0, 1);
    std::printf("logging p99 %.3f us; warm ticks with - without: p50 %+.0f ns, p99 %+.0f ns\n",
                1e-3 * percentile(cost.logging_ns, 0.99),
                percentile(cost.logged_ns, 0.5) - percentile(cost.bare_ns, 0.5),
                percentile(cost.logged_ns, 0.99) - percentile(cost.bare_ns, 0.99));
}

Line simulated(double rate_hz, double seconds, double spin) {
    engine::SimulatedPantograph device({}, 1.0 / rate_hz);
    device.begin({});
    const engine::Scene scene(stimuli::make_outline({.curvature = 5.0}),
                              {.period = 1.0 / rate_hz, .friction = {.mu_s = 0.7, .mu_d = 0.5}});
    engine::ThreadServo servo(device,
                              {.rate_hz = rate_hz,
                               .limits = {.ramp_step = engine::ramp_step(0.2, 1.0 / rate_hz)},
                               .realtime = RealtimeWish::everything(),
                               .spin_share = spin});
    servo.begin(scene);
    const Stopwatch processor;
    const double before = processor.now();
    std::array<engine::TickRecord, 256> some{};
    while (servo.elapsed_s() < seconds && servo.advance() == engine::ServoStatus::running) {
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
        while (servo.ring().pop(some) > 0) {
        }
    }
    const double share = (processor.now() - before) / servo.elapsed_s();
    servo.end();
    if (servo.trip() != engine::Trip::none || servo.dropped() > 0) {
        throw std::runtime_error("the simulated session tripped (" +
                                 std::string(to_string(servo.trip())) + ") or lost ticks");
    }
    return line_of(servo.lateness(), share);
}

void rates(const Plan& plan, Table& table) {
    table.heading("Simulated pantograph in real time");
    for (const double rate : {1000.0, 4000.0, 10000.0}) {
        table.add(simulated(rate, plan.seconds, 0.0), "rate", "sleeping", rate, 1);
        table.add(simulated(rate, plan.seconds, plan.spin), "rate", "spinning", rate, 1);
    }
}

}  // namespace

int servo_command(Words words) {
    const std::string csv_name = words.value("--csv");
    const Plan plan{.rounds = static_cast<int>(words.number("--rounds", 5, 1, 1000)),
                    .seconds = words.number("--seconds", 10.0, 0.1, 3600.0),
                    .spin = words.number("--spin", 0.3, 0.0, 0.5)};
    words.finish();
    Output csv(csv_name,
               "machine,part,method,rate_hz,round,ticks,p50_us,p99_us,p999_us,max_us,late,missed,"
               "processor_share\n");
    std::cout << machine() << std::endl;
    Table table(csv);
    wake_ups(plan, table);
    logging(plan, table);
    rates(plan, table);
    csv.finish();
    return 0;
}

}  // namespace palpate::bench
