#include "tests/bench/friction_runs.hpp"

#include "engine/rendering/energy_ledger.hpp"
#include "tests/support/outlines.hpp"
#include "tests/support/random.hpp"

namespace palpate::bench {
namespace {

using engine::Vec2;

constexpr double kStiffness = 1000.0;  ///< N/m
constexpr double kLoad = 4.0;          ///< N
constexpr double kTick = 1e-3;         ///< s

engine::Scene scene_of(const RubbedLaw& law, double period) {
    static const auto ground =
        tests::polyline({{-1.0, 0.0}, {1.0, 0.0}, {1.0, -1.0}, {-1.0, -1.0}}, true);
    return {ground,
            {.stiffness = kStiffness, .period = period, .friction = law.friction, .law = law.own}};
}

/// Friction on a hand that is pressed 4 mm deep, place by place.
class Pressed {
public:
    Pressed(const RubbedLaw& law, double period)
        : scene_(scene_of(law, period)), recalled_(law.as_recalled) {}

    /// On the hand, N. @param x  of HIP, m
    double at(double x) {
        if (recalled_) {
            return recalled(x);
        }
        return scene_.tick(state_, {x, -kLoad / kStiffness}).tangential_force;
    }

private:
    /// The paper's recursion with the map that goes with it, so that |z| = z_max in steady sliding.
    double recalled(double x) {
        constexpr double kMax = 0.5 * kLoad / kStiffness;
        const double stick = 0.7 * kMax;
        const double to8 = std::pow(stick, 8.0);
        const double max = kMax / (1.0 + std::pow(0.7, 8.0));
        const double z = x - anchor_;
        const double alpha = std::pow(z, 8.0) / (max * (to8 + std::pow(z, 8.0)));
        anchor_ = started_ ? anchor_ + std::fabs(x - x_) * alpha * z : x;
        if (std::fabs(x - anchor_) > kMax) {
            anchor_ = x - std::copysign(kMax, x - anchor_);
        }
        started_ = true;
        x_ = x;
        return -kStiffness * (x - anchor_);
    }

