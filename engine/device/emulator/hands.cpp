#include "engine/device/emulator/hands.hpp"

#include <cmath>

#include "engine/base/refuse.hpp"
#include "engine/device/machine.hpp"

namespace palpate::engine {

void GlidingHand::set_off() noexcept {
    from_ = angles_;
    time_ = 0.0;
}

bool GlidingHand::glide(const JointAngles& to, double seconds) noexcept {
    const double t = std::fmin(time_ / seconds, 1.0);
    const double share = t * t * (3.0 - 2.0 * t);
    for (std::size_t i = 0; i < 2; ++i) {
        angles_[i] = from_[i] + share * (to[i] - from_[i]);
    }
    return time_ >= seconds;
}

Vec2 GlidingHand::place_of(const Pantograph& machine, const JointAngles& angles) noexcept {
    const auto fix = machine.locate(angles);
    return fix ? fix->hip : Vec2{};
}

DeskHand::DeskHand(const Calibration& machine, const Exploration& plan)
    : pantograph_(machine.pantograph), path_(plan) {
    const auto home =
        machine.home ? pantograph_.reach(*machine.home) : std::optional(pantograph_.angles({0, 0}));
    const auto start = pantograph_.reach(plan.start);
    refuse_if(!home || !pantograph_.locate(*home) || !start,
              "the linkage of {} cannot be at its home pose or at the start: correct home, "
              "zero_deg or the origin",
              machine.pantograph.name);
    home_ = angles_ = *home;
    start_ = *start;
}

void DeskHand::before_set_up() noexcept {
    angles_ = home_;
    turn_to(Act::rests);
}

void DeskHand::turn_to(Act act) noexcept {
    act_ = act;
    set_off();
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
            if (glide(start_)) {
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
            if (glide(home_)) {
                turn_to(Act::rests);
            }
            break;
    }
}

namespace {

GantrySpec gantry_of(const Calibration& machine) {
    refuse_if(!machine.gantry, "the machine {} has no three axes", machine.name());
    return *machine.gantry;
}

GantryModel model_of(const Calibration& machine, bool held) {
    GantryModel model;
    model.damping = machine.damping().value_or(model.damping);
    model.hand = held ? HandModel{} : kNobody;
    return model;
}

/// Where it goes from home, and comes back to.
SurfaceExploration round_from(const GantrySpec& machine) {
    return {.start = machine.home(), .returns = true};
}

}  // namespace

FreeHandle::FreeHandle(const PlantModel& plant, const Vec2& place)
    : plant_(held_by(plant, kNobody)), stroke_(held_by(plant, {})), machine_(plant.machine) {
    put(place);
}

void FreeHandle::bring(const Vec2& place) {
    stroke_.begin({.start = place, .tremor = 0.0});  // refuses what cannot be reached
    aim_ = stroke_.angles();
    place_ = place;
    turn_to(Act::brings);
}

void FreeHandle::put(const Vec2& place) {
    plant_.begin({.start = place, .tremor = 0.0});
    plant_.set_torque(torque_);
    angles_ = plant_.angles();
    turn_to(Act::free);
}

void FreeHandle::hold(bool held) {
    if (held) {
        turn_to(Act::held);
    } else if (act_ != Act::free) {
        put(place_of(machine_, angles_));
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
    set_off();
}

void FreeHandle::set_torque(const Vec3& newton_metres) noexcept {
    torque_ = gain_ * Vec2(newton_metres);
    plant_.set_torque(torque_);
    stroke_.set_torque(torque_);
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
            if (glide(aim_, kBring)) {
                put(place_);
            }
            break;
        case Act::comes:
            if (glide(aim_)) {
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

GantryHand::GantryHand(const Calibration& machine, bool held)
    : machine_(gantry_of(machine)), held_(held), plant_(model_of(machine, held)) {
    plant_.begin(round_from(machine_));
}

void GantryHand::bring(const Vec3& place) {
    refuse_if(!Gantry(machine_).weakest_force(place),
              "({:.9g}, {:.9g}, {:.9g}) mm is outside the workspace of {}: give a place within it",
              1e3 * place.x, 1e3 * place.y, 1e3 * place.z, machine_.name);
    glide_to(place);
    keeps_ = held_;
}

/// At rest there, in whatever holds it.
void GantryHand::put(const Vec3& place) noexcept {
    plant_.begin({.start = place, .tremor = 0.0});
    plant_.set_force(force_);
    aim_.reset();
}

void GantryHand::glide_to(const Vec3& place) noexcept {
    from_ = place_ = hip();
    aim_ = place;
    time_ = 0.0;
}

/// At rest at both ends.
void GantryHand::glide(double seconds) noexcept {
    time_ += seconds;
    const double way = glm::length(*aim_ - from_);
    if (kSpeed * time_ >= way) {
        return put(*aim_);
    }
    const double t = kSpeed * time_ / way;
    place_ = from_ + t * t * (3.0 - 2.0 * t) * (*aim_ - from_);
}

void GantryHand::hold(bool held) {
    GantryModel model = model_of({.gantry = machine_}, held);
    model.friction = plant_.model().friction;
    model.weight = plant_.model().weight;
    const Vec3 place = hip();
    held_ = keeps_ = held;
    plant_ = GantryPlant(model);
    put(place);
}

void GantryHand::explore() {
    hold(true);
    keeps_ = explores_ = false;
    rested_ = 0.0;
    glide_to(machine_.home());
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
        put(machine_.home());
        explores_ = false;
        keeps_ = false;
        rested_ = 0.0;
    }
}

void GantryHand::advance(double seconds) noexcept {
    if (aim_) {
        return glide(seconds);
    }
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
    return (hip()[static_cast<int>(axis)] - straight.home) / straight.radius;
}

}  // namespace palpate::engine
