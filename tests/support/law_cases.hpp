#pragma once

#include "engine/friction/laws/law.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"

/// Random laws of friction, what they are to be felt in, and how they are held against an oracle.
namespace palpate::tests {

using engine::FrictionLaw;
using engine::law_named;
using engine::LawTraits;
using engine::Rub;

inline constexpr double kLawTick = 1e-3;  ///< s

/// A law with random numbers, and the ticks that it is to be felt in.
struct LawCase {
    engine::LawSpec spec{};
    engine::Friction friction{};
    double stiffness = 1000.0;
    std::vector<Rub> rubs;

    [[nodiscard]] FrictionLaw law() const { return {spec, friction, stiffness, kLawTick}; }
};

inline LawCase random_law_case(const LawTraits* kind, Random& random) {
    LawCase c;
    const double mu_d = random.in(0.1, 1.0);
    c.friction = {.mu_s = kind->sticks ? mu_d * random.in(1.0, 2.0) : mu_d, .mu_d = mu_d};
    c.stiffness = random.decade(2.0, 4.0);
    c.spec = {.traits = kind,
              .viscosity = random.in(0.0, 2.0),
              .bristle_damping = random.in(0.0, 1.0),
              .stribeck_speed = random.decade(-3.0, -1.0),
              .smoothing_speed = random.decade(-3.5, -2.0),
              .stick_speed = random.decade(-3.5, -2.0),
              .stick_share = random.in(0.0, 0.95),
              .seed = 7};
    return c;
}

/// A hand that goes to and fro at random under a load that comes, changes and almost goes.
inline void move_about(LawCase& c, Random& random, int ticks = 400) {
    double speed = 0.0;
    double load = 0.0;
    double wanted = random.in(0.5, 6.0);
    double aim = random.in(-0.1, 0.1);
    for (int i = 0; i < ticks; ++i) {
        if (random.below(40) == 0) {
            aim = random.below(4) == 0 ? 0.0 : random.in(-0.2, 0.2);
            wanted = random.in(0.05, 6.0);
        }
        speed = aim == 0.0 ? 0.0 : speed + 0.1 * (aim - speed);
        load += 0.05 * (wanted - load);
        c.rubs.push_back({.travel = speed * kLawTick, .load = load, .place = 0.0});
    }
}

/// Every tick of a case against what is expected of it, relative to the largest force of the case.
/// @param expected  friction against the motion, N
inline void check_law(const LawCase& c,
                      const std::function<double(const Rub&)>& expected,
                      double tolerance) {
    const FrictionLaw law = c.law();
    engine::LawState state;
    double largest = 1e-3;
    double worst = 0.0;
    for (const Rub& rub : c.rubs) {
        const double truth = expected(rub);
        largest = std::max(largest, std::fabs(truth));
        worst = std::max(worst, std::fabs(-law.step(state, rub).force - truth));
    }
    CHECK(worst / largest <= tolerance);
}

inline double sgn(double x) {
    return x > 0.0 ? 1.0 : x < 0.0 ? -1.0 : 0.0;
}

}  // namespace palpate::tests