    engine::Scene scene_;
    engine::ContactState state_{};
    bool recalled_;
    bool started_ = false;
    double anchor_ = 0.0;
    double x_ = 0.0;
};

/// 10 mm at 0.5 Hz.
double stroke(double t) {
    return 0.01 * std::sin(std::numbers::pi * t);
}

void stroke_runs(const RubbedLaw& law, FrictionRow& row) {
    constexpr int kTicks = 4000;
    Pressed slow(law, kTick);
    Pressed fast(law, 0.1 * kTick);
    double last = 0.0;
    for (int i = 0; i <= kTicks; ++i) {
        const double t = kTick * i;
        double finer = 0.0;
        for (int k = i == 0 ? 9 : 0; k < 10; ++k) {
            finer = fast.at(stroke(t - 0.1 * kTick * (9 - k)));
        }
        const double force = slow.at(stroke(t));
        row.jump = std::max(row.jump, i > 1 ? std::fabs(force - last) : 0.0);
        row.rate = std::max(row.rate, std::fabs(force - finer));
        last = force;
        if (i >= kTicks / 2) {
            row.x.push_back(stroke(t));
            row.force.push_back(force);
        }
    }
    for (int i = 0; i <= 500; ++i) {  // on to the turning point, and there it stays
        last = slow.at(stroke(kTick * (kTicks + i)));
    }
    for (int i = 0; i < 1000; ++i) {
        last = slow.at(stroke(kTick * (kTicks + 500)));
    }
    row.held = last;
}

/// 5 mm/s, read in steps of 10 um: the last of 4 s, by when every law slides evenly.
double chatter_of(const RubbedLaw& law) {
    constexpr int kTicks = 4000;
    Pressed hand(law, kTick);
    double sum = 0.0;
    double squares = 0.0;
    for (int i = 0; i < kTicks; ++i) {
        const double force = hand.at(1e-5 * std::floor(0.5 * i + 0.25));
        sum += i >= 3 * kTicks / 4 ? force : 0.0;
        squares += i >= 3 * kTicks / 4 ? force * force : 0.0;
    }
    const double mean = sum / (kTicks / 4);
    return std::sqrt(std::max(squares / (kTicks / 4) - mean * mean, 0.0));
}

/// 0.1 kg and 0.5 N s/m under 0.6 + 0.3 sin(2 pi t) N for 20 s: how far the mean place of the
/// last second lies from that of the second one.
double drift_of(const RubbedLaw& law) {
    constexpr int kSteps = 10;
    constexpr double kStep = kTick / kSteps;
    Pressed hand(law, kTick);
    double x = 0.0;
    double v = 0.0;
    double second = 0.0;
    double last = 0.0;
    for (int i = 0; i < 20'000; ++i) {
        const double friction = hand.at(x);
        for (int k = 0; k < kSteps; ++k) {
            const double t = kTick * i + kStep * k;
            const double load = 0.6 + 0.3 * std::sin(2.0 * std::numbers::pi * t);
            v += kStep * (load + friction - 0.5 * v) / 0.1;
            x += kStep * v;
        }
        second += i / 1000 == 1 ? 1e-3 * x : 0.0;
        last += i / 1000 == 19 ? 1e-3 * x : 0.0;
    }
    return last - second;
}

/// Hands that wander in and out, read in steps of 10 um; the worst balance of any episode.
double given_of(const RubbedLaw& law) {
    if (law.as_recalled) {
        return 0.0;
    }
    const engine::Scene scene = scene_of(law, kTick);
    double worst = -1.0;
    for (unsigned seed = 0; seed < 20; ++seed) {
        tests::Random random(seed);
        engine::ContactState state;
        engine::EnergyLedger<2> ledger(kStiffness);
        Vec2 hip{0.0, 0.005};
        Vec2 speed{};
        for (int i = 0; i < 20'000; ++i) {
            speed = 0.97 * speed + random.point(-1.0, 1.0) * 2e-5 - 0.002 * hip;
            hip += speed;
            const Vec2 read{1e-5 * std::floor(1e5 * hip.x), 1e-5 * std::floor(1e5 * hip.y)};
            const engine::Contact contact = scene.tick(state, read);
            ledger.add(read, contact.force, contact.mode != engine::Mode::free);
        }
        worst = std::max(worst, ledger.worst());
    }
    return worst;
}

/// The best of many passes over ready ticks, ns each.
double best_time(int ticks, const std::function<void()>& pass) {
    double best = 1e9;
    for (int i = 0; i < 60; ++i) {
        const auto start = std::chrono::steady_clock::now();
        pass();
        const std::chrono::duration<double, std::nano> took =
            std::chrono::steady_clock::now() - start;
        best = std::min(best, took.count() / ticks);
    }
    return best;
}

void times_of(const RubbedLaw& law, FrictionRow& row) {
    constexpr int kTicks = 4000;
    std::vector<Vec2> hips;
    std::vector<engine::Rub> rubs;
    for (int i = 0; i < kTicks; ++i) {
        hips.push_back({stroke(kTick * i), -kLoad / kStiffness});
        rubs.push_back({.travel = stroke(kTick * (i + 1)) - stroke(kTick * i),
                        .load = kLoad,
                        .place = hips.back().x + 1.0});
    }
    volatile double kept = 0.0;
    if (!law.as_recalled) {
        const engine::Scene scene = scene_of(law, kTick);
        engine::ContactState state;
        row.tick = best_time(kTicks, [&] {
            for (const Vec2& hip : hips) {
                kept = scene.tick(state, hip).force.x;
            }
        });
    }
    if (law.own.traits != nullptr) {
        const engine::FrictionLaw alone(law.own, law.friction, kStiffness, kTick);
        engine::LawState state;
        row.law_alone = best_time(kTicks, [&] {
            for (const engine::Rub& rub : rubs) {
                kept = alone.step(state, rub).force;
            }
        });
    }
}

}  // namespace

std::vector<RubbedLaw> rubbed_laws() {
    const engine::Friction one{.mu_s = 0.5, .mu_d = 0.5};
    std::vector<RubbedLaw> laws{{.name = "frictionless", .friction = {}},
                                {.name = "gos", .friction = tests::kStudyFriction},
                                {.name = "coulomb", .friction = one}};
    for (const engine::LawTraits* const each : engine::all_laws()) {
        const engine::LawTraits& traits = *each;
        RubbedLaw& law = laws.emplace_back();
        law.name = traits.word;
        law.friction = traits.sticks ? engine::Friction{.mu_s = 0.7, .mu_d = 0.5} : one;
        law.own.traits = &traits;
        law.own.viscosity = traits.needs_first ? 1.0 : 0.0;
    }
    laws.push_back({.name = "hayward_armstrong z^8", .friction = one, .as_recalled = true});
    return laws;
}

FrictionRow run_of(const RubbedLaw& law) {
    FrictionRow row;
    row.law = law;
    stroke_runs(law, row);
    row.chatter = chatter_of(law);
    row.drift = drift_of(law);
    row.given = given_of(law);
    times_of(law, row);
    return row;
}

std::vector<EulerRun> euler_runs() {
    constexpr double kBristles = 1e4;  ///< N/m
    constexpr double kLight = 2.0;     ///< N
    const engine::Friction friction{.mu_s = 0.7, .mu_d = 0.5};
    const engine::FrictionLaw exact({.traits = engine::law_named("lugre"), .stiffness = kBristles},
                                    friction, kStiffness, kTick);
    const engine::FrictionLaw euler(
        {.traits = engine::law_named("lugre_euler"), .stiffness = kBristles}, friction, kStiffness,
        kTick);
    std::vector<EulerRun> runs;
    for (double speed = 0.05; speed < 0.501; speed += 0.025) {
        EulerRun& run = runs.emplace_back();
        run.speed = speed;
        run.share = 2.0 * speed / engine::euler_limit(kBristles, kLight, friction.mu_d, kTick);
        engine::LawState a;
        engine::LawState b;
        for (int i = 0; i < 1000; ++i) {
            const engine::Rub rub{.travel = speed * kTick, .load = kLight};
            run.exact = std::fabs(exact.step(a, rub).force);
            run.euler = std::max(std::fabs(euler.step(b, rub).force), i < 900 ? 0.0 : run.euler);
        }
    }
    return runs;
}

}  // namespace palpate::bench
