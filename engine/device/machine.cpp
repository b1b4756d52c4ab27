#include "engine/device/machine.hpp"

#include <stdexcept>

#include "engine/base/text.hpp"

namespace palpate::engine {
namespace {

std::variant<Pantograph, Gantry> parts_of(const Calibration& calibration) {
    if (calibration.gantry) {
        return Gantry(*calibration.gantry);
    }
    return Pantograph(calibration.pantograph);
}

Machine::Counts home_counts(const Calibration& calibration) {
    if (calibration.gantry || !calibration.home) {
        return {};
    }
    const Pantograph pantograph(calibration.pantograph);
    const auto angles = pantograph.reach(*calibration.home);
    if (!angles || !pantograph.locate(*angles)) {
        throw std::invalid_argument(
            "the linkage of " + calibration.pantograph.name + " does not reach its home pose (" +
            number_text(1e3 * calibration.home->x) + ", " + number_text(1e3 * calibration.home->y) +
            ") mm: correct home, the link lengths or the origin");
    }
    return pantograph.counts(*angles);
}

}  // namespace

Machine::Machine(const Calibration& calibration)
    : calibration_(calibration), parts_(parts_of(calibration)), home_(home_counts(calibration)) {}

std::optional<Machine::Place> Machine::locate(const Counts& counts) const noexcept {
    if (const auto* gantry = std::get_if<Gantry>(&parts_)) {
        const auto hip = gantry->locate(counts);
        return hip ? std::optional(Place{.hip = *hip}) : std::nullopt;
    }
    const auto* pantograph = std::get_if<Pantograph>(&parts_);
    const auto fix = pantograph->locate(pantograph->angles(counts));
    return fix ? std::optional(Place{.hip = Vec3(fix->hip, 0.0), .fix = *fix}) : std::nullopt;
}

Machine::Drive Machine::drive(const Place& place, const Vec3& force) const noexcept {
    if (const auto* gantry = std::get_if<Gantry>(&parts_)) {
        return gantry->drive(force);
    }
    const Pantograph::Drive drive = std::get_if<Pantograph>(&parts_)->drive(place.fix, Vec2(force));
    return {.torque = Vec3(drive.torque, 0.0),
            .saturated = drive.saturated,
            .load = Vec3(drive.load, 0.0)};
}

std::optional<double> Machine::weakest_force(const Vec3& hip) const noexcept {
    const auto* gantry = std::get_if<Gantry>(&parts_);
    return gantry != nullptr ? gantry->weakest_force(hip)
                             : std::get_if<Pantograph>(&parts_)->weakest_force(Vec2(hip));
}

std::optional<double> Machine::reading_error(const Vec3& hip) const noexcept {
    const auto* gantry = std::get_if<Gantry>(&parts_);
    return gantry != nullptr ? gantry->reading_error(hip)
                             : std::get_if<Pantograph>(&parts_)->reading_error(Vec2(hip));
}

}  // namespace palpate::engine
