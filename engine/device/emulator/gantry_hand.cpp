#include "engine/device/emulator/gantry_hand.hpp"

#include <stdexcept>

#include "engine/base/text.hpp"
#include "engine/device/gantry.hpp"

namespace palpate::engine {
namespace {

GantrySpec gantry_of(const Calibration& machine) {
    if (!machine.gantry) {
        throw std::invalid_argument("the machine " + machine.name() + " has no three axes");
    }
    return *machine.gantry;
}

GantryModel model_of(const Calibration& machine, bool held) {
    GantryModel model;
    model.damping = machine.damping().value_or(model.damping);
    if (!held) {
        model.hand = {.mass = 0.0, .stiffness = 0.0, .damping = 0.0, .strength = 0.0};
    }
    return model;
}

/// Where it goes from home, and comes back to.
SurfaceExploration round_from(const GantrySpec& machine) {
    return {.start = machine.home(), .returns = true};
}

}  // namespace

GantryHand::GantryHand(const Calibration& machine, bool held)
    : machine_(gantry_of(machine)), held_(held), plant_(model_of(machine, held)) {
    plant_.begin(round_from(machine_));
}

void GantryHand::bring(const Vec3& place) {
    if (!Gantry(machine_).weakest_force(place)) {
        throw std::invalid_argument("(" + number_text(1e3 * place.x) + ", " +
                                    number_text(1e3 * place.y) + ", " + number_text(1e3 * place.z) +
                                    ") mm is outside the workspace of " + machine_.name +
                                    ": give a place within it");
    }
    plant_.begin({.start = place, .tremor = 0.0});
    plant_.set_force(force_);
    keeps_ = held_;
}

void GantryHand::hold(bool held) {
    GantryModel model = model_of({.gantry = machine_}, held);
    model.friction = plant_.model().friction;
    model.weight = plant_.model().weight;
    const Vec3 place = plant_.position();
    held_ = held;
    plant_ = GantryPlant(model);
    bring(place);
}

void GantryHand::explore() {
    hold(true);
    before_set_up();
}

void GantryHand::set_torque(const Vec3& newton_metres) noexcept {
    for (int motor = 0; motor < 3; ++motor) {
        const std::size_t axis = moves_[static_cast<std::size_t>(motor)];
        force_[static_cast<int>(axis)] =
            gain_[motor] * newton_metres[motor] / machine_.axes[axis].radius;
    }
    plant_.set_force(force_);
}

void GantryHand::before_set_up() noexcept {
    if (held_) {
        plant_.begin(round_from(machine_));
        explores_ = false;
        keeps_ = false;
        rested_ = 0.0;
    }
}

void GantryHand::advance(double seconds) noexcept {
    if (!held_) {
        plant_.advance(seconds);
        return;
    }
    if (keeps_) {
        return;
    }
    if (!explores_) {
        rested_ += seconds;
        if (rested_ >= kRest) {
            plant_.begin(round_from(machine_));
            plant_.set_force(force_);
            explores_ = true;
            settled_ = 0.0;
        }
        return;
    }
    plant_.advance(seconds);
    settled_ += plant_.hand_is_done() ? seconds : 0.0;
    if (settled_ >= kSettle) {
        explores_ = false;
        rested_ = 0.0;
    }
}

double GantryHand::angle(std::size_t axis) const noexcept {
    const StraightAxis& straight = machine_.axes[axis];
    return (plant_.position()[static_cast<int>(axis)] - straight.home) / straight.radius;
}

}  // namespace palpate::engine
