#include "engine/device/emulator/free_handle.hpp"

#include <cmath>

namespace palpate::engine {
namespace {

/// The same handle in the hand that explores.
PlantModel somebody_holds(PlantModel plant) {
    plant.hand = {};
    return plant;
}

}  // namespace

FreeHandle::FreeHandle(const PlantModel& plant, const Vec2& place)
    : plant_(nobody_holds(plant)), stroke_(somebody_holds(plant)), machine_(plant.machine) {
    let_go(place);
}

void FreeHandle::bring(const Vec2& place) {
    if (act_ == Act::free) {
        return let_go(place);
    }
    stroke_.begin({.start = place, .tremor = 0.0});  // refuses what cannot be reached
    aim_ = stroke_.angles();
    place_ = place;
    turn_to(Act::brings);
}

void FreeHandle::let_go(const Vec2& place) {
    plant_.begin({.start = place, .tremor = 0.0});
    plant_.set_torque(torque_);
    angles_ = plant_.angles();
    turn_to(Act::free);
}

Vec2 FreeHandle::place_now() const noexcept {
    const auto fix = machine_.locate(angles_);
    return fix ? fix->hip : Vec2{};
}

void FreeHandle::hold(bool held) {
    if (held) {
        turn_to(Act::held);
    } else if (act_ != Act::free) {
        let_go(place_now());
    }
}

void FreeHandle::explore(const Exploration& plan) {
    stroke_.begin(plan);  // refuses what cannot be reached, before anything moves
    plan_ = plan;
    aim_ = stroke_.angles();
    turn_to(Act::comes);
}

void FreeHandle::turn_to(Act act) noexcept {
    act_ = act;
    from_ = angles_;
    time_ = 0.0;
}

void FreeHandle::set_torque(const Vec3& newton_metres) noexcept {
    torque_ = gain_ * Vec2(newton_metres);
    plant_.set_torque(torque_);
    stroke_.set_torque(torque_);
}

/// At rest at both ends.
void FreeHandle::glide() noexcept {
    const double t = std::fmin(time_ / kGlide, 1.0);
    const double share = t * t * (3.0 - 2.0 * t);
    for (std::size_t i = 0; i < 2; ++i) {
        angles_[i] = from_[i] + share * (aim_[i] - from_[i]);
    }
}

void FreeHandle::advance(double seconds) noexcept {
    time_ += seconds;
    switch (act_) {
        case Act::free:
            plant_.advance(seconds);
            angles_ = plant_.angles();
            break;
        case Act::held:
            break;
        case Act::brings:
            glide();
            if (time_ >= kGlide) {
                let_go(place_);
            }
            break;
        case Act::comes:
            glide();
            if (time_ >= kGlide) {
                turn_to(Act::rests);
            }
            break;
        case Act::rests:
            if (time_ >= kRest) {
                stroke_.begin(plan_);
                stroke_.set_torque(torque_);
                turn_to(Act::strokes);
            }
            break;
        case Act::strokes:
            stroke_.advance(seconds);
            angles_ = stroke_.angles();
            if (stroke_.hand_is_done()) {
                turn_to(Act::comes);
            }
            break;
    }
}

}  // namespace palpate::engine
