#include "protocols/session/feasibility.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "engine/safety/passivity.hpp"
#include "protocols/design/object_outline.hpp"
#include "protocols/trial/start_gate.hpp"

namespace palpate::protocols {
namespace {

constexpr int kStrips = 8;            ///< of a patch along each of its sides
constexpr int kPieces = 64;           ///< of each side of an outline: 0.9 mm of the default one
constexpr double kHighestRate = 1e4;  ///< Hz, of a servo
constexpr double kRounding = 1e-9;    ///< share by which a bound may be missed

std::string delay_text(double ticks) {
    if (ticks == 0.0) {
        return "without delay";
    }
    return ticks == 1.0 ? "with one tick of delay"
                        : fmt::format("with {:.3g} ticks of delay", ticks);
}

/// @param space  z is said as well
std::string point_text(const engine::Vec3& point, bool space) {
    return fmt::format("({:.1f}, {:.1f}{}) mm", 1e3 * point.x, 1e3 * point.y,
                       space ? fmt::format(", {:.1f}", 1e3 * point.z) : std::string());
}

std::string damper_text(double damping) {
    return damping == 0.0 ? "" : fmt::format(" with a damper of {:.6g} N s/m", damping);
}

/// The apparatus with the damper of a friction, where that is the stronger one.
ApparatusSpec with_all_dampers(const Protocol& protocol) {
    ApparatusSpec apparatus = protocol.apparatus;
    apparatus.damping = contact_damping(protocol);
    return apparatus;
}

/// What would make b >= K T (1/2 + d) + |B|.
std::string passivity_remedy(const ApparatusSpec& apparatus,
                             const engine::DeviceTraits& traits,
                             double damping) {
    const double period = 1.0 / apparatus.rate_hz;
    const double left = damping - std::fabs(apparatus.damping);  // for the spring
    const double softest = left / (period * (0.5 + traits.delay_ticks));
    const double rate = apparatus.stiffness * (0.5 + traits.delay_ticks) / left;
    std::string remedy =
        softest >= 1.0 ? fmt::format("lower stiffness_n_per_m to {}",
                                     static_cast<long>(std::floor(softest * (1.0 + kRounding))))
        : apparatus.damping != 0.0
            ? std::string("lower damping_n_s_per_m or a friction's damper, which come on top")
            : std::string("give the device some damping");
    if (left > 0.0 && rate <= kHighestRate * (1.0 + kRounding)) {
        remedy += fmt::format(" or raise rate_hz to {}",
                              static_cast<long>(std::ceil(rate * (1.0 - kRounding))));
    }
    return remedy;
}

void check_passivity(const ApparatusSpec& apparatus,
                     const engine::DeviceTraits& traits,
                     std::vector<Finding>& findings) {
    const double period = 1.0 / apparatus.rate_hz;
    const double need =
        engine::min_damping(apparatus.stiffness, period, traits.delay_ticks, apparatus.damping);
    const std::string asked = fmt::format(
        "{:.6g} N/m{} at {:.6g} Hz {} needs {:.3g} N s/m at the handle", apparatus.stiffness,
        damper_text(apparatus.damping), apparatus.rate_hz, delay_text(traits.delay_ticks), need);
    if (!traits.damping) {
        findings.push_back({Verdict::warn, "how much the device damps is not known, and " + asked +
                                               ": measure it and give it in the calibration, or "
                                               "the contact may buzz under a light hand"});
        return;
    }
    const double damping = *traits.damping;
    if (damping >= need * (1.0 - kRounding)) {
        return;
    }
    findings.push_back(
        {Verdict::refuse, fmt::format("the device damps {:.3g} N s/m; {}: {}", damping, asked,
                                      passivity_remedy(apparatus, traits, damping))});
}

/// A point of an object, and what the device can do there.
struct Spot {
    const ObjectSpec* object = nullptr;
    engine::Vec3 point{};
    std::optional<double> force;  ///< N, in its weakest direction
    std::optional<double> error;  ///< m, of a reading
};

std::vector<Spot> spots(const Protocol& protocol, const engine::Device& device) {
    std::vector<Spot> found;
    const auto add = [&](const ObjectSpec& object, const engine::Vec3& point) {
        found.push_back({&object, point, device.weakest_force(point), device.reading_error(point)});
    };
    if (protocol.surface) {
        for (const ObjectSpec& object : protocol.objects) {
            const auto patch = surface_of(protocol, object);
            for (int i = 0; i <= kStrips * kStrips + 2 * kStrips; ++i) {
                const double u = 1.0 + static_cast<double>(i % (kStrips + 1)) / kStrips;
                const double v = 1.0 + static_cast<double>(i / (kStrips + 1)) / kStrips;
                add(object, patch->at(u, v).point);
            }
        }
        return found;
    }
    for (std::size_t i = 0; i < protocol.objects.size(); ++i) {
        const auto outline = outline_of(protocol, i);
        for (const auto& side : outline->spans()) {
            for (int k = 0; k < kPieces; ++k) {
                const engine::Vec2 point = side.at(static_cast<double>(k) / kPieces).point;
                add(protocol.objects[i], engine::Vec3(point, 0.0));
            }
        }
    }
    return found;
}

void check_workspace(const Protocol& protocol,
                     const std::vector<Spot>& spots,
                     bool start_in_reach,
                     std::vector<Finding>& findings) {
    const bool space = protocol.surface.has_value();
    const auto outside = std::ranges::find_if(spots, [](const Spot& spot) { return !spot.force; });
    if (outside != spots.end()) {
        findings.push_back(
            {Verdict::refuse,
             fmt::format(
                 "the handle cannot reach {} of object \"{}\": move or shrink the object "
                 "({}), or {}",
                 point_text(outside->point, space), outside->object->name,
                 space ? "surface.size_mm, curvature_per_m"
                       : "outline.a_mm, vertex_mm, b_mm, or the object's size and offset_mm",
                 space ? "correct home_mm, low_mm and high_mm of the axes in the calibration"
                       : "correct origin_mm, turn_deg and the links in the calibration")});
    }
    if (!start_in_reach) {
        findings.push_back(
            {Verdict::refuse, fmt::format("the handle cannot reach the start pose {}: move "
                                          "apparatus.start_mm{} closer to the object",
                                          point_text(start_of(protocol), space),
                                          space ? " or surface.start_height_mm" : "")});
    }
}

/// N > 0, to three digits and no more than it is.
double rounded_down(double force) {
    const double digit = std::pow(10.0, std::floor(std::log10(force)) - 2.0);
    return std::floor(force / digit * (1.0 + kRounding)) * digit;
}

void check_force(const Protocol& protocol,
                 const std::vector<Spot>& spots,
                 std::vector<Finding>& findings) {
    const ApparatusSpec& apparatus = protocol.apparatus;
    const Spot* weakest = nullptr;
    for (const Spot& spot : spots) {
        if (spot.force && (weakest == nullptr || *spot.force < *weakest->force)) {
            weakest = &spot;
        }
    }
    if (weakest == nullptr || *weakest->force >= apparatus.force_limit * (1.0 - kRounding)) {
        return;
    }
    findings.push_back(
        {Verdict::warn,
         fmt::format("the device gives {:.3g} N at {} of object \"{}\", less than force_limit_n = "
                     "{:.6g}: with {:.6g} N/m the force clips there from a depth of {:.3g} mm on; "
                     "such ticks are flagged as saturated, and force_limit_n = {:.3g} would make "
                     "the limit the same everywhere",
                     *weakest->force, point_text(weakest->point, protocol.surface.has_value()),
                     weakest->object->name, apparatus.force_limit, apparatus.stiffness,
                     1e3 * *weakest->force / apparatus.stiffness, rounded_down(*weakest->force))});
}

}  // namespace

Margins margins_of(const Protocol& protocol, const engine::Device& device) {
    const engine::DeviceTraits traits = device.traits();
    Margins margins{
        .needed_damping = engine::min_damping(protocol.apparatus.stiffness,
                                              1.0 / protocol.apparatus.rate_hz, traits.delay_ticks),
        .damping = traits.damping,
        .weakest_force = {},
        .reading_error = {}};
    for (const Spot& spot : spots(protocol, device)) {
        if (spot.force && !(margins.weakest_force && *margins.weakest_force <= *spot.force)) {
            margins.weakest_force = spot.force;
        }
        if (spot.error && !(margins.reading_error && *margins.reading_error >= *spot.error)) {
            margins.reading_error = spot.error;
        }
    }
    const ApparatusSpec asked = with_all_dampers(protocol);
    const double need = margins.needed_damping + std::fabs(asked.damping);
    margins.resting_friction = engine::resting_friction(
        asked.stiffness, 1.0 / asked.rate_hz, margins.reading_error.value_or(0.0), asked.damping);
    margins.creep =
        engine::creep_limit(margins.resting_friction, 0.0, margins.damping.value_or(0.0) - need);
    return margins;
}

std::string rest_text(const Margins& margins) {
    if (!margins.reading_error) {
        return {};
    }
    const auto shown = [](double value) {  // two digits or more, and never as 5e+02
        return value < 99.5 ? fmt::format("{:.2g}", value) : fmt::format("{:.0f}", value);
    };
    return fmt::format(
        "positions are read to within {} um: a contact comes to rest if the handle's dry "
        "friction is {} N or more, with less it may creep on{}",
        shown(1e6 * *margins.reading_error), shown(margins.resting_friction),
        std::isfinite(margins.creep)
            ? fmt::format(", at {} mm/s at the very most", shown(1e3 * margins.creep))
            : std::string());
}

std::vector<Finding> check_feasibility(const Protocol& protocol, const engine::Device& device) {
    std::vector<Finding> findings;
    const engine::DeviceTraits traits = device.traits();
    if (!traits.gives_force) {
        return findings;
    }
    check_passivity(with_all_dampers(protocol), traits, findings);
    const std::vector<Spot> known = spots(protocol, device);
    const bool start = device.weakest_force(start_of(protocol)).has_value();
    check_workspace(protocol, known, start, findings);
    check_force(protocol, known, findings);
    return findings;
}

}  // namespace palpate::protocols
