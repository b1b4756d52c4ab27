#include "tests/figures/thesis/algorithm1.hpp"

#include "engine/base/text.hpp"

namespace palpate::figures {
namespace {

const Algorithm1Spec& checked(const Algorithm1Spec& spec) {
    const auto from_zero = [](double v) {
        return std::isfinite(v) && v >= 0.0;
    };
    require(spec.stiffness > 0.0 && spec.stiffness <= 1e9, "stiffness", spec.stiffness,
            "give N/m above 0, at most 1e9");
    require(from_zero(spec.mu_d) && spec.mu_d <= 1e3, "mu_d", spec.mu_d, "give 0 to 1000");
    require(spec.mu_s >= spec.mu_d && spec.mu_s <= 1e3, "mu_s", spec.mu_s,
            "give a value from mu_d to 1000");
    require(std::isfinite(spec.epsilon) && spec.epsilon > 0.0, "epsilon", spec.epsilon,
            "give m above 0");
    require(from_zero(spec.dead_band), "dead band", spec.dead_band, "give m/s, 0 for none");
    return spec;
}

int sign(double value) noexcept {
    return value > 0.0 ? 1 : value < 0.0 ? -1 : 0;
}

}  // namespace

ThesisFriction::ThesisFriction(const Algorithm1Spec& spec) : spec_(checked(spec)) {}

bool ThesisFriction::turned(double before, double now) const noexcept {
    const bool both_move = std::fabs(before) > spec_.dead_band && std::fabs(now) > spec_.dead_band;
    return sign(before) != sign(now) && (spec_.dead_band == 0.0 || both_move);
}

double ThesisFriction::modulated(const Algorithm1State& state, double psi) const noexcept {
    const double error = std::fabs(psi);
    if (error <= spec_.epsilon || state.psi_0 <= 0.0) {
        return spec_.mu_d;
    }
    return spec_.mu_d + (spec_.mu_s - spec_.mu_d) * std::min(1.0, error / state.psi_0);
}

void ThesisFriction::no_contact(Algorithm1State& state, const Vec2& velocity) const noexcept {
    state = {};
    state.last_velocity = velocity;
}

Algorithm1Force ThesisFriction::contact(Algorithm1State& state,
                                        const PointOfApplication& at,
                                        const Vec2& hip,
                                        const Vec2& velocity) const noexcept {
    const Vec2 stretch = at.point - hip;
    const double psi = glm::dot(stretch, at.tangent);
    const double load = spec_.stiffness * glm::dot(stretch, at.normal);
    const double tangential = spec_.stiffness * psi;
    const bool reversal =
        turned(glm::dot(state.last_velocity, at.tangent), glm::dot(velocity, at.tangent));
    Algorithm1Force out{.mode = Mode::stuck, .fn = load, .mu = spec_.mu_s, .psi = psi};

    if (!state.dynamic) {
        state.locked = true;
        if (std::fabs(tangential) < spec_.mu_s * load) {
            state.friction = tangential + (state.continuity ? state.offset : 0.0);
            if (reversal) {
                state.seat = true;
                state.continuity = false;
            }
        } else {
            state.dynamic = true;
            state.locked = false;
            state.offset = state.friction;
            state.direction = sign(tangential);
            state.psi_0 = std::fabs(psi);
            state.slip_load = load;
            out.mode = Mode::transition;
        }
    } else if (reversal) {
        state.dynamic = false;
        state.seat = true;
        state.continuity = false;
    } else if (spec_.mu_d * load > spec_.mu_s * (spec_.variant == Algorithm1Variant::literal
                                                     ? state.last_load
                                                     : state.slip_load)) {
        state.dynamic = false;
        state.seat = true;
        state.continuity = true;
        state.offset = state.friction;
    } else {
        out.mode = std::fabs(psi) > spec_.epsilon ? Mode::transition : Mode::slip;
        out.mu = modulated(state, psi);
        state.friction = state.direction * out.mu * load + (state.continuity ? state.offset : 0.0);
    }
    state.last_load = load;
    state.last_velocity = velocity;
    out.ft = state.friction;
    out.force = load * at.normal + state.friction * at.tangent;
    return out;
}

}  // namespace palpate::figures
