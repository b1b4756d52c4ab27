#include "data/trace/retrace.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "engine/realtime/felt_scene.hpp"
#include "data/trace/columns.hpp"
#include "data/trace/derived_hash.hpp"
#include "data/trace/fixed_point.hpp"

namespace palpate::data {
namespace {

using engine::TickRecord;

template <class T>
bool same(const T& a, const T& b) noexcept {
    return std::memcmp(&a, &b, sizeof a) == 0;
}

bool same_contact(const TickRecord& a, const TickRecord& b) noexcept {
    return same(a.go, b.go) && same(a.force, b.force) && same(a.normal_force, b.normal_force) &&
           same(a.tangential_force, b.tangential_force) && same(a.mu, b.mu) && same(a.u, b.u) &&
           a.segment == b.segment && a.mode == b.mode && a.flags == b.flags && same(a.v, b.v);
}

}  // namespace

HipFromCounts::HipFromCounts(const engine::PantographSpec& machine) : machine_(machine) {}

void HipFromCounts::at(std::span<const engine::Pantograph::Counts> counts,
                       std::span<engine::Vec2> hips) noexcept {
    machine_.of(counts, hips);
    for (engine::Vec2& hip : hips) {
        last_ = std::isnan(hip.x) ? last_ : hip;
        hip = last_;
    }
}

Retrace::Retrace(const std::optional<engine::PantographSpec>& machine,
                 const engine::SceneView& scene)
    : scene_(scene), state_(std::make_unique<engine::FeltState>()) {
    if (machine) {
        machine_.emplace(*machine);
    }
}

Retrace::~Retrace() = default;

void Retrace::contacts(std::span<TickRecord> ticks) noexcept {
    engine::set_contacts(ticks, scene_, *state_);
}

/// What follows from the other columns.
engine::Vec3 Retrace::hip_of(const TickRecord& tick, std::size_t i) const noexcept {
    if (scene_.space != nullptr) {
        const auto whole = [](double metres) {
            return steps_in_metres(in_steps(metres, kHipSteps));
        };
        return {whole(tick.hip.x), whole(tick.hip.y), whole(tick.hip.z)};
    }
    return {machine_ ? hips_[i] : engine::Vec2{}, 0.0};
}

void Retrace::parts(std::span<const TickRecord> ticks, std::span<std::uint8_t> parts) {
    if (machine_) {
        counts_.resize(ticks.size());
        hips_.resize(ticks.size());
        std::ranges::transform(ticks, counts_.begin(), &TickRecord::counts);
        machine_->at(counts_, hips_);
    }
    again_.resize(ticks.size());
    for (std::size_t i = 0; i < ticks.size(); ++i) {  // what a contact depends on, or leaves alone
        again_[i].hip = ticks[i].hip;
        again_[i].v = ticks[i].v;
        again_[i].flags = ticks[i].flags;
    }
    contacts(again_);
    for (std::size_t i = 0; i < ticks.size(); ++i) {
        const TickRecord& tick = ticks[i];
        const auto us = static_cast<double>(tick.lateness_us);
        const auto part = [](bool follows, Part bit) {
            return follows ? 0U : static_cast<unsigned>(bit);
        };
        parts[i] = static_cast<std::uint8_t>(
            part(same(hip_of(tick, i), tick.hip), part_hip) |
            part(scene_.any() && same_contact(again_[i], tick), part_contact) |
            part(same(tick.command, tick.force), part_command) |
            part(same(lateness_us(in_steps(us, kLatenessSteps)), tick.lateness_us), part_lateness));
    }
}

}  // namespace palpate::data
