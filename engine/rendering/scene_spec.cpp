#include "engine/rendering/scene_spec.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

#include "engine/base/text.hpp"

namespace palpate::engine {
namespace {

void require(bool ok, const char* what, double value, const char* remedy) {
    if (!ok) {
        throw std::invalid_argument(std::string(what) + " is " + number_text(value) + ": " +
                                    remedy);
    }
}

}  // namespace

const SceneSpec& checked(const SceneSpec& spec) {
    const auto finite_from_zero = [](double v) {
        return std::isfinite(v) && v >= 0.0;
    };
    require(std::isfinite(spec.stiffness) && spec.stiffness > 0.0, "stiffness", spec.stiffness,
            "give N/m above 0");
    require(finite_from_zero(spec.damping), "damping", spec.damping, "give N s/m, 0 for none");
    require(std::isfinite(spec.period) && spec.period > 0.0, "tick period", spec.period,
            "give seconds above 0");
    require(finite_from_zero(spec.friction.mu_d), "mu_d", spec.friction.mu_d, "give 0 or more");
    require(std::isfinite(spec.friction.mu_s) && spec.friction.mu_s >= spec.friction.mu_d, "mu_s",
            spec.friction.mu_s, "give a finite value not below mu_d");
    require(finite_from_zero(spec.friction.tau_slip), "tau_slip", spec.friction.tau_slip,
            "give seconds, 0 for a sharp drop");
    require(finite_from_zero(spec.friction.tau_heal), "tau_heal", spec.friction.tau_heal,
            "give seconds, 0 for healing at once");
    require(finite_from_zero(spec.slew.speed), "vertex slew", spec.slew.speed,
            "give m/s, 0 for none");
    require(spec.slew.none() || (std::isfinite(spec.slew.radius) && spec.slew.radius > 0.0),
            "vertex radius", spec.slew.radius, "give m above 0 when there is a vertex slew");
    return spec;
}

}  // namespace palpate::engine
