#pragma once

#include <array>
#include <cmath>

#include "engine/safety/safety_chain.hpp"

namespace palpate::tests {

/// A handle that a hand presses against a flat wall through the origin, rendered without friction
/// and kept safe by the chain: what a commanded force does is what the machine makes of it, a tick
/// later.
struct PressedWall {
    double stiffness = 200.0;  ///< K, N/m
    double handle = 0.12;      ///< kg, with what of the hand moves with it
    double hand_k = 300.0;     ///< N/m to where the hand means to be
    double hand_b = 4.0;       ///< N s/m
    double press = 0.008;      ///< m inside of the wall that it means to be
    double approach = 0.06;    ///< m/s
    engine::Vec2 normal{0.0, 1.0};
    double tap_hz = 0.0;   ///< the hand goes up and down as well
    double tap = 0.0;      ///< m, amplitude
    double step = 0.0001;  ///< m, in which HIP is read
    /// Columns of the matrix from commanded to true force; a right machine's is 1.
    std::array<engine::Vec2, 2> machine{engine::Vec2{1.0, 0.0}, engine::Vec2{0.0, 1.0}};
    engine::SafetyLimits limits{.max_force = 1.5, .ramp_step = 0.005};

    struct Course {
        engine::Trip trip = engine::Trip::none;
        double touched_s = -1.0;  ///< first contact
        double full_s = -1.0;     ///< first command at the limit
        double tripped_s = -1.0;
        double deepest = 0.0;  ///< m
        double command = 0.0;  ///< N, the strongest after a trip
    };

    /// @param seconds  of a trial
    [[nodiscard]] Course run(double seconds) const {
        constexpr double kAway = 0.02;  // m from the wall at the start
        constexpr int kParts = 20;
        engine::SafetyLimits chain = limits;
        chain.stiffness = stiffness;
        engine::SafetyState state;
        Course course;
        engine::Vec2 at = kAway * normal;
        engine::Vec2 velocity{};
        engine::Vec2 waiting{};
        const double period = chain.period;
        for (int k = 0; k * period < seconds; ++k) {
            const double now = k * period;
            const engine::Vec2 hip{std::floor(at.x / step + 0.5) * step,
                                   std::floor(at.y / step + 0.5) * step};
            const double depth = std::fmax(0.0, -glm::dot(hip, normal));
            const engine::Vec2 force = stiffness * depth * normal;
            const engine::Command command = make_safe(state, chain,
                                                      {.force = engine::Vec3(force, 0.0),
                                                       .spring = engine::Vec3(depth * normal, 0.0),
                                                       .depth = depth,
                                                       .hip = engine::Vec3(hip, 0.0)});
            note(course, command, depth, now, chain.max_force);
            const engine::Vec2 means = intention(now, kAway);
            for (int i = 0; i < kParts; ++i) {
                const engine::Vec2 pull = waiting + hand_k * (means - at) - hand_b * velocity;
                velocity += period / kParts / handle * pull;
                at += period / kParts * velocity;
            }
            waiting = command.force.x * machine[0] + command.force.y * machine[1];
        }
        return course;
    }

private:
    [[nodiscard]] engine::Vec2 intention(double now, double away) const {
        const double down = std::fmin(away + press, approach * std::fmax(0.0, now - 0.1));
        const double swing = tap * std::sin(6.283185307179586 * tap_hz * now);
        return (away - down + swing) * normal;
    }
    static void note(
        Course& course, const engine::Command& command, double depth, double now, double limit) {
        course.deepest = std::fmax(course.deepest, depth);
        course.touched_s = course.touched_s < 0.0 && depth > 0.0 ? now : course.touched_s;
        const double strength = glm::length(command.force);
        course.full_s = course.full_s < 0.0 && strength > 0.999 * limit ? now : course.full_s;
        if (command.trip != engine::Trip::none) {
            course.tripped_s = course.trip == engine::Trip::none ? now : course.tripped_s;
            course.command = std::fmax(course.command, strength);
        }
        course.trip = command.trip;
    }
};

}  // namespace palpate::tests
