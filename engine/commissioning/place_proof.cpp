#include "engine/commissioning/place_proof.hpp"

#include <cmath>

#include "engine/base/text.hpp"

namespace palpate::engine {
namespace {

std::string millimetres(double metres) {
    return number_text(std::round(metres * 1e4) / 10.0) + " mm";
}

}  // namespace

bool Sight::still() const {
    return rest.span.x <= kStillCounts && rest.span.y <= kStillCounts &&
           rest.span.z <= kStillCounts;
}

std::string Sight::text(std::size_t axes) const {
    return place ? place_text(*place, axes) : "nowhere";
}

Sight look_for(PulseRunner& runner, const Calibration& calibration, const Vec3& aim) {
    Sight sight{.rest = runner.watch(kLook)};
    const auto whole = [&](int i) {
        return static_cast<std::int32_t>(std::lround(sight.rest.counts[i]));
    };
    const auto there = std::isfinite(sight.rest.place.x)
                         ? Machine(calibration).locate({whole(0), whole(1), whole(2)})
                         : std::nullopt;
    if (there) {
        sight.place = there->hip;
        sight.off = glm::length(there->hip - aim);
    }
    return sight;
}

ShortForm prove_home(PulseRunner& runner, const Calibration& calibration) {
    const Vec3 home = home_of(calibration);
    const Sight seen = look_for(runner, calibration, home);
    if (!seen.place || !seen.still()) {
        return {.refused = "the handle moves: let it rest, free, at home", .found = {}};
    }
    if (!starts_at_home(calibration)) {
        return {.refused = {}, .found = "at rest; its counts are its own"};
    }
    const std::size_t axes = calibration.axes();
    if (!seen.there()) {
        return {.refused = "bring the handle home, " + place_text(home, axes) +
                           ", and let go of it: the encoders say " + seen.text(axes) +
                           ". If it is at home, one of them slipped: end the session; the command "
                           "that goes on proves the rig from the beginning",
                .found = {}};
    }
    return {.refused = {}, .found = "at home to " + millimetres(seen.off)};
}

ShortForm MarkProof::look(PulseRunner& runner, Device& device) {
    const std::size_t axes = calibration_.axes();
    const Vec3 home = home_of(calibration_);
    const std::string mark = place_text(mark_, axes);
    const Sight seen = look_for(runner, calibration_, mark_);
    if (seen.still() && seen.there()) {
        astray_ = 0;
        return {.refused = {}, .found = "second mark met to " + millimetres(seen.off)};
    }
    const bool at_home = seen.place && glm::length(*seen.place - home) <= kAtPlace;
    astray_ = seen.still() && !at_home ? astray_ + 1 : 0;
    if (astray_ >= kAstray) {
        astray_ = 0;
        device.forget_home();
        return {.refused = "the handle rests, and its encoders say " + seen.text(axes) +
                           ", neither home nor the second mark " + mark + ": bring it home, " +
                           place_text(home, axes) +
                           ", once more; if it was brought there, plugs were exchanged",
                .found = {}};
    }
    return {.refused = "the device is back. Bring the handle to the second mark " + mark +
                       " and let go of it: the encoders say " + seen.text(axes),
            .found = {}};
}

}  // namespace palpate::engine
