#include "data/trace/retrace.hpp"

#include <cmath>
#include <cstring>

#include "engine/realtime/felt_scene.hpp"
#include "data/trace/derived_hash.hpp"
#include "data/trace/fixed_point.hpp"
#include "data/trace/stored_columns.hpp"

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

engine::Vec2 HipFromCounts::at(const engine::Pantograph::Counts& counts) noexcept {
    engine::Vec2 hip{};
    at(std::span(&counts, 1), std::span(&hip, 1));
    return hip;
}

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

/// HIP follows from the other columns.
bool Retrace::same_hip(const TickRecord& tick) noexcept {
    const auto whole = [](double metres) {
        return steps_in_metres(in_steps(metres, kHipSteps));
    };
    if (scene_.space != nullptr) {
        return same(engine::Vec3{whole(tick.hip.x), whole(tick.hip.y), whole(tick.hip.z)},
                    tick.hip);
    }
    return same(engine::Vec3(machine_ ? machine_->at(tick.counts) : engine::Vec2{}, 0.0), tick.hip);
}

std::uint8_t Retrace::parts(const TickRecord& tick) noexcept {
    unsigned parts = 0;
    if (!same_hip(tick)) {
        parts |= part_hip;
    }
    TickRecord again = tick;
    contacts(std::span(&again, 1));
    if (!has_scene() || !same_contact(again, tick)) {
        parts |= part_contact;
    }
    if (!same(tick.command, tick.force)) {
        parts |= part_command;
    }
    const auto us = static_cast<double>(tick.lateness_us);
    if (!same(lateness_us(in_steps(us, kLatenessSteps)), tick.lateness_us)) {
        parts |= part_lateness;
    }
    return static_cast<std::uint8_t>(parts);
}

}  // namespace palpate::data
