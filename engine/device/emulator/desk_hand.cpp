#include "engine/device/emulator/desk_hand.hpp"

#include <cmath>
#include <stdexcept>

namespace palpate::engine {

DeskHand::DeskHand(const Calibration& machine, const Exploration& plan)
    : pantograph_(machine.pantograph), path_(plan) {
    const auto home =
        machine.home ? pantograph_.reach(*machine.home) : std::optional(pantograph_.angles({0, 0}));
    const auto start = pantograph_.reach(plan.start);
    if (!home || !pantograph_.locate(*home) || !start) {
        throw std::invalid_argument("the linkage of " + machine.pantograph.name +
                                    " cannot be at its home pose or at the start: correct home, "
                                    "zero_deg or the origin");
    }
    home_ = angles_ = *home;
    start_ = *start;
}

Vec2 DeskHand::hip() const noexcept {
    const auto fix = pantograph_.locate(angles_);
    return fix ? fix->hip : Vec2{};
}

void DeskHand::before_set_up() noexcept {
    angles_ = home_;
    turn_to(Act::rests);
}

void DeskHand::turn_to(Act act) noexcept {
    act_ = act;
    from_ = angles_;
    time_ = 0.0;
}

/// At rest at both ends.
void DeskHand::glide(const JointAngles& to) noexcept {
    const double t = std::fmin(time_ / kGlide, 1.0);
    const double share = t * t * (3.0 - 2.0 * t);
    for (std::size_t i = 0; i < 2; ++i) {
        angles_[i] = from_[i] + share * (to[i] - from_[i]);
    }
}

void DeskHand::advance(double seconds) noexcept {
    time_ += seconds;
    switch (act_) {
        case Act::waits:
            break;
        case Act::rests:
            if (time_ >= kRest) {
                turn_to(Act::goes);
            }
            break;
        case Act::goes:
            glide(start_);
            if (time_ >= kGlide) {
                turn_to(Act::explores);
            }
            break;
        case Act::explores:
            angles_ = pantograph_.reach(path_.at(time_).position).value_or(angles_);
            if (time_ >= path_.duration()) {
                turn_to(Act::comes);
            }
            break;
        case Act::comes:
            glide(home_);
            if (time_ >= kGlide) {
                turn_to(Act::rests);
            }
            break;
    }
}

}  // namespace palpate::engine
